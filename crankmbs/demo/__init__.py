"""The page of a scene: the mechanism moving, and what each of its knobs changes, served or as a file.

Pages with a story and questions belong in lessons, pictures for paper in figures.
"""
