"""How large a curve is over a stretch of a run: its maximum, where that is, and its RMS."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["Size", "percent", "size_of", "within"]


_TIE = 1e-9  # relative: the same peak in two revolutions differs by rounding; the first counts


class Size(NamedTuple):
    """largest, rms [unit of the curve]; angle [rad], within one period, and index, of the sample
    with the largest.

    The RMS is taken over the crank angle.
    """

    largest: float
    rms: float
    angle: float
    sample: int


def size_of(curve: Array, angle: Array, period: float) -> Size:
    """Measure a curve over angles, both of shape (n,), [unit] and [rad]."""
    size = np.abs(curve)
    largest = float(np.max(size))
    angles_within = within(angle, period)
    ties = np.flatnonzero(size >= largest * (1.0 - _TIE))
    sample = int(ties[np.argmin(angles_within[ties])])
    widths = np.abs(np.diff(angle))
    turned = float(np.sum(widths))
    scaled = (size / largest) ** 2 if largest > 0.0 else size  # no overflow, no underflow
    if turned > 0.0:
        mean = float(np.sum(widths * (scaled[1:] + scaled[:-1]))) / (2.0 * turned)
    else:
        mean = float(np.mean(scaled))
    return Size(largest, largest * math.sqrt(mean), float(angles_within[sample]), sample)


def percent(part: float, peak: float) -> float:
    """``part`` in percent of ``peak``; NaN where the peak is zero."""
    return 100.0 * part / peak if peak > 0.0 else math.nan


def within(angle: Array, period: float) -> Array:
    """Angles modulo one period; those a rounding below its end become 0."""
    folded = np.mod(angle, period)
    return np.where(period - folded < _TIE, 0.0, folded)
