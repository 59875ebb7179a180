"""How large a curve is over a stretch of a run: its maximum, where that is, and its RMS."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["TIE", "Size", "percent", "size_of", "top_of", "within"]


TIE = 1e-9  # relative: the same peak in two revolutions differs by rounding; the first counts


class Size(NamedTuple):
    """largest, rms [unit of the curve]; angle [rad], within one period, of the largest.

    The RMS is taken over the crank angle.
    """

    largest: float
    rms: float
    angle: float


def size_of(curve: Array, angle: Array, period: float) -> Size:
    """Measure a curve over angles, both of shape (n,), [unit] and [rad]."""
    size = np.abs(curve)
    largest = float(np.max(size))
    top = top_of(curve, angle, period)
    widths = np.abs(np.diff(angle))
    scaled = (size / largest) ** 2 if largest > 0.0 else size  # no overflow, no underflow
    if np.any(widths):
        mean = float(np.average(0.5 * (scaled[1:] + scaled[:-1]), weights=widths))
    else:
        mean = float(np.mean(scaled))
    return Size(largest, largest * math.sqrt(mean), float(within(angle[top], period)))


def top_of(curve: Array, angle: Array, period: float) -> int:
    """The index of the largest size of a curve, the first in the period of equal ones."""
    size = np.abs(curve)
    ties = np.flatnonzero(size >= np.max(size) * (1.0 - TIE))
    return int(ties[np.argmin(within(angle[ties], period))])


def percent(part: float, peak: float) -> float:
    """``part`` in percent of ``peak``; NaN where the peak is zero."""
    return 100.0 * part / peak if peak > 0.0 else math.nan


def within(angle: Array | float, period: float) -> Array:
    """Angles modulo one period; those a rounding below its end become 0."""
    folded = np.mod(angle, period)
    return np.where(period - folded < TIE, 0.0, folded)
