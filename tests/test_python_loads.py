"""Loads that are functions of Python, against closed forms and the loads that they imitate."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Crank,
    Force,
    InputError,
    Load,
    Piston,
    Quadratic,
    Result,
    Rod,
    Run,
    Scene,
    Start,
    Table,
    TimeTable,
    load_scene,
    simulate,
)
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal.advance import Effort, advance
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.segment import StepSizes
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan
from crankmbs.numerics.function import Function
from crankmbs.scene.write import scene_files
from crankmbs.simulate import why
from validation.random_unlike import random_unlike

FREE = ["crank_angle", "minimal"]
PROPELLER = replace(load_scene("propeller"), run=Run(until="2 cycles", every="5 deg"))


def wheel(*torque, speed=12.0, until="3 rev", rod=0.0, piston=0.0, every="7 deg"):
    return Scene(
        crank=Crank(radius=0.04, inertia=0.5),
        rod=Rod(length=0.14, mass=rod),
        piston=Piston(mass=piston),
        start=Start(angle=0.4, speed=speed),
        torque=torque,
        run=Run(until=until, every=every, rtol=1e-9),
    )


@pytest.mark.parametrize("formulation", FREE)
def test_a_function_of_the_angle_does_its_integral(formulation):
    load = Load(lambda t, theta, omega: 20.0 * math.sin(3.0 * theta) + 5.0)
    result = simulate(wheel(load), formulation=formulation)
    theta, omega = (result.data[n].values for n in ("crank_angle", "crank_speed"))
    gained = 20.0 / 3.0 * (math.cos(1.2) - np.cos(3.0 * theta)) + 5.0 * (theta - 0.4)
    np.testing.assert_allclose(0.25 * omega**2, 36.0 + gained, rtol=1e-8)
    at = result.data["external_torque"]
    np.testing.assert_allclose(at, 20.0 * np.sin(3.0 * theta) + 5.0, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
def test_a_knot_is_met_as_soon_whatever_the_time(tolerance):
    """Halves of a step that rounding leaves short of a knot by one more, of 1e-18 s, put the angle
    on the knot and left the time: a jump of an angle that both passes may share."""
    steady = replace(PROPELLER, torque=(Load(lambda t, theta, omega: -20.0),))
    train, elapsed = crank_train(steady), []
    reduced = Reduced(train)
    for begin in np.linspace(0.0, 10.0, 201):
        state = State(float(begin), 0.3, 50.0, 0.0, begun(train))
        plan, taken = Plan(0.3, 1.0, True, begin + 1.0, True), StepSizes()
        for before in (None, taken):
            effort = Effort(tolerance, 10**6, before, 64)
            passed = next(advance(reduced, state, plan, effort, lambda *_: False))
            taken.add(passed.track.begins, passed.track.widths)
        elapsed.append(passed.end.time - begin)
        assert np.min(np.diff([*passed.track.begins, passed.end.time])) > 1e-5
    assert np.ptp(elapsed) < 1e-14


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
def test_functions_of_time_and_speed(formulation):
    """J omega' = 4 cos(t) - 0.3 omega, in closed form."""
    load = Load(lambda t, theta, omega: 4.0 * math.cos(t) - 0.3 * omega)
    data = simulate(wheel(load, until="4 s", every="0.1 s"), formulation=formulation).data
    t, a, b = data["time"].values, 0.6, 8.0
    forced = b * (a * np.cos(t) + np.sin(t)) / (a * a + 1.0)
    exact = forced + (12.0 - b * a / (a * a + 1.0)) * np.exp(-a * t)
    np.testing.assert_allclose(data["crank_speed"], exact, rtol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
def test_it_is_the_load_that_it_imitates(formulation):
    (load,) = PROPELLER.torque
    assert isinstance(load, Quadratic)
    c = load.coefficient
    same = replace(PROPELLER, torque=(Load(lambda t, theta, omega: -c * omega * abs(omega)),))
    a, b = (simulate(scene, formulation=formulation) for scene in (PROPELLER, same))
    for name in ("time", "crank_speed", "external_torque"):
        error = a.data[name].error_estimate + b.data[name].error_estimate
        assert np.max(np.abs(a.data[name].values - b.data[name].values)) <= error


def hat(x):
    return abs(x % 1.0 - 0.5)


UNDECLARED = {
    "angle": lambda t, theta, omega: 40.0 * hat(theta) - 10.0,
    "time": lambda t, theta, omega: 40.0 * hat(3.0 * t) - 10.0,
    "speed": lambda t, theta, omega: 60.0 * hat(0.7 * omega) - 20.0,
    "jump": lambda t, theta, omega: 15.0 if theta % 2.0 < 0.77 else -5.0,
}


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("name", UNDECLARED)
def test_undeclared_kinks_are_in_the_stated_error(name, formulation):
    """Against the same function at a hundredth of the tolerance."""
    scene = wheel(Load(UNDECLARED[name]), rod=0.3, piston=0.4, until="1.5 rev", every="30 deg")
    rough = simulate(scene, formulation=formulation, rtol=1e-5)
    fine = simulate(scene, formulation=formulation, rtol=1e-8)
    for variable in ("time", "crank_speed"):
        off = np.max(np.abs(rough.data[variable].values - fine.data[variable].values))
        stated = rough.data[variable].error_estimate + fine.data[variable].error_estimate
        assert off <= 2.0 * stated
        assert stated < 1e-2 * np.max(fine.data[variable].values)


def test_declared_kinks_cost_no_accuracy():
    times, torques = (0.0, 0.3, 0.9, 9.0), (3.0, -8.0, 5.0, 5.0)
    table = TimeTable(file=Table(times, torques))
    same = Load(lambda t, theta, omega: float(np.interp(t, times, torques)), kink_times=(0.3, 0.9))
    a, b = (simulate(wheel(load, until="1.5 s", every="0.05 s")) for load in (table, same))
    np.testing.assert_allclose(a.data["crank_speed"], b.data["crank_speed"], rtol=1e-9)
    assert b.data["crank_speed"].error_estimate < 1e-7


@pytest.mark.parametrize("formulation", FREE)
def test_kink_speeds_and_angles_are_landed_on(formulation):
    def brake(t, theta, omega):
        return (-30.0 if omega > 10.0 else -5.0) + (4.0 if theta % (2 * math.pi) < 1.0 else 0.0)

    load = Load(brake, kink_speeds=(10.0,), kink_angles=(0.0, 1.0))
    scene = wheel(load, until="0.6 rev", every="10 deg")
    data = simulate(scene, formulation=formulation).data
    theta, omega = data["crank_angle"].values, data["crank_speed"].values
    pulse = np.minimum(theta, 1.0) - 0.4 + np.maximum(theta - 2 * math.pi, 0.0)
    fast = 36.0 - 30.0 * (theta - 0.4) + 4.0 * pulse
    turn = 0.4 + 11.0 / 26.0  # where the brake has eaten 11 J, in the pulse
    slow = 25.0 - 5.0 * (theta - turn) + 4.0 * (pulse - (turn - 0.4))
    np.testing.assert_allclose(0.25 * omega**2, np.where(theta < turn, fast, slow), rtol=1e-8)
    assert data["crank_speed"].error_estimate < 1e-6


@pytest.mark.parametrize("formulation", FREE)
def test_a_declared_jump_may_hold_the_speed(formulation):
    clutch = Load(lambda t, theta, omega: -5.0 if omega > 10.0 else 5.0, kink_speeds=(10.0,))
    result = simulate(wheel(clutch), formulation=formulation)
    assert result.status == 1
    assert "held at 95.493 rpm" in result.message


def test_multibody_confirms():
    load = Load(lambda t, theta, omega: 9.0 * math.sin(theta) - 0.2 * omega + 3.0 * math.cos(5 * t))
    scene = wheel(load, rod=0.5, piston=0.8, until="1.5 rev", speed=20.0)
    answer, check = simulate(scene), simulate(scene, formulation="multibody")
    for name in ("crank_speed", "external_torque"):
        a, b = answer.data[name], check.data[name]
        apart = np.max(np.abs(a.values - b.values))
        assert apart <= a.error_estimate + b.error_estimate
    assert check.data["crank_speed"].error_estimate < 1e-2


@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("behind", [0.001, 0.004, 0.016])
def test_a_jump_right_behind_a_dead_centre_is_not_passed_over(behind, formulation):
    """There the force has no torque, so that what is before the jump gives nothing away."""

    def jumps(t, angle, displacement, velocity):
        return 200.0 if (angle - behind) % (2.0 * math.pi) > math.pi else -100.0

    machine = wheel(until="1 rev", piston=0.1)
    known = (behind, behind + math.pi)
    hidden, told = (
        simulate(
            replace(machine, force=(Force(jumps, kink_angles=kinks),)),
            formulation=each,
            rtol=1e-9,
        )
        for kinks, each in (((), formulation), (known, "crank_angle"))
    )
    for name in ("time", "crank_speed"):
        off = np.abs(hidden.data[name].values - told.data[name].values).max()
        stated = [one.data[name].attrs["error_estimate"] for one in (hidden, told)]
        assert off <= 2.0 * sum(stated), name


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("speed", [-503.0, -510.0, -515.0])
def test_a_jump_beside_a_dead_centre_is_in_the_stated_error_of_a_coarse_run(speed, formulation):
    """An offset piston's, 0.1 degrees from where the cycle angle begins and the force jumps."""
    scene = random_unlike(40).with_(start__speed=speed)
    exact = simulate(scene, formulation="crank_angle", rtol=1e-12).data["crank_angle"]
    found = simulate(scene, formulation=formulation).data["crank_angle"]
    off = abs(found.values[-1] - exact.values[-1])
    assert off <= 2.0 * found.attrs["error_estimate"]


@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("before", [-3e-4, 1e-4, 9e-4, 4e-3])
def test_a_bend_right_before_or_behind_a_knot_is_in_the_stated_error(before, formulation):
    """All cells end at the knot, so that no node may lie between it and the bend."""

    def rectified(t, theta, omega):
        return 40.0 * abs(math.sin(theta + before)) - 25.0

    knots = [k * math.pi for k in range(2)]
    bends = [angle - before for angle in knots]
    hidden, told = (
        simulate(wheel(Load(rectified, kink_angles=known)), formulation=each)
        for known, each in ((knots, formulation), ([*knots, *bends], "crank_angle"))
    )
    for name in ("time", "crank_speed"):
        off = np.abs(hidden.data[name].values - told.data[name].values).max()
        stated = [one.data[name].attrs["error_estimate"] for one in (hidden, told)]
        assert off <= sum(stated), name


def fails_late(t, theta, omega):
    return math.sqrt(1.0 - theta)


def divides(t, theta, omega):
    return 1.0 / (0.0 if t > 0.05 else 1.0)


def is_nan(t, theta, omega):
    return math.nan if theta > 1.0 else 1.0


@pytest.mark.slow
@pytest.mark.parametrize("formulation", [*FREE, "multibody"])
@pytest.mark.parametrize(
    ("function", "said"),
    [
        (fails_late, r"torque\[1\]: fails_late raises ValueError: .* at t = .* s, theta = \S+ rad"),
        (
            divides,
            r"torque\[1\]: divides raises ZeroDivisionError: .* at t = \S+ s, theta = .* omega = 1",
        ),
        (is_nan, r"torque\[1\]: is_nan gives nan at t = .* theta = 1.* rad, omega = 1"),
    ],
)
def test_a_function_that_fails_is_a_result_with_a_sentence(function, said, formulation):
    result = simulate(wheel(Load(function), rod=0.1, piston=0.1), formulation=formulation)
    assert result.status == -1
    assert re.search(said, result.message), result.message
    assert "cost cap" not in result.message  # found, not sought until it is given up
    assert float(result.data["time"][-1]) > 0.0


def test_a_function_that_fails_is_the_cause_and_no_cap():
    function = Function(is_nan)
    function.number(0.0, 2.0, 1.0)
    _, message = Ending.COSTLY.said(1.0, allowed=500_000)
    said = why(-1, message, [("torque[1]", function)])
    assert said.startswith("stopped at 57.2958 degrees: torque[1]: is_nan gives nan at t = 0 s")
    assert "cost cap" not in said
    assert why(-1, message, [("torque[1]", Function(math.sin))]) == message


@pytest.mark.slow
def test_a_jump_that_is_not_declared_is_named_where_it_costs_accuracy():
    def jumps(t, theta, omega):
        return 40.0 if theta % (2.0 * math.pi) < 1.0 else -40.0

    message = simulate(wheel(Load(jumps), until="1 rev")).message
    assert "reached" in message
    assert "where jumps bends or jumps must be declared, by kink_angles" in message
    declared = Load(jumps, kink_angles=(0.0, 1.0))
    assert simulate(wheel(declared, until="1 rev")).message == "reached the end of the run"


@pytest.mark.parametrize("formulation", FREE)
def test_a_load_that_is_undefined_from_a_time_on_ends_the_run(formulation):
    load = Load(lambda t, theta, omega: math.nan if t > 0.1 else -1.0)
    result = simulate(replace(load_scene("coasting"), torque=(load,)), formulation=formulation)
    assert result.status == -1
    assert "gives nan at t = 0.1 s" in result.message
    assert "no step" not in result.message
    assert float(result.data["time"][-1]) == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize("formulation", FREE)
def test_a_load_that_is_undefined_below_a_speed_is_not_crept_up_to(formulation):
    """Step after step as short as rounding, a million evaluations led nowhere."""
    load = Load(lambda t, theta, omega: -20.0 if omega > 330.0 else math.nan)
    scene = load_scene("yi_diesel_free").with_(torque=(load,), run__until="1 cycle")
    result = simulate(scene, formulation=formulation)
    assert result.status == -1
    assert "gives nan at t = 0.00339922 s" in result.message
    assert float(result.data["crank_speed"][-1]) == pytest.approx(330.0, rel=1e-12)
    assert result.cost.evaluations < 30_000


@pytest.mark.slow
def test_a_saved_result_keeps_the_name(tmp_path):
    result = simulate(wheel(Load(fails_late, kink_times=(1.0,), until=0.01), until="10 deg"))
    result.save(tmp_path / "out")
    scene = Result.load(tmp_path / "out").scene
    assert scene.torque[0].function.__name__ == "fails_late"
    assert scene.torque[0].kink_times == (1.0,)
    with pytest.raises(InputError, match=r"torque\[1\]: of the function fails_late a saved result"):
        simulate(scene)


def test_it_is_no_load_of_a_file():
    with pytest.raises(InputError, match=r"torque\[1\]: .*fails_late.*cannot be written"):
        scene_files(wheel(Load(fails_late)), "mine")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"function": 3.0}, "function: must be a function of t, theta and omega .*; 3.0 came"),
        ({"function": is_nan, "period": 5.0}, "period must be a multiple of half a revolution"),
        ({"function": is_nan, "period": -1.0}, "period: must be above 0; -1.0 came"),
        ({}, "function: this argument is missing"),
    ],
)
def test_bad_arguments(arguments, said):
    with pytest.raises(InputError, match=said):
        Load(**arguments)


@pytest.mark.parametrize("period", [4 * math.pi, 2 * math.pi / 3, 12 * math.pi])
def test_kink_angles_repeat_every_period(period):
    load = Load(is_nan, kink_angles=(0.5,), period=period)
    angles = load.parts.function.angles
    assert len(angles) == max(1, round(4 * math.pi / period))
    assert angles[0] == pytest.approx(0.5)


def test_compiled_and_plain_are_the_same():
    at = np.linspace(0.1, 3.0, 50).reshape(5, 10)
    quick = Function(lambda t, theta, omega: math.sin(theta) * omega + t)
    np.testing.assert_allclose(quick(at, at, at), np.sin(at) * at + at, rtol=1e-15)
    rows = {"a": 2.0}
    plain = Function(lambda t, theta, omega: rows["a"] * {1: t}[1])  # numba knows no such dict
    np.testing.assert_allclose(plain(at, at, at), 2.0 * at, rtol=1e-15)
