"""A free run by exudyn's generalized-alpha method at one step size, from cut to cut.

A stretch ends where the crank turns back, and at a time, a crank angle or a speed at which a force
jumps: exudyn runs beyond it by one step, with forces that go on as before it, and the next stretch
begins where the cubic through the last two steps meets it, with consistent positions, velocities
and accelerations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import decided
from crankmbs.motion.multibody.forces import Bounds, Limits
from crankmbs.motion.multibody.model import Model
from crankmbs.numerics.arrays import Array

__all__ = ["Path", "Stretch", "enter", "integrate"]

_SAME = 1e-12  # relative: times nearer than this are one
_ENTRY = 40  # steps of one cylinder that the begin of a stretch counts as
_SHORT = 0.02  # of a coarsest step: a stretch less long is run in steps of its own
_LEAST = 1e-4  # of one: shorter ones are not halved, as positions round
_STILL = 1e-9  # rad/s2: of an acceleration that is rounding


class Stretch(NamedTuple):
    """A part of a run in which the crank turns one way and no force jumps.

    begin : the state in which it begins
    rows : shape (m, 4), time [s], crank angle [rad], speed [rad/s] and acceleration [rad/s2] at its
        ends and at the steps between
    """

    begin: State
    rows: Array

    def at(self, places: Array) -> Array:
        """Time, crank angle and speed at places from 0 to 1 in it, shape (3, ...), by cubics
        between steps."""
        time = self.rows[0, 0] + places * (self.rows[-1, 0] - self.rows[0, 0])
        read = np.stack([time, *np.moveaxis(_cubics(self.rows)(time), -1, 0)])
        read[:, places == 1.0] = self.rows[-1, :3, np.newaxis]  # a bound to its last digit
        return read


class Path(NamedTuple):
    """A run at one step size.

    end : the state in which it ends
    steps, iterations : what it cost
    """

    stretches: tuple[Stretch, ...]
    end: State
    ending: Ending
    steps: int
    iterations: int


def integrate(
    model: Model,
    start: State,
    limits: Limits,
    coarsest: float,
    halvings: int = 0,
    *,
    stiff: bool = False,
) -> Path:
    """Run from a state with steps of a length [s], halved so often.

    stiff : whether exudyn's Newton iteration shall know how the loads change
    """
    step = coarsest / 2.0**halvings
    state, stretches = start, list[Stretch]()
    sense, steps, iterations, idle = 0.0, 0, 0, 0
    train = model.forces.train
    entry = _ENTRY // len(train.scene.cylinders)
    steady = all(load.is_steady for load in train.loads)
    ending = Ending.COMPLETE
    while (
        ending is Ending.COMPLETE
        and state.time < limits.time * (1.0 - _SAME)
        and state.theta not in limits.angles
    ):
        entered = enter(model, state, sense, limits)
        if entered is None or idle > 1 or steps >= limits.steps:
            ending = Ending.CALLED_OFF if entered and idle <= 1 else Ending.HELD
            break
        bounds, alpha = entered
        if not stretches and state.omega == 0.0 and abs(alpha) <= _STILL and steady:
            ending = Ending.UNMOVED
            break
        lasts, most = _lasts(state, bounds), limits.steps - steps
        own = step
        if lasts < _SHORT * coarsest:  # in all runs alike, or each errs by another multiple of h^2
            own = max(lasts / 2.0**halvings, min(lasts, _LEAST * coarsest))
        rows, ending, cost = model.run((*state[:3], alpha), own, most, bounds, stiff=stiff)
        steps, iterations = steps + len(rows) + entry, iterations + cost
        if len(rows) == 0:
            break
        if ending is Ending.COMPLETE:
            rows, sense = _cut(rows, bounds)
        time, theta, omega = rows[-1, :3].tolist()
        idle = 0 if time > state.time else idle + 1
        if idle == 0:
            stretches.append(Stretch(state, rows))
        state = State(time, theta, omega, 0.0, state.mode)
        if ending is Ending.COMPLETE:
            state = state._replace(mode=decided(train, state.mode, time, theta, omega))
    return Path(tuple(stretches), state, ending, steps, iterations)


def enter(
    model: Model, state: State, arrived: float, limits: Limits
) -> tuple[Bounds, float] | None:
    """Give the model the forces beside a state on the side to which it moves.

    arrived : the sign in which the speed came to a bound

    Returns
    -------
    the bounds of the stretch and the crank's acceleration [rad/s2] at its begin; None where the
    forces drive the crank back from both sides
    """
    forces, (_, theta, omega, _, mode) = model.forces, state
    at, refused = [np.array([each]) for each in state[:3]], 0
    for sense in (arrived, -arrived) if arrived else (1.0, -1.0):
        bounds = forces.bounds(state, sense, limits)
        model.torque = forces.load(bounds, mode)
        model.pushes = forces.pushes(bounds, mode, theta, math.copysign(1.0, omega or sense))
        alpha = model.start(*at).acceleration.item(2)
        if sense * alpha > 0.0 or (omega and omega not in bounds.speeds):
            return bounds, alpha
        refused += sense * alpha < -_STILL
    return None if refused == 2 else (bounds, alpha)


def _lasts(state: State, bounds: Bounds) -> float:
    """How long a stretch lasts at the speed [s] at its begin."""
    ahead = bounds.angles[state.omega > 0.0] - state.theta
    turned = ahead / state.omega if ahead * state.omega > 0.0 else math.inf
    return min(turned, bounds.times[1] - state.time)


def _cut(rows: Array, bounds: Bounds) -> tuple[Array, float]:
    """End rows where the last step first meets a bound; also the sign in which the speed did."""
    motion, end = _cubics(rows[-2:]), rows[-1]
    met = [(bounds.times[1], 0, bounds.times[1], 0.0)] * bool(end[0] >= bounds.times[1])
    for column in (1, 2):
        for bound, sign in zip(bounds[column], (-1.0, 1.0), strict=True):
            if sign * (end[column] - bound) > 0.0:
                roots = motion.solve(bound, extrapolate=False)[column - 1]
                last = float(roots[-1]) if len(roots) else float(rows[-2, 0])
                met.append((last, column, bound, sign * (column == 2)))
    time, column, bound, sign = min(met)
    row = np.array([time, *motion(time), motion(time, 1)[1]])
    row[column] = bound
    return np.vstack([rows[rows[:, 0] < time], row]), sign


def _cubics(rows: Array) -> CubicHermiteSpline:
    """Crank angle and speed over time, between steps."""
    return CubicHermiteSpline(rows[:, 0], rows[:, 1:3], rows[:, 2:])
