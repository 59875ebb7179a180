"""What a multibody run has to solve: where it ends, and where it jumps."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.speed import SpeedLaw, speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.multibody.gas import GasForces
from crankmbs.motion.plan import Plan, plan_of
from crankmbs.motion.prescribed import monotone_stretches
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = [
    "Problem",
    "erratic_order",
    "jump_times",
    "kink_times",
    "order_over_angle",
    "problem_of",
]

_MOST_KINKS = 12  # in a run; each costs a run-up, and a table of more is run over as it is


class Problem(NamedTuple):
    """A free crank, or one on a prescribed law.

    end [s] : infinite where only the crank angle ends the run
    rests : the law comes to rest at ``end``, before the end of the run
    """

    scene: Scene
    plan: Plan
    gas: GasForces
    law: SpeedLaw | None
    end: float
    rests: bool

    @property
    def start(self) -> tuple[float, float]:
        """Crank angle [rad] and speed [rad/s] at time 0."""
        if self.law is None:
            assert self.scene.start is not None
            return self.scene.start.angle, self.scene.start.speed
        theta, omega, _ = self.law.at_time(0.0)
        return float(theta), float(omega)


def problem_of(train: CrankTrain) -> Problem:
    """The problem of a crank train.

    Raises
    ------
    InputError : a speed table that ends before the run does
    """
    scene = train.scene
    plan, gas = plan_of(scene), GasForces(train)
    if scene.motion is None:
        return Problem(scene, plan, gas, None, plan.time_bound, False)
    law = speed_law(scene.motion)
    stretches, reached = monotone_stretches(plan, law)
    end = stretches[-1][1] if stretches else 0.0
    return Problem(scene, plan, gas, law, end, not reached)


def jump_times(problem: Problem) -> list[float]:
    """Times [s] above 0 at which a load or the prescribed acceleration jumps."""
    times: set[float] = set()
    for load in problem.scene.torque:
        times |= set(load.parts.function.times if load.parts.function else ())
        if load.parts.over_time is not None:
            times |= set(load.parts.over_time.jumps)
        times |= {end for end in (load.after, load.until) if end is not None}
    if problem.law is not None:
        corners = _corners(problem.law, problem.end)
        beside = corners * np.array([[1.0 - 1e-9], [1.0 + 1e-9]])
        before, after = problem.law.at_time(beside)[2]
        between = 0.5 * (corners[1:] + corners[:-1])  # at a corner it may be 0
        most = np.max(np.abs(problem.law.at_time(np.append(between, beside))[2]), initial=0.0)
        jumps = np.abs(after - before) > 1e-6 * most
        times |= set(corners[jumps].tolist())
    return sorted(t for t in times if t > 0.0)


def kink_times(problem: Problem) -> list[float]:
    """Times [s] within the run at which a load bends, if they are few.

    A bend within a step, and one between the steps of an interpolation, would leave an error that
    changes erratically with the step.
    """
    times = _row_times(problem)
    return times if len(times) <= _MOST_KINKS else []


def erratic_order(problem: Problem) -> int:
    """Power of the step with which the erratic part of an error goes, at least; 3 at most.

    It is 1 where a load jumps within a step, at a place in it that changes with the step, and 2
    where it bends, as loads over the angle do; loads over speed are not counted. No load bends a
    prescribed motion.
    """
    if problem.law is not None:
        corners = _corners(problem.law, problem.end).tolist()
        return 2 if set(corners) - set(jump_times(problem)) else 3
    over_angle = order_over_angle(problem)
    if any(load.parts.function is not None for load in problem.scene.torque):
        return 1  # nobody says whether it jumps
    return min(problem.gas.order, over_angle, 2 if len(_row_times(problem)) > _MOST_KINKS else 3)


def order_over_angle(problem: Problem) -> int:
    """The same of the loads over the angle alone."""
    parts = (load.parts.over_angle for load in problem.scene.torque)
    return min((part.order for part in parts if part is not None), default=3)


def _corners(law: SpeedLaw, end: float) -> Array:
    """Times [s] of the corners up to an end, and at it: there too the right-hand limit counts."""
    return law.corners(0.0, math.nextafter(end, math.inf))


def _row_times(problem: Problem) -> list[float]:
    """Times [s] within the run at which loads bend or jump."""
    parts = (load.parts.over_time for load in problem.scene.torque)
    bends = {t for part in parts if part is not None for t in part.bends}
    return sorted(t for t in bends if 0.0 < t < problem.end)
