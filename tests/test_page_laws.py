"""Friction, measured speeds and fuel in the page's engine, as in Python."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_engine import differences
from page_scenes import POLYTROPE, fuelled, settled, shortened

from crankmbs import load_scene, simulate
from crankmbs.page import refusals
from crankmbs.scene.drives import Motion, SpeedFile, Start
from crankmbs.scene.fuel import Fuel, Misfire
from crankmbs.scene.loads import Constant
from crankmbs.scene.parts import Friction
from crankmbs.scene.run import Extent
from crankmbs.scene.tables import Table

pytestmark = pytest.mark.slow

RUBBING = Friction(ring_force=30.0, ring_pressure=0.03, viscous=20.0)
RINGS = replace(RUBBING, viscous=0.0)
RUBBED = {
    "settled": replace(settled("v_twin"), friction=RINGS),
    "settled with drag": replace(settled("propeller"), friction=RUBBING),
    "run": replace(shortened(load_scene("yi_diesel_free"), 1.5), friction=RUBBING),
    "driven": replace(load_scene("yi_diesel"), friction=RUBBING),
    "misfiring": replace(
        shortened(fuelled("yi_diesel_free", motored=POLYTROPE)),
        friction=RUBBING,
        fuel=Fuel(misfire=(Misfire(cylinder=2, cycles="1-2"),)),
    ),
    "backwards": replace(
        shortened(load_scene("coasting"), 2.0),
        friction=replace(RUBBING, ring_pressure=0.0),
        start=Start(angle=0.3, speed=-150.0),
    ),
}


@pytest.mark.parametrize("name", RUBBED)
def test_friction_of_the_pistons_is_that_of_python(engine, name):
    scene = RUBBED[name]
    assert refusals(scene) == ()
    result = simulate(scene, rtol=1e-12)
    found = engine.answer(scene, result.data["crank_angle"].values)
    assert "friction_force" in found["variables"]
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])


def measured(rows, *, sense=1.0, **speed):
    """A speed in rows, none of which is where a sample is."""
    scene = load_scene("yi_diesel")
    run = replace(scene.run, until=Extent(value=1.2, unit="cycle"))
    file = Table(rows[0], tuple(sense * each for each in rows[1]))
    return replace(scene, run=run, motion=Motion(speed=SpeedFile(file=file, **speed), angle=0.2))


PERIOD = ((0.013, 2.0, 3.3, 5.1, 0.013 + 2.0 * math.pi), (300.0, 310.0, 280.0, 270.0, 300.0))
WHOLE = ((-16.013, -7.0, 0.1, 5.0, 11.0, 17.017), (150.0, 310.0, 280.0, 90.0, 250.0, 300.0))
MEASURED = {
    "over time, cubic": measured(
        ((0.0, 0.02, 0.05, 0.2), (280.0, 300.0, 260.0, 300.0)), interpolation="cubic"
    ),
    "one period": measured(PERIOD, kind="angle_table"),
    "one period, cubic": measured(PERIOD, kind="angle_table", interpolation="cubic"),
    "the run": measured(WHOLE, kind="angle_table"),
    "the run, cubic": measured(WHOLE, kind="angle_table", interpolation="cubic"),
    "backwards": measured(WHOLE, kind="angle_table", sense=-1.0),
}


@pytest.mark.parametrize("name", MEASURED)
def test_measured_speeds_are_those_of_python(engine, name):
    scene = MEASURED[name]
    assert refusals(scene) == ()
    result = simulate(scene, rtol=1e-12)
    found = engine.answer(scene, result.data["crank_angle"].values)
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])


def test_misfires_and_late_fuel_are_those_of_python(engine):
    base = fuelled("yi_diesel_free", motored=POLYTROPE)
    lists = (Misfire(cylinder=2, cycles="2-3"), Misfire(cylinder=4, cycles="every 2"))
    for fuel in (
        Fuel(misfire=lists),
        Fuel(after=0.04, until=0.09),
        Fuel(from_speed=310.0, until_speed=300.0),
    ):
        scene = shortened(replace(base, fuel=fuel), 4.0)
        result = simulate(scene, rtol=1e-12)
        found = engine.answer(scene, result.data["crank_angle"].values)
        assert max(differences(result, found["variables"]).values()) < 1e-9
        assert np.ptp(result.data["fuel"].values) == 1.0


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_where_every_speed_is_periodic_the_starts_mean_is_kept(engine, sense):
    base = replace(settled("yi_diesel_free"), gas=None, torque=(Constant(torque=0.0),))
    scene = replace(base, start=replace(base.start, speed=sense * 300.0))
    assert "balance" in simulate(scene).message
    found = engine.answer(scene, [0.0, sense * scene.period])
    assert found["balanced"]
    assert found["factor"] == pytest.approx(1.0, abs=1e-13)
    assert found["measures"]["mean_speed"] == pytest.approx(sense * 300.0, rel=1e-13)
    assert found["measures"]["fluctuation"] > 0.01
