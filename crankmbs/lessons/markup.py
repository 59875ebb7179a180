"""Figures as SVG and TeX as MathML, both to stand inside a page that loads nothing."""

from __future__ import annotations

import io
import re

from latex2mathml.converter import convert
from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.figure import Figure

__all__ = ["formula", "prose", "svg"]

_TEX = re.compile(r"\$([^$]+)\$")
_FUNCTION = re.compile(  # browsers leave no gap behind them
    r"(?:<msup><mi>(?:sin|cos|tan)</mi><mn>\d</mn></msup>"
    r"|(?<!<msup>)<mi>(?:sin|cos|tan)</mi>)(?!<mo)"
)
_NAMES = re.compile(r'(\bid="|xlink:href="#|url\(#)')


def prose(text: str) -> Markup:
    """HTML of a text in which $...$ is TeX.

    >>> prose("twice $r$")[:12]
    Markup('twice <math ')
    """
    return Markup(_TEX.sub(lambda match: _mathml(match[1], "inline"), text))


def formula(tex: str) -> Markup:
    """A formula on a line of its own."""
    return Markup(_mathml(tex, "block"))


def svg(figure: Figure, name: str) -> Markup:
    """A figure as an SVG element whose ids all begin with ``name``, no two figures share any.

    Letters are drawn as outlines: the page looks the same on every machine.
    """
    file = io.StringIO()
    about = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with rc_context({"svg.hashsalt": name, "svg.fonttype": "path"}):
        figure.savefig(file, format="svg", metadata=about)
    text = file.getvalue()
    text = text[text.index("<svg ") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'(<svg [^>]*?)\swidth="[^"]*"|(<svg [^>]*?)\sheight="[^"]*"', r"\1\2", text)
    return Markup(_NAMES.sub(rf"\g<1>{name}-", text))


def _mathml(tex: str, display: str) -> str:
    return _FUNCTION.sub(r'\g<0><mspace width="0.17em"/>', convert(tex, display=display))
