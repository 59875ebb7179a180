"""Solved cells of the crank angle read between their nodes, at angles or times."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule, summed

__all__ = ["Curves", "Read"]

_MOST_NEWTON = 100  # steps; bisecting alone takes 53
_EXACT = 4e-16  # of a place: rounding


class Read(NamedTuple):
    """Cell, position in it from 0 to 1, time and energy, shape (n,) each."""

    cell: Index
    position: Array
    time: Array
    energy: Array


class Curves(NamedTuple):
    """Cells to be read: angle turned, time and energy at their edges, shape (m + 1,); series, shape
    (s + 1, 3, m), of energy and time gained since a cell's begin, and of its pace dt/dx."""

    edges: Array
    time: Array
    energy: Array
    series: Array

    @staticmethod
    def of(rule: Rule, at_edges: tuple[Array, Array, Array], along: tuple[Array, Array]) -> Curves:
        """Of cells with dE/dx and dt/dx at their nodes, shape (m, s) each."""
        push, pace = along
        to_value, to_integral = rule.to_series
        parts = to_integral @ push.T, to_integral @ pace.T, to_value @ pace.T
        return Curves(*at_edges, np.stack(parts, axis=1))

    def at_angles(self, turned: Array) -> Read:
        """At increasing angles turned since the beginning [rad]."""
        cell = _cells(self.edges, turned)
        begin = self.edges[cell]
        position = (turned - begin) / (self.edges[1:][cell] - begin)
        return Read(cell, position, *self.inside(cell, position))

    def at_times(self, time: Array) -> Read:
        """At increasing times [s]."""
        cell = _cells(self.time, time)
        begin = self.time[cell]
        position = self._inverted(cell, time - begin, self.time[1:][cell] - begin)
        return Read(cell, position, time, self.inside(cell, position)[1])

    def inside(self, cell: Index, position: Array) -> tuple[Array, Array]:
        """Time and energy at positions in cells."""
        gained, spent = summed(self.series[:, :2].take(cell, axis=2), position)
        return self.time[cell] + spent, self.energy[cell] + gained

    def _inverted(self, cell: Index, target: Array, whole: Array) -> Array:
        """Where the time since a cell's begin, which rises to ``whole`` at 1, is ``target``:
        Newton's method, bisecting where it leaves its bracket."""
        series = self.series[:, 1:].take(cell, axis=2)
        low, high = np.zeros_like(target), np.ones_like(target)
        x = np.clip(target / whole, 0.0, 1.0)
        for _ in range(_MOST_NEWTON):
            spent, pace = summed(series, x)
            excess = spent - target
            above = excess > 0.0
            low, high = np.where(above, low, x), np.where(above, x, high)
            new = x - excess / pace
            # nor back to an end: rounding would send it to and fro
            new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
            new = np.where(excess == 0.0, x, new)
            moved, x = np.abs(new - x) > _EXACT * high, new
            if not moved.any():
                break
        return x


def _cells(at_edges: Array, values: Array) -> Index:
    """The cells that values lie in; on an edge the one before it."""
    return np.minimum(np.searchsorted(at_edges[1:], values), len(at_edges) - 2)
