"""How the page looks: one plot, one axis of the crank angle, one legend; readable on a slide."""

from __future__ import annotations

import math
from typing import Any

from bokeh.models import (
    ColumnDataSource,
    FixedTicker,
    Legend,
    LinearAxis,
    Range1d,
    Span,
)
from bokeh.plotting import figure

from crankmbs.figures.style import COLOURS

__all__ = [
    "BLUE",
    "CURVE",
    "GREEN",
    "GREY",
    "ORANGE",
    "PINK",
    "SKY",
    "YELLOW",
    "angle_axis",
    "legend",
    "plot",
    "scratch",
]

BLUE, ORANGE, GREEN, PINK, SKY, YELLOW = COLOURS
GREY = "#8c8c8c"

CURVE: dict[str, dict[str, Any]] = {
    "simulated": {"color": "black", "width": 3.0, "dash": "solid"},
    "exact formula": {"color": BLUE, "width": 2.5, "dash": [8, 4]},
    "lecture": {"color": ORANGE, "width": 2.5, "dash": [3, 3]},
}
"""Colour, width and dashes of a curve by where it comes from."""


def plot(width: int, height: int, y_label: str = "", **ranges: Any) -> figure:
    """An empty plot [px] without tools: the page has its own knobs."""
    made = figure(
        width=width,
        height=height,
        toolbar_location=None,
        tools="",
        outline_line_color=None,
        **ranges,
    )
    made.yaxis.axis_label = y_label
    made.axis.axis_label_text_font_size = "15px"
    made.axis.axis_label_text_font_style = "normal"
    made.axis.major_label_text_font_size = "14px"
    made.axis.minor_tick_line_color = None
    made.grid.grid_line_color = "#e6e6e6"
    made.yaxis.ticker.desired_num_ticks = 5
    made.min_border_left, made.min_border_right = 84, 24
    return made


def angle_axis(
    plots: list[figure], low: float, high: float, dead: ColumnDataSource
) -> tuple[list[Span], LinearAxis]:
    """Give stacked plots one crank-angle axis, low to high [deg].

    dead : source of "x" [deg] and "label", the dead centres; returns the cursor of each plot and
    the axis above them, which names the dead centres
    """
    angles = Range1d(low, high)
    first = math.ceil(low / 90.0 - 1e-9) * 90.0
    ticks = [first + 90.0 * k for k in range(int((high - first) / 90.0 + 1e-9) + 1)]
    cursors = []
    for place in plots:
        place.x_range = angles
        place.xaxis.ticker = FixedTicker(ticks=ticks)
        place.vspan(x="x", source=dead, line_color=GREY, line_dash=[5, 4], line_width=1)
        cursor = Span(location=low, dimension="height", line_color=PINK, line_width=2)
        cursor.syncable = False
        place.add_layout(cursor)
        cursors.append(cursor)
    for place in plots[:-1]:
        place.xaxis.major_label_text_font_size = "0px"
        place.min_border_bottom = 4
    plots[-1].xaxis.axis_label = "crank angle [deg]"
    names = LinearAxis(
        ticker=FixedTicker(ticks=[]),
        axis_line_color=None,
        major_tick_line_color=None,
        major_label_text_font_size="13px",
        major_label_text_color="#555555",
        major_label_standoff=0,
    )
    plots[0].add_layout(names, "above")
    return cursors, names


def legend(place: figure, entries: list[tuple[str, list[Any]]]) -> None:
    """A legend above the plot, in one row."""
    place.add_layout(
        Legend(
            items=entries,
            orientation="horizontal",
            location="left",
            label_text_font_size="15px",
            border_line_color=None,
            background_fill_color=None,
            padding=2,
            spacing=18,
            glyph_width=34,
            margin=2,
        ),
        "above",
    )


def scratch(*columns: str, name: str | None = None) -> ColumnDataSource:
    """An empty source that a script of the page fills; the server never sees it."""
    return ColumnDataSource({column: [] for column in columns}, name=name, syncable=False)
