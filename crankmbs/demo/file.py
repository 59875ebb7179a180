"""The page as one file that needs no server and no network: its states are computed beforehand."""

from __future__ import annotations

import html
import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.embed import file_html
from bokeh.layouts import row
from bokeh.models import Button, CategoricalSlider, ColumnDataSource
from bokeh.resources import INLINE

from crankmbs.demo.columns import unit_of
from crankmbs.demo.controls import RODS, TITLE
from crankmbs.demo.document import add_page, add_script, force_of
from crankmbs.demo.export import download, scene_file
from crankmbs.demo.knobs import FIRING_ORDERS, knobs_of, turned
from crankmbs.demo.outcome import Outcome, prepared, run
from crankmbs.demo.state import Data, state_of
from crankmbs.demo.views import STORES
from crankmbs.errors import CrankmbsError, InputError, shown
from crankmbs.scene.scene import Scene
from crankmbs.storage.files import text_in_one_move

__all__ = ["save_page"]

_POINTS = {1: 9, 2: 5}  # number of knobs -> values of each
_BETWEEN = " | "


def save_page(
    scene: Scene,
    stem: str,
    varied: Sequence[str],
    target: Path,
) -> int:
    """Compute a scene over a grid of one or two knobs and write the page that shows it.

    Parameters
    ----------
    stem : name of the files that the page hands out
    varied : one or two knobs by name; none takes the flywheel, or the rod ratio without one
    target : the file; it is replaced in one move

    Returns
    -------
    int : number of states

    Raises
    ------
    InputError : an unknown knob, too many of them, or a scene that stops before its end
    OutputError : the file cannot be written
    """
    start = prepared(scene)
    axes = _axes(start, varied)
    outcome = run(start)
    points = list(itertools.product(*(values.items() for _, values in axes.values())))
    states = {}
    for point in points:
        values = {n: v for n, (_, v) in zip(axes, point, strict=True) if v is not None}
        states[_BETWEEN.join(label for label, _ in point)] = _state(outcome, values, stem)
    text = file_html(_document(outcome, axes, states, stem), INLINE)
    text_in_one_move(target, text)
    return len(points)


Axis = tuple[str, dict[str, float | str | None]]
"""Title of a knob; its labels and their values, None the scene's own."""


def _axes(scene: Scene, varied: Sequence[str]) -> dict[str, Axis]:
    sliders = {knob.name: knob for knob in knobs_of(scene)}
    names = list(varied) or ["flywheel" if "flywheel" in sliders else "rod_ratio"]
    possible = [*sliders, "rod", "cylinders"]
    for name in names:
        if name not in possible:
            raise InputError(f"--vary: this scene has {', '.join(possible)}; {shown(name)} came")
    if len(set(names)) != len(names) or len(names) > len(_POINTS):
        raise InputError(f"--vary: one knob or two different ones; {', '.join(names)} came")
    axes: dict[str, Axis] = {}
    for name in names:
        if name == "rod":
            axes[name] = ("rod inertia", {kind: kind for kind in RODS})
        elif name == "cylinders":
            own = str(len(scene.cylinders))
            others = {n: n for n in FIRING_ORDERS if n != own}
            axes[name] = ("cylinders", dict(sorted({**others, own: None}.items())))
        else:
            knob = sliders[name]
            values = np.linspace(knob.start, knob.end, _POINTS[len(names)]).tolist()
            own_at = int(np.argmin(np.abs(np.array(values) - knob.value)))
            digits = len(knob.format.partition(".")[2])
            labels = {
                f"{knob.value if k == own_at else v:.{digits}f}": None if k == own_at else v
                for k, v in enumerate(values)
            }
            axes[name] = (knob.title, labels)
    return axes


def _state(start: Outcome, values: dict[str, Any], stem: str) -> dict[str, Any]:
    """What the page shows for one turn of the knobs; or the error, as the command line has it."""
    force, _ = force_of(start)
    try:
        outcome = start.followed_by(turned(start.result.scene, values), 1)
        data = _lighter(state_of(outcome, force))
    except CrankmbsError as error:
        return {"error": html.escape(f"error: {error}")}
    return {
        "error": "",
        "data": data,
        "scene": download(*scene_file(outcome.result.scene, stem)),
    }


def _lighter(state: Data) -> Data:
    """Every second sample in single precision: a page shows no more."""
    return {
        name: {
            key: column[::2].astype(np.float32) if isinstance(column, np.ndarray) else column
            for key, column in columns.items()
        }
        for name, columns in state.items()
    }


def _document(
    outcome: Outcome, axes: dict[str, Axis], states: dict[str, Any], stem: str
) -> Document:
    document = Document()
    force, unit = force_of(outcome)
    knobs = [
        CategoricalSlider(
            categories=list(values),
            value=_own(outcome, name, values),
            title=title,
            name=name,
            width=420,
            stylesheets=[TITLE],
        )
        for name, (title, values) in axes.items()
    ]
    reset = Button(label="reset", name="reset", width=60)
    toml = Button(label="scene TOML", name="toml", width=100)
    csv = Button(label="data CSV", name="csv", width=90)
    kept = ColumnDataSource({"name": [""], "base64": [""]}, name="download")
    state = _lighter(state_of(outcome, force))
    page = add_page(
        document, outcome, state, row(*knobs, spacing=30), row(reset, toml, csv), (kept,)
    )
    columns = {column for name in STORES for column in state[name]}
    add_script(
        document,
        "grid",
        knobs=knobs,
        states=states,
        sources=page.sources,
        tabs=page.tabs,
        message=page.message,
        reset=reset,
        toml=toml,
        csv=csv,
        download=kept,
        tables=list(STORES),
        units={column: unit_of(column, unit) for column in columns},
        stem=stem,
    )
    add_script(document, "download", download=kept)
    return document


def _own(outcome: Outcome, name: str, values: dict[str, float | str | None]) -> str:
    """The label of the scene's own value."""
    if name == "rod":
        return "two-mass" if outcome.result.scene.rod.inertia == "two-mass" else "rigid"
    return next(label for label, value in values.items() if value is None)
