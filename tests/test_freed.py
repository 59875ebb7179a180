"""A prescribed speed set free: periodic under its load, at the mean speed that was prescribed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Extent,
    Fuel,
    InputError,
    Misfire,
    Motion,
    Oscillation,
    Ramp,
    SpeedFile,
    Table,
    freed,
    load_scene,
    simulate,
)
from crankmbs.design.freed import mean_prescribed
from crankmbs.scene.gas import Polytrope
from crankmbs.scene.parts import Friction
from validation.adapter import reference_motion

DRIVEN = ("compressor", "friction", "grega_lecture", "yi_diesel")
DIESEL = load_scene("yi_diesel")
ROWS = Table((0.0, 2.0, 4.0, 2.0 * math.pi), (300.0, 340.0, 280.0, 300.0))
HEAVY = replace(DIESEL, crank=replace(DIESEL.crank, inertia=0.1))
SPEEDS = {
    "backwards": -335.0,
    "swinging": Oscillation(mean=300.0, amplitude=80.0, order=1.5, phase=0.4),
    "rising": Ramp(start=250.0, to=330.0, over=0.02),
    "measured": SpeedFile(file=Table((0.0, 0.02, 0.05, 0.2), (280.0, 300.0, 260.0, 300.0))),
    "over the angle": SpeedFile(file=ROWS, kind="angle_table", interpolation="cubic"),
}


def driven(speed, until="1.3 cycles"):
    run = replace(HEAVY.run, until=until)
    return replace(HEAVY, motion=Motion(speed=speed, angle=0.2), run=run)


def whole(scene, **changes):
    """One period with its ends alone."""
    run = replace(scene.run, every=scene.run.until, **changes)
    return simulate(replace(scene, run=run), rtol=1e-12).data


def shipped(name):
    """The scene of a name; with a flywheel, where it has none."""
    scene = load_scene(name)
    crank = replace(scene.crank, inertia=scene.crank.inertia or 0.01)
    return replace(scene, crank=crank)


@pytest.mark.slow
@pytest.mark.parametrize("name", DRIVEN)
def test_a_period_gains_nothing_and_has_the_mean_speed(name):
    scene = shipped(name)
    found = freed(scene)
    assert found.motion is None
    assert found.gas == scene.gas
    data = whole(found)
    speed, duration = data.crank_speed.values, float(data.time[-1])
    assert speed[-1] == pytest.approx(speed[0], rel=1e-12)
    assert scene.period / duration == pytest.approx(mean_prescribed(scene), rel=1e-12)
    assert np.ptp(simulate(found).data.crank_speed.values) > 1e-3 * speed[0]


@pytest.mark.parametrize("name", SPEEDS)
def test_the_mean_is_that_of_the_last_cycle_as_it_was_prescribed(name):
    scene = driven(SPEEDS[name])
    even = simulate(replace(scene, run=replace(scene.run, every="0.05 deg"))).data
    theta, time = even.crank_angle.values, even.time.values
    begin = theta[-1] - math.copysign(scene.period, theta[-1])
    order = np.argsort(theta)
    spent = time[-1] - np.interp(begin, theta[order], time[order])
    mean = (theta[-1] - begin) / spent
    assert mean_prescribed(scene) == pytest.approx(mean, rel=1e-6)
    data = whole(freed(scene))
    found = (data.crank_angle.values[-1] - data.crank_angle.values[0]) / float(data.time[-1])
    assert found == pytest.approx(mean_prescribed(scene), rel=1e-12)
    assert data.crank_speed.values[-1] == pytest.approx(data.crank_speed.values[0], rel=1e-12)


def test_the_mean_of_an_oscillation_over_whole_orders_is_in_closed_form():
    swing = Oscillation(mean=-300.0, amplitude=80.0, order=1.5, phase=0.4)
    assert mean_prescribed(driven(swing)) == pytest.approx(
        -math.sqrt(300.0**2 - 80.0**2), rel=1e-14
    )


@pytest.mark.parametrize(("until", "turned"), [("1.3 rev", 2.0), ("0.3 rev", 0.6), ("3 ms", None)])
def test_without_a_whole_cycle_it_is_the_last_revolution_or_all(until, turned):
    scene = driven(Ramp(start=200.0, to=400.0, over=0.1), until)
    end, in_time = scene.end
    slope = 200.0 / 0.1
    last = end if in_time else (math.sqrt(200.0**2 + 2.0 * slope * end) - 200.0) / slope
    angle = (200.0 + 0.5 * slope * last) * last if turned is None else turned * math.pi
    begin = (200.0 + 0.5 * slope * last) * last - angle
    first = (math.sqrt(200.0**2 + 2.0 * slope * begin) - 200.0) / slope
    assert mean_prescribed(scene) == pytest.approx(angle / (last - first), rel=1e-12)


@pytest.mark.parametrize("name", ["compressor", "grega_lecture", "yi_diesel"])
def test_the_load_is_the_mean_of_the_torque_that_the_drive_gives(name):
    """At a constant speed, over the angle: what swings the masses is nothing over a cycle."""
    scene = load_scene(name)
    even = replace(scene, motion=Motion(speed=mean_prescribed(scene)))
    run = replace(even.run, until=Extent(value=1.0, unit="cycle"), every="0.1 deg")
    torque = simulate(replace(even, run=run)).data.external_torque.values
    (load,) = freed(scene).torque
    assert load.torque == pytest.approx(torque[:-1].mean(), abs=1e-5 * np.abs(torque).max())


def test_viscous_friction_takes_what_it_does_in_that_motion():
    """By its power, and not what it would at a constant speed."""
    scene = replace(DIESEL, friction=Friction(ring_force=30.0, ring_pressure=0.02, viscous=300.0))
    found = freed(scene)
    data = simulate(replace(found, run=replace(found.run, every="0.1 deg")), rtol=1e-11).data
    speed = data.crank_speed.values[:, None]
    work = (data.gas_force + data.friction_force).values * data.piston_velocity.values / speed
    (load,) = found.torque
    assert load.torque == pytest.approx(-work[:-1].sum(axis=1).mean(), rel=1e-5)
    even = simulate(replace(scene, run=replace(scene.run, every="0.1 deg"))).data
    assert abs(load.torque / even.external_torque.values[:-1].mean() - 1.0) > 0.01


@pytest.mark.slow
@pytest.mark.parametrize("name", ["compressor", "yi_diesel"])
def test_the_oracle_comes_back_to_its_speed_at_that_time(name):
    scene = freed(load_scene(name))
    result = simulate(replace(scene, run=replace(scene.run, every="90 deg")), rtol=1e-12)
    motion = reference_motion(result)
    omega = motion.omega.astype(float)
    assert omega[-1] == pytest.approx(scene.start.speed, rel=2e-11)
    np.testing.assert_allclose(omega, result.data.crank_speed.values, rtol=2e-11)


def test_a_heavier_rod_needs_no_other_load_but_another_start():
    heavier = replace(DIESEL, rod=replace(DIESEL.rod, mass=3.0 * DIESEL.rod.mass))
    one, other = freed(DIESEL), freed(heavier)
    assert other.torque[0].torque == pytest.approx(one.torque[0].torque, rel=1e-12)
    assert abs(other.start.speed / one.start.speed - 1.0) > 0.01


@pytest.mark.slow
@pytest.mark.parametrize("viscous", [0.0, 300.0])
def test_it_swings_as_wide_as_it_can_until_it_is_refused(viscous):
    """Lighter and lighter: what is given has the mean speed and repeats itself."""
    friction = Friction(ring_force=40.0, viscous=viscous)
    bare = replace(DIESEL, friction=friction, crank=replace(DIESEL.crank, mass=0.0))
    given, swings, sentences = 0, [], []
    for inertia in (0.003, 0.001, 5e-4, 2e-4, 1e-4, 0.0):
        scene = replace(bare, crank=replace(bare.crank, inertia=inertia))
        try:
            found = freed(scene)
        except InputError as error:
            sentences.append(str(error))
            continue
        data = whole(found)
        given += 1
        assert data.crank_speed.values[-1] == pytest.approx(found.start.speed, rel=1e-9)
        mean = DIESEL.period / float(data.time[-1])
        assert mean == pytest.approx(DIESEL.motion.speed, rel=1e-9)
        swings.append(np.ptp(simulate(found).data.crank_speed.values) / mean)
    assert all("comes near rest in every cycle" in sentence for sentence in sentences)
    assert swings == sorted(swings)
    assert swings[-1] > 1.0
    assert given == 6 if viscous else 1 < given < 6


def light(scene, viscous=0.0):
    friction = Friction(viscous=viscous) if viscous else None
    crank = replace(scene.crank, mass=0.0, inertia=0.0)
    rod = replace(scene.rod, mass=1e-3, inertia=1e-9)
    piston = replace(scene.piston, mass=1e-3)
    return replace(scene, crank=crank, rod=rod, piston=piston, friction=friction)


FUELLED = replace(
    DIESEL,
    gas=replace(
        DIESEL.gas,
        motored=Polytrope(polytrope=1.32, closes=math.radians(-20.0), compression_ratio=18.0),
    ),
    fuel=Fuel(misfire=(Misfire(cylinder=1, cycles="every 3"),)),
)
RISES = Ramp(start=0.0, to=9.0, over=1.0)
FALLS = Ramp(start=300.0, to=-300.0, over=0.05)
BARE = replace(DIESEL.rod, mass=0.0, inertia=0.0)


@pytest.mark.parametrize(
    ("scene", "sentence"),
    [
        ("yi_diesel", "scene must be a Scene, such as load_scene reads"),
        (
            load_scene("propeller"),
            r"start: the crank is free already; give a scene with \[motion\]",
        ),
        (FUELLED, "fuel: with shares of the combustion cycles differ, and no one load balances"),
        (driven(RISES, "1 s"), "motion.speed: comes to rest or turns back within the run"),
        (driven(FALLS, "0.04 s"), "motion.speed: comes to rest or turns back within the run"),
        (driven(FALLS, "1 rev"), "motion.speed: comes to rest or turns back within the run"),
        (light(DIESEL), "comes near rest in every cycle; give it a heavier flywheel; 0 kg m"),
        (light(DIESEL, 1.0), "comes near rest in every cycle; give it a heavier flywheel; 0 kg m"),
        (
            replace(DIESEL, crank=replace(DIESEL.crank, mass=0.0, inertia=None), rod=BARE),
            "a free crank needs an inertia above 0, or nothing resists it at the dead centres",
        ),
    ],
)
def test_what_cannot_be_set_free_is_refused(scene, sentence):
    with pytest.raises(InputError, match=sentence):
        freed(scene)


def test_a_speed_that_turns_back_beyond_the_run_has_a_mean():
    assert mean_prescribed(driven(FALLS, "1 ms")) == pytest.approx(300.0 - 6.0, rel=1e-12)
    assert mean_prescribed(driven(FALLS, "0.2 rev")) > 200.0


def test_it_runs_under_another_formulation_than_the_algebra_of_a_prescribed_one():
    scene = replace(DIESEL, run=replace(DIESEL.run, formulation="kinetostatic"))
    assert simulate(freed(scene)).formulation == "crank_angle"
