"""A free motion segment by segment: the crank angle carries it wherever the crank turns fast
enough, time across rest and reversal. This is where the one hands over to the other.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle import advance as crank_angle
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.crank_angle.segment import AngleSegment
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal import advance as minimal
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.segment import StepSizes, TimeSegment
from crankmbs.motion.plan import Plan

__all__ = ["FINEST_STEP", "Handover"]

_VAIN = 8  # after as many vain hand-overs the crank must turn through a period before the next
_FAST = (2.0, 8.0)  # as many times as fast as need be either pass takes over: the better one later
# what either pass may miss at kinks of the loads: of the local tolerance, and at most
_KINKS, _MOST_MISSED = 0.2, (math.inf, 1e-11)
_ROUNDS = 5  # of splitting the cells of one segment
FINEST_STEP = 1e-15
"""What rounding leaves of a step over time."""


@dataclass
class Handover:
    """What carries a pass.

    grid : cells of the crank angle, the finest so far; reduced : the crank train over time
    local : what may be erred locally
    by_angle : the crank angle is the variable wherever it can be; else time throughout
    before : the steps of a first pass, which this one betters: the crank angle carries it only
        where it did then, and its steps over time are at most half as long
    refines : whether cells that err too much are split, and their segment is solved again
    taken : the steps of this pass
    """

    grid: Grid
    reduced: Reduced
    local: float
    by_angle: bool = True
    before: StepSizes | None = None
    refines: bool = False
    taken: StepSizes = field(default_factory=StepSizes)

    def segments(
        self, state: State, plan: Plan, allowed: int
    ) -> Generator[AngleSegment | TimeSegment, None, Ending]:
        """The segments from a state on; return how the motion ends.

        allowed : evaluations over time
        """
        period = self.grid.train.scene.period
        kinks = max(min(_KINKS * self.local, _MOST_MISSED[self.grid.checks]), FINEST_STEP)
        tolerance = max(0.01 * self.local, FINEST_STEP)
        hesitates = self.grid.train.has_functions
        turned_back, vain = plan.start, 0  # hand-overs that did not carry it through a period

        def is_fast(at: State, branch: Branch) -> bool:
            if not self.by_angle or at.omega == 0.0:
                return False
            if abs(at.theta - turned_back) < min(vain / _VAIN, 1.0) * period:
                return False
            # the grid is as fine as it must be where the first pass used it, and only there
            if self.before is not None and math.isfinite(self.before.at(at.time)):
                return False
            return crank_angle.is_fast(self.grid, at, branch, _FAST[self.before is not None])

        over_time, slow = not self.by_angle or state.omega == 0.0, False
        while True:
            begin, rounds = state, 0
            effort = minimal.Effort(tolerance, allowed, self.before, hesitates=hesitates)
            segments: Any = (
                minimal.advance(self.reduced, state, plan, effort, is_fast)
                if over_time
                else crank_angle.advance(self.grid, state, plan, kinks)
            )
            while True:
                try:
                    segment = next(segments)
                except StopIteration as stop:
                    ending: Ending | None = stop.value
                    break
                if not over_time and rounds < _ROUNDS and self._refined(segment):
                    segments = crank_angle.advance(self.grid, state, plan, kinks)
                    rounds += 1
                    continue
                rounds = 0
                state = segment.end
                turned_back = state.theta if state.omega == 0.0 else turned_back
                self._note(segment)
                allowed -= segment.evaluations if over_time else 0
                yield segment
            if ending is not None:
                return ending
            vain += not over_time and slow and abs(state.theta - begin.theta) < period
            over_time, slow = not over_time, slow or over_time

    def _refined(self, segment: AngleSegment) -> bool:
        """Whether a segment errs too much; the cells are finer then."""
        if not self.refines:
            return False
        before, errors = self.grid, segment.errors
        self.grid = before.refined(segment.terms.cell, errors.at_end, errors.inside, self.local)
        return self.grid is not before

    def _note(self, segment: AngleSegment | TimeSegment) -> None:
        """Add the steps of a segment to those taken."""
        if isinstance(segment, TimeSegment):
            self.taken.add(segment.track.begins, segment.track.widths)
        else:
            self.taken.add([segment.begin.time], [math.inf])
