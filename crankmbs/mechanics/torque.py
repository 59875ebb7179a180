"""Torques from outside on the free crank: on every smooth stretch one small polynomial.

Each load is a sum of parabolas in the speed and straight lines in time, between knots of its own
(`crankmbs.scene.loads.Parts`). So on a stretch without a kink their sum is

    T(t, omega) = c0 + ct t + c1 omega + c2 omega^2

and a `Branch` is these four numbers with the bounds of the stretch. The solvers continue a branch
smoothly beyond its bounds, land on the bound, and take the next branch. A `Course` is all branches
from one jump to the next, for a solver that crosses the rows between them at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError
from crankmbs.mechanics.forces import OnCrank
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phase, Phases, acting, phase_ends, place_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle, common_period, summed
from crankmbs.numerics.function import Function
from crankmbs.numerics.once import once
from crankmbs.numerics.piecewise import total
from crankmbs.scene.torque import Acting

__all__ = [
    "Branch",
    "Course",
    "branch_at",
    "branch_of",
    "course_of",
    "over_angle",
    "pushing",
]


@dataclass(frozen=True)
class Branch:
    """T = c0 + ct t + c1 omega + c2 omega^2 [N m] up to ``t_end`` [s], from ``omega_low`` to
    ``omega_high`` [rad/s]; with ``functions`` of time, angle and speed to be added."""

    c0: float
    ct: float
    c1: float
    c2: float
    t_end: float
    omega_low: float
    omega_high: float
    functions: tuple[Function, ...] = ()

    def __call__(self, t: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s] and speeds [rad/s]; without that of the functions."""
        omega = np.asarray(omega, dtype=np.float64)
        return np.asarray(self.c0 + self.ct * np.asarray(t) + (self.c1 + self.c2 * omega) * omega)

    def plus(self, torque: float) -> Branch:
        """With a constant torque [N m] more."""
        return replace(self, c0=self.c0 + torque)

    @property
    def coefficients(self) -> tuple[float, float, float, float]:
        """c0, ct, c1 and c2."""
        return self.c0, self.ct, self.c1, self.c2

    @property
    def is_steady(self) -> bool:
        """Whether it does not change with the time, but for its functions."""
        return self.ct == 0.0

    def slope(self, omega: Array) -> Array:
        """dT/domega [N m s/rad] at speeds [rad/s]."""
        return self.c1 + 2.0 * self.c2 * omega

    @property
    def is_affine_in_energy(self) -> bool:
        """Whether the torque is c0 + c2 omega^2: then dE/dtheta is linear in E."""
        return self.ct == 0.0 and self.c1 == 0.0 and not self.functions


@dataclass(frozen=True, eq=False)
class Course:
    """T = f(t) + g(omega) [N m], continuous up to ``t_end`` [s], from ``omega_low`` to
    ``omega_high`` [rad/s], with kinks at rows of tables.

    times : shape (k,) [s], increasing; in_time : shape (k + 1, 2), of f before, between and after
        them the coefficients by ascending power
    speeds : shape (n,) [rad/s]; in_speed : shape (n + 1, 3), the same of g
    """

    times: Array
    in_time: Array
    speeds: Array
    in_speed: Array
    t_end: float
    omega_low: float
    omega_high: float

    functions: tuple[Function, ...] = ()

    is_affine_in_energy = False

    def plus(self, torque: float) -> Course:
        """With a constant torque [N m] more."""
        return replace(self, in_time=self.in_time + np.array([torque, 0.0]))

    @property
    def is_steady(self) -> bool:
        """Whether it is a function of the speed alone."""
        return not self.in_time[:, 1].any()

    def __call__(self, t: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s] and speeds [rad/s]."""
        t, omega = np.asarray(t, dtype=np.float64), np.asarray(omega, dtype=np.float64)
        f = self.in_time[np.searchsorted(self.times, t, side="right")]
        g = self.in_speed[np.searchsorted(self.speeds, omega, side="right")]
        of_speed = g[..., 0] + (g[..., 1] + g[..., 2] * omega) * omega
        return np.asarray(f[..., 0] + f[..., 1] * t + of_speed)

    def slope(self, omega: Array) -> Array:
        """dT/domega [N m s/rad] at speeds [rad/s], above a row where one is."""
        k = np.searchsorted(self.speeds, omega, side="right")
        _, linear, square = self.in_speed.T
        return np.asarray(linear[k] + 2.0 * square[k] * omega)


def branch_of(
    torques: tuple[Acting, ...], t: float, omega: float, *, rising: bool, phases: Phases = ()
) -> Branch:
    """The smooth stretch of all loads together that begins at (t, omega).

    Parameters
    ----------
    t [s] : on a knot in time the stretch after it counts
    omega [rad/s] : on a knot in the speed the stretch above counts if ``rising``
    phases : of the loads' windows

    Raises
    ------
    InputError : a time table has come to its end

    >>> branch_of((Constant(torque=2.0),), 0.0, 0.0, rising=True).c0
    2.0
    """
    c0 = ct = c1 = c2 = 0.0
    functions: list[Function] = []
    times, speeds = phase_ends(torques, phases)
    t_end = min((end for end in times if end > t), default=math.inf)
    low, high = _beside(speeds, omega, rising=rising)
    for number, load in acting(torques, phases):
        try:
            load.given.check_time(t)
        except InputError as error:
            raise InputError(f"{place_of(torques, number)}.{error}") from None
        over_time, over_speed, _, function = load.parts
        if over_time is not None:
            (value, slope, _), _, end = over_time.piece(t, after=True)
            c0, ct, t_end = c0 + value, ct + slope, min(t_end, end)
        if over_speed is not None:
            (value, slope, square), below, above = over_speed.piece(omega, after=rising)
            c0, c1, c2 = c0 + value, c1 + slope, c2 + square
            low, high = max(low, below), min(high, above)
        if function is not None:
            functions.append(function)
            t_end = min([t_end, *(kink for kink in function.times if kink > t)])
            below, above = _beside(tuple(function.speeds), omega, rising=rising)
            low, high = max(below, low), min(above, high)
    return Branch(c0, ct, c1, c2, t_end, low, high, tuple(functions))


def branch_at(
    torques: tuple[Acting, ...],
    state: tuple[float, float, float],
    rest: float,
    phases: Phases = (),
) -> Branch | None:
    """The branch that the motion enters at a state: time, crank angle and speed.

    rest [N m] : torque of gas and gravity minus J_1 omega^2 / 2; with a load's torque added its
        sign is that of the acceleration

    Returns
    -------
    Branch, or None where a jump of a speed table drives the speed back from both sides, so that
    no motion leaves this speed
    """
    t, _, omega = state
    above = branch_of(torques, t, omega, rising=True, phases=phases)
    below = above  # but on a knot in the speed, which begins the branch above
    if not above.omega_low < omega:
        below = branch_of(torques, t, omega, rising=False, phases=phases)
    push, pull = float(above(t, omega)), float(below(t, omega))
    for function in above.functions:
        push, pull = push + function.beside(*state, 1.0), pull + function.beside(*state, -1.0)
    if rest + push > 0.0:
        return above
    if rest + pull < 0.0:
        return below
    jumps = pull - push > 1e-12 * max(abs(pull), abs(push))
    return None if jumps else above


def course_of(
    torques: tuple[Acting, ...], branch: Branch, t: float, phases: Phases = ()
) -> Branch | Course:
    """What continues a branch of these loads from a time [s] on, without a jump and in its sense of
    rotation; a branch where that has no kink."""
    times, speeds = phase_ends(torques, phases)
    parts = [load.parts for _, load in acting(torques, phases)]
    by_time = [part.over_time for part in parts if part.over_time and part.over_time.knots]
    by_speed = [part.over_speed for part in parts if part.over_speed and part.over_speed.bends]
    if not by_time and not by_speed:
        return branch
    ends = [end for over_time in by_time for end in (*over_time.breaks, over_time.knots[-1])]
    ends += [kink for function in branch.functions for kink in function.times]
    t_end = _outside([*times, *ends], branch.t_end, branch.t_end)[1]
    stops = [end for over_speed in by_speed for end in over_speed.breaks]
    stops += [kink for function in branch.functions for kink in function.speeds]
    low, high = _outside([0.0, *speeds, *stops], branch.omega_low, branch.omega_high)
    rows_in_time, in_time = total([part.over_time for part in parts if part.over_time], t, t_end)
    over_speed = [part.over_speed for part in parts if part.over_speed]
    rows_in_speed, in_speed = total(over_speed, low, high)
    bent_in_time, bent = (np.diff(rows[:, 1]) != 0.0 for rows in (in_time, in_speed))
    if not bent_in_time.any() and not bent.any():
        return replace(branch, t_end=t_end, omega_low=low, omega_high=high)
    in_time, in_speed = in_time[np.append(True, bent_in_time)], in_speed[np.append(True, bent)]
    times, speeds_of_rows = rows_in_time[bent_in_time], rows_in_speed[bent]
    in_time = in_time[:, :2].copy()
    return Course(times, in_time, speeds_of_rows, in_speed, t_end, low, high, branch.functions)


def _beside(speeds: tuple[float, ...], omega: float, *, rising: bool) -> tuple[float, float]:
    """The speeds next to one; where it is one of them, on the side it rises or falls to."""
    below = (end for end in speeds if end < omega or (end == omega and rising))
    above = (end for end in speeds if end > omega or (end == omega and not rising))
    return max(below, default=-math.inf), min(above, default=math.inf)


def _outside(ends: list[float], low: float, high: float) -> tuple[float, float]:
    """The nearest of these ends outside a range."""
    below = max((end for end in ends if end <= low), default=-math.inf)
    return below, min((end for end in ends if end >= high), default=math.inf)


@once
def over_angle(train: CrankTrain, phases: Phases = ()) -> Callable[[ArrayLike], Array] | None:
    """What the loads that act give over the crank angle [N m], at angles [rad] of any shape."""
    parts = [load.parts.over_angle for _, load in acting(train.loads, phases)]
    present = [part for part in parts if part is not None]
    tables = [part for part in present if isinstance(part, Cycle)]
    if len(tables) == len(present):
        return summed(tables, common_period(part.period for part in tables))
    return lambda angle: np.asarray(sum(part(angle) for part in present))


def pushing(train: CrankTrain, phases: Phases) -> tuple[OnCrank, ...]:
    """The forces on the pistons that act.

    >>> pushing(crank_train(load_scene("coasting")), ())
    ()
    """
    first = len(train.loads) - len(train.pushes)
    return tuple(
        push
        for number, push in enumerate(train.pushes, start=first)
        if not phases or phases[number] is Phase.ACTING
    )
