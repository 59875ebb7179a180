"""A toothed wheel on the crank: its edges in a signal over time, and which tooth each one is."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array, Index

__all__ = ["Wheel", "edges", "first_edges", "marked_edges", "tick_of", "tick_of_times", "wheel_of"]

_FORM = re.compile(r"([1-9][0-9]*)(?:\s*-\s*([1-9][0-9]*))?(?:\s+(rising|falling))?")
_BAND = 0.15  # of the range: a signal must pass so far beyond its middle to have an edge
_NEIGHBOURS = 7  # intervals whose median is the pitch
_DIGITAL = 0.75  # of the range within one sample: a pulse without flanks
_EVEN = (0.55, 1.6)  # of the pitch: intervals from tooth to tooth, also of uneven teeth


class Wheel(NamedTuple):
    """teeth : places on the circumference; missing : how many of them, one beside the other, are
    empty; falling : whether the falling edges of the signal count, else the rising ones."""

    teeth: int
    missing: int
    falling: bool

    @property
    def pitch(self) -> float:
        """From one place to the next [deg]."""
        return 360.0 / self.teeth

    @property
    def edges(self) -> int:
        """Edges of a revolution."""
        return self.teeth - self.missing

    @property
    def edge(self) -> str:
        """Which edges count, in a word."""
        return "falling" if self.falling else "rising"

    def __str__(self) -> str:
        return f"{self.teeth}-{self.missing}" if self.missing else f"{self.teeth}"


def wheel_of(value: Any) -> Wheel:
    """A wheel as it is written.

    Raises
    ------
    InputError : what is no wheel

    >>> wheel_of("60-2 falling")
    Wheel(teeth=60, missing=2, falling=True)
    """
    if isinstance(value, Wheel):
        return value
    match = _FORM.fullmatch(value.strip()) if isinstance(value, str) else None
    teeth, missing = (int(match[1]), int(match[2] or 0)) if match else (0, 0)
    if match is None or teeth < 8 or 3 * missing > teeth:
        raise InputError(
            'must be teeth less the missing ones, "60-2" or "60-2 falling", at least 8 and at most '
            f'a third of them missing, or the pulses of an encoder, "360"; {shown(value)} came'
        )
    return Wheel(teeth, missing, match[3] == "falling")


def edges(time: Array, signal: Array, *, falling: bool = False) -> Array:
    """Times [s] at which a signal passes the middle of its range, upwards or downwards.

    An edge counts where the signal comes from well below the middle and goes well above it; its
    time lies on the straight line between two samples.

    >>> edges(np.arange(6.0), np.array([0.0, 0.0, 1.0, 1.0, 0.0, 1.0])).tolist()
    [1.5, 4.5]
    """
    s = -signal if falling else signal
    low, high = float(np.min(s)), float(np.max(s))
    middle, band = 0.5 * (low + high), _BAND * (high - low)
    side = np.where(s > middle + band, 1, np.where(s < middle - band, -1, 0))
    clear = np.flatnonzero(side)
    rises = clear[1:][(side[clear[1:]] > 0) & (side[clear[:-1]] < 0)]
    crossings = np.flatnonzero((s[:-1] < middle) & (s[1:] >= middle)) + 1
    k = crossings[np.searchsorted(crossings, rises, side="right") - 1]
    share = (middle - s[k - 1]) / (s[k] - s[k - 1])
    return time[k - 1] + share * (time[k] - time[k - 1])


def tick_of(time: Array, signal: Array) -> float:
    """The step [s] by which a signal's edges are known: that of its samples where a pulse goes from
    low to high within one of them, 0 where its flanks have samples.

    >>> tick_of(np.arange(6.0), np.array([0.0, 0.0, 5.0, 5.0, 0.0, 0.0]))
    1.0
    """
    low, high = np.quantile(signal, [0.1, 0.9])
    rises = np.diff(signal)
    middle = 0.5 * (low + high)
    crossing = rises[(signal[:-1] < middle) & (signal[1:] >= middle)]
    digital = crossing.size > 0 and np.median(crossing) > _DIGITAL * (high - low)
    return float(np.median(np.diff(time))) if digital else 0.0


def tick_of_times(time: Array) -> float:
    """The step [s] of the clock that the times of edges were read from: the least by which the
    intervals between them differ, beyond the rounding of numbers.

    >>> round(tick_of_times(np.array([0.0, 0.25, 0.75, 1.0, 1.75, 2.0])), 9)
    0.25
    """
    steps = np.diff(np.sort(np.diff(time)))
    apart = steps[steps > 8.0 * np.spacing(np.max(np.abs(time)))]
    return float(np.min(apart)) if apart.size else 0.0


def first_edges(time: Array, wheel: Wheel) -> Index:
    """The places of the first edges after the gaps.

    time : of the edges, shape (n,) [s]

    Raises
    ------
    InputError : no gap, less than two of them, teeth missing or doubled between two of them
    """
    if not wheel.missing:
        raise InputError(
            f"a wheel {wheel} has no gap, so no tooth is the first; give wheel with its "
            'missing teeth, such as "60-2", or of an encoder the column of its mark, index="Z"'
        )
    if len(time) < 2 * wheel.edges:
        raise InputError(
            f"a wheel {wheel} has {wheel.edges} edges a revolution, and the record has "
            f"{len(time)} {wheel.edge} ones; record two cycles at least, or check wheel"
        )
    ratio = _in_pitches(time)
    gap = wheel.missing + 1
    first = np.flatnonzero(ratio > np.sqrt(gap * (gap - 1.0))) + 1
    if len(first) < 2:
        other = "rising" if wheel.falling else "falling"
        raise InputError(
            f"no gap of {wheel.missing} teeth comes again in the {wheel.edge} edges: the "
            f"widest interval, at {time[np.argmax(ratio)]:.6g} s, spans {np.max(ratio):.3g} "
            f"pitches, and {gap} are looked for; correct wheel, or take its other edges, "
            f'wheel="{wheel} {other}"'
        )
    _check_revolutions(time, ratio, first, wheel)
    return first


def marked_edges(time: Array, marks: Array, wheel: Wheel) -> Index:
    """The places of an encoder's edges next to the marks of its index.

    Raises
    ------
    InputError : less than two marks, pulses missing or doubled between two of them
    """
    inside = marks[(marks >= time[0]) & (marks <= time[-1])] if len(time) else marks[:0]
    if len(inside) < 2:
        raise InputError(
            f"the index has {len(inside)} {wheel.edge} edges, and one a revolution is "
            "needed; give the column that has them"
        )
    behind = np.clip(np.searchsorted(time, inside), 1, len(time) - 1)
    nearer = inside - time[behind - 1] < time[behind] - inside
    first = behind - nearer
    _check_revolutions(time, _in_pitches(time), first, wheel)
    return first


def _in_pitches(time: Array) -> Array:
    """Intervals over the median of their neighbours."""
    steps = np.diff(time)
    return steps / median_filter(steps, _NEIGHBOURS, mode="nearest")


def _check_revolutions(time: Array, ratio: Array, first: Index, wheel: Wheel) -> None:
    for a, b in pairwise(first):
        inner = ratio[a : b - 1 if wheel.missing else b]
        wide, narrow = a + int(np.argmax(inner)), a + int(np.argmin(inner))
        if b - a == wheel.edges and ratio[wide] < _EVEN[1] and ratio[narrow] > _EVEN[0]:
            continue
        missing = b - a < wheel.edges or (b - a == wheel.edges and ratio[wide] >= _EVEN[1])
        fault = "are missing" if missing else "are doubled"
        if missing and ratio[wide] < _EVEN[1]:
            raise InputError(
                f"from the gap at {time[a]:.6g} s to that at {time[b]:.6g} s the wheel shows "
                f"{b - a} {wheel.edge} edges, and {wheel} has {wheel.edges}: at one of the two, "
                "teeth are missing beside each other; cut the record before or after that, or "
                "check wheel"
            )
        k = wide if missing else narrow
        raise InputError(
            f"between {time[a]:.6g} and {time[b]:.6g} s the wheel shows {b - a} "
            f"{wheel.edge} edges, and {wheel} has {wheel.edges}: teeth {fault} near "
            f"{time[k]:.6g} s, where an interval spans {ratio[k]:.2g} pitches; cut the record "
            "before or after that, check wheel, or take its other edges, such as "
            'wheel="60-2 falling"'
        )
