"""The segments of a free motion as they are solved: kept, sampled, and counted."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Generator
from dataclasses import replace
from typing import Protocol

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion import base
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle.segment import AngleSegment
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal.segment import TimeSegment
from crankmbs.motion.plan import Plan
from crankmbs.motion.states import samples_at

__all__ = ["Recorder", "Segment"]

_VAIN = 20  # as many reversals that reach no farther, and the end is not coming
_MOST_HELD, _A_SAMPLE = 40_000_000, 100  # numbers in segments: at most, or as many for each sample
_KEPT_AT_LEAST = 8.0 * math.pi  # rad: the end of a run that is always kept, two cycles
_SAMPLE = 200  # evaluations as costly as a sample of a swing


class Segment(base.Segment, Protocol):
    """A solved stretch of a free motion."""

    @property
    def last(self) -> Samples:
        """The motion at its end, by its polynomials."""

    @property
    def size(self) -> int:
        """About how many numbers it holds."""

    @property
    def steps(self) -> int:
        """Steps or cells in it."""

    @property
    def evaluations(self) -> int:
        """Evaluations of the equation of motion that it took."""


class Recorder:
    """The segments of one pass, sampled as they come; with a finite plan.last only the last stay.

    can_swing : whether a swing that reaches no farther is known to go on so for ever
    allowed : evaluations over time
    one_way : whether it is given up where the crank stops or turns back
    slow : times [s] at which time takes over
    dropped : whether segments were given up, as memory would not hold all
    kept : set it of a pass that betters another: the time [s] from which that one is kept, and this
        one with it
    """

    kept: float | None = None

    def __init__(
        self,
        train: CrankTrain,
        plan: Plan,
        first: Samples,
        *,
        can_swing: bool,
        allowed: int,
        one_way: bool = False,
    ) -> None:
        self._train, self._one_way, self.dropped, self._held = train, one_way, False, 0
        self._plan, self._can_swing, self._left = plan, can_swing, allowed
        self._farthest, self._since = 0.0, 0  # reach [rad], and reversals that reached no farther
        self.slow = list[float]()
        self._blocks, self._count = [first], 1
        self.segments: deque[Segment] = deque()
        self.reversals = self.steps = self.evaluations = 0

    def follow(self, segments: Generator[AngleSegment | TimeSegment, None, Ending]) -> Ending:
        """Add every segment; return how the motion ends."""
        over_time = False
        while True:
            try:
                segment = next(segments)
            except StopIteration as stop:
                ending: Ending = stop.value
                return ending
            went_on, over_time = over_time, isinstance(segment, TimeSegment)
            self.slow += [segment.begin.time] if over_time and not went_on else []
            count = self._count
            self._add(segment)
            if self._one_way and self.reversals:
                return Ending.UNMOVED
            self._left -= segment.evaluations if over_time else 0
            if self._swings():
                if self._can_swing:
                    return Ending.SWING
                self._left -= _SAMPLE * (self._count - count)
                if self._left <= 0:
                    return Ending.COSTLY

    def _add(self, segment: Segment) -> None:
        self.steps += segment.steps
        self.evaluations += segment.evaluations
        if segment.end.omega == 0.0:
            self.reversals += 1
            reach = abs(segment.end.theta - self._plan.start)
            if reach > self._farthest * (1.0 + 1e-4):
                self._farthest, self._since = reach, 0
            self._since += 1
        if math.isinf(self._plan.last):
            if self.segments and self._plan.in_time:
                self._blocks[-1] = self._begun_by(segment, self._blocks[-1])
            self._blocks += (blocks := self._sampled(segment))
            self._count += sum(len(block.time) for block in blocks)
            self._plan.room.check(self._count)
        self.segments.append(segment)
        self._held += segment.size
        while self._is_spare(abs(segment.end.theta - self.segments[0].end.theta)):
            self._held -= self.segments.popleft().size
            self.dropped = True
            if math.isfinite(self._plan.last):
                self._blocks = []  # the sample at the start lies before what is kept

    def _is_spare(self, behind: float) -> bool:
        """Whether a segment that ends an angle [rad] behind the motion's end is given up."""
        if behind > self._plan.last:
            return True
        if self.kept is not None:
            return len(self.segments) > 1 and self.segments[0].end.time < self.kept
        most = max(_MOST_HELD, _A_SAMPLE * self._count)
        return self._held > most and behind > _KEPT_AT_LEAST

    def _begun_by(self, segment: Segment, before: Samples) -> Samples:
        """Samples up to the time at which a segment begins: one there has its values, as a load
        that sets in, ends or jumps does so between the two."""
        at = before.time[-1:]
        if abs(at[0] - segment.begin.time) > self._plan.hair:
            return before
        after = samples_at(segment.cells, self._train, at, in_time=True)
        return Samples.joined([before.select(slice(-1)), after])

    def _sampled(self, segment: Segment) -> list[Samples]:
        """The samples of the plan in a segment, if any: after its begin, up to its end."""
        plan, (begin, end) = self._plan, (segment.begin, segment.end)
        between = (begin.time, end.time) if plan.in_time else (begin.theta, end.theta)
        values = plan.between(*between)
        if len(values) == 0:
            return []
        return [samples_at(segment.cells, self._train, values, in_time=plan.in_time)]

    def _last(self) -> Samples:
        """The one sample at the end."""
        segment = self.segments[-1]
        time, theta, omega, residual = np.array(segment.end[:4])[:, None]
        return replace(segment.last, time=time, theta=theta, omega=omega, energy_residual=residual)

    def _swings(self) -> bool:
        """Whether an end in angle is not coming nearer, reversal by reversal."""
        return self._since > _VAIN and not self._plan.until_time

    def samples(self) -> Samples:
        """All samples, the last one exactly at the end."""
        if not self.segments:
            return self._blocks[0]
        blocks = self._blocks
        if math.isfinite(self._plan.last):
            blocks = [
                *blocks,
                *(block for segment in self.segments for block in self._sampled(segment)),
            ]
        joined = Samples.joined([*blocks, self._last()])
        kept = np.ones(len(joined.time), dtype=np.bool_)
        values = joined.time if self._plan.in_time else joined.theta
        if len(values) > 1:
            kept[-2] = not self._plan.is_end(float(values[-2]), float(values[-1]))
        if math.isfinite(self._plan.last):
            near = np.abs(joined.theta - joined.theta[-1]) <= self._plan.last * (1.0 + 1e-12)
            kept &= near
        return joined if kept.all() else joined.select(kept)

    @property
    def state(self) -> State | None:
        """The state reached, None before the first segment."""
        return self.segments[-1].end if self.segments else None
