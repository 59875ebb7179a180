"""The scene to start from: complete as it stands, and true in what it shows behind a "#"."""

import math
import re
from pathlib import Path

import pytest
from gas_work import gas_work

from crankmbs.scene.read import parse_scene
from crankmbs.scene.template import template

FILE = Path("engine.toml")
SCENE = template("engine")


def shown(scene, *keys):
    """The scene with these commented lines brought to life."""
    for key in keys:
        scene, found = re.subn(rf"(?m)^#({re.escape(key)})", r"\1", scene)
        assert found == 1
    return scene


def hidden(scene, begin, end):
    """The scene without the lines from the table ``begin`` up to the line ``end``."""
    return scene[: scene.index(begin)] + scene[scene.index(end) :]


def test_it_is_short_and_parses_as_it_is():
    assert len(SCENE.splitlines()) < 60
    assert max(map(len, SCENE.splitlines())) < 100
    scene = parse_scene(SCENE, FILE)
    assert scene.title == "engine"
    assert len(scene.cylinders) == 1


@pytest.mark.parametrize(
    "name", ["V8", 'a "b" \\ c', "line\nbreak", "tab\t", "motör \x7f", "{x}", ""]
)
def test_any_title_survives(name):
    assert parse_scene(template(name), FILE).title == name


def test_its_load_balances_the_gas():
    scene = parse_scene(SCENE, FILE)
    drive = gas_work(scene) / scene.period
    assert scene.torque[0].coefficient * scene.start.speed**2 == pytest.approx(drive, rel=0.01)


@pytest.mark.parametrize(
    "keys",
    [
        ["source"],
        ["mass"],
        ["mass", "center_of_mass"],
        ["offset"],
        ["[layout]", "firing_order"],
        ["stroke"],
        ["pre_expansion"],
        ["[gravity]", "acceleration"],
        ["[gravity]", "acceleration", "angle"],
        ["every"],
    ],
    ids=" ".join,
)
def test_its_optional_keys_are_read(keys):
    assert parse_scene(shown(SCENE, *keys), FILE) != parse_scene(SCENE, FILE)


def test_its_prescribed_speed_takes_the_place_of_the_start():
    driven = shown(hidden(SCENE, "[start]", "#[motion]"), "[motion]", "speed")
    assert parse_scene(driven, FILE).motion.speed == pytest.approx(100.0 * math.pi)


def test_its_pressure_file_takes_the_place_of_the_indicator(tmp_path):
    (tmp_path / "gas.csv").write_text("crank_angle_deg,pressure_bar\n0,1\n240,2\n480,3\n")
    tabled = shown(hidden(SCENE, "\n[gas.indicator]", "\n#[gravity]"), "pressure", "interpolation")
    gas = parse_scene(shown(tabled, "closing"), tmp_path / "engine.toml").gas
    assert (gas.interpolation, gas.closing) == ("cubic", 2e3)
