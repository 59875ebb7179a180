"""A scene in steps over time: the same motion as a run, under what another model sets.

Long, as every kind of load, rest and decision is stepped through by the same few helpers.
"""

import gc
import math
import pickle
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Crank,
    Extent,
    Fuel,
    InputError,
    Load,
    Motion,
    Piston,
    Ramp,
    Rod,
    Run,
    Scene,
    Start,
    Stepper,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.scene.parts import Friction
from validation.random_changes import random_changes
from validation.random_friction import random_friction
from validation.random_scenes import random_scene

DIESEL, COASTING = load_scene("yi_diesel_free"), load_scene("coasting")
RANDOM = {
    "machine": random_scene,
    "friction": random_friction,
    **{k: lambda seed, kind=k: random_changes(kind, seed) for k in ("windows", "fuel", "all")},
}
SEEDS = {"machine": (5, 7, 36), "friction": (17, 22, 57), "windows": (3, 20), "fuel": (15, 32)}


def ends(scene, until, count):
    """The scene up to a time, with so many samples."""
    every = Extent(value=until / count, unit="s")
    return replace(scene, run=replace(scene.run, until=Extent(value=until, unit="s"), every=every))


def off(state, data, k=-1):
    """Differences of angle and speed from a run, over what both state."""
    found = []
    for name in ("crank_angle", "crank_speed"):
        apart = abs(getattr(state, name) - float(data[name][k]))
        stated = getattr(state, f"{name}_error") + data[name].attrs["error_estimate"]
        found.append(apart / stated)
    return max(found)


def wheel(*torque, speed=0.0, **others):
    """A bare flywheel of 0.5 kg m2."""
    return Scene(
        crank=Crank(radius=0.04, inertia=0.5),
        rod=Rod(length=0.14),
        piston=Piston(mass=0.0),
        start=Start(angle=0.3, speed=speed),
        torque=torque,
        run=Run(until="1 s", rtol=1e-10),
        **others,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "seed"), [(kind, seed) for kind, seeds in SEEDS.items() for seed in seeds]
)
def test_odd_steps_give_the_motion_of_a_run(kind, seed):
    scene = RANDOM[kind](seed)
    end, in_time = scene.end
    end = end if in_time else 20.0 / abs(scene.start.speed or 20.0)
    stepper, rng = Stepper(scene), np.random.default_rng(seed)
    for until in [*np.sort(rng.uniform(0.0, end, 12)).tolist(), end]:
        state = stepper.advance(until - stepper.state.time)
    assert state.status == 0, state.message
    data = simulate(ends(scene, state.time, 7), formulation="crank_angle", rtol=1e-12).data
    if data["time"][-1] == state.time:
        assert off(state, data) < 2.0
    else:  # the run ends where the crank rests for good, and steps go on resting
        assert state.crank_speed == 0.0 == float(data["crank_speed"][-1])
        assert state.crank_angle == pytest.approx(float(data["crank_angle"][-1]), abs=1e-6)


def test_over_the_angle_and_over_time_it_is_the_same_motion():
    states = []
    for formulation in ("crank_angle", "minimal"):
        stepper = Stepper(replace(DIESEL, run=replace(DIESEL.run, formulation=formulation)))
        states += [[stepper.advance(2.3e-3, load=-40.0) for _ in range(5)]]
    for one, other in zip(*states, strict=True):
        assert one[:4] != other[:4]
        stated = one.crank_angle_error + other.crank_angle_error
        assert abs(one.crank_angle - other.crank_angle) < 2.0 * stated
        stated = one.crank_speed_error + other.crank_speed_error
        assert abs(one.crank_speed - other.crank_speed) < 2.0 * stated


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_the_stated_error_is_what_it_errs(rtol):
    scene = replace(DIESEL, run=replace(DIESEL.run, rtol=rtol))
    stepper, errors = Stepper(scene), [0.0]
    for _ in range(40):
        state = stepper.advance(1.7e-3)
        errors.append(state.crank_angle_error)
    assert errors == sorted(errors)  # over all that it has run, not of a moment
    data = simulate(ends(scene, state.time, 1), rtol=1e-13).data
    true = abs(state.crank_angle - float(data["crank_angle"][-1]))
    assert true < 2.0 * state.crank_angle_error < 2.0 * 10.0 * rtol * state.crank_angle


def test_a_load_held_from_step_to_step_is_a_time_table_with_jumps():
    torques, dt = [-40.0, 25.0, 0.0, -80.0, -80.0, 60.0], 3e-3
    stepper = Stepper(DIESEL)
    seen = []
    for torque in torques:
        stepper.advance(0.5 * dt, load=torque)
        seen.append((stepper.state, stepper.data))
        stepper.advance(0.5 * dt, load=torque)
    times = dt * np.repeat(np.arange(len(torques) + 1), 2)[1:-1]
    held = TimeTable(file=Table(tuple(times.tolist()), tuple(np.repeat(torques, 2).tolist())))
    scene = ends(replace(DIESEL, torque=(*DIESEL.torque, held)), dt * len(torques), 12)
    data = simulate(scene, rtol=1e-12).data
    assert off(stepper.state, data) < 2.0
    for k, (state, own) in enumerate(seen):
        assert off(state, data, 2 * k + 1) < 2.0
        assert set(own.variables) == set(data.variables)
        for name in set(own.data_vars) - {"energy_residual"}:
            there = data.isel(time=[2 * k + 1])[name]
            stated = own[name].attrs["error_estimate"] + there.attrs["error_estimate"]
            assert np.abs(own[name].values - there.values).max() < 2.0 * stated, name
        assert state.crank_acceleration == pytest.approx(float(own["crank_acceleration"][0]))


def test_the_energy_residual_knows_the_work_of_the_load():
    stepper = Stepper(wheel())
    stepper.advance(2.0, load=5.0)
    data = stepper.data
    assert float(data["kinetic_energy"][0]) == pytest.approx(0.25 * 20.0**2, rel=1e-12)
    assert abs(float(data["energy_residual"][0])) < 1e-10


def test_it_turns_back_where_the_load_drives_it_back():
    stepper = Stepper(wheel(speed=7.0))
    state = stepper.advance(1.5, load=-5.0)
    assert state.crank_speed == pytest.approx(7.0 - 15.0, rel=1e-12)
    assert state.crank_angle == pytest.approx(0.3 + 7.0 * 1.5 - 5.0 * 1.5**2, rel=1e-12)
    state = stepper.advance(0.25, load=16.0)
    assert state.crank_speed == pytest.approx(0.0, abs=1e-12)
    assert state.crank_acceleration == pytest.approx(32.0, rel=1e-12)


def test_a_crank_at_rest_rests_until_a_load_moves_it():
    stepper = Stepper(wheel())
    state = stepper.advance(2.0)
    assert (state.time, state.crank_angle, state.crank_speed, state.status) == (2.0, 0.3, 0.0, 0)
    assert "no torque moves the crank" in state.message
    state = stepper.advance(1.0, load=5.0)
    assert state.crank_speed == pytest.approx(10.0, rel=1e-12)


def test_friction_holds_a_crank_up_to_its_limit_and_lets_go_beyond():
    rubbing = replace(COASTING, gravity=None, friction=Friction(ring_force=40.0))
    rubbing = replace(rubbing, start=Start(angle=1.0, speed=0.0), torque=())
    data = Stepper(rubbing).data
    rod, r = rubbing.rod.length, rubbing.crank.radius
    beta = math.asin(r * math.sin(1.0) / rod)
    limit = 40.0 * r * (math.sin(1.0) + math.cos(1.0) * math.tan(beta))
    stepper = Stepper(rubbing)
    for share in (0.5, -0.999):
        state = stepper.advance(0.01, load=share * limit)
        assert (state.crank_angle, state.crank_speed) == (1.0, 0.0)
        assert "holds the crank there" in state.message
        held = float(stepper.data["friction_force"][0, 0])
        assert held == pytest.approx(-share * 40.0, rel=1e-9)
    assert float(data["friction_force"][0, 0]) == 0.0
    assert stepper.advance(0.01, load=-1.001 * limit).crank_speed < 0.0


def test_a_load_of_the_scene_that_sets_in_moves_a_resting_crank():
    state = Stepper(wheel(Constant(torque=5.0, after=0.75))).advance(1.0)
    assert state.crank_speed == pytest.approx(2.5, rel=1e-12)
    stepper = Stepper(wheel(Constant(torque=5.0, until=0.75)))
    at = stepper.advance(0.75)
    assert at.crank_acceleration == 0.0  # at its end a load has ended
    assert stepper.advance(0.5).crank_speed == pytest.approx(7.5, rel=1e-12)


def test_it_steps_up_to_the_last_row_of_a_time_table_and_not_beyond():
    stepper = Stepper(wheel(TimeTable(file=Table((0.0, 1.0), (0.0, 4.0)))))
    state = stepper.advance(1.0)
    assert state.crank_acceleration == pytest.approx(8.0, rel=1e-12)
    assert float(stepper.data["external_torque"][0]) == pytest.approx(4.0, rel=1e-12)
    with pytest.raises(InputError, match=r"torque\[1\]\.file: .*ends at 1 s"):
        stepper.advance(0.1)
    assert stepper.state == state


def fuelled(**fuel):
    return replace(load_scene("misfire"), fuel=Fuel(**fuel))


def test_fuel_that_is_cut_is_fuel_whose_window_has_ended():
    stepper, cut = Stepper(fuelled()), 0.031
    stepper.advance(cut)
    assert set(stepper.data["fuel"].values.ravel()) == {1.0}
    while stepper.state.time < 0.09:
        stepper.advance(4e-3, fuel=0.0)
    scene = ends(fuelled(until=cut), stepper.state.time, 3)
    data = simulate(scene, rtol=1e-12).data
    assert off(stepper.state, data) < 2.0
    assert set(stepper.data["fuel"].values.ravel()) == {0.0}


def test_a_share_holds_from_the_decision_on_for_one_period():
    scene = fuelled(scatter=0.3)
    stepper = Stepper(scene)
    quarter = math.pi / abs(scene.start.speed)
    begin = stepper.data["fuel"].values[0]
    stepper.advance(1.2 * quarter, fuel=0.625)
    after = stepper.data["fuel"].values[0]
    assert sorted(after != begin) == [False, False, False, True]
    assert 0.625 in after
    stepper.advance(3.5 * quarter)
    assert 0.625 in stepper.data["fuel"].values[0]
    stepper.advance(4.0 * quarter)
    own = stepper.data["fuel"].values[0]
    assert 0.625 not in own  # the scene's law again
    assert (own != begin).all()


def test_a_governor_waits_with_its_integral_while_a_share_is_imposed():
    stepper = Stepper(load_scene("run_up"))
    while stepper.state.time < 1.0:
        stepper.advance(5e-3)

    def integral():
        return stepper.save().standing.states[0].mode.firing.integral

    before, time = integral(), stepper.state.time
    while stepper.state.time < time + 0.2:
        stepper.advance(5e-3, fuel=0.1)
    assert integral() == before
    stepper.advance(0.1)
    assert integral() != before


@pytest.mark.parametrize("name", ["run_up", "run_down", "friction", "torque_driven"])
def test_what_follows_a_restored_snapshot_is_the_same_to_the_last_bit(name):
    scene = load_scene(name)
    stepper = Stepper(scene)
    fuel = 0.4 if scene.fuel else None
    load = -3.0 if scene.start else 0.0
    stepper.advance(0.0123, load=load, fuel=fuel)
    snapshot = pickle.loads(pickle.dumps(stepper.save()))
    there, data = stepper.state, stepper.data

    def onwards(one):
        return [one.advance(dt, fuel=fuel) for dt in (1e-3, 0.04, 7e-4)], one.data

    states, last = onwards(stepper)
    stepper.restore(snapshot)
    for again in (stepper, Stepper(load_scene(name))):
        again.restore(snapshot)
        assert again.state == there
        assert again.data.identical(data)
        found, after = onwards(again)
        assert found == states
        assert after.identical(last)


def test_a_snapshot_is_of_its_scene():
    with pytest.raises(InputError, match="of another scene than this stepper's"):
        Stepper(COASTING).restore(Stepper(DIESEL).save())
    with pytest.raises(InputError, match="snapshot must be what save gave; 3 came"):
        Stepper(COASTING).restore(3)


@pytest.mark.slow
def test_nothing_grows_with_the_number_of_steps():
    """What a stepper holds is of one size, once the tracer has seen it all made anew."""
    stepper = Stepper(replace(fuelled(), torque=(Viscous(coefficient=0.01),)))
    sizes, held_then = [], []
    tracemalloc.start()
    try:
        for steps in (100, 300, 300):
            for _ in range(steps):
                stepper.advance(1e-3, load=-1.0)
            sizes.append(len(pickle.dumps(stepper.save())))
            held_then.append(held())
    finally:
        tracemalloc.stop()
    assert np.abs(np.diff(sizes)).max() < 64
    # a float more in each step: 7200, both times; what else is made anew, as caches, comes once
    assert np.abs(np.diff(held_then)).min() < 4000


def held():
    """Bytes that are held, but for those that numpy keeps for its next arrays."""
    gc.collect()
    lines = [tracemalloc.Filter(False, f"*/{name}") for name in ("numpy/*", "tracemalloc.py")]
    return sum(trace.size for trace in tracemalloc.take_snapshot().filter_traces(lines).traces)


PRESCRIBED = {
    "constant": Motion(speed="3200 rpm", angle=0.3),
    "ramp": Motion(speed=Ramp(start=-60.0, to=340.0, over=0.02)),  # through rest
}


@pytest.mark.parametrize("motion", PRESCRIBED.values(), ids=PRESCRIBED)
@pytest.mark.parametrize("fires", [True, False])
def test_a_prescribed_speed_is_followed(motion, fires):
    scene = replace(fuelled(scatter=0.3), start=None, motion=motion, torque=())
    scene = scene if fires else replace(scene, fuel=None)
    stepper = Stepper(scene)
    for _ in range(9):
        state = stepper.advance(5e-3)
    data = simulate(ends(scene, state.time, 3)).data.isel(time=[-1])
    own = stepper.data
    assert state.crank_angle == pytest.approx(float(data["crank_angle"][0]), rel=1e-14)
    assert set(own.variables) == set(data.variables) - {"energy_residual"}
    for name in own.data_vars:
        scale = 1e-12 * float(np.abs(data[name]).max()) + 2.0 * own[name].attrs["error_estimate"]
        np.testing.assert_allclose(own[name].values, data[name].values, rtol=0.0, atol=scale)


def test_a_share_is_imposed_under_a_prescribed_speed_too():
    scene = replace(fuelled(), start=None, motion=PRESCRIBED["constant"], torque=())
    stepper = Stepper(scene)
    stepper.advance(0.05, fuel=0.25)
    assert set(stepper.data["fuel"].values.ravel()) == {0.25}


@pytest.mark.parametrize("angle", [0.65, 0.825, 1.1, 1.15, 1.25, 1.3])
def test_what_a_function_does_undeclared_is_in_the_stated_error(angle):
    def jumps(_time, theta, _omega):
        return 40.0 if theta > angle else 0.0

    undeclared, declared = (
        Stepper(COASTING.with_(torque=(Load(jumps, kink_angles=kinks),))).advance(0.02)
        for kinks in ((), (angle,))
    )
    for name in ("crank_angle", "crank_speed"):
        apart = abs(getattr(undeclared, name) - getattr(declared, name))
        assert 0.0 < apart <= 2.0 * getattr(undeclared, f"{name}_error")


def test_the_forces_know_the_load_that_is_held():
    stepper = Stepper(DIESEL)
    state = stepper.advance(1e-3, load=-50.0)
    (brake,) = DIESEL.torque
    own = -brake.coefficient * state.crank_speed * abs(state.crank_speed)
    assert float(stepper.data.external_torque[0]) == pytest.approx(own - 50.0, rel=1e-12)
    found = float(stepper.data.crank_acceleration[0])
    assert found == pytest.approx(state.crank_acceleration, rel=1e-10)


def test_what_the_passes_differ_by_is_the_most_so_far():
    stepper, standings = Stepper(DIESEL), []
    for _ in range(20):
        stepper.advance(1e-3)
        standings.append(stepper.save().standing)
    for name in ("ahead", "faster"):
        found = [getattr(standing, name) for standing in standings]
        assert found == sorted(found)
        assert found[-1] > 0.0
