"""Knots at which a function changes its formula, and the numbered pieces between them."""

from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import Arithmetic, Array, Number


@dataclass(frozen=True)
class Grid:
    """Piece i lies between knot i and knot i + 1; without period the outer pieces are open."""

    knots: Array
    period: Number | None
    arithmetic: Arithmetic

    def knot(self, index: int) -> Number:
        """The knot of an index, also beyond the first period; infinite beyond both ends."""
        count = len(self.knots)
        if self.period is not None:
            return self.knots[index % count] + (index // count) * self.period
        if 0 <= index < count:
            return self.knots[index]
        return self.arithmetic.number("-inf" if index < 0 else "inf")

    def bounds(self, piece: int) -> tuple[Number, Number]:
        """The knots at both ends of a piece."""
        return self.knot(piece), self.knot(piece + 1)

    def inside(self, piece: int) -> Number:
        """A point inside the piece."""
        lower, upper = self.bounds(piece)
        if np.isinf(float(lower)) and np.isinf(float(upper)):
            return self.arithmetic.number(0)
        if np.isinf(float(lower)):
            return upper - 1
        return lower + 1 if np.isinf(float(upper)) else (lower + upper) / 2

    def pieces_at(self, value: Number) -> list[int]:
        """The piece that holds a value; on a knot the piece above it, then the one below."""
        turns = 0
        if self.period is not None:
            turns = int(np.floor(float((value - self.knots[0]) / self.period)))
            turns -= value < self.knot(turns * len(self.knots))
            turns += value >= self.knot((turns + 1) * len(self.knots))
        start = turns * len(self.knots) - (self.period is None)
        piece = start
        while piece < start + len(self.knots) and value >= self.knot(piece + 1):
            piece += 1
        return [piece, piece - 1] if value == self.knot(piece) else [piece]


def merge(values: list[Number], arithmetic: Arithmetic, period: Number | None = None) -> Grid:
    """The grid of the distinct values, reduced to one period if there is one."""
    if period is not None:
        period = arithmetic.number(period)
        values = [value % period for value in values]
    return Grid(arithmetic.array(sorted(set(values))), period, arithmetic)
