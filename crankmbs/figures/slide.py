"""A figure as a slide: 16 to 9, type that is read from the back of a room, the headline first."""

from __future__ import annotations

import textwrap
from typing import Any

from matplotlib.figure import Figure

from crankmbs.figures.style import STYLE

__all__ = ["SIZE", "SLIDE", "head"]

SIZE = (40.0 / 3.0, 7.5)  # inch; 2000 x 1125 pixels
_TYPE = 18  # points: a thirtieth of the height
SLIDE: Any = {
    **STYLE,
    "font.size": _TYPE,
    "axes.titlesize": _TYPE + 2,
    "axes.labelsize": _TYPE,
    "legend.fontsize": _TYPE - 1,
    "legend.frameon": False,
    "legend.borderaxespad": 0.0,
    "lines.linewidth": 3.0,
}
_TOP = 0.875  # of the height: the headline's foot
_LETTERS = 66  # in a line of the headline


def head(figure: Figure, headline: tuple[str, str]) -> None:
    """Write a headline above legend and panels, cut where it is longer than its line.

    headline : and a smaller second line
    """
    first, second = headline
    for text, at, size, weight, letters in (
        (first, 0.975, _TYPE + 6, "bold", _LETTERS),
        (second, 0.915, _TYPE + 2, "normal", _LETTERS + 20),
    ):
        line = textwrap.shorten(text, letters, placeholder=" ...")
        figure.text(0.015, at, line, va="top", fontsize=size, fontweight=weight, parse_math=False)
    (legend,) = figure.legends
    legend.set_bbox_to_anchor((0.0, 0.0, 1.0, _TOP))
    top = legend.get_window_extent().y0 / figure.bbox.height
    figure.set_layout_engine("constrained", rect=(0.0, 0.0, 1.0, top))
