"""Loops over samples, compiled by numba (`crankmbs.numerics.kernels`): what the samples make of
tables over one period."""

from __future__ import annotations

import math

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

__all__ = ["apart", "together"]


@kernel
def together(parts: Array, which: Index, square: Array, alpha: Array, room: Array) -> None:
    """Variables, shape (rows, n), from their parts (`reactions`), shape (rows, 3, angles), at the
    angles ``which``, in their places."""
    for row in range(len(parts)):
        part, variable = parts[row], room[row]
        for i in range(len(which)):
            k = which[i]
            variable[i] = part[0, k] * square[i] + part[1, k] * alpha[i] + part[2, k]


@kernel
def apart(parts: Array, which: Index, square: Array, alpha: Array, variable: Array) -> float:
    """Largest absolute difference of a variable from what `together` makes of parts; NaN where
    one is."""
    most = total = 0.0
    for i in range(len(which)):
        k = which[i]
        here = parts[0, k] * square[i] + parts[1, k] * alpha[i] + parts[2, k] - variable[i]
        most, total = max(most, abs(here)), total + here
    return most if total == total else math.nan
