"""Where the gas force jumps: at a start, at a reversal, backwards, and together with a load.

At a jump the value above it counts, at the larger angle, whichever way the crank turns.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from references import assert_within_stated

from crankmbs.result import Result
from crankmbs.scene.drives import Motion, SpeedFile, Start
from crankmbs.scene.gas import Gas
from crankmbs.scene.loads import TimeTable, Viscous
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from crankmbs.simulate import simulate

pytestmark = pytest.mark.slow

COASTING = load_scene("coasting")
RPM = math.pi / 30.0


def stepped(*rows: tuple[float, float]) -> Scene:
    """A gauge pressure [Pa] that steps at crank angles [deg]."""
    angles, pressures = (tuple(column) for column in zip(*rows, strict=True))
    table = Table(tuple(math.radians(angle) for angle in angles), pressures)
    gas = Gas(pressure=table, absolute=False, stroke=2, interpolation="step")
    return replace(COASTING, gas=gas, piston=replace(COASTING.piston, area=1e-3))


STEPPED = stepped((0.0, 2e5), (60.0, -1e5), (90.0, 3e5), (200.0, -2e5), (300.0, 1e5))
V_TWIN = load_scene("v_twin")
HELD = stepped((0.0, 2e5), (90.0, -2e5), (180.0, -1e5), (270.0, 1e5))


def started(scene: Scene, angle: float, speed: float, until: str, *torque: Torque) -> Scene:
    """With a start [deg, rpm]."""
    run = Run(until=until, every="1 deg")
    start = Start(angle=math.radians(angle), speed=speed * RPM)
    return replace(scene, start=start, motion=None, torque=torque, run=run)


def driven(scene: Scene, angle: float, *rows: tuple[float, float]) -> Scene:
    """With a speed over time [s, rpm]."""
    times, speeds = zip(*rows, strict=True)
    table = Table(tuple(times), tuple(speed * RPM for speed in speeds))
    run = Run(until="1 rev", every="1 deg")
    motion = Motion(speed=SpeedFile(file=table), angle=math.radians(angle))
    return replace(scene, start=None, motion=motion, torque=(), run=run)


def both(scene: Scene) -> tuple[Result, Result]:
    """The scene by multibody, and exactly."""
    found = simulate(scene, formulation="multibody", rtol=1e-4, cost_cap=60.0)
    return found, simulate(scene, rtol=1e-11)


@pytest.mark.parametrize("angle", [0.0, 180.0, -360.0])
def test_a_crank_at_rest_at_a_dead_centre_with_a_jump_stays(angle: float) -> None:
    weightless = replace(stepped((0.0, 2e5), (180.0, -1e5)), gravity=None)
    result, exact = both(started(weightless, angle, 0.0, "0.1 s"))
    assert result.status == exact.status == 1
    assert result.message.startswith(f"did not move: at rest at {angle:g} degrees")
    for name in ("gas_pressure", "main_bearing_force_x", "piston_pin_force_x"):
        assert result.data[name].values == pytest.approx(exact.data[name].values, rel=1e-9)


def test_a_crank_at_rest_between_two_pressures_that_drive_it_back_is_held() -> None:
    result, exact = both(started(HELD, 90.0, 0.0, "0.1 s"))
    assert result.status == exact.status == 1
    assert result.message.startswith("held at 0 rpm at 90 degrees")
    assert_within_stated(result, exact)


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_an_excursion_over_a_jump_shorter_than_a_step(speed: float) -> None:
    scene = started(HELD, 90.0, speed, "0.1 s")
    result = simulate(scene, formulation="multibody", cost_cap=1.0)
    assert result.data["crank_angle"].values == pytest.approx(0.5 * math.pi, abs=0.01)


def test_a_swing_about_a_jump_ends_at_the_cost_cap() -> None:
    scene = started(HELD, 85.0, 0.0, "2 s", Viscous(coefficient=0.5))
    result = simulate(scene, formulation="multibody", cost_cap=1.0)
    assert result.status == -1
    assert "above the cost cap of 1 s" in result.message
    assert result.cost.steps <= 20_000


BACKWARDS = {
    "from a jump to a jump": started(STEPPED, 60.0, -900.0, "360 deg"),
    "from between, to a time": started(STEPPED, 75.0, -900.0, "0.1 s"),
    "slowly from a jump": started(STEPPED, 90.0, -0.001, "0.1 s"),
    "two cylinders with valves": started(V_TWIN, 0.0, -1500.0, "1.5 cycle"),
    "forwards from a jump to a jump": started(STEPPED, 60.0, 900.0, "360 deg"),
    "driven": driven(STEPPED, 60.0, (0.0, -900.0), (1.0, -900.0)),
    "driven from rest": driven(
        STEPPED, 60.0, (0.0, 0.0), (0.05, 0.0), (0.1, -900.0), (1.0, -900.0)
    ),
    "driven, faster from a jump on": driven(
        STEPPED, 60.0, (0.0, -1000.0), (0.01, -1000.0), (0.03, -2000.0), (1.0, -2000.0)
    ),
}


@pytest.mark.parametrize("name", BACKWARDS)
def test_at_a_jump_the_value_above_it_counts(name: str) -> None:
    result, exact = both(BACKWARDS[name])
    assert result.status == 0
    assert_within_stated(result, exact)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_load_that_sets_in_moves_a_crank_from_rest_at_a_jump(sense: float) -> None:
    load = TimeTable(file=Table((0.0, 0.02, 0.02, 1.0), (0.0, 0.0, 5.0 * sense, 5.0 * sense)))
    weightless = replace(stepped((0.0, 2e5), (180.0, -1e5)), gravity=None)
    result, exact = both(started(weightless, 0.0, 0.0, "0.05 s", load))
    assert np.all(np.diff(sense * result.data["crank_angle"].values) > 0.0)
    assert_within_stated(result, exact)
