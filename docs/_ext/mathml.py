"""Formulas of the manual as MathML, which a browser shows without a script or a network."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING, Any

from docutils import nodes
from sphinx.util.math import get_node_equation_number

from crankmbs.lessons.markup import formula, prose

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

__all__ = ["setup"]

_CLOSE = re.compile(r"(?<=[\w})])\s*(?=\\(?:sin|cos|tan)\b)")  # a factor before a function


def _inline(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(prose(f"${_spaced(node)}$"))
    raise nodes.SkipNode


def _block(self: HTML5Translator, node: nodes.math_block) -> None:
    label = "".join(f' id="{escape(one)}"' for one in node["ids"][:1])
    number = f"({get_node_equation_number(self, node)})" if node["number"] else ""
    shown = f'{formula(_spaced(node))}<span class="eqno">{number}</span>'
    self.body.append(f'<div class="formula"{label}>{shown}</div>\n')
    raise nodes.SkipNode


def _spaced(node: nodes.Node) -> str:
    """Its TeX with a gap before sin, cos and tan, where browsers leave none."""
    return _CLOSE.sub(r"\\,", node.astext())


def setup(app: Sphinx) -> dict[str, Any]:
    """Make Sphinx write formulas this way."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
