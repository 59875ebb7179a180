"""How the manual is built: ``python -m sphinx -W -b html docs docs/_build``. Nothing in it comes
from a network."""

import sys
from pathlib import Path

from pygments.lexers import TextLexer
from sphinx.application import Sphinx

_HERE = Path(__file__).parent
sys.path[:0] = [str(_HERE / "_ext"), str(_HERE.parent)]

project = "crankmbs"
copyright = "the crankmbs founders, MIT license"
extensions = ["myst_parser", "sphinx.ext.autodoc", "docstrings", "mathml", "made", "blocks"]
exclude_patterns = ["_build", "_made"]
smartquotes = False

myst_enable_extensions = ["dollarmath", "colon_fence", "html_image"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 80

numfig = True

html_theme = "furo"
html_title = "crankmbs"
html_math_renderer = "mathml"
html_static_path = ["_static", "../crankmbs/lessons/font"]
html_css_files = ["manual.css"]
html_extra_path = ["_made/pages"]
html_show_sphinx = False
html_show_sourcelink = False
html_copy_source = False


def setup(app: Sphinx) -> None:
    """Rows of numbers need no colours."""
    app.add_lexer("csv", TextLexer)
