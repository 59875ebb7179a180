"""Motions that die away: both passes come to rest, each when its tolerance says so."""

from dataclasses import replace

import numpy as np
import pytest
from references import worst_ratio
from scipy.integrate import solve_ivp

from crankmbs import Constant, Gravity, Load, Run, Start, Viscous, load_scene, simulate
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import Samples
from crankmbs.motion.free.passes import match, stays
from validation.random_periods import random_periods
from validation.random_scenes import random_scene

BOTH = pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
HANGING = replace(
    load_scene("coasting"),
    gravity=Gravity(acceleration=9.81, angle=0.5),
    torque=(Viscous(coefficient=1.0),),
)


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("seed", [1009, 1625, 2334])
def test_a_motion_that_creeps_or_swings_to_rest(seed, formulation):
    """Of 1625 and 2334 the first pass swings on, by its errors alone."""
    result = simulate(random_scene(seed), formulation=formulation)
    assert result.status == 1
    assert result.message.startswith("came to rest at")
    assert worst_ratio(result) <= 2.0


def test_passes_that_turn_back_within_a_step_do_not_err_alike():
    """The error control of either pass shortens the step there, by itself to the same length."""
    scene = random_periods(108)
    speed, exact = (simulate(scene, **asked).data["crank_speed"] for asked in ({}, {"rtol": 1e-8}))
    assert np.abs(speed.values - exact.values).max() <= 2.0 * speed.error_estimate


@BOTH
@pytest.mark.parametrize("until", ["9 rev", "30 s"])
def test_when_it_is_deemed_at_rest_is_no_error(until, formulation):
    """While it creeps the speed and its slope are mere errors: no sample goes astray there."""
    run = Run(until=until, every="0.1 s", rtol=1e-6)
    result = simulate(replace(HANGING, run=run), formulation=formulation)
    assert result.message in ("came to rest at 10.503 degrees", "reached the end of the run")
    assert result.error.estimated <= 1e-6
    time = result.data["time"].values
    assert np.all(np.diff(time) > 0.0)
    late = result.data["crank_speed"].values[time > 13.0]
    assert np.abs(late).max() <= 5e-6


def dashpot(_time, _angle, speed):
    return -1000.0 * speed


@pytest.mark.parametrize("speed", [0.0, 0.05])
@pytest.mark.parametrize("load", [Viscous(coefficient=1000.0), Load(dashpot)], ids=["", "Python"])
def test_a_crank_creeps_under_a_stiff_load_in_long_steps(speed, load):
    """The speed dies away 600,000 times while the crank turns by a radian."""
    loads = Constant(torque=50.0), load
    run = Run(until="0.2 rev", every="5 deg")
    start = Start(angle=-7.0, speed=speed)
    scene = replace(load_scene("coasting"), torque=loads, start=start, run=run)
    result = simulate(scene)
    assert result.status == 0
    assert result.cost.evaluations < 20_000  # 60 million are stable steps of an explicit method
    data, train = result.data, crank_train(scene)

    def slopes(_, y):
        inertia, slope, torque = (float(part) for part in reduce(train, y[0]))
        return y[1], (torque + 50.0 - 1000.0 * y[1] - 0.5 * slope * y[1] ** 2) / inertia

    def derivatives(_, y):
        inertia, off = float(reduce(train, y[0]).inertia), 1e-5
        of_angle = slopes(0.0, (y[0] + off, y[1]))[1] - slopes(0.0, (y[0] - off, y[1]))[1]
        return [[0.0, 1.0], [0.5 * of_angle / off, -1000.0 / inertia]]

    times, close = data.time.values, {"rtol": 1e-11, "atol": [1e-13, 1e-14]}
    by_scipy = solve_ivp(
        slopes,
        (0.0, times[-1]),
        (-7.0, speed),
        method="Radau",
        t_eval=times,
        jac=derivatives,
        **close,
    )
    for name, there in zip(("crank_angle", "crank_speed"), by_scipy.y, strict=True):
        off = np.abs(data[name].values - there)[1:].max()
        assert off <= 2.0 * data[name].error_estimate + 1e-11


def samples(time, theta):
    return Samples(
        *(np.array(column, dtype=float) for column in (time, theta, *[[0.0] * len(time)] * 3))
    )


def test_an_end_at_rest_is_compared_at_equal_times():
    a = samples([0, 1, 2, 2.5], [0.0, 0.9, 1.0, 1.0])
    b = samples([0, 1, 2, 3, 4, 4.5], [0.0, 0.8, 1.0, 1.0, 1.0, 1.0 + 1e-5])
    assert stays(a, b)
    assert stays(b, a)
    for one, other in ((a, b), (b, a)):
        own, better, parted = match(one, other, in_time=True, reversals=0, at_rest=True)
        assert not parted
        np.testing.assert_array_equal(own.time, better.time)
        assert own.time[-1] == one.time[-1]
        assert own.theta[-1] == one.theta[-1]
        assert better.theta[-1] == other.theta[-1]
    assert not stays(a, samples([0, 1, 2, 3], [0.0, 0.8, 1.0, 1.1]))


def test_a_turn_on_a_sample_that_one_pass_misses():
    """Of three returns to one angle the first pass touches the second not at all."""
    a = samples([0, 1.0, 3.0, 4.0], [1.0, 1.0, 1.0, 0.5])
    b = samples([0, 0.999, 1.001, 1.999, 2.001, 2.999, 3.001, 4.0], [1.0] * 7 + [0.5])
    own, better, parted = match(a, b, in_time=False, reversals=3, at_rest=False)
    assert not parted
    np.testing.assert_allclose(better.time, own.time, atol=2e-3)
