"""The live page: every turn of a knob is simulated, and the page shows what came out."""

from __future__ import annotations

import html
import json
from typing import Any

from bokeh.document import Document
from bokeh.layouts import row
from bokeh.models import Button, ColumnDataSource

from crankmbs.demo.answer import packed
from crankmbs.demo.controls import (
    RODS,
    cylinder_choice,
    cylinders_choice,
    knob_area,
    rod_choice,
    slider_of,
)
from crankmbs.demo.document import add_page, add_script, force_of
from crankmbs.demo.export import data_file, download, scene_file
from crankmbs.demo.knobs import knobs_of, turned
from crankmbs.demo.outcome import Outcome
from crankmbs.demo.state import state_of
from crankmbs.errors import CrankmbsError
from crankmbs.scene.scene import Scene

__all__ = ["Live"]


class Live:
    """One visitor's page of a scene; what it shows is the last scene that could be run.

    scene : prepared; outcome : of it; stem : name of the files handed out
    """

    def __init__(self, scene: Scene, outcome: Outcome, stem: str) -> None:
        self._scene = scene
        self._outcome = outcome
        self._stem = stem
        self._force, _ = force_of(outcome)
        self._request = ColumnDataSource({"json": [""]}, name="request")
        self._answer = ColumnDataSource(packed(0, "", {}), name="answer")
        self._download = ColumnDataSource({"name": [""], "base64": [""]}, name="download")

    def add_to(self, document: Document) -> None:
        """Build the page in a document and listen to its knobs."""
        rigid = self._scene.rod.inertia != "two-mass"
        sliders = {knob.name: slider_of(knob) for knob in knobs_of(self._scene)}
        knobs = {
            **sliders,
            "rod": rod_choice(RODS.index("rigid" if rigid else "two-mass")),
            "cylinders": cylinders_choice(len(self._scene.cylinders)),
        }
        reset = Button(label="reset", name="reset", width=60)
        toml = Button(label="scene TOML", name="toml", width=100)
        csv = Button(label="data CSV", name="csv", width=90)
        toml.on_click(lambda: self._give(*scene_file(self._outcome.result.scene, self._stem)))
        csv.on_click(lambda: self._give(*data_file(self._outcome.result, self._stem)))
        self._request.on_change("data", lambda _attr, _old, _new: self._reply())
        cylinder = cylinder_choice(len(self._scene.cylinders))
        below = knob_area(sliders, knobs["rod"], knobs["cylinders"], cylinder)
        page = add_page(
            document,
            self._outcome,
            state_of(self._outcome, self._force),
            below,
            row(reset, toml, csv),
            (self._request, self._answer, self._download),
        )
        add_script(
            document,
            "knobs",
            knobs=knobs,
            choices={"cylinder": cylinder, "tabs": page.tabs},
            reset=reset,
            request=self._request,
            answer=self._answer,
            sources=page.sources,
            message=page.message,
        )
        add_script(document, "download", download=self._download)

    def _reply(self) -> None:
        asked: dict[str, Any] = json.loads(self._request.data["json"][0])
        error = ""
        try:
            scene = turned(self._scene, asked["values"])
            self._outcome = self._outcome.followed_by(scene, asked["cylinder"])
        except CrankmbsError as refusal:
            error = html.escape(f"error: {refusal}")
        state = state_of(self._outcome, self._force, [asked["tab"]])
        self._answer.data = packed(asked["number"], error, state)

    def _give(self, name: str, content: bytes) -> None:
        self._download.data = download(name, content)
