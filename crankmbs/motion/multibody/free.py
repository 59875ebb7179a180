"""A free run: sampled, with the error of every variable, and how it ended."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Solution, State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import begun
from crankmbs.motion.multibody.account import account_of_runs
from crankmbs.motion.multibody.answer import Answers, residual, rounding, sample, solution
from crankmbs.motion.multibody.integrate import Limits
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.runs import Runs
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["run"]

_PER_SECOND = 20_000  # steps of one cylinder that a second of the cost cap stands for
_FEW = 200  # samples at which a run is judged before it is at all of them
_SINGLE = 32  # samples: among more there is one where nothing cancels
_SLOW = 1e-6  # of the fastest speed

Values = dict[str, Array]


def run(train: CrankTrain, rtol: float, cost_cap: float) -> Solution:
    """Run from the start of the scene to its end, refined until ``rtol`` is met.

    cost_cap [s] : each second of it stands for 20,000 steps of one cylinder

    Raises
    ------
    FormulationError : exudyn cannot take a single step of this scene
    """
    scene = train.scene
    assert scene.start is not None
    start = State(0.0, scene.start.angle, scene.start.speed, 0.0, begun(train))
    plan, model = plan_of(scene), Model(scene)
    rate = _PER_SECOND / len(scene.cylinders)
    limits = Limits(plan.time_bound, plan.angle_bounds, math.ceil(cost_cap * rate))
    try:
        runs = Runs(train, model, start, limits)
        finer, note = runs.first(), ""
        while True:
            values, errors = _answer(runs, plan, _FEW)
            if not _worst(values, errors) > rtol or not runs.affords_another or not finer:
                values, errors = _answer(runs, plan)
                if not _worst(values, errors) > rtol or not runs.affords_another or not finer:
                    break
            finer = runs.halve()
            note = "" if finer else "; at a finer step exudyn's Newton iteration does not converge"
        status, message = _ended(runs, plan, cost_cap)
        worst = _worst(values, errors)
        if runs.moves and worst > rtol:
            message += note or _shortfall(worst, rtol, runs.steps / rate, cost_cap)
        account = account_of_runs(runs)
    finally:
        model.close()
    cost = sum(path.iterations for path in runs.paths), runs.steps
    return solution(values, errors, (status, message), cost, account)


def _answer(runs: Runs, plan: Plan, most: int | None = None) -> tuple[Values, dict[str, float]]:
    """Every variable at the samples, or at so many of them, and its error."""
    answers = Answers(runs.model, runs.forces, runs.states)
    if not runs.moves:
        at_rest = (np.array([each]) for each in runs.start[:3])
        values = answers.at(*at_rest) | {"energy_residual": np.zeros(1)}
        del values["fallen"]
        return values, rounding(values)
    answer, check = runs.motions()
    bounded = runs.ending is Ending.COMPLETE and runs.states[-1].theta in plan.angle_bounds
    end = runs.states[-1].theta if bounded else None
    time, theta = sample(plan, answer, end)
    if most is not None and len(time) > most:
        chosen = np.unique(np.linspace(0, len(time) - 1, most).astype(int))
        time, theta = time[chosen], theta[chosen]
    omega = answer.at(time)[1]
    omega[time == 0.0] = runs.start.omega
    if runs.ending is not Ending.COMPLETE:
        omega[-1] = runs.states[-1].omega
    values = answers.at(time, theta, omega)
    begin = answers.at(*(np.array([each]) for each in runs.start[:3]))
    edges = np.union1d(answer.grid[answer.grid < time[-1]], time)
    work = answers.work(answer, edges)[np.searchsorted(edges, time)]
    values["energy_residual"] = residual(values, begin, work)
    by_angle = np.full(len(time), not plan.in_time)
    by_angle[-1] = bounded
    errors = dict.fromkeys(values, 0.0)
    sides = (1.0, -1.0) if runs.forces.jumps else (1.0,)
    for side in sides:
        before = values
        for shifted in _shifts(answer, check, (time, theta, omega), by_angle, side):
            after = answers.at(*shifted)
            for name in errors.keys() & after.keys():
                errors[name] += peak(after[name] - before[name]) / len(sides)
            before = after
    ahead = check.at(time)[0] - theta
    errors["crank_angle"] = peak(ahead)
    errors["energy_residual"] = peak(values["energy_residual"])
    if runs.ending is not Ending.COMPLETE:  # each run ends elsewhere
        last, other = (path.states[-1] for path in runs.paths[:-3:-1])
        for name, x, y in zip(("time", "crank_angle", "crank_speed"), last, other, strict=False):
            errors[name] = max(errors[name], 1.5 * abs(x - y))
    return values, {name: errors[name] + least for name, least in rounding(values).items()}


def _shifts(answer, check, at, by_angle, side):
    """The samples in a motion that is off, at the same angles or times; of few samples, where
    changes may cancel by chance, that of place and speed one after the other."""
    time, theta, omega = at
    ahead = side * (check.at(time)[0] - theta)
    bend = np.gradient(omega, time) if len(time) > 1 else 0.0 * omega
    room = np.sqrt(np.maximum(omega**2 - 2.0 * bend * ahead, 0.0))
    late = np.zeros_like(time)
    np.divide(-2.0 * ahead, omega + np.copysign(room, omega), out=late, where=omega + room != 0.0)
    late = np.where(by_angle, late, 0.0)
    place = np.maximum(time + late, 0.0), theta + np.where(by_angle, 0.0, ahead)
    faster = side * (check.at(place[0])[1] - answer.at(place[0])[1])
    speed = answer.at(place[0])[1] + faster
    if len(time) <= _SINGLE:
        yield *place, omega
    yield *place, speed


def _worst(values: Values, errors: dict[str, float]) -> float:
    angle = values["crank_angle"]
    if len(angle) == 1:
        return 0.0
    peaks = {name: peak(each) for name, each in values.items()}
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


def _shortfall(worst: float, rtol: float, spent: float, cap: float) -> str:
    """What to say where ``rtol`` is not met."""
    if math.isinf(worst):
        return "; its error is unknown"
    cost = float(f"{spent * math.sqrt(worst / rtol):.2g}")
    return (
        f"; relative error {worst:.1e} reached, {rtol:.0e} asked for: that would take about "
        f"{cost:g} s, above the cost cap of {cap:g} s"
    )
