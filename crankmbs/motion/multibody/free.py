"""A free run: sampled, with the error of every variable, and how it ended."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.motion.base import Solution, State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import begun
from crankmbs.motion.multibody.account import Kept, stretches_of
from crankmbs.motion.multibody.answer import Answers, solution
from crankmbs.motion.multibody.cost import STEPS_A_SECOND
from crankmbs.motion.multibody.forces import EVERYWHERE, Limits
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["follow", "run"]

_MOST = 2**31 - 1  # steps that exudyn counts
_FEW = 200  # samples at which a run is judged before it is at all of them
_SLOW = 1e-6  # of the fastest speed
_ROUNDED = "finer steps err as much by rounding, which grows in this motion"
_NO_FINER = "at a finer step exudyn's Newton iteration does not converge"

Values = dict[str, Array]
Errors = dict[str, float]


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
    with closing(Answers(train)) as answers:
        limits = Limits(plan.time_bound, plan.angle_bounds, steps)
        runs = Runs(answers.forces, answers.model, start, limits)
        values, errors, why = _refined(runs, rtol, lambda most: _at_plan(runs, answers, plan, most))
    status, message = _ended(runs, plan, cost_cap)
    if runs.moves and not (worst := _worst(values, errors)) <= rtol:
        message += _shortfall(worst, rtol, why, runs.steps / rate, cost_cap)
    cost = sum(path.iterations for path in runs.paths), runs.steps
    passes = tuple(runs.motions()) if runs.moves else ()
    kept = Kept(train, start, passes, _bound(runs, plan), runs.ending)
    return solution(values, errors, (status, message), cost), kept


def follow(
    train: CrankTrain, start: State, times: Array, rtol: float, steps: int
) -> tuple[Values, Errors]:
    """Every variable at later times [s], integrated from a state; and its error.

    Raises
    ------
    FormulationError : exudyn cannot take a single step from there
    """
    with closing(Answers(train)) as answers:
        limits = Limits(float(times[-1]), EVERYWHERE, steps)
        runs = Runs(answers.forces, answers.model, start, limits)
        by_angle = np.zeros(len(times), dtype=bool)

        def read(_most: int | None) -> tuple[Values, Errors]:
            return _checked(runs, answers, (times, *runs.motions()[0].at(times)), by_angle)

        values, errors, _ = _refined(runs, rtol, read)
    return values, errors


def _refined(
    runs: Runs, rtol: float, read: Callable[[int | None], tuple[Values, Errors]]
) -> tuple[Values, Errors, str]:
    """The values and errors of runs fine enough, and why they are not what was asked for.

    read : at so many samples, or at all
    """
    finer, why = runs.first(), ""
    for most in (_FEW, None):
        values, errors = read(most)
        while finer and runs.affords_another and not _worst(values, errors) <= rtol:
            if runs.rounded:
                finer, why = False, _ROUNDED
            elif runs.halve():
                values, errors = read(most)
            else:
                finer, why = False, _NO_FINER
    return values, errors, why


def _at_plan(runs: Runs, answers: Answers, plan: Plan, most: int | None) -> tuple[Values, Errors]:
    """Every variable at the samples of a plan, or at so many of them, and its error."""
    if not runs.moves:
        start = Motion((), (), (runs.start, runs.start))
        values = answers.free(start, *(np.array([each]) for each in runs.start[:3]))
        return values | {"energy_residual": np.zeros(1)}, dict.fromkeys(EVERY, 0.0)
    answer, bound = runs.motions()[0], _bound(runs, plan)
    ends = [*(state.time for state in answer.states[:-1]), answer.until(bound)]
    time, theta = plan.samples(pairwise(ends), lambda t: answer.at(t)[0], answer.times, bound)
    if most is not None and len(time) > most:
        chosen = np.unique(np.linspace(0, len(time) - 1, most).astype(int))
        time, theta = time[chosen], theta[chosen]
    omega = answer.at(time)[1]
    omega[time == 0.0] = runs.start.omega
    if runs.ending is not Ending.COMPLETE:
        omega[-1] = answer.states[-1].omega
    by_angle = np.full(len(time), not plan.in_time)
    by_angle[-1] = bound is not None
    values, errors = _checked(runs, answers, (time, theta, omega), by_angle)
    cells = [each.cells for each in stretches_of(runs.forces, answer, bound)]
    values["energy_residual"] = answers.residual(cells, time)
    errors["energy_residual"] = peak(values["energy_residual"])
    return values, errors


def _bound(runs: Runs, plan: Plan) -> float | None:
    """The crank angle [rad] at which the runs end, where they end at one."""
    theta = runs.states[-1].theta
    return theta if runs.ending is Ending.COMPLETE and theta in plan.angle_bounds else None


def _checked(
    runs: Runs, answers: Answers, at: tuple[Array, Array, Array], by_angle: NDArray[np.bool_]
) -> tuple[Values, Errors]:
    """The variables at samples, and what they change by in the motions that check the answer.

    Where forces jump, so does what lies beside: these motions are then taken on both sides. A run
    that does not come to its end ends elsewhere in each of them.
    """
    answer, *checks = runs.motions()
    values = answers.free(answer, *at)
    if not checks:
        return values, dict.fromkeys(values, math.inf)
    if runs.forces.is_cut:
        weights = (2.0 * np.array(answer.weights) - each.weights for each in checks)
        pairs = zip(checks[:], weights, strict=True)
        checks += [replace(each, weights=tuple(other.tolist())) for each, other in pairs]
    errors = dict.fromkeys(values, 0.0)
    for check in checks:
        then, angle, speed = _shifted(check, *at, by_angle)
        if runs.ending is not Ending.COMPLETE:
            then[-1], angle[-1], speed[-1] = check.states[-1][:3]
        after = answers.free(check, then, angle, speed)
        errors = {n: max(most, peak(after[n] - values[n])) for n, most in errors.items()}
    late = max(peak(check.at(at[0])[0] - at[1]) for check in checks)
    errors["crank_angle"] = max(errors["crank_angle"], late)
    return values, errors


def _shifted(
    check: Motion, time: Array, theta: Array, omega: Array, by_angle: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """The samples in a motion that is off, at the same angles or times."""
    ahead = check.at(time)[0] - theta
    bend = np.gradient(omega, time) if len(time) > 1 else 0.0 * omega
    room = np.sqrt(np.maximum(omega**2 - 2.0 * bend * ahead, 0.0))  # near a reversal
    whole = omega + np.copysign(room, omega)
    late = np.divide(-2.0 * ahead, whole, out=np.zeros_like(time), where=whole != 0.0)
    then = np.maximum(time + np.where(by_angle, late, 0.0), 0.0)
    return then, theta + np.where(by_angle, 0.0, ahead), check.at(then)[1]


def _worst(values: Values, errors: Errors) -> float:
    peaks = {name: peak(values[name]) for name in errors}
    angle = values["crank_angle"]
    return relative_error(peaks, errors, peak(angle - angle[0]))


def _ended(runs: Runs, plan: Plan, cap: float) -> tuple[int, str]:
    """Status and sentence."""
    time, theta, omega = runs.states[-1][:3]
    ending = runs.ending
    if ending is Ending.HELD and runs.forces.train.scene.friction and omega == 0.0:
        ending = Ending.STICKS
    elif ending is Ending.COMPLETE and plan.folds_at(theta):
        ending = Ending.FOLD
    elif ending is Ending.CALLED_OFF:
        rows = runs.paths[-1].rows
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
