"""The stretch of a run over which it is summed up."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crankmbs.motion.motion import Motion, Passes
from crankmbs.result import Result

__all__ = ["CYCLES", "TURNS_BACK", "Span", "last_span", "measured_span", "passes_over"]

CYCLES = "last cycle", "last period"
"""Kinds of spans that are whole cycles."""
TURNS_BACK = "last swings"
"""The kind in which the crank rests or turns back."""

_SAME_ANGLE = 1e-9  # rad: rounding of start + k * every must not lose a cycle


@dataclass(frozen=True)
class Span:
    """A stretch of a run up to its end.

    kind : "last cycle", "last revolution" or "whole run"; of several cycles that come again
        together "last period"; "last swings" where the crank rests or turns back in it: from where
        it last was so far from where it ends
    begin, end [s]; angle : crank angle turned between them [rad], negative backwards
    first : number of the last sample at or before ``begin``
    inside : number of the first sample at or after ``begin``
    """

    kind: str
    begin: float
    end: float
    angle: float
    first: int
    inside: int

    @property
    def duration(self) -> float:
        """Length in time [s]."""
        return self.end - self.begin


def last_span(result: Result) -> Span:
    """The last whole cycle of a run; without one the last whole revolution, or else the run. It
    ends with the run.

    >>> last_span(simulate(load_scene("propeller"))).kind
    'last cycle'
    """
    lengths = (("last cycle", result.scene.period), ("last revolution", 2.0 * math.pi))
    for kind, wanted in lengths:
        window = _ending(result, kind, wanted)
        if window is not None:
            return window
    return _whole_run(result)


def measured_span(result: Result) -> Span:
    """What a run is summed up over: where cycles differ and come again together, by a sequence of
    pressures, misfires "every n" or loads over the angle, its last whole period; without one that
    of the loads, else the `last_span`."""
    scene = result.scene
    for period in scene.settled_period, scene.load_period:
        if period > scene.period + _SAME_ANGLE:
            whole = _ending(result, "last period", period)
            if whole is not None:
                return whole
    return last_span(result)


def passes_over(result: Result, window: Span) -> Passes:
    """The motion over a window, and the motions that check it over theirs."""
    if window.kind == "whole run":
        return result.passes
    turned = abs(window.angle)
    answer = result.passes.answer.last(turned) or result.passes.answer
    checks = [motion.last(turned) for motion in result.passes.checks]
    return Passes(answer, tuple(check for check in checks if check), result.passes.share)


def _ending(result: Result, kind: str, wanted: float) -> Span | None:
    """The stretch up to the end in which the crank turns through an angle [rad], if any."""
    time, angle = result.sampled("time"), result.sampled("crank_angle")
    turned = np.abs(angle[-1] - angle)
    before = np.flatnonzero(turned >= wanted - _SAME_ANGLE)
    if len(before) == 0:
        return None
    k = int(before[-1])
    sense = math.copysign(1.0, angle[-1] - angle[k])
    part: Motion | None = result.passes.answer.last(wanted)
    if part is not None and not part.turns_one_way:
        kind = TURNS_BACK
    if turned[k] <= wanted + _SAME_ANGLE:
        return Span(kind, float(time[k]), float(time[-1]), sense * wanted, k, k)
    begin = float(time[k]) if part is None else part.begin
    inside = int(np.searchsorted(time, begin))
    return Span(kind, begin, float(time[-1]), sense * wanted, inside - 1, inside)


def _whole_run(result: Result) -> Span:
    time, angle = result.sampled("time"), result.sampled("crank_angle")
    whole = float(angle[-1] - angle[0])
    return Span("whole run", float(time[0]), float(time[-1]), whole, 0, 0)
