"""How a stretch begins: with a run-up, so that nothing of the solver's own start is left in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.speed import SpeedLaw
from crankmbs.motion.multibody.model import Model, Record
from crankmbs.motion.multibody.start import (
    DIES_AWAY,
    SPECTRAL_RADIUS,
    Start,
    angle_of,
    coordinates,
    quiet_start,
)
from crankmbs.motion.multibody.taylor import taylor
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["RUN_UP", "Steps", "run_free", "run_prescribed"]

RUN_UP = 6  # steps: an acceleration that was not quite right has died away by then
_SEEN = 20  # steps, of which a look at the crank's acceleration is made
_DEGREE = 8  # of the polynomial through it
_LOOKS = 2  # the first with no acceleration, the second with the one seen
_SHOTS = 12  # at most; it ends before where a shot misses no less
_CLOSE, _CLOSER = 1e-9, 1e-12  # miss of a shot: accepted at last, and at once
_FAR = 0.1  # miss of a shot with an acceleration that the steps do not resolve
_OPEN = 1e-6  # m or rad: how far a body may be off the closed loop


class Steps(NamedTuple):
    """Steps to be taken: from when, of what length [s], how many, and by crank angle and speed
    whether to go on, asked after each."""

    begin: float
    length: float
    number: int
    proceed: Callable[[float, float], bool] | None


def run_free(
    scene: Scene,
    model: Model,
    state: tuple[float, float],
    steps: Steps,
) -> tuple[Record, int]:
    """Run a free crank from its angle and speed; return also the rows of run-up.

    Where no run-up is found the first row is what exudyn solves for there.
    """
    time, step, count, proceed = steps
    start = _shoot(scene, model, time, state, step)
    if start is not None:
        begin = time - RUN_UP * step
        return model.run(start, begin, step, count + RUN_UP, proceed, RUN_UP), RUN_UP
    row = model.consistent(coordinates(scene, *state), time)
    alpha = float(row.acceleration[0, 2])
    at_once = quiet_start(scene, angle_of(state, [alpha], step), step)
    record = model.run(at_once, time, step, count, proceed)
    solved = row.rows()
    for name, recorded in record.rows().items():
        recorded[0] = solved[name][0]
    return record, 0


def run_prescribed(
    scene: Scene,
    model: Model,
    law: SpeedLaw,
    steps: Steps,
) -> tuple[Record, int]:
    """Run a prescribed crank; return also the rows of run-up.

    The run-up follows a polynomial through the law after its end, up to the eighth derivative.
    """
    time, step, count, proceed = steps
    places = min(_DEGREE, count) * (0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, 2 * _DEGREE)))
    theta, omega, alpha = law.at_time(time + step * places)
    bend = np.polynomial.Polynomial.fit(places, step**2 * alpha, _DEGREE - 2)
    polynomial = bend.integ(2, [float(omega[0]) * step, float(theta[0])], lbnd=0.0)
    angles = polynomial(np.arange(-RUN_UP, 0)).tolist()
    first = [float(polynomial.deriv(k)(-RUN_UP)) / math.factorial(k) for k in range(_DEGREE + 1)]

    def angle(row: int) -> float:
        while row >= len(angles):
            rows = np.arange(len(angles), 2 * len(angles)) - RUN_UP
            ahead: Array = law.at_time(np.minimum(time + step * rows, time + step * count))[0]
            angles.extend(ahead.tolist())
        return float(angles[row])

    model.angle = angle
    quiet, rows = quiet_start(scene, first, step), count + RUN_UP
    return model.run(quiet, time - RUN_UP * step, step, rows, proceed, RUN_UP), RUN_UP


def _shoot(
    scene: Scene, model: Model, time: float, state: tuple[float, float], step: float
) -> Start | None:
    """The start from which the solver, in RUN_UP steps, arrives at crank angle and speed.

    Looks at the acceleration over some steps make the start quiet. Then the tangent of that map
    is near [[1, lead], [0, 1]]; Broyden's formula mends it. None where it does not converge: a very
    stiff load, a fold.
    """
    lead = RUN_UP * step
    begin, target = time - lead, np.array(state)
    alpha = [0.0]
    for _ in range(_LOOKS):
        x = _before(state, alpha, step)
        start = quiet_start(scene, angle_of(x, alpha, step), step)
        seen = _rows(scene, model, start, begin, step)
        if seen is None:
            return None
        alpha = (_FIT @ seen[1:, 2]).tolist()
    x = _before(state, alpha, step)
    back = np.array([[1.0, -lead], [0.0, 1.0]])
    scale = np.array([1.0, abs(state[1]) + abs(alpha[0]) * lead + 1e-300])
    moved = missed = np.zeros(2)
    best, chosen = _CLOSE, None
    for shot in range(_SHOTS):
        start = quiet_start(scene, angle_of(x, alpha, step), step)
        seen = _rows(scene, model, start, begin, step, RUN_UP)
        if seen is None:
            return None
        miss = seen[-1, :2] - target
        size = float(np.max(np.abs(miss) / scale))
        if chosen is not None and size >= best:
            break  # Newton's method leaves no less
        if size < best:
            best, chosen = size, start
        if size < _CLOSER or not size < _FAR:
            break
        if shot > 0:
            change = back @ (miss - missed)
            back = back + np.outer(moved - change, moved @ back) / (moved @ change)
        missed, moved = miss, -back @ miss
        x = x + moved
    return chosen


def _before(state: tuple[float, float], alpha: Sequence[float], step: float) -> Array:
    """Crank angle and speed RUN_UP steps before those of a state.

    alpha [rad/s2] : coefficients of the acceleration over the number of the step, from there
    """
    once = np.arange(1.0, len(alpha) + 1.0)
    speeds = np.asarray(alpha) * step * RUN_UP**once / once
    turned = float(np.sum(speeds / (once + 1.0))) * step * RUN_UP
    omega = state[1] - float(np.sum(speeds))
    return np.array([state[0] - turned - omega * RUN_UP * step, omega])


def _rows(
    scene: Scene, model: Model, start: Start, begin: float, step: float, steps: int = _SEEN
) -> Array | None:
    """Crank angle, speed and acceleration at the steps; None where it fails or folds over."""
    seen, position = model.crank(start, begin, step, steps)
    if len(seen) <= steps:
        return None
    closed = taylor(scene, [float(seen[-1, 0])])[0]
    return seen if np.max(np.abs(position - closed)) < _OPEN else None


def _fit() -> Array:
    """Least squares: from the rows of a look but the first to the smooth polynomial.

    The rest rings with the spectral radius, in each constraint up to the square of the number of
    the step times that, or dies away with the algorithmic acceleration.
    """
    rows = np.arange(1.0, _SEEN + 1.0)
    part = rows / _SEEN
    smooth = [part**k for k in range(_DEGREE + 1)]
    ringing = [(-SPECTRAL_RADIUS) ** rows * part**k for k in range(3)]
    columns = np.stack([*smooth, *ringing, DIES_AWAY**rows], axis=1)
    scale = float(_SEEN) ** np.arange(_DEGREE + 1)
    return np.asarray(np.linalg.pinv(columns)[: _DEGREE + 1] / scale[:, None])


_FIT = _fit()
