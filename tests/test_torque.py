"""Branches of the loads against the loads themselves."""

import math

import numpy as np
import pytest

from crankmbs import Constant, InputError, Quadratic, SpeedTable, Table, TimeTable, Viscous
from crankmbs.mechanics.torque import branch_at, branch_of

RAMP = Table((0.0, 1.0, 1.0, 4.0), (0.0, 2.0, 5.0, -1.0))
CURVE = Table((-20.0, -5.0, 10.0, 10.0, 30.0), (4.0, 7.0, 1.0, -6.0, -2.0))
ALL = (
    Constant(torque=3.0),
    Viscous(coefficient=0.5),
    Quadratic(coefficient=0.25),
    TimeTable(file=RAMP),
    SpeedTable(file=CURVE),
)


def torque(t, omega):
    """The sum of all loads, written out."""
    value = 3.0 - 0.5 * omega - 0.25 * omega * abs(omega)
    value += 2.0 * t if t < 1.0 else 5.0 - 2.0 * (t - 1.0)
    if omega < 10.0:
        return value + np.interp(omega, (-20.0, -5.0, 10.0), (4.0, 7.0, 1.0))
    return value + np.interp(omega, (10.0, 30.0), (-6.0, -2.0))


def test_all_loads_at_any_state():
    times, speeds = np.array([0.0, 0.5, 1.7, 2.0]), np.array([-50.0, -8.0, 3.0, 12.0])
    exact = [torque(*at) for at in zip(times, speeds, strict=True)]
    np.testing.assert_allclose(sum(load(times, times, speeds) for load in ALL), exact, rtol=1e-14)


@pytest.mark.parametrize("t", [0.0, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("omega", [-50.0, -20.0, -8.0, -2.0, 3.0, 12.0, 30.0, 99.0])
def test_a_branch_is_the_sum_of_the_loads(t, omega):
    branch = branch_of(ALL, t, omega, rising=True)
    assert branch(t, omega) == pytest.approx(torque(t, omega), rel=1e-14, abs=1e-14)
    low, high = max(branch.omega_low, omega - 1.0), min(branch.omega_high, omega + 1.0)
    for speed in (0.5 * (low + omega), 0.5 * (high + omega)):
        later = 0.5 * (t + branch.t_end)
        assert branch(later, speed) == pytest.approx(torque(later, speed), rel=1e-13)


@pytest.mark.parametrize("loads", [ALL + ALL, ALL[::-1] + ALL, ALL + ALL[::-1]])
def test_loads_add_up_in_any_order(loads):
    once, twice = (branch_of(some, 0.5, 3.0, rising=True) for some in (ALL, loads))
    assert twice.coefficients == pytest.approx([2.0 * c for c in once.coefficients], rel=1e-14)


def test_bounds():
    branch = branch_of(ALL, 0.5, 3.0, rising=True)
    assert (branch.t_end, branch.omega_low, branch.omega_high) == (1.0, 0.0, 10.0)
    branch = branch_of(ALL, 1.0, 10.0, rising=True)
    assert (branch.t_end, branch.omega_low, branch.omega_high) == (4.0, 10.0, 30.0)
    branch = branch_of(ALL, 1.0, 10.0, rising=False)
    assert (branch.omega_low, branch.omega_high) == (0.0, 10.0)
    branch = branch_of(ALL, 1.0, 0.0, rising=False)
    assert (branch.omega_low, branch.omega_high, branch.c2) == (-5.0, 0.0, 0.25)
    branch = branch_of((), 0.0, 1.0, rising=True)
    assert (branch.t_end, branch.omega_low, branch.omega_high) == (math.inf, -math.inf, math.inf)


@pytest.mark.parametrize(
    ("loads", "affine"),
    [
        ((Constant(torque=1.0), Quadratic(coefficient=1.0)), True),
        ((Viscous(coefficient=1.0),), False),
        ((TimeTable(file=RAMP),), False),
    ],
)
def test_which_loads_are_affine_in_the_energy(loads, affine):
    assert branch_of(loads, 0.5, 1.0, rising=True).is_affine_in_energy is affine


@pytest.mark.parametrize(
    ("rest", "low", "high"), [(7.0, 10.0, 30.0), (-5.0, -5.0, 10.0), (0.0, None, None)]
)
def test_a_jump_is_left_upwards_downwards_or_never(rest, low, high):
    branch = branch_at(ALL[4:], (0.0, 0.0, 10.0), rest)
    assert (branch and branch.omega_low, branch and branch.omega_high) == (low, high)


def test_a_kink_holds_nothing():
    assert branch_at(ALL[4:], (0.0, 0.0, -5.0), -7.0) is not None


def test_a_table_that_ends_before_the_run():
    with pytest.raises(
        InputError, match=r"torque\[4\]\.file: table: the time table ends at 4 s, before"
    ):
        branch_of(ALL, 4.0, 1.0, rising=True)
