"""Functions of one number that are a polynomial between every two of their knots."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.numerics.arrays import Array

__all__ = ["Piecewise", "total"]

Row = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Piecewise:
    """Parabolas on the whole line.

    knots : n numbers, strictly increasing; pieces : before, between and after them the n + 1
    parabolas, each by its coefficients of 1, x and x^2; jumps : the knots where the value jumps
    """

    knots: tuple[float, ...]
    pieces: tuple[Row, ...]
    jumps: tuple[float, ...] = ()

    @staticmethod
    def through(x: tuple[float, ...], y: tuple[float, ...]) -> Piecewise:
        """Straight lines through rows, the ends held; two rows at one abscissa are a jump.

        >>> Piecewise.through((0.0, 2.0), (1.0, 5.0))([-1.0, 1.0])
        array([1., 3.])
        """
        lines: list[Row] = [(y[0], 0.0, 0.0)]
        knots, jumps = [x[0]], []
        for k in range(1, len(x)):
            if x[k] == x[k - 1]:
                jumps += [x[k]] if y[k] != y[k - 1] else []
                continue
            slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
            lines.append((y[k] - slope * x[k], slope, 0.0))
            knots.append(x[k])
        return Piecewise(tuple(knots), (*lines, (y[-1], 0.0, 0.0)), tuple(jumps))

    def piece(self, x: float, *, after: bool) -> tuple[Row, float, float]:
        """The parabola at a number, and between which numbers it holds; on a knot that after it, or
        else that before."""
        k = (bisect_right if after else bisect_left)(self.knots, x)
        low = self.knots[k - 1] if k > 0 else -math.inf
        high = self.knots[k] if k < len(self.knots) else math.inf
        return self.pieces[k], low, high

    def __call__(self, x: ArrayLike) -> Array:
        """Values at numbers of any shape; on a jump that after it."""
        x = np.asarray(x, dtype=np.float64)
        if not self.knots:
            a, b, c = self.pieces[0]
            return np.asarray(a + (b + c * x) * x)
        return self.of_piece(x, x)

    def by_number(self, low: float = -math.inf, high: float = math.inf) -> Callable[[float], float]:
        """The same from number to number; below and above two ends on by the parabola inside.

        >>> Piecewise.through((0.0, 2.0), (1.0, 5.0)).by_number(0.0, 2.0)(3.0)
        7.0
        """
        knots, pieces, high = self.knots, self.pieces, math.nextafter(high, low)

        def value(x: float) -> float:
            a, b, c = pieces[bisect_right(knots, low if x < low else high if x > high else x)]
            return a + (b + c * x) * x

        return value

    def of_piece(self, at: Array, x: Array) -> Array:
        """Values at numbers by the parabolas that hold at others, of one shape."""
        knots, rows = self.arrays
        row = rows[np.searchsorted(knots, at, side="right")]
        return np.asarray(row[..., 0] + (row[..., 1] + row[..., 2] * x) * x)

    @cached_property
    def arrays(self) -> tuple[Array, Array]:
        """Knots and pieces."""
        return np.array(self.knots), np.array(self.pieces)

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """The knots where the value jumps or the second derivative changes."""
        knots, rows = self.arrays
        curved = set(knots[np.diff(rows[:, 2]) != 0.0].tolist())
        return tuple(sorted(curved.union(self.jumps)))

    @cached_property
    def bends(self) -> tuple[float, ...]:
        """The knots where the value jumps or the slope changes."""
        knots, rows = self.arrays
        _, slope, square = np.diff(rows, axis=0).T
        bent = set(knots[slope + 2.0 * square * knots != 0.0].tolist())
        return tuple(sorted(bent.union(self.jumps)))

    @cached_property
    def largest(self) -> float:
        """The largest value, without its sign, at the knots; without any, at 0."""
        at = self.arrays[0] if self.knots else np.zeros(1)
        before = self.of_piece(np.nextafter(at, -math.inf), at)
        return float(np.max(np.abs([self(at), before])))

    @cached_property
    def is_constant(self) -> bool:
        """Whether every piece is, though they may differ."""
        return not self.arrays[1][:, 1:].any()


def total(functions: list[Piecewise], low: float, high: float) -> tuple[Array, Array]:
    """Sum of functions in a range: knots inside it, and the parabolas before, between and after
    them, shape (n,) and (n + 1, 3)."""
    inside = {k for function in functions for k in function.knots if low < k < high}
    knots = np.array(sorted(inside))
    if len(knots):
        middle = 0.5 * (knots[1:] + knots[:-1])
        first, last = max(low, knots[0] - 1.0), min(high, knots[-1] + 1.0)
        at = np.concatenate([[0.5 * (first + knots[0])], middle, [0.5 * (last + knots[-1])]])
    else:
        at = np.array([0.5 * (max(low, min(high, 0.0) - 1.0) + min(high, max(low, 0.0) + 1.0))])
    pieces = np.zeros((len(at), 3))
    for function in functions:
        ends, rows = function.arrays
        pieces += rows[np.searchsorted(ends, at)]
    return knots, pieces
