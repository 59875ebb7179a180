"""Roots: of a monotone function at many targets at once, and of one that may turn back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["first_above", "invert_monotone"]


_HALVES = 50  # to 1e-15 of the bracket


def invert_monotone(
    function: Callable[[Array], tuple[Array, Array]], target: Array, low: Array, high: Array
) -> Array:
    """Solve function(x) = target element by element: Newton, bisecting where it leaves its bracket.

    Parameters
    ----------
    function : returns value and slope at x, shape (n,) each; monotone on the bracket
    target, low, high : shape (n,); the solution lies between low and high, low < high

    Returns
    -------
    x : shape (n,), to the rounding of the function

    >>> float(invert_monotone(lambda x: (x * x, 2 * x), *map(np.atleast_1d, (2.0, 0.0, 2.0)))[0])
    1.414213562373095
    """
    low, high = low.copy(), high.copy()
    at_low, at_high = function(low)[0], function(high)[0]
    falling = at_high < at_low
    with np.errstate(divide="ignore", invalid="ignore"):
        x = low + (high - low) * np.clip(
            np.nan_to_num((target - at_low) / (at_high - at_low)), 0, 1
        )
        for _ in range(100):
            value, slope = function(x)
            excess = value - target
            above = (excess > 0) != falling
            high, low = np.where(above, x, high), np.where(above, low, x)
            new = x - excess / slope
            # nor back to an end: where rounding decides it would go to and fro for ever
            new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
            new = np.where(excess == 0.0, x, new)
            settled = np.abs(new - x) <= 4e-16 * np.maximum(np.abs(low), np.abs(high))
            x = new
            if settled.all():
                break
    return x


def first_above(
    function: Callable[[Array], tuple[Array, Array]], low: float, high: float
) -> float | None:
    """Where a function first rises above zero, also if it comes back before ``high``.

    Parameters
    ----------
    function : returns value and slope at x, shape (1,) each; without a turn, or with one, in the
        bracket; where it begins at zero it may go below first

    Returns
    -------
    x, or None where the function stays below

    >>> first_above(lambda x: (0.25 - (x - 1.0) ** 2, 2.0 - 2.0 * x), 0.0, 1.75)
    0.5
    """

    def at(x: float) -> tuple[float, float]:
        value, slope = function(np.array([x]))
        return float(value[0]), float(slope[0])

    top = high
    if at(high)[0] <= 0.0:
        left, right = low, high
        for _ in range(_HALVES):
            top = 0.5 * (left + right)
            value, slope = at(top)
            if value > 0.0:
                break
            if value + abs(slope) * (right - left) <= 0.0:
                return None
            left, right = (top, right) if slope > 0.0 else (left, top)
        else:
            return None
    if at(low)[0] >= 0.0:
        below = top
        for _ in range(_HALVES):
            below = 0.5 * (low + below)
            if at(below)[0] < 0.0:
                low = below
                break
        else:
            return low
    return float(invert_monotone(function, *map(np.atleast_1d, (0.0, low, top)))[0])
