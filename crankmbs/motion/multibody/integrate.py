"""A free run by exudyn's generalized-alpha method at one step size, from cut to cut.

A stretch ends at a time, a crank angle or a speed at which a force jumps: exudyn runs beyond it by
one step, with forces that go straight on, and the next stretch begins where the cubic through the
last two steps meets it, with consistent positions, velocities and accelerations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode, decided
from crankmbs.motion.multibody.forces import Bounds, Forces
from crankmbs.motion.multibody.model import Consistent, Model
from crankmbs.numerics.arrays import Array

T = TypeVar("T", float, Array)

__all__ = ["Limits", "Path", "acceleration", "integrate"]

_BESIDE = 1e-10  # of a speed: so near it is on it
_ON = 1e-11  # rad
_SAME = 1e-12  # relative: times nearer than this are one
_ENTRY = 50  # steps that the begin of a stretch counts as
_STILL = 1e-9  # rad/s2: of an acceleration that is rounding
_MOST_SPEEDS = 100  # cuts at speeds in a run; beyond, the loads are run over as they are


class Limits(NamedTuple):
    """Time [s] and crank angles [rad] at which a run ends, and steps that it may take."""

    time: float
    angles: tuple[float, float]
    steps: int


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

    def at(self, time: Array) -> tuple[Array, Array]:
        """Crank angle and speed at times, by cubics between steps; beyond the end they go on."""
        t, theta, omega, alpha = self.rows.T
        k = np.clip(np.searchsorted(t, time, side="right") - 1, 0, len(t) - 2)
        k = np.where(t[k + 1] > t[k], k, np.maximum(k - 1, 0))
        h = t[k + 1] - t[k]
        x = (time - t[k]) / h
        return (
            _cubic(x, theta[k], theta[k + 1], h * omega[k], h * omega[k + 1]),
            _cubic(x, omega[k], omega[k + 1], h * alpha[k], h * alpha[k + 1]),
        )


def integrate(
    train: CrankTrain,
    model: Model,
    start: State,
    limits: Limits,
    step: float,
    *,
    stiff: bool = False,
) -> Path:
    """Run from a state with steps of a length [s].

    stiff : whether exudyn's Newton iteration shall know how the loads change
    """
    forces = Forces(train)
    state, states, parts = start, [start], []
    sense, steps, iterations, cuts, idle = 0.0, 0, 0, 0, 0
    ending = Ending.COMPLETE
    while state.time < limits.time * (1.0 - _SAME) and state.theta not in limits.angles:
        if cuts > _MOST_SPEEDS:
            forces = forces.blind
        entered = _enter(model, forces, state, sense)
        if entered is None or idle > 1:
            ending = Ending.HELD
            break
        bounds = _within(entered[0], limits)
        left = limits.steps - steps
        if left <= 0:
            ending = Ending.CALLED_OFF
            break
        inside = _inside(bounds)
        rows, ending, cost = model.run(state[:3], step, left, inside, stiff=stiff)
        steps, iterations = steps + len(rows) + _ENTRY, iterations + cost
        if ending is not Ending.COMPLETE:
            parts.append(rows)
            states.append(_state(rows, state.mode))
            break
        rows, sense = _cut(rows, bounds)
        cuts += sense != 0.0
        met = _state(rows, state.mode)
        idle = 0 if met.time > state.time else idle + 1
        if idle == 0:
            parts.append(rows)
            states.append(met)
        state = met._replace(mode=decided(train, state.mode, *met[:3]))
        states[-1] = state
    rows = np.concatenate(parts) if parts else np.array([[*start[:3], 0.0]])
    whole = cuts <= _MOST_SPEEDS and forces.smooth
    return Path(rows, tuple(states), ending, whole, steps, iterations)


def acceleration(model: Model, forces: Forces, state: State) -> float | None:
    """Crank acceleration [rad/s2] with which a crank leaves a state; None where it is held."""
    entered = _enter(model, forces, state, 0.0)
    return None if entered is None else float(entered[1].acceleration[0, 2])


def _enter(
    model: Model, forces: Forces, state: State, arrived: float
) -> tuple[Bounds, Consistent] | None:
    """Give the model the forces beside a state on the side to which it moves.

    arrived : the sign in which the speed came to a bound

    Returns
    -------
    the bounds of the stretch and the consistent start; None where the forces drive the crank back
    from both sides
    """
    time, theta, omega, _, mode = state
    refused = 0
    for sense in (arrived, -arrived) if arrived else (1.0, -1.0):
        side = math.copysign(1.0, omega) if omega else sense
        bounds = forces.bounds(time, theta, omega, mode, (side, sense))
        model.torque = forces.load(bounds, mode)
        model.pushes = forces.pushes(bounds, mode, theta, side)
        begin = model.start(*state[:3])
        leaves = sense * float(begin.acceleration[0, 2])
        if leaves > 0.0 or (omega and omega not in bounds.speeds):
            return bounds, begin
        refused += leaves < -_STILL
    return None if refused == 2 else (bounds, begin)


def _state(rows: Array, mode: Mode) -> State:
    time, theta, omega, _ = rows[-1].tolist()
    return State(time, theta, omega, 0.0, mode)


def _within(bounds: Bounds, limits: Limits) -> Bounds:
    angles = max(bounds.angles[0], limits.angles[0]), min(bounds.angles[1], limits.angles[1])
    return Bounds((bounds.times[0], min(bounds.times[1], limits.time)), angles, bounds.speeds)


def _inside(bounds: Bounds) -> Callable[[float, float, float], bool]:
    (_, end), (low, high), (slow, fast) = bounds
    low, high = low - _ON, high + _ON
    slow, fast = slow - _BESIDE * abs(slow), fast + _BESIDE * abs(fast)

    def inside(time: float, theta: float, omega: float) -> bool:
        return time < end and low < theta < high and slow <= omega <= fast

    return inside


def _cut(rows: Array, bounds: Bounds) -> tuple[Array, float]:
    """End rows where the last step first meets a bound; also the sign in which the speed did."""
    (t, theta, omega, alpha), (t1, theta1, omega1, alpha1) = rows[-2:].tolist()
    h = t1 - t
    angle = _coefficients(theta, theta1, h * omega, h * omega1)
    speed = _coefficients(omega, omega1, h * alpha, h * alpha1)
    met = [(min((bounds.times[1] - t) / h, 1.0), 0, bounds.times[1], 0.0)]
    for column, cubic, value, ends in (
        (1, angle, theta1, bounds.angles),
        (2, speed, omega1, bounds.speeds),
    ):
        for bound, sign in zip(ends, (-1.0, 1.0), strict=True):
            if sign * (value - bound) > 0.0:
                met.append((_root(cubic, bound), column, bound, sign))
    x, column, bound, sign = min(met)
    row = [t + x * h, *(float(np.polyval(c, x)) for c in (angle, speed))]
    row.append(float(np.polyval(np.polyder(speed), x)) / h)
    row[column] = bound
    return np.vstack([rows[:-1], row]), sign if column == 2 else 0.0


def _root(cubic: Sequence[float], value: float) -> float:
    """Where in its step a cubic that ends beyond a value last comes to it."""
    roots = np.roots([*cubic[:-1], cubic[-1] - value])
    real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real <= 1.0)]
    return float(real.max(initial=0.0))


def _coefficients(y: T, y1: T, slope: T, slope1: T) -> tuple[T, T, T, T]:
    """Of the cubic in a step, from 0 to 1, by descending power."""
    rise = y1 - y
    return slope + slope1 - 2.0 * rise, 3.0 * rise - 2.0 * slope - slope1, slope, y


def _cubic(x: Array, y: Array, y1: Array, slope: Array, slope1: Array) -> Array:
    a, b, c, d = _coefficients(y, y1, slope, slope1)
    return ((a * x + b) * x + c) * x + d
