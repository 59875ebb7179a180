"""The page of a scene, served or as a file: the mechanism moving, and what each knob changes.

Pages with a story and questions belong in lessons, pictures for paper in figures.
"""
