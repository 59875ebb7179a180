"""The stretch of a run over which it is summed up, and integrals over it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["Span", "integral", "last_span", "measured_span", "same_span"]


_JUMPS = 4  # of a cylinder in a cycle that count: as many as it has dead centres
_SAME_ANGLE = 1e-9  # rad: rounding of start + k * every must not lose a cycle


@dataclass(frozen=True)
class Span:
    """A stretch of a run up to its end.

    kind : "last cycle", "last revolution" or "whole run"; "settled period" of several cycles
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
    """The last whole cycle of a run; without one the last whole revolution, or else the run.

    It ends with the run. Where it begins between two samples the time follows from the cubic
    through their angles and speeds; exact to fourth order in the spacing.

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
    """What a run is summed up over: of a settled motion its whole period, else the `last_span`."""
    scene = result.scene
    if scene.settles and result.status == 0 and scene.settled_period > scene.period + _SAME_ANGLE:
        whole = _ending(result, "settled period", scene.settled_period)
        if whole is not None:
            return whole
    return last_span(result)


def same_span(window: Span, result: Result) -> Span:
    """The window of the same kind and length in the same run, sampled otherwise."""
    found = None
    if window.kind != "whole run":
        found = _ending(result, window.kind, abs(window.angle))
    return found or _whole_run(result)


def _ending(result: Result, kind: str, wanted: float) -> Span | None:
    """The stretch up to the end in which the crank turns through an angle [rad], if any."""
    time, angle = result.data["time"].values, result.data["crank_angle"].values
    turned = np.abs(angle[-1] - angle)
    before = np.flatnonzero(turned >= wanted - _SAME_ANGLE)
    if len(before) == 0:
        return None
    k = int(before[-1])
    sense = math.copysign(1.0, angle[-1] - angle[k])
    if turned[k] <= wanted + _SAME_ANGLE:
        return Span(kind, float(time[k]), float(time[-1]), sense * wanted, k, k)
    pair = slice(k, k + 2)
    speed = result.data["crank_speed"].values
    path = CubicHermiteSpline(time[pair], angle[pair], speed[pair])
    begin = float(path.solve(angle[-1] - sense * wanted, extrapolate=False)[-1])
    return Span(kind, begin, float(time[-1]), sense * wanted, k, k + 1)


def _whole_run(result: Result) -> Span:
    time, angle = result.data["time"].values, result.data["crank_angle"].values
    whole = float(angle[-1] - angle[0])
    return Span("whole run", float(time[0]), float(time[-1]), whole, 0, 0)


def integral(result: Result, window: Span, values: Array) -> tuple[Array, Array]:
    """Integral over time across a window, and an estimate of its quadrature error.

    A cubic spline through the samples is integrated: order 4 in the spacing where the quantity is
    smooth, 2 across a bend, 1 across a jump. The error is the difference from the splines through
    the even and through the odd samples, whichever is largest: their sum, where smooth 16 times too
    large; as those at jumps and bends may cancel by luck the root of squares of its parts; and, as
    cylinders that jump at the same place between two samples add up, the sum of the largest parts.

    Parameters
    ----------
    values : shape (samples, ...) [unit]; all samples of the run

    Returns
    -------
    integral, error : shape (...) [unit s]
    """
    time = result.data["time"].values[window.first :]
    inner = values[window.first :]
    if len(time) < 2:
        return np.zeros(values.shape[1:]), np.zeros(values.shape[1:])
    number, last = np.arange(len(time)), len(time) - 1
    cycles = max(1, round(abs(window.angle) / result.scene.period))
    jumps = min(_JUMPS * cycles * len(result.scene.cylinders), last // 2)
    found = CubicSpline(time, inner).antiderivative()
    error = np.zeros(values.shape[1:])
    for odd in (0, 1):
        chosen = (number % 2 == odd) | (number == 0) | (number == last)
        coarse = CubicSpline(time[chosen], inner[chosen]).antiderivative()
        edges = np.maximum(time[chosen], window.begin)
        apart = np.diff(found(edges) - coarse(edges), axis=0)
        error = np.maximum(error, np.abs(apart.sum(axis=0)))
        error = np.maximum(error, np.sqrt((apart**2).sum(axis=0)))
        largest = np.sort(np.abs(apart), axis=0)[len(apart) - jumps :]
        error = np.maximum(error, largest.sum(axis=0))
    return np.asarray(found(window.end) - found(window.begin)), error
