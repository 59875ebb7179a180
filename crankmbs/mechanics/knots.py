"""Angles at which a piecewise function passes from one piece to the next: knots."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["KNOT", "apart", "repeat"]

KNOT = 1e-9  # rad: an angle this close below a knot counts as on it, so rounding does not
# decide the side of a pressure step


def apart(knots: Array) -> Array:
    """Of knots [rad], shape (n,), those that are not one with another before them, sorted.

    >>> apart(np.array([2.0, 1.0, 1.0 + 1e-15]))
    array([1., 2.])
    """
    knots = np.sort(knots)
    return np.asarray(knots[np.append(True, knots[1:] - knots[:-1] > KNOT)[: len(knots)]])


def repeat(knots: Array, period: float, low: float, high: float) -> Array:
    """The knots of one period [rad], repeated over the open interval from ``low`` to ``high``.

    >>> repeat(np.array([1.0]), 2.0, 0.0, 6.0)
    array([1., 3., 5.])
    """
    if len(knots) == 0:
        return knots
    first = math.floor((low - float(knots.max())) / period)
    last = math.ceil((high - float(knots.min())) / period)
    tiled = (np.arange(first, last + 1)[:, None] * period + knots).ravel()
    return np.asarray(tiled[(tiled > low) & (tiled < high)])
