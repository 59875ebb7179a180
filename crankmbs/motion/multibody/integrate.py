"""A free run by exudyn's generalized-alpha method at one step size, from cut to cut.

A stretch ends where the crank turns back, and at a time, a crank angle or a speed at which a force
jumps: exudyn runs beyond it by one step, with forces that go straight on, and the next stretch
begins where the cubic through the last two steps meets it, with consistent positions, velocities
and accelerations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import decided
from crankmbs.motion.multibody.forces import EVERYWHERE, Bounds, Forces, Limits
from crankmbs.motion.multibody.model import Consistent, Model
from crankmbs.numerics.arrays import Array

__all__ = ["Path", "acceleration", "enter", "integrate"]

_SAME = 1e-12  # relative: times nearer than this are one
_ENTRY = 50  # steps that the begin of a stretch counts as
_STILL = 1e-9  # rad/s2: of an acceleration that is rounding
_MOST_SPEEDS = 100  # cuts at speeds in a run; beyond, the loads are run over as they are


class Path(NamedTuple):
    """A run at one step size, of m rows in n stretches.

    rows : shape (m, 4), time [s], crank angle [rad], speed [rad/s] and acceleration [rad/s2] at the
        steps and on both sides of each cut
    states : where each stretch begins, and where the last one ends
    whole : whether the run was cut at every jump of the loads over speed
    steps, iterations : what it cost
    """

    rows: Array
    states: tuple[State, ...]
    ending: Ending
    whole: bool
    steps: int
    iterations: int

    def at(self, time: Array) -> Array:
        """Crank angle and speed at times, shape (2, p), by cubics between steps; beyond the end
        they go on."""
        t = self.rows[:, 0]
        k = np.clip(np.searchsorted(t, time, side="right") - 1, 0, len(t) - 2)
        k = np.where(t[k + 1] > t[k], k, np.maximum(k - 1, 0))
        x = (time - t[k]) / (t[k + 1] - t[k])
        a, b, c, d = _cubics(self.rows[k], self.rows[k + 1])[:, 1:]
        return np.asarray(((a * x + b) * x + c) * x + d)


def integrate(
    forces: Forces, model: Model, start: State, limits: Limits, step: float, *, stiff: bool = False
) -> Path:
    """Run from a state with steps of a length [s].

    stiff : whether exudyn's Newton iteration shall know how the loads change
    """
    state, states, parts = start, [start], list[Array]()
    sense, steps, iterations, cuts, idle = 0.0, 0, 0, 0, 0
    ending = Ending.COMPLETE
    while state.time < limits.time * (1.0 - _SAME) and state.theta not in limits.angles:
        entered = enter(model, forces, state, sense, limits, stops=cuts <= _MOST_SPEEDS)
        if entered is None or idle > 1 or steps >= limits.steps:
            ending = Ending.CALLED_OFF if entered and idle <= 1 else Ending.HELD
            break
        rows, ending, cost = model.run(
            state[:3], step, limits.steps - steps, entered[0], stiff=stiff
        )
        steps, iterations = steps + len(rows) + _ENTRY, iterations + cost
        if ending is Ending.COMPLETE:
            rows, sense = _cut(rows, entered[0])
            cuts += bool(sense and rows[-1, 2])
        time, theta, omega = rows[-1, :3].tolist()
        met = State(time, theta, omega, 0.0, state.mode)
        idle = 0 if met.time > state.time else idle + 1
        if ending is Ending.COMPLETE:
            met = met._replace(mode=decided(forces.train, state.mode, time, theta, omega))
        if idle == 0 or ending is not Ending.COMPLETE:
            parts.append(rows)
            states.append(met)
        state = states[-1] = met
        if ending is not Ending.COMPLETE:
            break
    every = np.concatenate(parts) if parts else np.array([[*start[:3], 0.0]])
    whole = cuts <= _MOST_SPEEDS and forces.smooth
    return Path(every, tuple(states), ending, whole, steps, iterations)


def acceleration(model: Model, forces: Forces, state: State) -> float | None:
    """Crank acceleration [rad/s2] with which a crank leaves a state; None where it is held."""
    entered = enter(model, forces, state, 0.0, Limits(math.inf, EVERYWHERE, 0))
    return None if entered is None else float(entered[1].acceleration[0, 2])


def enter(
    model: Model,
    forces: Forces,
    state: State,
    arrived: float,
    limits: Limits,
    *,
    stops: bool = True,
) -> tuple[Bounds, Consistent] | None:
    """Give the model the forces beside a state on the side to which it moves.

    arrived : the sign in which the speed came to a bound

    Returns
    -------
    the bounds of the stretch and the consistent start; None where the forces drive the crank back
    from both sides
    """
    _, theta, omega, _, mode = state
    refused = 0
    for sense in (arrived, -arrived) if arrived else (1.0, -1.0):
        bounds = forces.bounds(state, sense, limits, stops=stops)
        model.torque = forces.load(bounds, mode)
        model.pushes = forces.pushes(bounds, mode, theta, math.copysign(1.0, omega or sense))
        begin = model.start(*state[:3])
        leaves = sense * float(begin.acceleration[0, 2])
        if leaves > 0.0 or (omega and omega not in bounds.speeds):
            return bounds, begin
        refused += leaves < -_STILL
    return None if refused == 2 else (bounds, begin)


def _cut(rows: Array, bounds: Bounds) -> tuple[Array, float]:
    """End rows where the last step first meets a bound; also the sign in which the speed did."""
    begin, end = rows[-2:]
    cubics = _cubics(begin, end)
    x, column, bound, sign = min(
        (_root(cubics[:, column], bound), column, bound, sign)
        for column, ends in enumerate(bounds)
        for bound, sign in zip(ends, (-1.0, 1.0), strict=True)
        if (beyond := sign * (end[column] - bound)) > 0.0 or beyond == column == 0
    )
    rate = np.polyval(np.polyder(cubics[:, 2]), x) / (end[0] - begin[0])
    row = np.append(np.polyval(cubics, x), rate)
    row[column] = bound
    return np.vstack([rows[:-1], row]), sign if column == 2 else 0.0


def _root(cubic: Array, value: float) -> float:
    """Where in its step a cubic that ends beyond a value last comes to it."""
    roots = np.roots([*cubic[:-1], cubic[-1] - value])
    real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real < 1.0 + 1e-9)]
    return min(float(real.max(initial=0.0)), 1.0)


def _cubics(begin: Array, end: Array) -> Array:
    """Those of time, angle and speed in steps between rows, from 0 to 1, by descending power; shape
    (4, 3, ...)."""
    y, y_1, h = begin.T[:3], end.T[:3], end.T[0] - begin.T[0]
    slope, slope_1 = (h * np.array([np.ones_like(h), *row.T[2:]]) for row in (begin, end))
    rise = y_1 - y
    return np.array([slope + slope_1 - 2.0 * rise, 3.0 * rise - 2.0 * slope - slope_1, slope, y])
