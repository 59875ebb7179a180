"""A prescribed speed: at every sample exudyn's equations give the forces and the drive's torque."""

from __future__ import annotations

from contextlib import closing

from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.speed import speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.driven import Way, driven, monotone_stretches
from crankmbs.motion.multibody.answer import Answers, solution
from crankmbs.motion.plan import plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["run"]

_POINTS = 6  # of Gauss in 5 degrees, in which the work is summed


def run(train: CrankTrain, sampled: Solution) -> Solution:
    """Solve for the forces at the samples of a prescribed motion; nothing is integrated.

    sampled : time, crank angle, speed and acceleration by the law, with shares of the combustion
        and forces from outside
    """
    assert train.scene.motion is not None
    law = speed_law(train.scene.motion)
    stretches, _ = monotone_stretches(plan_of(train.scene), law)
    pieces = [piece.cells for piece in driven(Way(train, law, _POINTS), stretches)]
    with closing(Answers(train)) as answers:
        values = _values(answers, sampled.samples)
        values["energy_residual"] = answers.residual(pieces, values["time"])
        other = _values(answers, sampled.better or sampled.samples)
    errors = {name: peak(other.get(name, 0.0) - each) for name, each in values.items()}
    said = sampled.status, sampled.message
    return solution(values, errors, said, (sampled.evaluations, 0))


def _values(answers: Answers, at: Samples) -> dict[str, Array]:
    names = ("crank_angle", "crank_speed", "crank_acceleration")
    motion = dict(zip(names, (at.theta, at.omega, at.alpha), strict=True)) | dict(at.computed)
    return answers.consistent(motion, driven=True) | motion | {"time": at.time}
