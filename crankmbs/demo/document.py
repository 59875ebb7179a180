"""The page: mechanism on the left, tabs on the right, knobs below; shared by server and file."""

from __future__ import annotations

import html
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.layouts import column, row
from bokeh.models import (
    Button,
    ColumnDataSource,
    CustomJS,
    Div,
    Select,
    Slider,
    Tabs,
    Toggle,
    UIElement,
)

from crankmbs.demo.columns import FORCES
from crankmbs.demo.controls import TITLE
from crankmbs.demo.outcome import Outcome
from crankmbs.demo.stage import ARROWS, stage
from crankmbs.demo.state import Data
from crankmbs.demo.views import STORES, views
from crankmbs.figures.style import force_scale

__all__ = ["Page", "add_page", "add_script", "force_of"]

_JS = Path(__file__).parent / "js"
_LEFT, _RIGHT, _HEIGHT = 390, 860, 580  # px
_TABS = ".bk-tab { font-size: 16px; padding: 5px 14px; }"
_SECONDS = 6.0  # that a cycle takes on the page, at first
_SLOW = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


@dataclass(frozen=True)
class Page:
    """What the server or the file fills: sources by name, and the line of messages."""

    sources: dict[str, ColumnDataSource]
    message: Div
    tabs: Tabs


def force_of(outcome: Outcome) -> tuple[float, str]:
    """Divisor and unit in which the page shows forces."""
    data = outcome.result.data
    names = ("main_bearing_force_x", "main_bearing_force_y", "crank_pin_force_x")
    return force_scale(*(data[name].values for name in names))


def add_page(
    document: Document,
    outcome: Outcome,
    state: Data,
    knobs: UIElement,
    buttons: UIElement,
    kept: tuple[ColumnDataSource, ...],
) -> Page:
    """Fill a document with the page of an outcome, knobs below and buttons above.

    state : of the outcome, with all tabs; kept : sources that nothing draws
    """
    scene = outcome.result.scene
    _, unit = force_of(outcome)
    sources = {
        name: ColumnDataSource(data, name=f"{name} data", syncable=False)
        for name, data in state.items()
    }
    peak = float(np.max(outcome.view.values("gas_pressure"), initial=1e-9)) / 1e5
    drawn = stage(scene, max(peak, 1e-9), sources["shapes"], _LEFT, _HEIGHT - 88)
    view = outcome.view
    low, high = round(view.low, 6), round(view.high, 6)
    shown = views(
        {name: sources[name] for name in STORES},
        sources["dead"],
        sources["words"],
        (low, high),
        unit,
        _RIGHT,
        _HEIGHT - 36,
    )
    tabs = Tabs(tabs=shown.panels, width=_RIGHT, height=_HEIGHT, name="tabs", stylesheets=[_TABS])
    message = Div(
        text="",
        width=_LEFT + _RIGHT,
        height=22,
        name="message",
        styles={"color": "#B33A00", "font-size": "15px", "font-weight": "bold"},
    )
    title = Div(
        text=f"<b>{html.escape(scene.title or 'scene')}</b>",
        disable_math=True,  # in a title a $ is no formula
        width=_LEFT + _RIGHT - 420,
        height=24,
        styles={"font-size": "18px", "overflow": "hidden", "white-space": "nowrap"},
    )
    numbers = Div(
        text=sources["numbers"].data["text"][0],
        width=_LEFT + _RIGHT - 420,
        height=24,
        name="numbers",
        styles={"font-size": "15px", "white-space": "nowrap"},
    )
    player = _player(low, high, float(view.values("time")[-1] - view.values("time")[0]))
    left = column(
        drawn.drawing,
        drawn.numbers,
        row(player["play"], player["back"], player["forward"], player["slow"], spacing=4),
        player["angle"],
    )
    root = column(
        row(column(title, numbers), buttons),
        message,
        row(left, tabs),
        knobs,
        name="page",
        tags=[*sources.values(), *kept],
    )
    document.add_root(root)
    document.title = f"crankmbs: {scene.title or 'scene'}"
    add_script(
        document,
        "stage",
        frames=sources["frames"],
        shapes=sources["shapes"],
        chosen=sources["chosen"],
        **player,
        parts=drawn.parts,
        tabs=tabs,
        cursors=shown.cursors,
        readout=drawn.readout,
        polar=shown.polar["shown"],
        tip=shown.tip,
        canvas=drawn.drawing,
        radius=scene.crank.radius,
        gassed=scene.gas is not None,
        colours=list(ARROWS.values()),
        names=list(FORCES),
        unit=unit,
        reach=drawn.reach,
    )
    add_script(
        document,
        "curves",
        fits=shown.fits,
        budget=shown.budget,
        polar=shown.polar,
        dead=sources["dead"],
        tops=shown.tops,
        numbers={"source": sources["numbers"], "shown": numbers},
    )
    return Page(sources, message, tabs)


def add_script(document: Document, name: str, **arguments: Any) -> None:
    """Let a script of the folder js wire up models when the page is ready."""
    code = (_JS / f"{name}.mjs").read_text(encoding="utf-8")
    document.js_on_event(DocumentReady, CustomJS(args=arguments, code=code, module=True))


def _player(low: float, high: float, seconds: float) -> dict[str, Any]:
    """Play, step, slow motion and the angle's slider; they never leave the browser."""
    wanted = _SECONDS / seconds if seconds > 0.0 else 1.0
    slow = min(_SLOW, key=lambda factor: abs(np.log(factor / wanted)))
    made = {
        "play": Toggle(label="► play", width=86, name="play", button_type="primary"),
        "back": Button(label="◄ 1°", width=56, name="back"),
        "forward": Button(label="1° ►", width=56, name="forward"),
        "slow": Select(
            options=[(str(f), f"{f} times slower" if f > 1 else "real time") for f in _SLOW],
            value=str(slow),
            width=150,
            name="slow",
        ),
        "angle": Slider(
            start=low,
            end=high,
            value=low,
            step=1.0,
            title="crank angle [deg]",
            format="0",
            width=_LEFT - 20,
            name="angle",
            stylesheets=[TITLE],
        ),
    }
    for model in made.values():
        model.syncable = False
    return made
