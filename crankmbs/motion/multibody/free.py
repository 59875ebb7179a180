"""A free run: sampled, with the error of every variable, and how it ended."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import closing
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.motion.base import Solution, State
from crankmbs.motion.cells import cell_of
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import begun
from crankmbs.motion.multibody.answer import free, solution
from crankmbs.motion.multibody.cost import STEPS_A_SECOND
from crankmbs.motion.multibody.forces import Limits
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["Kept", "refined", "run"]

_MOST = 2**31 - 1  # steps that exudyn counts
_FEW = 200  # samples at which a run is judged before it is at all of them
_SLOW = 1e-6  # of the fastest speed
_ROUNDED = "finer steps err as much by rounding, which grows in this motion"
_NO_FINER = "at a finer step exudyn's Newton iteration does not converge"

_NO_ERRORS = dict.fromkeys(EVERY, 0.0)

Values = dict[str, Array]
Errors = dict[str, float]
Places = Callable[[Motion], tuple[Array, Array]]


class Kept(NamedTuple):
    """What is kept of the runs of a scene.

    motions : the answer first, and its checks; none where the crank stays at rest
    """

    train: CrankTrain
    start: State
    motions: tuple[Motion, ...]
    ending: Ending


def run(train: CrankTrain, rtol: float, cost_cap: float) -> tuple[Solution, Kept]:
    """Run from the start of the scene to its end, refined until ``rtol`` is met.

    cost_cap [s] : in `STEPS_A_SECOND`

    Raises
    ------
    FormulationError : exudyn cannot take a single step of this scene
    """
    scene, plan = train.scene, plan_of(train.scene)
    assert scene.start is not None
    start = State(0.0, scene.start.angle, scene.start.speed, 0.0, begun(train))
    rate = STEPS_A_SECOND / len(scene.cylinders)
    steps = math.ceil(min(cost_cap * rate, _MOST))
    limits = Limits(plan.time_bound, plan.angle_bounds, steps)

    def places(answer: Motion) -> tuple[Array, Array]:
        ends = [answer.pieces[0].begin, *(piece.end for piece in answer.pieces)]
        times, angles, _ = np.array([state[:3] for state in ends]).T

        def angle(time: Array) -> Array:
            known = times.searchsorted(time)
            return np.asarray(answer.at_times(time)[1] if plan.in_time else angles[known])

        def passed(theta: Array, begin: float, _: float) -> Array:
            k = np.full(len(theta), times.searchsorted(begin))
            return np.asarray(answer.at(k, theta, in_time=False)[0])

        return plan.samples(pairwise(times.tolist()), angle, passed, ends[-1].theta)

    with closing(Model(train)) as model:
        runs = Runs(model, start, limits)
        values, errors, why = refined(runs, rtol, places, by_angle=not plan.in_time)
    status, message = _ended(runs, plan, cost_cap)
    if runs.moves and not (worst := _worst(values, errors)) <= rtol:
        message += _shortfall(worst, rtol, why, runs.steps / rate, cost_cap)
    cost = sum(path.iterations for path in runs.paths), runs.steps
    kept = Kept(train, start, runs.motions, runs.ending)
    return solution(values, errors, (status, message), cost), kept


def refined(
    runs: Runs, rtol: float, places: Places, *, by_angle: bool
) -> tuple[Values, Errors, str]:
    """The values and errors of runs fine enough, and why they are not what was asked for.

    places : of a motion, times [s] and crank angles [rad], the last at its end; by_angle : whether
        the angles are given, and else the times
    """
    finer, why = runs.first(), ""
    if not runs.moves:
        rows = np.array(runs.start[:3])[:, np.newaxis]
        only = np.zeros(1, dtype=np.intp)
        return free(runs.model, [runs.start.mode], only, only, rows), _NO_ERRORS, ""
    for few in (True, False):
        values, errors = _checked(runs, places, few=few, by_angle=by_angle)
        while finer and runs.affords_another and not _worst(values, errors) <= rtol:
            if runs.rounded:
                finer, why = False, _ROUNDED
            elif runs.halve():
                values, errors = _checked(runs, places, few=few, by_angle=by_angle)
            else:
                finer, why = False, _NO_FINER
    return values, errors, why


def _checked(runs: Runs, places: Places, *, few: bool, by_angle: bool) -> tuple[Values, Errors]:
    """The variables at samples, the last at the end, and what they change by in the motions that
    check the answer, at the same angles or times, and from end to end."""
    answer, *checks = runs.motions
    rows = np.array(places(answer))
    every = 1 + len(rows[0]) // _FEW if few else 1
    time, theta = rows[:, ::-1][:, ::every][:, ::-1]
    k = cell_of(answer.ends, time)
    omega = answer.at(k, time, in_time=True)[2]
    omega[time == runs.start.time] = runs.start.omega
    omega[-1] = answer.pieces[-1].end.omega
    motion = np.array([time, theta, omega])
    values = free(runs.model, answer.modes, k, answer.after(time), motion)
    errors = dict.fromkeys(values, 0.0 if checks else math.inf)
    for check in checks:
        then = cell_of(check.ends, time)
        at = check.at(then, time, in_time=True)
        late = peak(at[1, :-1] - theta[:-1])
        if by_angle and len(check.pieces) == len(answer.pieces):
            then, at = k, check.at(k, theta, in_time=False)
        at[:, -1] = check.pieces[-1].end[:3]
        after = free(runs.model, check.modes, then, check.after(at[0]), at)
        errors = {n: max(most, peak(after[n] - values[n])) for n, most in errors.items()}
        errors["crank_angle"] = max(errors["crank_angle"], late)
    return values, errors


def _worst(values: Values, errors: Errors) -> float:
    peaks = {name: peak(values[name]) for name in errors}
    angle = values["crank_angle"]
    return relative_error(peaks, errors, peak(angle - angle[0]))


def _ended(runs: Runs, plan: Plan, cap: float) -> tuple[int, str]:
    """Status and sentence."""
    time, theta, omega = runs.paths[-1].end[:3]
    ending = runs.ending
    if ending is Ending.HELD and runs.model.forces.train.scene.friction and omega == 0.0:
        ending = Ending.STICKS
    elif ending is Ending.COMPLETE and plan.folds_at(theta):
        ending = Ending.FOLD
    elif ending is Ending.CALLED_OFF:
        rows = np.concatenate([stretch.rows for stretch in runs.paths[-1].stretches])
        late = rows[rows[:, 0] > 0.9 * time, 2]
        if peak(late) < _SLOW * peak(rows[:, 2]):
            ending = Ending.SLOWED
    share = (time if plan.until_time else abs(theta - plan.start)) / plan.until
    whole = float(f"{cap / share:.2g}") if share else math.inf
    return ending.said(theta, omega, time=time, whole=whole, cap=cap)


def _shortfall(worst: float, rtol: float, why: str, spent: float, cost_cap: float) -> str:
    """What to say where ``rtol`` is not met."""
    if math.isinf(worst):
        return "; its error is unknown"
    halvings = math.ceil(math.log(worst / rtol, 4.0))
    cost = float(f"{spent * 2.0**halvings:.2g}")
    why = why or f"that would take about {cost:g} s, above the cost cap of {cost_cap:g} s"
    return f"; relative error {worst:.1e} reached, {rtol:.0e} asked for: {why}"
