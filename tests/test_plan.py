"""Plans: where samples lie, and where a run ends, in every formulation."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest

from crankmbs import Motion, Ramp, Run, Start, load_scene, simulate
from crankmbs.motion.plan import plan_of
from crankmbs.numerics.periodic import period_of
from crankmbs.scene.units import DEGREE

FREE = replace(load_scene("propeller"), start=Start(angle=0.1, speed=300.0))
BACKWARDS = replace(FREE, start=Start(angle=0.1, speed=-300.0))
PRESCRIBED = replace(
    FREE,
    start=None,
    torque=(),
    motion=Motion(speed=Ramp(start=250.0, to=350.0, over=0.02), angle=0.1),
)
WAYS = {
    "crank_angle": (FREE, "crank_angle"),
    "backwards": (BACKWARDS, "crank_angle"),
    "minimal": (FREE, "minimal"),
    "minimal backwards": (BACKWARDS, "minimal"),
    "kinetostatic": (PRESCRIBED, "kinetostatic"),
}
EVERY_WAY = pytest.mark.parametrize("way", WAYS)


def run(way, until, every):
    scene, formulation = WAYS[way]
    result = simulate(
        replace(scene, run=Run(until=until, every=every, rtol=1e-6)), formulation=formulation
    )
    assert result.status == 0
    return result.data["time"].values, result.data["crank_angle"].values


def sense(way):
    return -1.0 if "backwards" in way else 1.0


@EVERY_WAY
@pytest.mark.parametrize(
    ("until", "reach"), [("1 cycle", 4 * pi), ("0.75 rev", 1.5 * pi), ("100.5 deg", 100.5 * DEGREE)]
)
def test_samples_in_angle_up_to_an_angle(way, until, reach):
    time, angle = run(way, until, "7 deg")
    count = int(np.floor(reach / (7 * DEGREE) + 1e-9))
    grid = 0.1 + sense(way) * (7 * DEGREE) * np.arange(count + 1)
    end = 0.1 + sense(way) * reach
    expected = grid if abs(grid[-1] - end) < 1e-9 else np.append(grid, end)
    np.testing.assert_array_equal(angle[:-1], expected[:-1])
    assert angle[-1] == end
    assert time[0] == 0.0
    assert np.all(np.diff(time) > 0.0)


@EVERY_WAY
@pytest.mark.parametrize("until", ["20 ms", "20.5 ms"])
def test_samples_in_time_up_to_a_time(way, until):
    time, _ = run(way, until, "2 ms")
    np.testing.assert_array_equal(time[:11], 2e-3 * np.arange(11))
    assert time[-1] == float(until.split()[0]) * 1e-3
    assert len(time) == (11 if until == "20 ms" else 12)


@EVERY_WAY
def test_samples_in_angle_up_to_a_time(way):
    time, angle = run(way, "20 ms", "7 deg")
    grid = 0.1 + sense(way) * (7 * DEGREE) * np.arange(len(angle) - 1)
    np.testing.assert_array_equal(angle[:-1], grid)
    assert time[-1] == 0.02
    assert np.all(np.diff(time) > 0.0)


@EVERY_WAY
def test_samples_in_time_up_to_an_angle(way):
    time, angle = run(way, "1 rev", "2 ms")
    np.testing.assert_array_equal(time[:-1], 2e-3 * np.arange(len(time) - 1))
    assert 0.0 < time[-1] - time[-2] <= 2e-3
    assert angle[-1] == 0.1 + sense(way) * 2 * pi


@pytest.mark.slow
@EVERY_WAY
@pytest.mark.parametrize("until", ["3 cycles", "100 ms"])
def test_none_keeps_the_last_period(way, until):
    time, angle = run(way, until, "none")
    assert 4 * pi * (1 - 1e-12) <= abs(angle[-1] - angle[0]) < 4 * pi + DEGREE
    np.testing.assert_allclose(np.abs(np.diff(angle))[:-1], DEGREE, rtol=1e-10)
    steps = (angle[:-1] - 0.1) / DEGREE
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    whole_time, whole_angle = run(way, until, "1 deg")
    np.testing.assert_allclose(time, whole_time[-len(time) :], rtol=1e-6)
    np.testing.assert_allclose(angle, whole_angle[-len(angle) :], rtol=1e-6)


@EVERY_WAY
@pytest.mark.parametrize("until", ["100 deg", "1 rev", "1 cycle", "30 ms"])
def test_none_keeps_a_run_of_a_period_or_less_whole(way, until):
    """With the sample at its start."""
    time, angle = run(way, until, "none")
    whole_time, whole_angle = run(way, until, "1 deg")
    assert time[0] == 0.0
    np.testing.assert_array_equal(time, whole_time)
    np.testing.assert_array_equal(angle, whole_angle)


@EVERY_WAY
@pytest.mark.parametrize(("until", "every"), [("1 deg", "30 deg"), ("10 us", "1 ms")])
def test_a_run_shorter_than_its_spacing(way, until, every):
    time, angle = run(way, until, every)
    assert len(time) == 2
    assert angle[0] == 0.1


def test_plans():
    plan = plan_of(replace(FREE, run=Run(until="2 cycles", every="2 deg")))
    assert (plan.start, plan.every, plan.in_time, plan.last) == (0.1, 2 * DEGREE, False, inf)
    assert plan.angle_bounds == (0.1 - 8 * pi, 0.1 + 8 * pi)
    assert plan.time_bound == inf
    plan = plan_of(replace(FREE, run=Run(until="3 s", every="none")))
    assert (plan.every, plan.time_bound) == (DEGREE, 3.0)
    assert 4 * pi + 0.999 * DEGREE < plan.last < 4 * pi + DEGREE
    assert plan.angle_bounds == (-inf, inf)


@pytest.mark.parametrize(
    ("begin", "end", "grid"),
    [
        (0.125, 0.4, [0.25, 0.375]),
        (0.25, 0.375, [0.375]),
        (0.4, 0.125, [0.375, 0.25, 0.125]),
        (0.26, 0.37, []),
    ],
)
def test_grid_between(begin, end, grid):
    plan = replace(plan_of(FREE), start=0.0, every=0.125)
    assert plan.between(begin, end).tolist() == grid


@pytest.mark.parametrize(
    ("offset", "folds"), [(0.0, (-0.5 * pi, 0.5 * pi)), (0.1, (-0.5 * pi, 1.5 * pi))]
)
def test_folds(offset, folds):
    crank = replace(FREE.crank, radius=0.5)
    rod = replace(FREE.rod, length=0.5 + offset)
    piston = replace(FREE.piston, offset=offset)
    scene = replace(FREE, crank=crank, rod=rod, piston=piston)
    assert plan_of(scene).folds == pytest.approx(folds, abs=2e-6)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_angles_that_repeat_are_found_once(sense):
    """Three cycles at 1 degree from anywhere, and an end off the grid."""
    theta = sense * np.append(0.3 + DEGREE * np.arange(3 * 720 + 1), 0.3 + 12.1 * pi)
    once, which = period_of(theta, 4 * pi)[:2]
    assert len(once) == 721
    whole = (once[which] - theta) / (4 * pi)
    np.testing.assert_allclose(whole, np.round(whole), atol=1e-14)
    assert once[which[-1]] == theta[-1]


@pytest.mark.parametrize(
    "theta",
    [
        np.empty(0),
        np.array([0.2]),
        np.array([0.2, 0.2]),
        DEGREE * np.arange(100),  # not a whole period
        0.7 * np.arange(100),  # no whole number of them makes one
        np.append(DEGREE * np.arange(700), DEGREE * np.arange(698, 0, -1)),  # turns back
        pi * np.linspace(0.0, 9.0, 4000) ** 1.1,  # even in time only
    ],
)
def test_angles_that_do_not_repeat_stay(theta):
    once, which = period_of(theta, 4 * pi)[:2]
    np.testing.assert_array_equal(once[which], theta)
    assert len(once) == len(theta)


def test_a_swing_of_more_than_a_period_is_not_mistaken():
    theta = DEGREE * np.concatenate([np.arange(800), np.arange(798, 0, -1)])
    once, which = period_of(theta, 4 * pi)[:2]
    whole = (once[which] - theta) / (4 * pi)
    np.testing.assert_allclose(whole, np.round(whole), atol=1e-14)
