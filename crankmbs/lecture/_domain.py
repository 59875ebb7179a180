"""What the formulas take, and what they refuse."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crankmbs.errors import InputError

Real = float | NDArray[np.float64]


def require(holds: ArrayLike, what: str, rule: str, value: Real, way_out: str) -> None:
    """Raise InputError unless the rule holds for every entry; name the first that breaks it."""
    satisfied = np.asarray(holds, dtype=bool)
    if not satisfied.all():
        wrong = np.broadcast_to(value, satisfied.shape)[~satisfied][0]
        raise InputError(f"{what}: {rule}, got {wrong:.6g}; {way_out}")


def series_ratio(crank_radius: Real, rod_length: Real) -> Real:
    """Rod ratio lambda = r/l of a truncated series, refused from 1 on: the series diverges."""
    return converging(crank_radius / rod_length)


def converging(ratio: Real) -> Real:
    """Hand back the rod ratio if a series in it converges."""
    require(
        (ratio >= 0.0) & (ratio < 1.0),
        "rod ratio crank_radius / rod_length",
        "must be at least 0 and below 1",
        ratio,
        "take a rod longer than the crank radius",
    )
    return ratio


def require_turning(crank_radius: Real, rod_length: Real, offset: Real) -> None:
    """Refuse a rod too short for the crank to turn all the way round."""
    require(
        rod_length >= crank_radius + np.abs(offset),
        "rod_length",
        "must be at least crank_radius + |offset|, or the crank cannot turn round",
        rod_length,
        "take a longer rod or a smaller offset",
    )


def falling_root(function: Callable[[Real], Real], above: Real, below: Real) -> Real:
    """Bisect for the root between `above`, where the function is positive, and `below`."""
    for _ in range(60):  # pi / 2**60 is far below the spacing of floats near pi
        middle = 0.5 * (above + below)
        positive = function(middle) > 0.0
        above, below = np.where(positive, middle, above), np.where(positive, below, middle)
    return 0.5 * (above + below)
