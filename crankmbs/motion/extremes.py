"""Least and largest speed between marks on the way."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples
from crankmbs.motion.cells import Cells
from crankmbs.motion.states import samples_at
from crankmbs.numerics.arrays import Array

__all__ = ["extremes"]

_ROUNDS = (
    2  # of the secant method; the error that it leaves is of second order in the speed's slope
)


def extremes(cells: Cells, train: CrankTrain, marks: Array, points: Samples) -> Array:
    """Least and largest speed [rad/s] between times [s], shape (n + 1, 2): of the values at points
    in the cells, and where the acceleration vanishes beside those that might be it."""
    time, speed = points.time, points.omega
    segment = np.searchsorted(marks, time)
    low, high = np.full((2, len(marks) + 1), np.nan)
    for into, least in ((low, np.fmin), (high, np.fmax)):
        least.at(into, segment, speed)
    before, after = speed[1:-1] - speed[:-2], speed[2:] - speed[1:-1]
    lift = np.maximum(np.abs(before), np.abs(after))
    of = segment[1:-1]
    may = (speed[1:-1] - lift < low[of]) | (speed[1:-1] + lift > high[of])
    k = 1 + np.flatnonzero((before * after < 0.0) & may)
    if len(k):
        a, b, c = (_moving(cells, train, time[at]) for at in (k - 1, k, k + 1))
        falls = b[1] * c[1] < 0.0
        a, c = (np.where(falls, one, other) for one, other in ((b, a), (c, b)))
        for _ in range(_ROUNDS):
            steep = np.where(c[1] != a[1], c[1] - a[1], np.inf)
            b = _moving(cells, train, np.clip(a[0] - a[1] * (c[0] - a[0]) / steep, a[0], c[0]))
            inside = np.searchsorted(marks, b[0])
            np.fmin.at(low, inside, b[2])
            np.fmax.at(high, inside, b[2])
            left = a[1] * b[1] < 0.0
            a, c = np.where(left, a, b), np.where(left, b, c)
    return np.column_stack([low, high])


def _moving(cells: Cells, train: CrankTrain, time: Array) -> Array:
    """Times [s], acceleration [rad/s2] and speed [rad/s] there, shape (3, n)."""
    found = samples_at(cells, train, time, in_time=True)
    return np.array([time, found.alpha, found.omega])
