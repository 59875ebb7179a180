"""The tabs: speed, piston motion, torque and side thrust, error budget, bearing load."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from bokeh.layouts import column, row
from bokeh.models import (
    ColumnDataSource,
    Div,
    LayoutDOM,
    LinearAxis,
    Range1d,
    Select,
    Span,
    TabPanel,
)
from bokeh.plotting import figure

from crankmbs.compare import CAUSES
from crankmbs.demo.columns import BEARINGS, BUDGETED, CURVES, SCALES
from crankmbs.demo.style import (
    BLUE,
    CURVE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    SKY,
    YELLOW,
    angle_axis,
    legend,
    plot,
    scratch,
)

__all__ = ["STORES", "Views", "views"]

STORES = ("speed", "motion", "thrust", "budget", "bearing")
"""The sources of the tabs, in the order of the tabs."""

_COLOURS = (BLUE, SKY, ORANGE, GREEN, PINK, YELLOW, GREY)
_CAUSES = dict(zip(CAUSES, _COLOURS, strict=True))
_SIDES, _ENDS = ("up", "down"), ("from", "to")
_NAMES = {
    "simulated": "simulated",
    "exact formula": "exact formula, constant speed",
    "lecture": "lecture's approximation",
}


@dataclass
class Views:
    """The tabs, and what the scripts of the page need of them."""

    stores: dict[str, ColumnDataSource]
    dead: ColumnDataSource
    panels: list[TabPanel] = field(default_factory=list)
    cursors: list[list[Span]] = field(default_factory=list)
    tops: list[LinearAxis] = field(default_factory=list)
    fits: list[dict[str, Any]] = field(default_factory=list)
    budget: dict[str, Any] = field(default_factory=dict)
    polar: dict[str, Any] = field(default_factory=dict)
    tip: ColumnDataSource = field(default_factory=lambda: scratch("x0", "y0", "x1", "y1"))


def views(
    stores: dict[str, ColumnDataSource],
    dead: ColumnDataSource,
    words: ColumnDataSource,
    angles: tuple[float, float],
    force_unit: str,
    width: int,
    height: int,
) -> Views:
    """Make the tabs over the sources `STORES`; angles : ends of the crank-angle axis [deg]."""
    made = Views(stores, dead)
    _speed(made, angles, width, height)
    units = {name: SCALES.get(name, (1.0, force_unit))[1] for name in (*SCALES, *BUDGETED)}
    motion = ("piston displacement", "piston velocity", "piston acceleration")
    _compared(made, "motion", "piston motion", motion, units, angles, width, height)
    _compared(
        made,
        "thrust",
        "torque and side thrust",
        ("torque", "side thrust"),
        units,
        angles,
        width,
        height,
    )
    _budget(made, words, units, angles, width, height)
    _bearing(made, force_unit, width, height)
    return made


def _axis(made: Views, plots: list[figure], angles: tuple[float, float]) -> None:
    cursors, top = angle_axis(plots, *angles, made.dead)
    made.cursors.append(cursors)
    made.tops.append(top)


def _fit(made: Views, place: figure, store: str, columns: list[str], least: float) -> None:
    place.y_range = Range1d(0.0, 0.0, syncable=False)
    made.fits.append(
        {"range": place.y_range, "source": made.stores[store], "columns": columns, "least": least}
    )


def _panel(made: Views, child: LayoutDOM, title: str) -> None:
    made.panels.append(TabPanel(child=child, title=title))


def _speed(made: Views, angles: tuple[float, float], width: int, height: int) -> None:
    place = plot(width, height, "crank speed [rpm]")
    _axis(made, [place], angles)
    source, columns = made.stores["speed"], ["speed, simulated", "speed, constant"]
    constant = place.line(
        "degrees", columns[1], source=source, line_color=BLUE, line_width=2.5, line_dash=[8, 4]
    )
    run = place.line("degrees", columns[0], source=source, line_color="black", line_width=3)
    legend(place, [("simulated", [run]), ("constant-speed assumption", [constant])])
    _fit(made, place, "speed", columns, 0.02)
    _panel(made, place, "speed")


def _compared(
    made: Views,
    store: str,
    title: str,
    quantities: tuple[str, ...],
    units: dict[str, str],
    angles: tuple[float, float],
    width: int,
    height: int,
) -> None:
    """Stacked plots, each a quantity by its three curves."""
    each = (height - 84) // len(quantities)
    plots, lines = [], {}
    for k, name in enumerate(quantities):
        extra = 50 * (k == 0) + 34 * (k == len(quantities) - 1)
        place = plot(width, each + extra, f"{name.removeprefix('piston ')} [{units[name]}]")
        columns = [f"{name}, {curve}" for curve in CURVES]
        for curve, column_name in zip(CURVES, columns, strict=True):
            look = CURVE[curve]
            drawn = place.line(
                "degrees",
                column_name,
                source=made.stores[store],
                line_color=look["color"],
                line_width=look["width"],
                line_dash=look["dash"],
            )
            if k == 0:
                lines[curve] = drawn
        _fit(made, place, store, columns, 0.0)
        plots.append(place)
    _axis(made, plots, angles)
    legend(plots[0], [(_NAMES[curve], [line]) for curve, line in lines.items()])
    _panel(made, column(plots, spacing=0), title)


def _budget(
    made: Views,
    words: ColumnDataSource,
    units: dict[str, str],
    angles: tuple[float, float],
    width: int,
    height: int,
) -> None:
    select = Select(options=list(BUDGETED), value=BUDGETED[0], width=220, name="quantity")
    sentences = Div(
        text="", width=width - 250, height=84, name="sentences", styles={"font-size": "14px"}
    )
    sentences.syncable = False
    ends = [f"{side}{k} {end}" for k in range(len(_CAUSES)) for side in _SIDES for end in _ENDS]
    shown = scratch("degrees", "total", *ends)
    place = plot(width, height - 96, "")
    _axis(made, [place], angles)
    entries = []
    for k, (cause, colour) in enumerate(_CAUSES.items()):
        bands = [
            place.varea(
                "degrees",
                f"{side}{k} from",
                f"{side}{k} to",
                source=shown,
                fill_color=colour,
                fill_alpha=0.75,
            )
            for side in _SIDES
        ]
        entries.append((cause, bands))
    total = place.line("degrees", "total", source=shown, line_color="black", line_width=2.5)
    legend(place, [*entries, ("sum", [total])])
    place.y_range = Range1d(0.0, 0.0, syncable=False)
    made.budget = {
        "store": made.stores["budget"],
        "shown": shown,
        "select": select,
        "causes": list(_CAUSES),
        "range": place.y_range,
        "axis": place.yaxis[0],
        "units": units,
        "words": words,
        "sentences": sentences,
    }
    _panel(made, column(row(select, sentences), place), "error budget")


def _bearing(made: Views, force_unit: str, width: int, height: int) -> None:
    select = Select(options=list(BEARINGS), value=BEARINGS[0], width=180, name="bearing")
    side = height - 8
    x_range, y_range = Range1d(0.0, 0.0, syncable=False), Range1d(0.0, 0.0, syncable=False)
    place = plot(
        side + 60, side, f"X, to the head [{force_unit}]", x_range=x_range, y_range=y_range
    )
    place.xaxis.axis_label = f"Y, 90 deg ahead of X [{force_unit}]"
    names = [f"{curve} {axis}" for curve in ("simulated", "lecture") for axis in "xy"]
    shown, marks = scratch("degrees", *names), scratch("x", "y", "label")
    lines = {}
    for curve in ("lecture", "simulated"):
        look = CURVE[curve]
        lines[curve] = place.line(
            f"{curve} y",
            f"{curve} x",
            source=shown,
            line_color=look["color"],
            line_width=look["width"],
            line_dash=look["dash"],
        )
    place.scatter("x", "y", source=marks, size=8, color="black")
    place.text(
        "x",
        "y",
        text="label",
        source=marks,
        text_font_size="14px",
        x_offset=10,
        y_offset=-7,
        background_fill_color="white",
        background_fill_alpha=0.85,
    )
    place.segment("x0", "y0", "x1", "y1", source=made.tip, line_color=PINK, line_width=3)
    place.scatter("x1", "y1", source=made.tip, size=12, color=PINK)
    legend(place, [(_NAMES[curve], [lines[curve]]) for curve in ("simulated", "lecture")])
    made.polar = {
        "store": made.stores["bearing"],
        "shown": shown,
        "marks": marks,
        "select": select,
        "x_range": x_range,
        "y_range": y_range,
    }
    about = Div(
        text=(
            "<p>The force of the earlier part on the later one, in the order bearing, crank, rod, "
            "piston.</p><p>Main bearing: of all cylinders, in the engine's frame. Pins: of the "
            "chosen cylinder, in its own frame.</p><p>Dots: crank angle in degrees.</p>"
        ),
        width=width - side - 90,
        styles={"font-size": "15px"},
    )
    made.cursors.append([])
    _panel(made, row(place, column(select, about)), "bearing load")
