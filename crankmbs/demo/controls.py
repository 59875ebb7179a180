"""The knobs of the page as bokeh widgets, and how they are laid out."""

from __future__ import annotations

from collections.abc import Mapping

from bokeh.layouts import column, row
from bokeh.models import Div, RadioButtonGroup, Select, Slider, UIElement

from crankmbs.demo.knobs import AS_GIVEN, FIRING_ORDERS, Knob

__all__ = [
    "RODS",
    "TITLE",
    "cylinder_choice",
    "cylinders_choice",
    "knob_area",
    "rod_choice",
    "slider_of",
]

RODS = ("rigid", "two-mass")
TITLE = ".bk-slider-title { font-size: 15px; }"
_WIDTH, _ACROSS = 214, 4  # px; sliders in a row


def slider_of(knob: Knob) -> Slider:
    """A slider to which the script of the page listens."""
    return Slider(
        start=knob.start,
        end=knob.end,
        step=knob.step,
        value=knob.value,
        title=knob.title,
        format=knob.format,
        width=_WIDTH,
        name=knob.name,
        syncable=False,
        stylesheets=[TITLE],
    )


def rod_choice(active: int) -> RadioButtonGroup:
    """The rod's inertia: its own, or that of two masses."""
    return RadioButtonGroup(labels=list(RODS), active=active, name="rod", syncable=False, width=150)


def cylinders_choice(count: int) -> Select:
    """The scene's own cylinders, or a number of them in line."""
    options = [(AS_GIVEN, f"{AS_GIVEN} ({count})"), *((n, n) for n in FIRING_ORDERS)]
    return Select(options=options, value=AS_GIVEN, name="cylinders", syncable=False, width=106)


def cylinder_choice(count: int) -> Select:
    """The cylinder from which the page is seen."""
    options = [str(number) for number in range(1, count + 1)]
    return Select(options=options, value="1", name="cylinder", syncable=False, width=52)


def knob_area(
    sliders: Mapping[str, Slider], rod: UIElement, cylinders: UIElement, cylinder: UIElement
) -> UIElement:
    """Sliders in rows, the choices beside them."""
    each = list(sliders.values())
    rows = [row(*each[k : k + _ACROSS], spacing=8) for k in range(0, len(each), _ACROSS)]
    choices = column(
        row(_name("rod inertia"), rod),
        row(_name("cylinders"), cylinders, _name("shown", 42), cylinder),
    )
    return row(column(*rows, spacing=4), choices, spacing=14)


def _name(text: str, width: int = 74) -> Div:
    return Div(text=text, width=width, styles={"line-height": "31px", "font-size": "14px"})
