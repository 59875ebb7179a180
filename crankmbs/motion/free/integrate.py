"""One pass of a free motion from start to end."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from crankmbs.motion.assemble import ANGLE_ROUNDING
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.handover import Handover
from crankmbs.motion.free.recorder import Recorder
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan
from crankmbs.motion.states import first_sample

__all__ = ["Begin", "Pass", "Setup", "begin_at_start", "integrate"]

Begin = Callable[[Grid, float], State]


class Setup(NamedTuple):
    """What a pass follows: from where, sampled how, and the evaluations over time it may take.

    refines : whether cells that err too much in a first pass are split on the way
    one_way : whether it is given up, UNMOVED, where the crank stops or turns back
    """

    begin: Begin
    plan: Plan
    allowed: int
    refines: bool = False
    one_way: bool = False


class Pass(NamedTuple):
    """One pass over the whole motion.

    begin, first : the state where it begins, and the sample there
    start : where its segments begin: of a second pass a rounding ahead
    grid : on which it began; hand : what carried it, with the finest grid and the steps it took
    """

    begin: State
    first: Samples
    start: State
    grid: Grid
    hand: Handover
    samples: Samples
    ending: Ending
    path: Recorder


def begin_at_start(grid: Grid, _: float) -> State:
    """The state in which the scene starts."""
    start = grid.train.scene.start
    assert start is not None
    return State(0.0, start.angle, start.speed, 0.0, begun(grid.train))


def integrate(
    grid: Grid, setup: Setup, local: float, *, by_angle: bool, before: Pass | None = None
) -> Pass:
    """One pass from start to end, handing over between the formulations near rest; a second one
    betters the one ``before``."""
    train, plan = grid.train, setup.plan
    begin = start = setup.begin(grid, local)
    steady = all(load.is_steady for load in train.loads) and train.law is None
    same = before is not None and before.first.omega[0] == begin.omega
    first = before.first if before and same else first_sample(train, begin)
    if before:  # it begins a rounding ahead: so the difference knows what the motion makes of one
        ahead = math.copysign(ANGLE_ROUNDING * begin.theta, begin.omega or float(first.alpha[0]))
        start = begin._replace(theta=begin.theta + ahead)
    reduced, refines = Reduced(train, grid.checks), setup.refines and before is None
    hand = Handover(grid, reduced, local, by_angle, before and before.hand.taken, refines)
    path = Recorder(
        train,
        plan,
        first,
        can_swing=steady and not train.sticks,
        allowed=setup.allowed,
        one_way=setup.one_way,
    )
    if before and before.path.segments:
        path.kept = before.path.segments[0].begin.time
    ending = path.follow(hand.segments(start, plan, setup.allowed))
    if ending is Ending.COMPLETE and plan.folds_at((path.state or start).theta):
        ending = Ending.FOLD
    return Pass(begin, first, start, grid, hand, path.samples(), ending, path)
