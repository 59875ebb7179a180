"""A free run: sampled, with the error of every variable, and how it ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.motion.base import Solution, State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import begun
from crankmbs.motion.multibody.account import Kept
from crankmbs.motion.multibody.answer import Answers, rounding, sample, solution
from crankmbs.motion.multibody.cost import STEPS_A_SECOND
from crankmbs.motion.multibody.forces import EVERYWHERE
from crankmbs.motion.multibody.integrate import Limits
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["follow", "run"]

_MOST = 2**31 - 1  # steps that exudyn counts
_FEW = 200  # samples at which a run is judged before it is at all of them
_SINGLE = 32  # samples: among more there is one where nothing cancels
_SLOW = 1e-6  # of the fastest speed
_ROUNDED = "finer steps err as much by rounding, which grows in this motion"
_NO_FINER = "at a finer step exudyn's Newton iteration does not converge"

Values = dict[str, Array]


def run(train: CrankTrain, rtol: float, cost_cap: float) -> tuple[Solution, Kept]:
    """Run from the start of the scene to its end, refined until ``rtol`` is met.

    cost_cap [s] : in `STEPS_A_SECOND`

    Raises
    ------
    FormulationError : exudyn cannot take a single step of this scene
    """
    scene = train.scene
    assert scene.start is not None
    start = State(0.0, scene.start.angle, scene.start.speed, 0.0, begun(train))
    plan, model = plan_of(scene), Model(scene)
    rate = STEPS_A_SECOND / len(scene.cylinders)
    steps = math.ceil(min(cost_cap * rate, _MOST))
    limits = Limits(plan.time_bound, plan.angle_bounds, steps)
    try:
        runs = Runs(train, model, start, limits)
        values, errors, why = _refined(runs, rtol, partial(_of_plan, runs, plan))
        status, message = _ended(runs, plan, cost_cap)
        worst = _worst(values, errors)
        if runs.moves and worst > rtol:
            message += _shortfall(worst, rtol, why, runs.steps / rate, cost_cap)
    finally:
        model.close()
    cost = sum(path.iterations for path in runs.paths), runs.steps
    return solution(values, errors, (status, message), cost), _kept(runs, plan)


def follow(
    train: CrankTrain, start: State, times: Array, rtol: float, steps: int
) -> tuple[Values, dict[str, float]]:
    """Every variable at later times [s], integrated from a state; and its error.

    Raises
    ------
    FormulationError : exudyn cannot take a single step from there
    """
    model = Model(train.scene)
    try:
        runs = Runs(train, model, start, Limits(float(times[-1]), EVERYWHERE, steps))

        def answer(_most: int | None) -> tuple[Values, dict[str, float]]:
            omega = runs.motions()[0].at(times)
            return _shared(runs, times, *omega, np.zeros(len(times), dtype=bool))

        values, errors, _ = _refined(runs, rtol, answer)
    finally:
        model.close()
    return values, errors


def _refined(
    runs: Runs, rtol: float, answer: Callable[[int | None], tuple[Values, dict[str, float]]]
) -> tuple[Values, dict[str, float], str]:
    """An answer and its errors, and why it is none that was asked for.

    answer : of so many samples, or of all
    """
    finer, why = runs.first(), ""
    while True:
        values, errors = answer(_FEW)
        if finer and runs.rounded:
            why, finer = _ROUNDED, False
        enough = not finer or not runs.affords_another
        if enough or not _worst(values, errors) > rtol:
            values, errors = answer(None)
            if enough or not _worst(values, errors) > rtol:
                return values, errors, why
        finer = runs.halve()
        why = "" if finer else _NO_FINER


def _of_plan(runs: Runs, plan: Plan, most: int | None) -> tuple[Values, dict[str, float]]:
    """Every variable at the samples of a plan, or at so many of them, and its error."""
    answers = Answers(runs.model, runs.forces, runs.states)
    begin = answers.at(*(np.array([each]) for each in runs.start[:3]))
    if not runs.moves:
        del begin["fallen"]
        begin["energy_residual"] = np.zeros(1)
        return begin, rounding(begin)
    answer, _ = runs.motions()
    last, bound = runs.states[-1], _bound(runs, plan)
    time, theta = sample(plan, answer, answer.until(last.time, bound), bound)
    if most is not None and len(time) > most:
        chosen = np.unique(np.linspace(0, len(time) - 1, most).astype(int))
        time, theta = time[chosen], theta[chosen]
    omega = answer.at(time)[1]
    omega[time == 0.0] = runs.start.omega
    if runs.ending is not Ending.COMPLETE:
        omega[-1] = last.omega
    by_angle = np.full(len(time), not plan.in_time)
    by_angle[-1] = bound is not None
    values, errors = _shared(runs, time, theta, omega, by_angle)
    edges = np.union1d(answer.grid[answer.grid < time[-1]], time)
    work = answers.work(answer, edges)[np.searchsorted(edges, time)]
    gained = values["kinetic_energy"] - begin["kinetic_energy"]
    values["energy_residual"] = gained - (values.pop("fallen") - begin["fallen"]) - work
    errors["energy_residual"] = peak(values["energy_residual"])
    if runs.ending is not Ending.COMPLETE:  # each run ends elsewhere
        other = runs.paths[-2:][0].states[-1]
        for name, x, y in zip(
            ("time", "crank_angle", "crank_speed"), last[:3], other[:3], strict=True
        ):
            errors[name] = max(errors[name], 1.5 * abs(x - y))
    del errors["fallen"]
    return values, {name: errors[name] + least for name, least in rounding(values).items()}


def _bound(runs: Runs, plan: Plan) -> float | None:
    """The crank angle [rad] at which the runs end, where they end at one."""
    theta = runs.states[-1].theta
    return theta if runs.ending is Ending.COMPLETE and theta in plan.angle_bounds else None


def _kept(runs: Runs, plan: Plan) -> Kept:
    """What is kept of the runs; the states of a check are those of the run before."""
    passes = []
    if runs.moves and runs.paths:
        answer, checks = runs.motions()
        before = runs.paths[-2:][0].states
        passes = [(answer, runs.states), *((check, before) for check in checks[:-1])]
        passes += [(check, runs.states) for check in checks[-1:]]
    return Kept(runs.forces.train, runs.start, tuple(passes), _bound(runs, plan), runs.ending)


def _shared(
    runs: Runs, time: Array, theta: Array, omega: Array, by_angle: NDArray[np.bool_]
) -> tuple[Values, dict[str, float]]:
    """The variables at samples, and what they change by in the motions that check the answer.

    Where forces jump, so does what lies beside: these motions are then taken on both sides. A speed
    that the loads hold is what it is in each of them.
    """
    answers = Answers(runs.model, runs.forces, runs.states)
    values = answers.at(time, theta, omega)
    answer, checks = runs.motions()
    if not checks:
        return values, dict.fromkeys(values, math.inf)
    coarser = Answers(runs.model, runs.forces, runs.paths[-2].states)  # with decisions of its own
    errors = dict.fromkeys(values, 0.0)
    for check, side in product(checks, (1.0, -1.0) if runs.forces.jumps else (1.0,)):
        before, changes = values, dict.fromkeys(values, 0.0)
        for then, angle, speed in _shifts(answer, check, (time, theta, omega), by_angle, side):
            if runs.ending is Ending.HELD:
                speed[-1] = omega[-1]
            after = coarser.at(then, angle, speed)
            changes = {name: changes[name] + peak(after[name] - before[name]) for name in values}
            before = after
        errors = {name: max(errors[name], changes[name]) for name in values}
    errors["crank_angle"] = max(peak(check.at(time)[0] - theta) for check in checks)
    return values, errors


def _shifts(
    answer: Motion,
    check: Motion,
    at: tuple[Array, Array, Array],
    by_angle: NDArray[np.bool_],
    side: float,
) -> Iterator[tuple[Array, Array, Array]]:
    """The samples in a motion that is off, at the same angles or times; of few samples, where
    changes may cancel by chance, that of place and speed one after the other."""
    time, theta, omega = at
    ahead = side * (check.at(time)[0] - theta)
    bend = np.gradient(omega, time) if len(time) > 1 else 0.0 * omega
    room = np.sqrt(np.maximum(omega**2 - 2.0 * bend * ahead, 0.0))  # near a reversal
    whole = omega + np.copysign(room, omega)
    late = np.divide(-2.0 * ahead, whole, out=np.zeros_like(time), where=whole != 0.0)
    late = np.where(by_angle, late, 0.0)
    then = np.maximum(time + late, 0.0)
    angle = theta + np.where(by_angle, 0.0, ahead)
    speed, other = answer.at(then)[1], check.at(then)[1]
    if len(time) <= _SINGLE:
        yield then, angle, omega
    yield then, angle, speed + side * (other - speed)


def _worst(values: Values, errors: dict[str, float]) -> float:
    angle = values["crank_angle"]
    if len(angle) == 1:
        return 0.0
    known = {name: error for name, error in errors.items() if name in EVERY}
    peaks = {name: peak(values[name]) for name in known}
    return relative_error(peaks, known, peak(angle - angle[0]))


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
