"""A prescribed speed: at every sample exudyn's equations give the forces and the drive's torque."""

from __future__ import annotations

from contextlib import closing

from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.multibody.answer import Answers, solution
from crankmbs.numerics.arrays import Array

__all__ = ["run"]


def run(train: CrankTrain, sampled: Solution) -> Solution:
    """Solve for the forces at the samples of a prescribed motion; nothing is integrated.

    sampled : time, crank angle, speed and acceleration by the law, with shares of the combustion
        and forces from outside
    """
    with closing(Answers(train)) as answers:
        values = _values(answers, sampled.samples)
        other = _values(answers, sampled.better or sampled.samples)
    errors = {name: peak(other[name] - each) for name, each in values.items()}
    said = sampled.status, sampled.message
    return solution(values, errors, said, (sampled.evaluations, 0))


def _values(answers: Answers, at: Samples) -> dict[str, Array]:
    names = ("time", "crank_angle", "crank_speed", "crank_acceleration")
    motion = dict(zip(names, (at.time, at.theta, at.omega, at.alpha), strict=True))
    motion |= at.computed
    return answers.consistent(motion, driven=True) | motion
