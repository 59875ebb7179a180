"""Periods that begin and end inside of a cell, a place of its own in every case.

Over cells, such a period has what lies before the place in that cell's stead, and what lies behind
it, in the period before, as a cell more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule, summed
from crankmbs.numerics.lagrange import at_nodes, ends_and_nodes

__all__ = ["Cuts", "inside", "place_of"]

_STEPS = 5  # of Newton's method towards an end, in a cell in which the speed hardly changes


class Cuts(NamedTuple):
    """In which cells of m periods of k cases begin and end, at which places, 0 to 1; shape (k,)."""

    cell: Index
    place: Array

    def of(self, table: Array) -> Array:
        """What a table, shape (machines, ..., m, s), has in these cells, shape (k, ..., s).

        >>> cuts = Cuts(np.array([2, 0, 2]), np.zeros(3))
        >>> cuts.of(np.arange(6.0).reshape(1, 3, 2))[:, 1].tolist()
        [5.0, 1.0, 5.0]
        """
        machine = np.minimum(np.arange(len(self.cell)), len(table) - 1)
        return np.asarray(table[machine, ..., self.cell, :])

    def more(self, table: Array) -> Array:
        """A table with these cells behind, shape (k, ..., m + 1, s)."""
        whole = np.broadcast_to(table, (len(self.cell), *table.shape[1:]))
        return np.concatenate([whole, self.of(table)[..., None, :]], axis=-2)

    def ends(self, case: Index, cell: Index, m: int) -> tuple[Array, Array]:
        """From where to where in cells of cases, of m and one more, the period is."""
        low = np.where(cell == m, self.place[case], 0.0)
        return low, np.where(cell == self.cell[case], self.place[case], 1.0)

    def places(self, width: Array) -> tuple[Array, Array]:
        """Angles turned [rad] to where the cells begin, and their widths, shape (k, m + 1)."""
        m, case = width.shape[-1], np.arange(len(self.cell))[:, None]
        low, high = self.ends(case, np.arange(m + 1), m)
        before = np.cumsum(width, axis=1) - width
        begin, whole = (self.more(each[..., None])[..., 0] for each in (before, width))
        return begin + low * whole, (high - low) * whole

    def cut(self, values: Array) -> Array:
        """Values at the nodes of whole cells, shape (k, ..., m + 1, s), in those of which parts
        count at the nodes of these."""
        each, m, values = np.arange(len(values)), values.shape[-2] - 1, values.copy()
        for cell in (self.cell, np.full_like(self.cell, m)):
            whole = values[each, ..., cell, :]
            part = at_nodes(values.shape[-1]).part(whole.T, *self.ends(each, cell, m))
            values[each, ..., cell, :] = part.T
        return values


def inside(nodes: Array, begin: Array, end: Array, place: Array) -> Array:
    """Energies at places in cells, by those at nodes and ends."""
    rows = np.column_stack([begin, nodes, end]).T
    return summed(ends_and_nodes(nodes.shape[1]).series(rows)[:, 0], place)


def place_of(rule: Rule, slow: Array, left: Array) -> Array:
    """At which places in cells times are over, shape (k,); slow : time for the unit of length at
    the nodes, shape (k, s)."""
    place = left / np.einsum("ks,s->k", slow, rule.weights)
    slope, value = (np.einsum("ds,ks->dk", matrix, slow) for matrix in rule.to_series)
    for _ in range(_STEPS):
        place = place - (summed(value, place) - left) / summed(slope, place)
    return np.asarray(place)
