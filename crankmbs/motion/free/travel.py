"""One pass of a free motion from start to end."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from crankmbs.motion.assemble import ANGLE_ROUNDING
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.crank_angle.window import Window
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.handover import Handover, Spans
from crankmbs.motion.free.passage import Passage, Watch
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan
from crankmbs.motion.states import first_sample
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Begin", "Pass", "Trail", "Way", "begin_at_start", "travel"]

Begin = Callable[[Grid, float], State]


class Way(NamedTuple):
    """What a pass follows: from where, sampled how, and the evaluations over time it may take.

    watch : is shown every piece
    """

    begin: Begin
    plan: Plan
    allowed: int
    watch: Watch | None = None


class Trail(NamedTuple):
    """Where a pass begins, the one sample there, and the spans of time [s] that the crank angle
    carries."""

    state: State
    begin: Samples
    fast: Spans


class Pass(NamedTuple):
    """One pass over the whole motion.

    local : shape (2, cells), errors at ends and inside
    slow : times [s] where time took over
    """

    trail: Trail
    samples: Samples
    ending: Ending
    path: Passage
    local: Array
    slow: list[float]


def begin_at_start(grid: Grid, _: float) -> State:
    """The state in which the scene starts."""
    start = grid.train.scene.start
    assert start is not None
    return State(0.0, start.angle, start.speed, 0.0, begun(grid.train))


def travel(
    grid: Grid, way: Way, local: float, *, by_angle: bool, first: Trail | None = None
) -> Pass:
    """One pass from start to end, handing over between the formulations near rest; a second one
    betters the ``first``."""
    scene, plan = grid.train.scene, way.plan
    state = begun_in = way.begin(grid, local)
    steady = all(load.is_steady for load in scene.torque) and grid.train.law is None
    steady = steady and not _sticks(scene)
    same = first is not None and first.begin.omega[0] == state.omega
    of_angle = float(grid.at(state.mode.loads).outside(np.asarray(state.theta)))
    begin = first.begin if first and same else first_sample(grid.train, state, of_angle)
    path = Passage(grid.train, plan, begin, can_swing=steady, allowed=way.allowed, watch=way.watch)
    if not scene.settles:  # a periodic motion has no start: what acts was decided before
        path.log.start(state)
    if first:  # it begins a rounding ahead: so the difference knows what the motion makes of one
        ahead = math.copysign(ANGLE_ROUNDING * state.theta, state.omega or float(begin.alpha[0]))
        state = state._replace(theta=state.theta + ahead)
    reduced, usable = Reduced(grid.train, grid.checks), None if first is None else first.fast
    hand = Handover(grid, reduced, local, by_angle, usable)
    worst = np.zeros((2, len(grid.edges) - 1))
    note = partial(_note, worst) if first is None else None
    ending = path.follow(hand.pieces(state, plan, way.allowed), note)
    if ending is Ending.COMPLETE and plan.folds_at((path.state or state).theta):
        ending = Ending.FOLD
    path.log.close(ending, path.state or begun_in)
    trail = Trail(begun_in, begin, tuple(path.fast))
    return Pass(trail, path.samples(), ending, path, worst, path.slow if by_angle else [])


def _sticks(scene: Scene) -> bool:
    """Whether friction brings a swing to rest."""
    friction = scene.friction
    return friction is not None and friction.ring_force + friction.ring_pressure > 0.0


def _note(worst: Array, window: Window) -> None:
    """Keep the largest errors so far of a window's cells."""
    window.errors.raised(worst, window.strip.cell)
