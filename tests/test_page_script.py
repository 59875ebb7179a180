"""Why a run is replayed and not computed by the page, and its modules as one script."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_scenes import POLYTROPE, fuelled

from crankmbs import load_scene
from crankmbs.page import joined, refusals
from crankmbs.page.export import encoded
from crankmbs.page.script import FOLDER
from crankmbs.scene.fuel import Fuel, Governor
from crankmbs.scene.python_load import Load


def fold(scene):
    radius = scene.crank.radius
    piston = replace(scene.piston, offset=0.0)
    return replace(scene, rod=replace(scene.rod, length=radius), piston=piston)


def test_what_the_page_cannot_compute_has_its_reason():
    free, driven = load_scene("yi_diesel_free"), load_scene("yi_diesel")
    governor = Governor(speed=300.0, kp=0.01, ki=0.01)
    burning = fuelled("yi_diesel_free", motored=POLYTROPE)
    speed = {"from": 100.0, "to": -50.0, "over": 0.01}
    refused = {
        "multibody": replace(free, run=replace(free.run, formulation="multibody")),
        "function": replace(free, torque=(Load(lambda t, theta, omega: 0.0),)),
        "governor": replace(burning, fuel=Fuel(governor=governor)),
        "random firing": replace(burning, fuel=Fuel(scatter=0.1)),
        "settled fuel": replace(burning, run=replace(burning.run, until="settled")),
        "fold": fold(free),
        "rest": load_scene("torque_driven"),
        "reversal": replace(driven, motion=replace(driven.motion, speed=speed)),
    }
    for reason, scene in refused.items():
        (said,) = refusals(scene)
        assert said.startswith(f"{reason}: ")


def test_a_script_holds_no_markup_and_modules_that_cannot_be_joined_are_named(
    tmp_path, monkeypatch
):
    assert "<" not in encoded({"title": "</script><script>alert(1)", "x": np.array([1.0])})
    with pytest.raises(ValueError, match="not JSON compliant"):
        encoded({"x": math.nan})
    (tmp_path / "odd.js").write_text('import * as all from "./other.js";\n')
    monkeypatch.setattr("crankmbs.page.script.FOLDER", tmp_path)
    with pytest.raises(ValueError, match=r"odd\.js"):
        joined("odd")


def test_the_modules_are_held_to_the_length_of_the_others():
    for path in FOLDER.glob("*.js"):
        lines = path.read_text(encoding="utf-8").splitlines()
        assert len(lines) <= 300, path.name
        assert max(map(len, lines)) <= 100, path.name
        assert lines[0].startswith("/** "), path.name
