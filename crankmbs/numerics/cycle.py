"""Periodic functions of an angle that are a cubic between every two of their knots."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.numerics.arrays import Array, Index

__all__ = ["NEAR", "Cycle", "Periodic", "common_period", "summed", "tiled"]

NEAR = 1e-9  # rad: an angle this close below a knot counts as on it, or rounding decides the side


class Periodic(Protocol):
    """A periodic function of an angle, smooth between its knots.

    knots : shape (n + 1,) [rad], increasing, the last one period above the first
    """

    @property
    def knots(self) -> Array:
        """Its knots."""

    @property
    def period(self) -> float:
        """Period [rad]."""

    @property
    def largest(self) -> float:
        """About its largest value, without its sign."""

    def __call__(self, angle: ArrayLike) -> Array:
        """Values at angles [rad] of any shape; on a jump that after it."""


@dataclass(frozen=True, eq=False)
class Cycle:
    """Cubics, periodic.

    knots : shape (n + 1,) [rad], increasing, the last one period above the first
    coefficients : shape (4, n), by descending power of (angle - knots[i]) in rad
    """

    knots: Array
    coefficients: Array

    @property
    def period(self) -> float:
        """Period [rad]."""
        return float(self.knots[-1] - self.knots[0])

    def __call__(self, angle: ArrayLike) -> Array:
        """Values at angles [rad] of any shape; on a jump that after it.

        >>> Cycle(np.array([0.0, 1.0]), np.array([[0.0], [0.0], [2.0], [5.0]]))([0.5, 3.25])
        array([6. , 5.5])
        """
        first, period, starts = self._layout
        behind = np.asarray(angle, dtype=np.float64) - (first - NEAR)
        behind = behind - period * np.floor(behind / period)
        index = starts[1:].searchsorted(behind, side="right")
        return self.piece(index, behind - NEAR - starts.take(index))

    @cached_property
    def _layout(self) -> tuple[float, float, Array]:
        """First knot, period, and the first knot of each piece behind that one [rad]."""
        return float(self.knots[0]), self.period, self.knots[:-1] - self.knots[0]

    def piece(self, index: Index, distance: ArrayLike) -> Array:
        """Value of the pieces ``index`` at ``distance`` [rad] behind their first knot."""
        x = np.asarray(distance, dtype=np.float64)
        a, b, c, d = (power.take(index) for power in self.coefficients)
        return np.asarray(((a * x + b) * x + c) * x + d)

    def cubics(self, knots: Array) -> Array:
        """The coefficients between knots of another set [rad], in each of which lies one piece."""
        first, period, starts = self._layout
        middle = 0.5 * (knots[:-1] + knots[1:])
        within = np.mod(middle - first, period)
        index = starts[1:].searchsorted(within, side="right")
        x = within - starts[index] - (middle - knots[:-1])
        a, b, c, d = self.coefficients[:, index]
        slope, square = c + (2.0 * b + 3.0 * a * x) * x, b + 3.0 * a * x
        return np.array([a, square, slope, d + (c + (b + a * x) * x) * x])

    def by_number(self, low: float = -math.inf, high: float = math.inf) -> Callable[[float], float]:
        """The same from number to number [rad], fifty times faster for one; below and above two
        ends on by the cubic inside.

        >>> Cycle(np.array([0.0, 1.0]), np.array([[0.0], [0.0], [2.0], [5.0]])).by_number()(3.25)
        5.5
        """
        first, period = float(self.knots[0]) - NEAR, self.period
        (starts, pieces), low, high = self._numbers, float(low), float(high) - 2.0 * NEAR

        def value(angle: float) -> float:
            inside = low if angle < low else high if angle > high else angle
            x = (inside - first) % period
            k = bisect_right(starts, x) - 1
            a, b, c, d = pieces[k]
            x += angle - inside - starts[k] - NEAR
            return ((a * x + b) * x + c) * x + d

        return value

    @cached_property
    def _numbers(self) -> tuple[list[float], list[list[float]]]:
        """Where its pieces start above the first knot [rad], and their coefficients."""
        return self._layout[2].tolist(), self.coefficients.T.tolist()

    @cached_property
    def largest(self) -> float:
        """The largest value, without its sign, at the knots."""
        ends = self.piece(np.arange(len(self.knots) - 1), np.diff(self.knots))
        return float(np.max(np.abs([self.coefficients[3], ends])))


def summed(cycles: list[Cycle], period: float) -> Cycle | None:
    """The sum over a common period [rad], from angle 0 on; None of none."""
    if not cycles:
        return None
    inside = [tiled(cycle.knots[:-1], cycle.period, period) for cycle in cycles]
    knots = np.unique(np.concatenate([[0.0], *inside]))
    knots = knots[np.append(True, np.diff(knots) > NEAR) & (knots < period - NEAR)]
    knots = np.append(knots, period)
    return Cycle(knots, np.sum([cycle.cubics(knots) for cycle in cycles], axis=0))


def common_period(periods: Iterable[float]) -> float:
    """Least common multiple of periods that are multiples of half a revolution [rad].

    >>> round(common_period([4.0 * math.pi, 3.0 * math.pi]) / math.pi)
    12
    """
    return math.lcm(*(round(period / math.pi) for period in periods)) * math.pi


def tiled(knots: Array, part: float, period: float) -> Array:
    """Knots that come again after a part of a period, all of those in [0, period) [rad].

    >>> tiled(np.array([1.0, -0.5]), 2.0, 4.0)
    array([1. , 3.5, 3. , 1.5])
    """
    turns = part * np.arange(round(period / part))[:, None]
    return np.asarray(np.mod(turns + knots, period).ravel())
