"""The model beside a motion that is known: at states of it, and from one of them on."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import closing

from crankmbs.errors import FormulationError
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phases
from crankmbs.motion.base import Samples, Solution, State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode, begun
from crankmbs.motion.multibody.answer import MOTION, solution, values_at
from crankmbs.motion.multibody.forces import EVERYWHERE, Limits
from crankmbs.motion.multibody.free import refined
from crankmbs.motion.multibody.integrate import enter
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.numerics.arrays import Array

__all__ = ["consistent", "driven", "initial", "integrated"]


def integrated(
    train: CrankTrain,
    state: tuple[float, float, float],
    phases: Phases,
    times: Array,
    rtol: float,
    steps: int,
) -> tuple[dict[str, Array], dict[str, float]]:
    """Every variable of a free crank at later times [s], shape (m,), integrated from a time [s],
    crank angle [rad] and speed [rad/s]; and the error of each.

    train : without a law on the fuel; phases : of the loads' windows; rtol asked for; steps :
        allowed

    Raises
    ------
    FormulationError : exudyn cannot take a single step from there, or does not come to the end
    """
    limits = Limits(float(times[-1]), EVERYWHERE, steps)

    def places(answer: Motion) -> tuple[Array, Array]:
        return times, answer.at_times(times)[1]

    with closing(Model(train)) as model:
        start = State(*state, 0.0, Mode(phases))
        runs = Runs(model, start, limits)
        values, errors, _ = refined(runs, rtol, places, by_angle=False)
    if runs.ending is not Ending.COMPLETE:
        end, fails = runs.paths[-1].end, runs.ending is Ending.DIVERGED
        why = (
            "beyond which its Newton iteration does not converge"
            if fails
            else f"in {steps:,} steps"
        )
        raise FormulationError(
            f"exudyn comes to {end.time:.6g} s, {math.degrees(end.theta):.6g} degrees, {why}"
        )
    return values, errors


def consistent(train: CrankTrain, motion: Mapping[str, Array], *, driven: bool) -> dict[str, Array]:
    """Accelerations, multipliers and all that follows from them at states of a motion, as
    `crankmbs.motion.multibody.answer.values_at` says."""
    with closing(Model(train)) as model:
        return values_at(model, motion, driven=driven)


def driven(train: CrankTrain, sampled: Solution) -> Solution:
    """The forces at the samples of a prescribed motion, and the drive's torque; nothing is
    integrated.

    sampled : time, crank angle, speed and acceleration by the law, with shares of the combustion
        and forces from outside
    """

    def found(at: Samples) -> dict[str, Array]:
        rows = zip(MOTION, (at.time, at.theta, at.omega, at.alpha), strict=True)
        motion = {**dict(rows), **at.computed}
        return consistent(train, motion, driven=True) | motion

    values, other = (found(at or sampled.samples) for at in (sampled.samples, sampled.better))
    errors = {name: peak(other[name] - each) for name, each in values.items()}
    said = sampled.status, sampled.message
    return solution(values, errors, said, (sampled.evaluations, 0))


def initial(train: CrankTrain, step: float) -> tuple[Array, Array, Array]:
    """Coordinates at the start of a scene, their velocities and accelerations, from which a run
    with steps of this length [s] does not ring, under the forces of the side of a jump to which the
    crank moves; of a prescribed speed a constant one."""
    first = train.scene.start or train.scene.motion
    assert first is not None
    assert isinstance(first.speed, float)
    with closing(Model(train)) as model:
        state = State(0.0, first.angle, first.speed, 0.0, begun(train))
        entered = enter(model, state, 0.0, Limits(math.inf, EVERYWHERE, 0))
        model.driven = train.scene.start is None
        alpha = entered[1] if entered and not model.driven else 0.0
        _, quiet = model.quiet_start((*state[:3], alpha), step)
    return quiet.position[0], quiet.velocity[0], quiet.acceleration[0]
