"""The largest sample of a quantity, and how far the quantity may rise above it between samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["rise"]

Array = NDArray[np.float64]

_T = np.linspace(-0.25, 1.25, 601)  # across one interval, and a little on either side
_JUMP = 10.0  # a difference so many times its neighbour is a jump
_INSIDE = (_T >= 0.0) & (_T <= 1.0)


def rise(values: Array, at: int) -> float:
    """How far a quantity may go above its sample ``at``, the largest, before the next samples.

    Parabolas through the three samples on either side of an interval are continued into it. Where
    they agree the quantity is smooth, where they cross it has a kink there, and the lower one
    counts; where they miss one another it jumps, and the higher one counts, because the jump may
    be anywhere. A jump between the two farther of three samples leaves a line through the nearer.

    Parameters
    ----------
    values : shape (n,) [unit]; evenly spaced samples

    Returns
    -------
    float [unit], at least 0; third order in the spacing where smooth
    """
    mirrored = values[::-1]
    return max(0.0, _beyond(values, at), _beyond(mirrored, len(values) - 1 - at))


def _beyond(values: Array, at: int) -> float:
    """The highest value between the samples ``at`` and ``at + 1``, less that at ``at``."""
    before, after = values[max(at - 2, 0) : at + 1], values[at + 1 : at + 4]
    if len(after) == 0:
        return 0.0
    curves = [
        _continued(np.array(place), samples)
        for place, samples in (([0, -1, -2], before[::-1]), ([1, 2, 3], after))
        if len(samples) == 3
    ]
    if not curves:
        return 0.0
    gap = curves[0] - curves[-1]
    crossing = gap.min() <= 0.0 <= gap.max()
    curve = (np.minimum if crossing else np.maximum)(curves[0], curves[-1])
    return float(curve[_INSIDE].max() - values[at])


def _continued(place: Array, samples: Array) -> Array:
    """The parabola through three samples, nearest first, or the line through the nearer two."""
    near, far = np.abs(np.diff(samples))
    smooth = 3 if far <= _JUMP * near else 2
    return np.asarray(
        np.polynomial.Polynomial.fit(place[:smooth], samples[:smooth], smooth - 1)(_T)
    )
