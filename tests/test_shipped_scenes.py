"""The scenes that ship: each loads, names its source, and is what it says."""

import math

import numpy as np
import pytest
from gas_work import gas_work

from crankmbs.mechanics.pressure import pressures_of
from crankmbs.scene.read import load_scene
from crankmbs.scene.shipped import models_folder, shipped_scenes
from validation import indicated

NAMES = [
    "coasting",
    "compressor",
    "friction",
    "grega_lecture",
    "indicated",
    "misfire",
    "propeller",
    "run_down",
    "run_up",
    "steam_engine",
    "torque_driven",
    "turning_moment",
    "two_stage_compressor",
    "v_twin",
    "yi_diesel",
    "yi_diesel_free",
]
TABLES = sorted(models_folder().rglob("*.csv"))
AT = 98066.5  # kgf/cm2 in Pa


def test_these_ship():
    assert list(shipped_scenes()) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_shipped_scene_loads_and_names_its_source(name):
    scene = load_scene(name)
    assert scene.title
    assert scene.source
    text = shipped_scenes()[name].read_text()
    assert len(text.splitlines()) < 50


@pytest.mark.parametrize("path", TABLES, ids=lambda path: path.stem)
def test_a_shipped_table_says_what_it_is_and_is_used(path):
    assert path.read_text().startswith("# ")
    scenes = [load_scene(name) for name in NAMES]
    users = [table for scene in scenes if scene.gas for table in scene.gas.tables]
    users += [scene.gas.crank_end for scene in scenes if scene.gas]
    users += [getattr(load, "file", None) for scene in scenes for load in scene.torque]
    assert str(path) in {table.source for table in users if table}


def test_the_indicated_cycles_are_those_of_their_seed():
    assert indicated.text() == (models_folder() / "pressure" / "indicated.csv").read_text()


@pytest.mark.parametrize("name", ["indicated", "misfire", "run_down", "run_up"])
def test_the_same_engine_goes_other_ways(name):
    """What a scene of its own does not say again is that of yi_diesel_free."""
    first, scene = load_scene("yi_diesel_free"), load_scene(name)
    for part in ("crank", "rod", "piston", "layout"):
        assert getattr(scene, part) == getattr(first, part)
    assert "not measured" in scene.source or "assumed" in scene.source


@pytest.mark.parametrize(
    ("name", "kilowatts"),
    [("yi_diesel", 29.26 / 4.0), ("grega_lecture", 29.8), ("compressor", -0.80)],
)
def test_indicated_power_is_plausible(name, kilowatts):
    scene = load_scene(name)
    speed = scene.motion.speed
    speed = speed if isinstance(speed, float) else speed.mean
    power = len(scene.cylinders) * gas_work(scene) / scene.period * speed
    assert power / 1e3 == pytest.approx(kilowatts, rel=5e-3)


@pytest.mark.parametrize("name", ["propeller", "v_twin", "yi_diesel_free"])
def test_the_load_balances_the_gas_at_the_starting_speed(name):
    scene = load_scene(name)
    (load,) = scene.torque
    drive = len(scene.cylinders) * gas_work(scene) / scene.period
    assert load.coefficient * scene.start.speed**2 == pytest.approx(drive, rel=5e-3)


def test_yi_diesel_is_the_engine_of_the_paper():
    scene = load_scene("yi_diesel")
    r, l = scene.crank.radius, scene.rod.length
    assert r / l == pytest.approx(0.3, rel=1e-9)
    assert scene.piston.offset / r == pytest.approx(0.0282, rel=1e-9)
    to_and_fro = scene.piston.mass + scene.rod.mass * scene.rod.center_of_mass / l
    assert to_and_fro == pytest.approx(0.15727 * 9.80665, rel=1e-6)
    pressure = pressures_of(scene)[0](np.radians([0.0, 90.0, 180.0, 360.0]))
    assert pressure / AT + 1.0 == pytest.approx([1.133, 0.6908, 0.9001, 65.7187], rel=1e-12)


def test_yi_diesel_free_is_the_same_engine_four_times():
    one, four = load_scene("yi_diesel"), load_scene("yi_diesel_free")
    assert (four.rod, four.piston, four.gas) == (one.rod, one.piston, one.gas)
    phases = [cylinder.phase for cylinder in four.cylinders]
    assert np.degrees(phases) == pytest.approx([0.0, 180.0, 540.0, 360.0])
    assert four.crank.inertia == 0.15


def test_the_rods_of_v_twin_share_a_pin():
    first, second = load_scene("v_twin").cylinders
    apart = first.phase + first.bank - second.phase - second.bank
    assert math.remainder(apart, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-14)
    assert second.bank - first.bank == pytest.approx(math.pi / 3.0)


def test_torque_driven_is_made_of_uniform_bars():
    scene = load_scene("torque_driven")
    crank, rod = scene.crank, scene.rod
    assert crank.inertia == pytest.approx(crank.mass * crank.radius**2 / 3.0, rel=1e-15)
    assert rod.inertia == pytest.approx(rod.mass * rod.length**2 / 12.0, rel=1e-14)
    assert (crank.center_of_mass, rod.center_of_mass) == (0.05, 0.15)
