"""The live page: every turn of a knob is simulated, and the page shows what came out."""

from __future__ import annotations

import html
import json
from typing import Any

from bokeh.document import Document
from bokeh.layouts import row
from bokeh.models import Button, ColumnDataSource, Select

from crankmbs.demo.controls import RODS, cylinders_choice, knob_area, rod_choice, slider_of
from crankmbs.demo.document import Page, add_page, add_script, force_of
from crankmbs.demo.export import data_file, download, scene_file
from crankmbs.demo.knobs import knobs_of, turned
from crankmbs.demo.outcome import Outcome
from crankmbs.demo.state import state_of
from crankmbs.errors import CrankmbsError
from crankmbs.scene import Scene

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
        self._reply = ColumnDataSource({"number": [0]}, name="reply")
        self._download = ColumnDataSource({"name": [""], "base64": [""]}, name="download")
        self._cylinder = Select(name="cylinder", width=52, syncable=False)
        self._offer_cylinders()
        self._page: Page

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
        self._request.on_change("data", lambda _attr, _old, _new: self._answer())
        below = knob_area(sliders, knobs["rod"], knobs["cylinders"], self._cylinder)
        self._page = add_page(
            document,
            self._outcome,
            state_of(self._outcome, self._force),
            below,
            row(reset, toml, csv),
            (self._request, self._reply, self._download),
        )
        add_script(
            document,
            "knobs",
            knobs=knobs,
            choices={"cylinder": self._cylinder, "tabs": self._page.tabs},
            reset=reset,
            request=self._request,
            reply=self._reply,
        )
        add_script(document, "download", download=self._download)

    def _answer(self) -> None:
        asked: dict[str, Any] = json.loads(self._request.data["json"][0])
        try:
            self._outcome = self._outcome.followed_by(
                turned(self._scene, asked["values"]), asked["cylinder"]
            )
            self._page.message.text = ""
            self._offer_cylinders()
            state = state_of(self._outcome, self._force, [asked["tab"]])
            for name, data in state.items():
                self._page.sources[name].data = data
        except CrankmbsError as error:
            self._page.message.text = html.escape(f"error: {error}")
        finally:
            self._reply.data = {"number": [asked["number"]]}

    def _offer_cylinders(self) -> None:
        count = len(self._outcome.result.scene.cylinders)
        self._cylinder.options = [str(k) for k in range(1, count + 1)]
        self._cylinder.value = str(self._outcome.cylinder)

    def _give(self, name: str, content: bytes) -> None:
        self._download.data = download(name, content)
