"""What a scene and a run amount to in rows of words, for a terminal, and as HTML, for a notebook.

Numbers are computed elsewhere, figures drawn in figures.
"""
