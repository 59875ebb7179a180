"""TeX as MathML, to stand inside a page that loads nothing."""

from __future__ import annotations

import re

from latex2mathml.converter import convert
from markupsafe import Markup

__all__ = ["formula", "prose"]

_TEX = re.compile(r"\$([^$]+)\$")
_FUNCTION = re.compile(  # browsers leave no gap behind them
    r"(?:<msup><mi>(?:sin|cos|tan)</mi><mn>\d</mn></msup>"
    r"|(?<!<msup>)<mi>(?:sin|cos|tan)</mi>)(?!<mo)"
)


def prose(text: str) -> Markup:
    """HTML of a text in which $...$ is TeX.

    >>> prose("twice $r$")[:12]
    Markup('twice <math ')
    """
    return Markup(_TEX.sub(lambda match: _mathml(match[1], "inline"), text))


def formula(tex: str) -> Markup:
    """A formula on a separate line."""
    return Markup(_mathml(tex, "block"))


def _mathml(tex: str, display: str) -> str:
    return _FUNCTION.sub(r'\g<0><mspace width="0.17em"/>', convert(tex, display=display))
