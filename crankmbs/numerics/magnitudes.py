"""Magnitudes of vectors of polynomials: where a magnitude is least its integral is split, and where
it is largest is its peak.

Polynomials are given by their values at places in the unit interval, first axis; each is a number
of its own, last axis: nothing depends on the others, not by rounding either.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import summed
from crankmbs.numerics.lagrange import Lagrange

__all__ = ["Tops", "impulses", "magnitudes", "size_of", "tops"]

_BENT = 1.2  # of what a vector changes by across a piece: where it is less it may have a bend
_DEEPEST = 18  # halvings of a cell
_SIGNS, _HEIGHTS = 4, 2  # places a node at which signs are seen, and where the largest may be
_STEPS = 4  # of Newton's method from there


class Tops(NamedTuple):
    """The largest magnitude of each group of polynomials: which of all it is, the place and the
    size; and how high all polynomials come, as far as it is seen."""

    which: Index
    place: Array
    size: Array
    heights: Array


def size_of(vectors: Array) -> Array:
    """Of vectors, shape (components, ...) -> (...).

    >>> size_of(np.array([[3.0], [4.0]]))
    array([5.])
    """
    if len(vectors) == 1:
        return np.asarray(np.abs(vectors[0]))
    return np.asarray(np.sqrt((vectors**2).sum(axis=0)))


def tops(polynomials: Lagrange, rows: Array, starts: Index) -> Tops:
    """The largest magnitudes of consecutive groups of vectors of polynomials.

    rows : shape (n, components, p); starts : of the groups, shape (g,)
    """
    n, _, p = rows.shape
    fine = np.linspace(0.0, 1.0, _HEIGHTS * n + 1)
    seen = size_of(np.einsum("xn,ncp->cxp", polynomials.basis(fine), rows)).T.copy()
    every, at = np.arange(p), np.argmax(seen, axis=1)
    high = seen[every, at]
    lower = seen[every, np.clip([at - 1, at + 1], 0, len(fine) - 1)].min(axis=0)
    group = np.repeat(np.arange(len(starts)), np.diff(starts, append=p))
    # a polynomial goes hardly farther beyond its values than they lie apart
    near = np.flatnonzero(~(2.0 * high - lower < np.maximum.reduceat(high, starts)[group]))
    high[near], place = _top(polynomials, rows[..., near], fine[at[near]])
    order = np.lexsort((high[near], group[near]))
    last = order[np.append(np.diff(group[near[order]]) != 0, True)]
    return Tops(near[last], place[last], high[near[last]], high)


def _top(polynomials: Lagrange, rows: Array, x: Array) -> tuple[Array, Array]:
    """Largest magnitudes of vectors near places, shape (p,), and where they are."""
    series, step = polynomials.series(rows, 2), 1.0 / (_HEIGHTS * len(rows))
    low, high = np.clip(x - step, 0.0, 1.0), np.clip(x + step, 0.0, 1.0)
    for _ in range(_STEPS):
        value, slope, bend = summed(series, x)
        rise, steep = (value * slope).sum(axis=0), (slope**2 + value * bend).sum(axis=0)
        move = np.divide(rise, steep, out=np.zeros_like(rise), where=steep < 0.0)
        x = np.clip(x - move, low, high)
    return size_of(summed(series[:, 0], x)), x


def impulses(polynomials: Lagrange, forces: Array, sizes: Array, density: Array) -> Array:
    """Integrals of the magnitudes of r vectors times a density over m unit intervals, shape (k, r).

    forces, sizes : at the places, shape (k, r, 2, m, n) and (k, r, m, n); density : (k, m, n)
    """
    over = density * polynomials.weights
    total = np.einsum("krms,kms->kr", sizes, over)
    least = np.minimum(sizes[..., 0], sizes[..., -1])
    apart = ((forces[..., -1] - forces[..., 0]) ** 2).sum(axis=2)
    case, row, cell = np.nonzero(least**2 < _BENT**2 * apart)
    if len(cell):
        rows = np.concatenate([forces[case, row, :, cell], density[case, cell][:, None]], axis=1)
        by_rule = (sizes[case, row, cell] * over[case, cell]).sum(axis=1)
        np.add.at(total, (case, row), magnitudes(polynomials, rows.T.copy()) - by_rule)
    return np.asarray(total)


def magnitudes(polynomials: Lagrange, rows: Array) -> Array:
    """Integrals over the unit interval of the magnitudes of vectors times a density, shape (p,).

    rows : two components and the density at the places, shape (n, 3, p)

    >>> z, weights = np.polynomial.legendre.leggauss(8)
    >>> line = Lagrange(0.5 + 0.5 * z, 0.5 * weights)
    >>> rows = np.stack([line.places - 0.25, 0.0 * z, np.ones(8)], axis=1)[..., None]
    >>> round(float(magnitudes(line, rows)[0]), 12)
    0.3125
    """
    total, single = np.empty(rows.shape[-1]), ~rows[:, 1].any(axis=0)
    total[single] = _split(polynomials, rows[:, ::2, single])
    total[~single] = _halved(polynomials, rows[..., ~single])
    return total


def _split(polynomials: Lagrange, rows: Array) -> Array:
    """Of a single component, between its zeros: there it is a polynomial; rows : that and the
    density."""
    fine = np.linspace(0.0, 1.0, _SIGNS * len(rows) + 1)
    positive = np.einsum("xs,sp->xp", polynomials.basis(fine), rows[:, 0]) > 0.0
    total = np.einsum("s,sp->p", polynomials.weights, np.abs(rows[:, 0]) * rows[:, 1])
    both = positive.any(axis=0) & ~positive.all(axis=0)
    if both.any():
        total[both] = _split_at_zeros(polynomials, rows[..., both], positive[:, both], fine)
    return np.asarray(total)


def _split_at_zeros(
    polynomials: Lagrange, rows: Array, positive: NDArray[np.bool_], fine: Array
) -> Array:
    """The same where the component is of either sign at close places."""
    count = rows.shape[-1]
    at, row = np.nonzero(positive[1:] != positive[:-1])
    series, every = polynomials.series(rows)[:, 0], np.arange(count)
    zeros = polynomials.inverse(rows[:, 0].T, row, np.zeros(len(row)), fine[at], fine[at + 1])
    row = np.concatenate([every, row, every])
    ends = np.concatenate([np.zeros(count), zeros, np.ones(count)])
    order = np.lexsort((ends, row))
    row, ends = row[order], ends[order]
    piece = np.flatnonzero(row[1:] == row[:-1])
    row, low, wide = row[piece], ends[piece], np.diff(ends)[piece]
    places = low + wide * polynomials.places[:, None]
    force, density = summed(series[:, :, None, row], places)
    pieces = np.einsum("s,sp->p", polynomials.weights, np.abs(force) * density)
    total = np.zeros(count)
    np.add.at(total, row, wide * pieces)
    return total


def _halved(polynomials: Lagrange, rows: Array) -> Array:
    """Of two components, in pieces halved until nothing bends in them; rows : these and the
    density."""
    total, row = np.zeros(rows.shape[-1]), np.arange(rows.shape[-1])
    for depth in range(_DEEPEST + 1):
        sizes = np.sqrt(rows[:, 0] ** 2 + rows[:, 1] ** 2)
        apart = ((rows[-1, :-1] - rows[0, :-1]) ** 2).sum(axis=0)
        bent = (sizes.min(axis=0) ** 2 < _BENT**2 * apart) & (depth < _DEEPEST)
        pieces = np.einsum("s,sp->p", polynomials.weights, sizes * rows[:, -1])
        np.add.at(total, row[~bent], (0.5**depth * pieces)[~bent])
        if not bent.any():
            break
        halves = np.einsum("hxs,scp->xchp", _halves(polynomials), rows[..., bent])
        rows, row = halves.reshape(*rows.shape[:2], -1), np.tile(row[bent], 2)
    return total


@cache
def _halves(polynomials: Lagrange) -> Array:
    """From values at the places of a cell to those at the places of either half."""
    return np.array([polynomials.basis(0.5 * (polynomials.places + side)) for side in (0.0, 1.0)])
