"""The mechanism on the page: to scale, with the forces on its joints and what is read off it."""

from __future__ import annotations

from dataclasses import dataclass

from bokeh.models import ColumnDataSource, LinearColorMapper, Range1d
from bokeh.plotting import figure

from crankmbs.demo.columns import FORCES
from crankmbs.demo.style import BLUE, GREEN, ORANGE, SKY, scratch
from crankmbs.scene.scene import Scene

__all__ = ["ARROWS", "Stage", "stage"]

ARROWS = dict(zip(FORCES, (BLUE, SKY, GREEN, "#B07A00", ORANGE), strict=True))
"""Colour of a force's arrow."""

_PALE_TO_RED = (
    "#f2f5f8",
    "#fdeee0",
    "#fcdcc0",
    "#f9c69a",
    "#f4ac74",
    "#ea8f50",
    "#dd7131",
    "#c9531a",
)
_NUMBERS = 74  # px, height
_ENDS = ("x0", "y0", "x1", "y1")
_PARTS = {
    "gas": ("x", "y", "pressure", "alpha"),
    "piston": ("x", "y", "alpha"),
    "rod": (*_ENDS, "alpha"),
    "crank": (*_ENDS, "alpha"),
    "pins": ("x", "y", "alpha"),
    "arrows": (*_ENDS, "turn", "size", "colour"),
    "label": ("x", "y", "text"),
}


@dataclass(frozen=True)
class Stage:
    """The drawing, the numbers below it, and the sources that the animation fills.

    reach [m] : length of the longest arrow
    """

    drawing: figure
    numbers: figure
    parts: dict[str, ColumnDataSource]
    shapes: ColumnDataSource
    readout: ColumnDataSource
    reach: float


def stage(scene: Scene, peak: float, shapes: ColumnDataSource, width: int, height: int) -> Stage:
    """Draw the mechanism of a scene and its numbers, together of this size [px].

    The animation moves it all.

    peak [bar] : the pressure of the deepest colour

    X, to the head, points up and Y to the left, so that counter-clockwise stays so.
    """
    parts = {name: scratch(*columns, name=f"{name} drawn") for name, columns in _PARTS.items()}
    drawing = _canvas(width, height - _NUMBERS)
    pressures = LinearColorMapper(palette=_PALE_TO_RED, low=0.0, high=peak)
    r = scene.crank.radius
    drawing.circle(0.0, 0.0, radius=r, fill_color=None, line_color="#c8c8c8", line_dash=[4, 4])
    drawing.patches(
        "x",
        "y",
        source=parts["gas"],
        alpha="alpha",
        line_color=None,
        fill_color={"field": "pressure", "transform": pressures},
    )
    drawing.multi_line(
        "liner y", "liner x", source=shapes, line_color="#555555", line_width=3, line_join="round"
    )
    drawing.patches(
        "x",
        "y",
        source=parts["piston"],
        alpha="alpha",
        fill_color="#bdbdbd",
        line_color="#555555",
        line_width=1.5,
    )
    for name, colour, thick in (("crank", "#777777", 16), ("rod", "#4d4d4d", 9)):
        drawing.segment(
            *_ENDS,
            source=parts[name],
            line_color=colour,
            line_width=thick,
            line_cap="round",
            line_alpha="alpha",
        )
    drawing.circle(
        "x",
        "y",
        radius=0.09 * r,
        source=parts["pins"],
        fill_color="white",
        line_color="#333333",
        line_width=2,
        alpha="alpha",
    )
    drawing.segment(*_ENDS, source=parts["arrows"], line_color="colour", line_width=4)
    drawing.scatter(
        "x1",
        "y1",
        marker="triangle",
        size="size",
        angle="turn",
        source=parts["arrows"],
        fill_color="colour",
        line_color="colour",
    )
    drawing.text(
        "x",
        "y",
        text="text",
        source=parts["label"],
        text_font_size="15px",
        text_align="center",
        text_baseline="middle",
    )
    numbers, readout = _numbers(width)
    return Stage(drawing, numbers, parts, shapes, readout, 2.4 * r)


def _canvas(width: int, height: int) -> figure:
    """A bare area; ranges are the script's."""
    made = figure(
        width=width,
        height=height,
        toolbar_location=None,
        tools="",
        outline_line_color=None,
        x_range=Range1d(1.0, -1.0, syncable=False),
        y_range=Range1d(-1.0, 1.0, syncable=False),
        min_border=0,
    )
    made.axis.visible = False
    made.grid.visible = False
    return made


def _numbers(width: int) -> tuple[figure, ColumnDataSource]:
    """The forces in the colours of their arrows, and the speed, in two columns."""
    count = len(FORCES) + 1
    readout = ColumnDataSource(
        {
            "x": [k % 2 for k in range(count)],
            "y": [-(k // 2) for k in range(count)],
            "colour": [*ARROWS.values(), "#333333"],
            "text": [""] * count,
        },
        syncable=False,
    )
    made = _canvas(width, _NUMBERS)
    made.x_range, made.y_range = Range1d(-0.05, 2.0), Range1d(-2.6, 0.6)
    made.text(
        "x",
        "y",
        text="text",
        text_color="colour",
        source=readout,
        text_font_size="15px",
        text_baseline="middle",
    )
    return made, readout
