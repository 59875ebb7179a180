"""One pass of a free motion from start to end.

The crank angle carries the motion wherever the crank turns fast enough; time carries it across
rest and reversal. This is where the one hands over to the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.assemble import ANGLE_ROUNDING
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle import advance as crank_angle
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.crank_angle.window import Window
from crankmbs.motion.ending import Ending
from crankmbs.motion.events import Log
from crankmbs.motion.first import first_sample
from crankmbs.motion.free.passage import Passage, Watch
from crankmbs.motion.minimal import advance as minimal
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["FINEST_STEP", "Begin", "Pass", "Trail", "Way", "begin_at_start", "travel"]

Begin = Callable[[Grid, float], State]

_VAIN = 8  # after as many vain hand-overs the crank must turn through a period before the next
_FAST = (2.0, 8.0)  # as many times as fast as need be either pass takes over: the better one later
# what either pass may miss at kinks of the loads: of the local tolerance, and at most
_KINKS, _MOST_MISSED = 0.2, (math.inf, 1e-11)
FINEST_STEP = 1e-15  # what rounding leaves of a step over time


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
    fast: tuple[tuple[float, float], ...]


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
    log = Log(grid.train)
    if not scene.settles:  # a periodic motion has no start: what acts was decided before
        log.start(state)
    path = Passage(plan, begin, log, can_swing=steady, allowed=way.allowed, watch=way.watch)
    if first:  # it begins a rounding ahead: so the difference knows what the motion makes of one
        ahead = math.copysign(ANGLE_ROUNDING * state.theta, state.omega or float(begin.alpha[0]))
        state = state._replace(theta=state.theta + ahead)
    tolerance = max(0.01 * local, FINEST_STEP)
    reduced = Reduced(grid.train, grid.checks)
    worst = np.zeros((2, len(grid.edges) - 1))
    fast: list[tuple[float, float]] = []
    slow: list[float] = []

    kinks = max(min(_KINKS * local, _MOST_MISSED[grid.checks]), FINEST_STEP)
    vain = 0  # hand-overs to the crank angle that did not carry the motion through a period

    def is_fast(at: State, branch: Branch) -> bool:
        swings = abs(at.theta - path.turned_back) < min(vain / _VAIN, 1.0) * scene.period
        # the grid is as fine as it must be where the first pass used it, and only there
        usable = first is None or any(since <= at.time < end for since, end in first.fast)
        may = by_angle and at.omega != 0.0 and not swings and usable
        return may and crank_angle.is_fast(grid, at, branch, _FAST[first is not None])

    ending, over_time = None, not by_angle or state.omega == 0.0
    while ending is None:
        at = path.state or state
        if over_time:
            effort = minimal.Effort(tolerance, 2 if grid.checks else 1, path.left)
            slow.append(at.time)
            pieces = minimal.advance(reduced, at, plan, effort, is_fast)
            ending = path.follow(pieces, over_time=True)
        else:
            windows = crank_angle.advance(grid, at, plan, kinks)
            note = partial(_note, worst) if first is None else None
            ending = path.follow(windows, over_time=False, note=note)
            now = path.state or state
            fast.append((at.time, now.time))
            vain += bool(slow) and abs(now.theta - at.theta) < scene.period
        over_time = not over_time
    if ending is Ending.COMPLETE and plan.folds_at((path.state or state).theta):
        ending = Ending.FOLD
    log.close(ending, path.state or begun_in)
    trail = Trail(begun_in, begin, tuple(fast))
    return Pass(trail, path.samples(), ending, path, worst, slow if by_angle else [])


def _sticks(scene: Scene) -> bool:
    """Whether friction brings a swing to rest."""
    friction = scene.friction
    return friction is not None and friction.ring_force + friction.ring_pressure > 0.0


def _note(worst: Array, window: Window) -> None:
    """Keep the largest errors so far of a window's cells."""
    window.errors.raised(worst, window.strip.cell)
