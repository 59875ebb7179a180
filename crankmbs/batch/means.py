"""Integrals over time of the magnitudes of forces, which bend where they come near zero: there a
cell is split where a single component passes zero, else halved until nothing bends."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.peaks import polynomials_of, series_of
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import gauss, summed

__all__ = ["impulses", "magnitudes"]

_BENT = 0.6  # of what a force changes by across a piece: where it is less it has a bend, or nearly
_NEAR = 2.0  # the same at the ends of a cell: where it is less inside it may be
_DEEPEST = 16  # halvings of a cell
_FINE, _STEPS = 4, 4  # places a node at which signs are seen; of Newton's method towards a zero


def impulses(forces: Array, sizes: Array, spent: Array, pairs: int) -> Array:
    """Those of r forces in all cells, shape (k, r).

    forces, sizes : at the nodes, shape (k, r, 2, m, s) and (k, r, m, s); only the first ``pairs``
        have a second component
    spent : time for the unit of length of a cell, shape (k, m, s) [s]
    """
    over = spent * polynomials_of(sizes.shape[-1]).weights
    total = np.einsum("krms,kms->kr", sizes, over)
    across = ((forces[..., -1] - forces[..., 0]) ** 2).sum(axis=2)
    near = np.minimum(sizes[..., 0], sizes[..., -1]) ** 2 < _NEAR**2 * across
    for first, beyond, components in ((0, pairs, 2), (pairs, len(sizes[0]), 1)):
        case, row, cell = np.nonzero(near[:, first:beyond])
        row += first
        if len(cell):
            rows = forces[case, row, :components, cell]
            by_rule = (sizes[case, row, cell] * over[case, cell]).sum(axis=1)
            np.add.at(total, (case, row), magnitudes(rows, spent[case, cell]) - by_rule)
    return np.asarray(total)


def magnitudes(forces: Array, density: Array) -> Array:
    """Integrals over the unit interval of the magnitudes of forces times a density, shape (c,).

    forces, density : polynomials by their values at Gauss nodes, shape (c, 1 or 2, s) and (c, s)

    >>> nodes = polynomials_of(8).places
    >>> round(float(magnitudes(nodes[None, None] - 0.25, np.ones((1, 8)))[0]), 12)
    0.3125
    """
    rows = np.concatenate([forces, density[:, None]], axis=1)
    return _split(rows) if forces.shape[1] == 1 else _halved(rows)


def _split(rows: Array) -> Array:
    """Of a single component, between its zeros; rows : that and the density."""
    rule, s = gauss(rows.shape[-1]), rows.shape[-1]
    fine = np.linspace(0.0, 1.0, _FINE * s + 1)
    positive = rows[:, 0] @ polynomials_of(s).basis(fine).T > 0.0
    found = (np.abs(rows[:, 0]) * rows[:, 1] * rule.weights).sum(axis=1)
    both = positive.any(axis=1) & ~positive.all(axis=1)
    if both.any():
        found[both] = _split_at_zeros(rows[both], positive[both], fine)
    return np.asarray(found)


def _split_at_zeros(rows: Array, positive: NDArray[np.bool_], fine: Array) -> Array:
    """The same where the component is of either sign at close places."""
    count, _, s = rows.shape
    rule, (row, at) = gauss(s), np.nonzero(positive[:, 1:] != positive[:, :-1])
    zeros = _zeros(rows[row, 0], fine[at], fine[at + 1])
    every = np.arange(count)
    row = np.concatenate([every, row, every])
    ends = np.concatenate([np.zeros(count), zeros, np.ones(count)])
    order = np.lexsort((ends, row))
    row, ends = row[order], ends[order]
    piece = np.flatnonzero(row[1:] == row[:-1])
    row, low, wide = row[piece], ends[piece], np.diff(ends)[piece]
    places = low + wide * rule.nodes[:, None]
    series = series_of(rows.swapaxes(0, 1))[:, 0]
    force, density = summed(series[:, :, None, row], places)
    found = np.zeros(count)
    np.add.at(found, row, wide * (rule.weights @ (np.abs(force) * density)))
    return found


def _zeros(rows: Array, low: Array, high: Array) -> Array:
    """The zeros of polynomials between places where their signs differ, shape (c,)."""
    series, x = series_of(rows, 1), 0.5 * (low + high)
    for _ in range(_STEPS):
        value, slope = summed(series, x)
        move = np.divide(value, slope, out=np.zeros_like(value), where=slope != 0.0)
        x = np.clip(x - move, low, high)
    return x


def _halved(rows: Array) -> Array:
    """Of two components; rows : these and the density."""
    s = rows.shape[-1]
    found, row = np.zeros(len(rows)), np.arange(len(rows))
    for depth in range(_DEEPEST + 1):
        size = np.sqrt((rows[:, :-1] ** 2).sum(axis=1))
        across = ((rows[:, :-1, -1] - rows[:, :-1, 0]) ** 2).sum(axis=1)
        bent = (size.min(axis=1) ** 2 < _BENT**2 * across) & (depth < _DEEPEST)
        pieces = (size[~bent] * rows[~bent, -1] * polynomials_of(s).weights).sum(axis=1)
        np.add.at(found, row[~bent], 0.5**depth * pieces)
        if not bent.any():
            break
        rows = np.concatenate([rows[bent] @ half.T for half in _halves(s)])
        row = np.tile(row[bent], 2)
    return found


@cache
def _halves(stages: int) -> tuple[Array, Array]:
    """From values at the nodes of a cell to those at the nodes of either half."""
    polynomials = polynomials_of(stages)
    low, high = (polynomials.basis(0.5 * (polynomials.places + side)) for side in (0.0, 1.0))
    return low, high
