"""Loops over samples, compiled by numba (`crankmbs.numerics.kernels`): what the samples make of
tables over one period."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

__all__ = ["apart", "together"]

Motion = tuple[Array, Array, Array]  # omega^2, alpha and omega


@kernel
def together(
    parts: Array, swift: NDArray[np.bool_], which: Index, motion: Motion, room: Array
) -> None:
    """Variables, shape (rows, n), from their parts (`reactions`), shape (rows, 3, angles), at the
    angles ``which``, in their places; those of ``swift`` rows times the speed."""
    square, alpha, omega = motion
    for row in range(len(parts)):
        part, variable = parts[row], room[row]
        for i in range(len(which)):
            k = which[i]
            variable[i] = part[0, k] * square[i] + part[1, k] * alpha[i] + part[2, k]
        if swift[row]:
            for i in range(len(which)):
                variable[i] *= omega[i]


@kernel
def apart(
    parts: Array,
    swift: NDArray[np.bool_],
    which: Index,
    motion: Motion,
    given: tuple[Array, Array],
) -> None:
    """Fill for each row the largest absolute difference of a variable from what `together` makes
    of parts; NaN where one is.

    given : the variables, and the room for what is filled
    """
    (square, alpha, omega), (variables, largest) = motion, given
    for row in range(len(parts)):
        part, variable, fast = parts[row], variables[row], swift[row]
        most = total = 0.0
        for i in range(len(which)):
            k = which[i]
            here = part[0, k] * square[i] + part[1, k] * alpha[i] + part[2, k]
            if fast:
                here *= omega[i]
            here -= variable[i]
            most, total = max(most, abs(here)), total + here
        largest[row] = most if total == total else math.nan
