"""One run at one step size, from start to end.

It is made of stretches, cut where something jumps or bends at a time known beforehand (a load,
the prescribed acceleration) and where the gas force of a cylinder jumps, at a crank angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.landing import LEAST_STEPS, PASSED
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.problem import Problem, jump_times, kink_times
from crankmbs.motion.multibody.start import coordinates
from crankmbs.motion.multibody.step_table import StepTable
from crankmbs.motion.multibody.walk import SAME, Walk, initial_acceleration
from crankmbs.numerics.cycle import NEAR

__all__ = ["Stepped", "coarsest_step", "model_of", "solve"]

_ENDLESS = 1_000_000_000  # steps: the run ends by its time or its cost long before
_STEPS_PER_TURN = 125  # of the coarsest run
_STEPS = 125  # of the coarsest run, at least
_STUCK = 1e-9  # rad/s2


class Stepped(NamedTuple):
    """A run at one step size.

    tables : the stretches, one after the other
    landings : the state at the start and at the end of each stretch that has some length
    ending : COMPLETE, CALLED_OFF, HELD, or DIVERGED where the solver gave up
    blind : whether it ran over bends or jumps of the loads over speed
    steps, iterations : what it cost
    """

    tables: tuple[StepTable, ...]
    landings: tuple[State, ...]
    ending: Ending
    blind: bool
    steps: int
    iterations: int


def model_of(problem: Problem) -> Model:
    """exudyn's system for a problem."""
    reference = coordinates(problem.scene, problem.start[0], 0.0)
    gas = problem.scene.gas is not None or problem.scene.friction is not None
    return Model(problem.scene, reference, gas=gas, free=problem.law is None)


def solve(
    problem: Problem, model: Model, step: float, halvings: int, go_on: Callable[[], bool] | None
) -> Stepped:
    """Run from time 0 to the end with ``step`` halved so often.

    go_on : asked now and then; False calls the run off. None: nothing does
    """
    walk = Walk(problem, model, go_on)
    jumps = jump_times(problem)
    cuts = sorted({*jumps, *kink_times(problem)})
    ends = [*(t for t in cuts if t < problem.end * (1.0 - SAME)), problem.end]
    bounds, ending = problem.plan.angle_bounds, Ending.COMPLETE

    def at_jump_in_time() -> bool:
        return any(math.isclose(walk.time, t, rel_tol=SAME) for t in jumps)

    while ending is Ending.COMPLETE and ends and walk.bound not in bounds:
        h, count = _steps(ends[0] - walk.time, step, halvings)
        anew = not walk.tables or at_jump_in_time()
        if anew and not walk.goes_up and walk.is_at_gas_jump(NEAR):
            walk.above(h)
        ending = walk.stretch(ends[0], h, count, bounds)
        while ends and walk.time >= ends[0] * (1.0 - SAME):
            ends.pop(0)
        if ending is Ending.COMPLETE and ends and go_on is not None and not go_on():
            last = walk.tables[-1]  # half of it: an end at a jump has no certain side
            walk.tables[-1] = last._replace(until=0.5 * (last.after + last.until))
            return _path(walk, Ending.CALLED_OFF)
    if walk.time > 0.0 and (
        walk.is_at_gas_jump(PASSED) or walk.is_at_dead_centre(PASSED) or at_jump_in_time()
    ):
        walk.above(h)  # what comes after the jump is asked for at the end, too
    return _path(walk, ending)


def _path(walk: Walk, ending: Ending) -> Stepped:
    made = tuple(walk.tables), tuple(walk.landings)
    return Stepped(*made, ending, walk.is_blind, walk.steps, walk.iterations)


def coarsest_step(problem: Problem, model: Model) -> tuple[float, bool]:
    """A step [s] to begin with, and whether the crank will move at all.

    It resolves a turn at a speed that the run will come near: the fastest prescribed one, that at
    the start, or from rest the speed after one turn at the first acceleration.
    """
    omega = problem.start[1]
    moves, speed = True, abs(omega)
    if problem.law is not None:
        speeds = problem.law.at_time(problem.end * np.linspace(0.0, 1.0, 1001))[1]
        speed = float(np.max(np.abs(speeds)))
    elif omega == 0.0:
        alpha = abs(initial_acceleration(problem, model))
        loads_change = not all(load.is_steady for load in problem.scene.torque)
        moves = alpha > _STUCK or loads_change
        speed = min(math.sqrt(4.0 * math.pi * alpha), alpha * problem.end)
    turn = 2.0 * math.pi / speed if speed > 0.0 else math.inf
    longest = 1.0 if math.isinf(problem.end) else problem.end
    return min(turn / _STEPS_PER_TURN, longest / _STEPS), moves


def _steps(duration: float, step: float, halvings: int) -> tuple[float, int]:
    """Step [s] and number of steps for a stretch."""
    if math.isinf(duration):
        return step / 2**halvings, _ENDLESS
    count = max(math.ceil(duration / step - 1e-9), LEAST_STEPS) * 2**halvings
    return duration / count, count
