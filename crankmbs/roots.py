"""One root finder for all inversions: a monotone function, solved at many targets at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["invert_monotone"]

Array = NDArray[np.float64]


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
            new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
            new = np.where(excess == 0.0, x, new)
            settled = np.abs(new - x) <= 4e-16 * np.maximum(np.abs(low), np.abs(high))
            x = new
            if settled.all():
                break
    return x
