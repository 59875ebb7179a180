"""A prescribed speed: at every sample exudyn's equations give the forces and the drive's torque."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.speed import SpeedLaw, speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.account import Account
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.driven import Way, driven, driven_observer
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.answer import Answers, rounding, sample, solution
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.observer import account_of
from crankmbs.motion.plan import plan_of
from crankmbs.motion.prescribed import monotone_stretches
from crankmbs.numerics.arrays import Array

__all__ = ["run"]

_POINTS = (6, 8)  # of Gauss in 5 degrees, in either look at what happens on the way


class _Course:
    """A law as a course."""

    def __init__(self, law: SpeedLaw, stretches: list[tuple[float, float]]) -> None:
        self._law, self._stretches = law, stretches

    @property
    def stretches(self) -> list[tuple[float, float]]:
        return self._stretches

    def at(self, time: Array) -> tuple[Array, Array]:
        theta, omega, _ = self._law.at_time(time)
        return theta, omega

    def times(self, theta: Array, begin: float, end: float) -> Array:
        return self._law.time_at(theta, begin, end)


def run(train: CrankTrain) -> Solution:
    """Sample the prescribed motion; nothing is integrated.

    Raises
    ------
    InputError : a speed table that ends before the run does
    """
    scene = train.scene
    assert scene.motion is not None
    plan, law, model = plan_of(scene), speed_law(scene.motion), Model(scene)
    stretches, reached = monotone_stretches(plan, law)
    course = _Course(law, stretches)
    try:
        pieces = list(driven(Way(train, law, _unasked, _POINTS[0]), stretches))
        states = [state for piece in pieces for state in (piece.begin, *piece.decisions)]
        answers = Answers(model, Forces(train), [*states, pieces[-1].end])
        bounded = reached and not plan.until_time
        bound = plan.angle_bounds[pieces[-1].end.theta > plan.start]
        time, theta = sample(plan, course, bound if bounded else None)
        values = _values(answers, law, time, theta)
        begin = _values(answers, law, np.zeros(1), np.array([plan.start]))
        edges = np.unique(np.concatenate([time, *(piece.nodes().edges for piece in pieces)]))
        work = answers.work(course, edges, law)[np.searchsorted(edges, time)]
        gained = values["kinetic_energy"] - begin["kinetic_energy"]
        values["energy_residual"] = gained - (values.pop("fallen") - begin["fallen"]) - work
        errors = _errors(answers, law, values, by_angle=not plan.in_time)
        account = _account(train, answers, law, stretches, rests=not reached)
    finally:
        model.close()
    ending = Ending.COMPLETE if reached else Ending.LAW_RESTS
    ending = Ending.FOLD if plan.folds_at(float(theta[-1])) else ending
    status, message = ending.said(float(theta[-1]))
    return solution(values, errors, (status, message), (len(time), 0), account)


def _values(answers: Answers, law: SpeedLaw, time: Array, theta: Array) -> dict[str, Array]:
    _, omega, alpha = law.at_time(time)
    return answers.at(time, theta, omega, alpha)


def _errors(
    answers: Answers, law: SpeedLaw, values: dict[str, Array], *, by_angle: bool
) -> dict[str, float]:
    """Rounding, and what the law itself may be off by."""
    off = dict.fromkeys(values, 0.0)
    if law.off is not law:
        time, theta = values["time"], values["crank_angle"]
        if by_angle:
            time = law.off.time_at(theta, 0.0, math.inf)
        else:
            theta = law.off.at_time(time)[0]
        found = _values(answers, law.off, time, theta)
        off |= {name: peak(found[name] - each) for name, each in values.items() if name in found}
    off["energy_residual"] = peak(values["energy_residual"])
    return {name: off[name] + least for name, least in rounding(values).items()}


def _account(
    train: CrankTrain,
    answers: Answers,
    law: SpeedLaw,
    stretches: list[tuple[float, float]],
    *,
    rests: bool,
) -> Account:
    def moving(time: Array, _shares: Array | None) -> Samples:
        theta, omega, alpha = law.at_time(time)
        found = answers.at(time, theta, omega, alpha)
        own = {name: found[name] for name in ("kinetic_energy", "external_torque")}
        return Samples(time, theta, omega, alpha, np.zeros_like(time), own)

    seen = [
        driven_observer(
            train, driven(Way(train, law, moving, points), stretches), finer=k > 0, rests=rests
        )
        for k, points in enumerate(_POINTS)
    ]
    return account_of(seen, 1.0)


def _unasked(_time: Array, _shares: Array | None) -> Samples:
    raise AssertionError("no samples are taken of pieces that are looked at for their modes")
