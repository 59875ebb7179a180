"""How a stretch begins: with a run-up, so that nothing of the solver's own start is left in it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crankmbs.formulations.base import Array
from crankmbs.formulations.multibody.model import Model, Record
from crankmbs.formulations.multibody.start import coordinates, quiet_start
from crankmbs.scene import Scene
from crankmbs.speed import SpeedLaw

__all__ = ["RUN_UP", "run_free", "run_prescribed"]

RUN_UP = 150  # steps: what quiet_start leaves of the ringing has died away by then
_SHOTS = 15
_CLOSE, _CLOSER = 1e-9, 1e-12  # miss of a shot: accepted at last, and at once
_OPEN = 1e-6  # m or rad: how far a body may be off the closed loop

Proceed = Callable[[float, float], bool]


def run_free(
    scene: Scene,
    model: Model,
    time: float,
    state: tuple[float, float],
    step: float,
    steps: int,
    proceed: Proceed,
    with_run_up: bool,
) -> tuple[Record, int]:
    """Run a free crank from its angle and speed at a time; return also the rows of run-up.

    Without a run-up (not wanted, or none found) the first row is what exudyn solves for there.
    """
    first = _shoot(scene, model, time, state, step) if with_run_up else None
    lead = 0 if first is None else RUN_UP
    begin = time - lead * step
    theta, omega = state if first is None else first
    row = model.consistent(coordinates(scene, theta, omega), begin)
    start = quiet_start(coordinates(scene, theta, omega, float(row.acceleration[0, 2])), step)
    record = model.run(start, begin, step, steps + lead, proceed, lead)
    if lead == 0:
        solved = row.rows()
        for name, recorded in record.rows().items():
            recorded[0] = solved[name][0]
    return record, lead


def run_prescribed(
    scene: Scene,
    model: Model,
    law: SpeedLaw,
    time: float,
    step: float,
    steps: int,
    proceed: Proceed,
) -> tuple[Record, int]:
    """Run a prescribed crank from a time on; return also the rows of run-up.

    The run-up follows the Taylor polynomial of the law at ``time``.
    """
    theta, omega, alpha = (float(q) for q in law.at_time(time))
    near = 1e-3 * step
    jerk = (float(law.at_time(time + near)[2]) - alpha) / near
    t = step * np.arange(-RUN_UP, 0)
    angles = (theta + t * (omega + t * (alpha / 2.0 + t * jerk / 6.0))).tolist()
    lead = float(t[0])
    omega, alpha = omega + lead * (alpha + lead * jerk / 2.0), alpha + lead * jerk
    start = coordinates(scene, angles[0], omega, alpha, jerk)

    def angle(row: int) -> float:
        while row >= len(angles):
            rows = np.arange(len(angles), 2 * len(angles)) - RUN_UP
            ahead: Array = law.at_time(np.minimum(time + step * rows, time + step * steps))[0]
            angles.extend(ahead.tolist())
        return float(angles[row])

    model.angle = angle
    quiet, rows = quiet_start(start, step), steps + RUN_UP
    return model.run(quiet, time + lead, step, rows, proceed, RUN_UP), RUN_UP


def _shoot(
    scene: Scene, model: Model, time: float, state: tuple[float, float], step: float
) -> tuple[float, float] | None:
    """Crank angle and speed from which the solver, in RUN_UP steps, arrives at ``state``.

    The tangent of that map is near [[1, lead], [0, 1]]; Broyden's formula mends it. None where
    it does not converge: a very stiff load, a fold.
    """
    lead = RUN_UP * step
    theta, omega = state
    alpha = float(model.consistent(coordinates(scene, theta, omega), time).acceleration[0, 2])
    x = np.array([theta - omega * lead + 0.5 * alpha * lead**2, omega - alpha * lead])
    back = np.array([[1.0, -lead], [0.0, 1.0]])
    scale = np.array([1.0, abs(omega) + abs(alpha) * lead + 1e-300])
    moved = missed = np.zeros(2)
    best, chosen = _CLOSE, None
    for shot in range(_SHOTS):
        row = model.consistent(coordinates(scene, x[0], x[1]), time - lead)
        exact = coordinates(scene, x[0], x[1], float(row.acceleration[0, 2]))
        record = model.run(quiet_start(exact, step), time - lead, step, RUN_UP)
        end = float(record.position[-1, 2])
        closed = coordinates(scene, end, 0.0).position
        if not record.complete or np.max(np.abs(record.position[-1] - closed)) > _OPEN:
            return None  # it came over a fold in another way
        miss = np.array([end, record.velocity[-1, 2]]) - state
        size = float(np.max(np.abs(miss) / scale))
        if chosen is not None and size >= best:
            break  # Newton's method leaves no less
        if size < best:
            best, chosen = size, (float(x[0]), float(x[1]))
        if size < _CLOSER or not size < 10.0:
            break
        if shot > 0:
            change = back @ (miss - missed)
            back = back + np.outer(moved - change, moved @ back) / (moved @ change)
        missed, moved = miss, -back @ miss
        x = x + moved
    return chosen
