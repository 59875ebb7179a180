"""One pass of a free motion from start to end."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs.motion.assemble import ANGLE_ROUNDING
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.handover import Handover
from crankmbs.motion.free.recorder import Recorder, Watch
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.step_sizes import StepSizes
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan
from crankmbs.motion.states import first_sample

__all__ = ["Begin", "Origin", "Pass", "Setup", "begin_at_start", "integrate"]

Begin = Callable[[Grid, float], State]


class Setup(NamedTuple):
    """What a pass follows: from where, sampled how, and the evaluations over time it may take.

    refines : whether cells that err too much in a first pass are split on the way
    watch : is shown every segment
    """

    begin: Begin
    plan: Plan
    allowed: int
    refines: bool = False
    watch: Watch | None = None


class Origin(NamedTuple):
    """Where a pass begins, the one sample there, and the steps that it took over time."""

    state: State
    begin: Samples
    taken: StepSizes


class Pass(NamedTuple):
    """One pass over the whole motion.

    grid : the finest on which it was solved
    slow : times [s] where time took over
    """

    origin: Origin
    samples: Samples
    ending: Ending
    path: Recorder
    grid: Grid
    slow: list[float]


def begin_at_start(grid: Grid, _: float) -> State:
    """The state in which the scene starts."""
    start = grid.train.scene.start
    assert start is not None
    return State(0.0, start.angle, start.speed, 0.0, begun(grid.train))


def integrate(
    grid: Grid, setup: Setup, local: float, *, by_angle: bool, first: Origin | None = None
) -> Pass:
    """One pass from start to end, handing over between the formulations near rest; a second one
    betters the ``first``."""
    scene, plan = grid.train.scene, setup.plan
    state = begun_in = setup.begin(grid, local)
    steady = all(load.is_steady for load in grid.train.loads) and grid.train.law is None
    steady = steady and not grid.train.sticks
    same = first is not None and first.begin.omega[0] == state.omega
    of_angle = float(grid.at(state.mode.loads).outside(np.asarray(state.theta)))
    begin = first.begin if first and same else first_sample(grid.train, state, of_angle)
    path = Recorder(
        grid.train, plan, begin, can_swing=steady, allowed=setup.allowed, watch=setup.watch
    )
    if not scene.settles:  # a periodic motion has no start: what acts was decided before
        path.log.start(state)
    if first:  # it begins a rounding ahead: so the difference knows what the motion makes of one
        ahead = math.copysign(ANGLE_ROUNDING * state.theta, state.omega or float(begin.alpha[0]))
        state = state._replace(theta=state.theta + ahead)
    reduced = Reduced(grid.train, grid.checks)
    refines = setup.refines and first is None
    hand = Handover(grid, reduced, local, by_angle, first and first.taken, refines)
    ending = path.follow(hand.segments(state, plan, setup.allowed))
    if ending is Ending.COMPLETE and plan.folds_at((path.state or state).theta):
        ending = Ending.FOLD
    path.log.close(ending, path.state or begun_in)
    origin = Origin(begun_in, begin, hand.taken)
    return Pass(origin, path.samples(), ending, path, hand.grid, path.slow if by_angle else [])
