"""A figure as a slide: 16 to 9, type that is read from the back of a room, the headline first."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from crankmbs.figures.style import STYLE, legend_grid, panels

__all__ = ["SLIDE", "slide", "slide_legend"]

_SIZE = (40.0 / 3.0, 7.5)  # inch; 2000 x 1125 pixels
_TYPE = 18  # points: a thirtieth of the height
SLIDE: Any = {
    **STYLE,
    "font.size": _TYPE,
    "axes.titlesize": _TYPE + 2,
    "axes.labelsize": _TYPE,
    "legend.fontsize": _TYPE - 1,
    "lines.linewidth": 3.0,
}
_TOP = 0.855  # of the height: the headline's foot
_ROW = 0.048  # of the height: a row of the legend
_LETTERS = 66  # in a line of the headline


def slide(
    columns: int, headline: tuple[str, str], labels: Sequence[str]
) -> tuple[Figure, list[Axes]]:
    """A slide of two rows of panels with room for a legend under its headline, which is cut where
    it is longer than its line.

    headline : and a smaller second line; labels : of the legend, see `slide_legend`
    """
    figure, axes = panels(2, columns, *_SIZE)
    layout = figure.get_layout_engine()
    assert isinstance(layout, ConstrainedLayoutEngine)
    layout.set(rect=(0.0, 0.0, 1.0, _TOP - _ROW * legend_grid(labels, figure)[0]))
    first, second = headline
    for text, at, size, weight, letters in (
        (first, 0.975, _TYPE + 6, "bold", _LETTERS),
        (second, 0.915, _TYPE + 2, "normal", _LETTERS + 20),
    ):
        line = textwrap.shorten(text, letters, placeholder=" ...")
        figure.text(0.015, at, line, va="top", fontsize=size, fontweight=weight, parse_math=False)
    return figure, axes


def slide_legend(figure: Figure, handles: dict[str, Artist]) -> None:
    """The legend between headline and panels, by label."""
    figure.legend(
        list(handles.values()),
        list(handles),
        loc="upper center",
        bbox_to_anchor=(0.5, _TOP + 0.01),
        ncols=legend_grid(list(handles), figure)[1],
        frameon=False,
        borderpad=0.0,
        borderaxespad=0.0,
    )
