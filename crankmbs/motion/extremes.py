"""Least and largest speed between marks on the way."""

from __future__ import annotations

import numpy as np

from crankmbs.motion.base import Solved
from crankmbs.motion.plan import Chosen
from crankmbs.numerics.arrays import Array

__all__ = ["extremes"]

_ROUNDS = (
    2  # of the secant method; the error that it leaves is of second order in the speed's slope
)


def extremes(piece: Solved, marks: Array, time: Array, speed: Array) -> Array:
    """Least and largest speed [rad/s] between marks, shape (n + 1, 2): of the values at increasing
    times, and where the acceleration vanishes beside those that might be it."""
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
        a, b, c = (_moving(piece, time[at]) for at in (k - 1, k, k + 1))
        falls = b[1] * c[1] < 0.0
        a, c = (np.where(falls, one, other) for one, other in ((b, a), (c, b)))
        for _ in range(_ROUNDS):
            steep = np.where(c[1] != a[1], c[1] - a[1], np.inf)
            b = _moving(piece, np.clip(a[0] - a[1] * (c[0] - a[0]) / steep, a[0], c[0]))
            inside = np.searchsorted(marks, b[0])
            np.fmin.at(low, inside, b[2])
            np.fmax.at(high, inside, b[2])
            left = a[1] * b[1] < 0.0
            a, c = np.where(left, a, b), np.where(left, b, c)
    return np.column_stack([low, high])


def _moving(piece: Solved, time: Array) -> Array:
    """Times [s] in any order, acceleration [rad/s2] and speed [rad/s] there, shape (3, n)."""
    order = np.argsort(time)
    found = piece.sample(Chosen(time[order], in_time=True))
    rows = np.empty((3, len(time)))
    rows[:, order] = time[order], found.alpha, found.omega
    return rows
