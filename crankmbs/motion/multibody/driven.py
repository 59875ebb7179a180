"""A prescribed speed: at every sample exudyn's equations give the forces and the drive's torque."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.speed import SpeedLaw, speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Solution
from crankmbs.motion.driven import Way, driven
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.answer import Answers, rounding, sample, solution
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.plan import plan_of
from crankmbs.motion.prescribed import monotone_stretches
from crankmbs.numerics.arrays import Array

__all__ = ["run"]

_POINTS = 6  # of Gauss in 5 degrees, in which decisions on the fuel are looked for


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
        pieces = list(driven(Way(train, law, _POINTS), stretches))
        states = [state for piece in pieces for state in (piece.begin, *piece.decisions)]
        answers = Answers(model, Forces(train), [*states, pieces[-1].end])
        bounded = reached and not plan.until_time
        bound = plan.angle_bounds[pieces[-1].end.theta > plan.start]
        time, theta = sample(plan, course, stretches[-1][1], bound if bounded else None)
        values = _values(answers, law, time, theta)
        begin = _values(answers, law, np.zeros(1), np.array([plan.start]))
        edges = np.unique(
            np.concatenate([time, *(piece.cells.time[:, [0, -1]].ravel() for piece in pieces)])
        )
        work = answers.work(course, edges, law)[np.searchsorted(edges, time)]
        gained = values["kinetic_energy"] - begin["kinetic_energy"]
        values["energy_residual"] = gained - (values.pop("fallen") - begin["fallen"]) - work
        errors = _errors(answers, law, values, by_angle=not plan.in_time)
    finally:
        model.close()
    ending = Ending.COMPLETE if reached else Ending.LAW_RESTS
    ending = Ending.FOLD if plan.folds_at(float(theta[-1])) else ending
    return solution(values, errors, ending.said(float(theta[-1])), (len(time), 0))


def _values(answers: Answers, law: SpeedLaw, time: Array, theta: Array) -> dict[str, Array]:
    _, omega, alpha = law.at_time(time)
    return answers.at(time, theta, omega, alpha)


def _errors(
    answers: Answers, law: SpeedLaw, values: dict[str, Array], *, by_angle: bool
) -> dict[str, float]:
    """Rounding, and what the law itself may be off by."""
    off = dict.fromkeys(values, 0.0)
    if law.perturbed is not law:
        time, theta = values["time"], values["crank_angle"]
        if by_angle:
            time = law.perturbed.time_at(theta, 0.0, math.inf)
        else:
            theta = law.perturbed.at_time(time)[0]
        found = _values(answers, law.perturbed, time, theta)
        off |= {name: peak(found[name] - each) for name, each in values.items() if name in found}
    off["energy_residual"] = peak(values["energy_residual"])
    return {name: off[name] + least for name, least in rounding(values).items()}
