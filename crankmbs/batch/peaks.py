"""Largest sizes of curves over the angle: the cells in which they may lie, and the tops of the
polynomials through the nodes there."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import gauss, summed
from crankmbs.numerics.lagrange import Lagrange
from crankmbs.scene.units import DEGREE

__all__ = [
    "Curves",
    "Peaks",
    "Which",
    "find_peaks",
    "polynomials_of",
    "series_of",
    "sizes_at",
    "sparse_nodes",
]

_APART = 6.0 * DEGREE  # nodes at which it is seen where a curve may be largest
_MANY = 40_000  # sizes at once: so many stay in the processor's cache
_FINE = 2  # places a node at which polynomials are looked at
_STEPS = 3  # of Newton's method from the highest of them
_ROUNDING = 64 * float(np.finfo(float).eps)
_TAILS = (
    2.0  # times the last Legendre coefficient: what the polynomial of a cell misses at its ends
)


class Which(NamedTuple):
    """Some cells of some curves of some cases, shape (c,) each."""

    case: Index
    curve: Index
    cell: Index


class Curves(NamedTuple):
    """r curves of k cases, vectors that are polynomials in each of m cells.

    shape : k and r; alike : so many in a row are of one size, whose rounding is nothing to any
    sizes : of a case at some nodes, so near to one another that a curve goes hardly farther beyond
        the values there than neighbours lie apart, shape (r, n)
    cells : of these nodes, shape (n,)
    rows : values at all nodes of some cells, shape (c, components, s)
    always : cells of every case that are looked at besides, shape (k, any)
    """

    shape: tuple[int, int]
    alike: int
    sizes: Callable[[slice], Array]
    cells: Index
    rows: Callable[[Which], Array]
    always: Index | None = None


class Peaks(NamedTuple):
    """Of every curve its largest size, the cell and the place in it, 0 to 1, where that is, and by
    how much the polynomials may miss it, shape (k, r); no numbers of a curve without any."""

    size: Array
    cell: Index
    place: Array
    missed: Array


@cache
def polynomials_of(stages: int) -> Lagrange:
    """The polynomials through the nodes of a Gauss rule.

    >>> polynomials_of(2).basis(np.array([0.5]))
    array([[0.5, 0.5]])
    """
    rule = gauss(stages)
    return Lagrange(rule.nodes, rule.weights)


def sparse_nodes(width: Array, stages: int) -> Index:
    """Numbers of nodes that lie no more than some degrees apart, one or more of each cell; width :
    of the cells [rad], shape (m,).

    >>> sparse_nodes(np.array([0.01, 0.2]), 5)
    array([2, 5, 7, 9])
    """
    counts = np.ceil(width / _APART).astype(np.intp)
    chosen = np.zeros((int(counts.max()) + 1, stages), bool)
    chosen[:2, stages // 2] = True
    for count in range(2, len(chosen)):
        chosen[count, np.linspace(0, stages - 1, count + 1).astype(np.intp)] = True
    return np.flatnonzero(chosen[counts])


def find_peaks(curves: Curves) -> Peaks:
    """The largest sizes."""
    shape = curves.shape
    which = _candidates(curves)
    found = Peaks(*np.full((4, *shape), np.nan))._replace(cell=np.zeros(shape, np.intp))
    if len(which.cell) == 0:
        return found
    rows = curves.rows(which)
    group = which.case * shape[1] + which.curve
    starts = np.flatnonzero(np.append(True, np.diff(group) != 0))
    high, near, place = _coarse_tops(rows, starts, group)
    size, place = _top(rows[near], place)
    order = np.lexsort((size, group[near]))
    last = order[np.append(np.diff(group[near][order]) != 0, True)[: len(order)]]
    at = which.case[near][last], which.curve[near][last]
    tail = np.sqrt(((rows @ gauss(rows.shape[-1]).to_legendre[-1]) ** 2).sum(axis=1))
    high[near] = size
    beyond = np.maximum.reduceat(high + _TAILS * tail, starts)
    found.size[at], found.place[at] = size[last], place[last]
    found.cell[at] = which.cell[near][last]
    number = np.searchsorted(group[starts], group[near][last])
    found.missed[at] = beyond[number] - size[last]
    return found


def sizes_at(curves: Curves, peaks: Peaks) -> Array:
    """The sizes where the peaks of others are, shape (k, r)."""
    found = np.full(peaks.size.shape, np.nan)
    case, curve = np.nonzero(np.isfinite(peaks.size))
    if len(case):
        rows = curves.rows(Which(case, curve, peaks.cell[case, curve]))
        series = series_of(rows.swapaxes(0, 1))[:, 0]
        found[case, curve] = _size(summed(series, peaks.place[case, curve]))
    return found


def series_of(rows: Array, derivatives: int = 0) -> Array:
    """Chebyshev series of polynomials by their values at Gauss nodes, shape (..., s), and of so
    many derivatives: shape (s, 1 + derivatives, ...), as `crankmbs.numerics.collocation.summed`
    takes them."""
    s = rows.shape[-1]
    matrix = _to_series(s)[: 1 + derivatives].reshape(-1, s)
    found = (rows.reshape(-1, s) @ matrix.T).T.reshape(1 + derivatives, s, *rows.shape[:-1])
    return np.ascontiguousarray(found.swapaxes(0, 1))


@cache
def _to_series(stages: int) -> Array:
    """Of the polynomial and two derivatives, shape (3, s, s)."""
    matrices = [gauss(stages).to_series[0][:stages]]
    for _ in range(2):
        slopes = 2.0 * np.polynomial.chebyshev.chebder(matrices[-1])
        matrices.append(np.zeros((stages, stages)))
        matrices[-1][: stages - 1] = slopes[: stages - 1]
    return np.array(matrices)


def _candidates(curves: Curves) -> Which:
    """The cells in which a curve may be larger than at any node, case after case."""
    (k, r), n, found = curves.shape, len(curves.cells), []
    many = max(1, _MANY // (r * n))
    for first in range(0, k, many):
        sizes = curves.sizes(slice(first, first + many)).reshape(-1, n)
        every, top = np.arange(len(sizes)), np.argmax(sizes, axis=1)
        best = sizes[every, top]
        nothing = _ROUNDING * np.repeat(best[:: curves.alike], curves.alike)
        apart = np.abs(sizes[:, 1:] - sizes[:, :-1])
        sizes[:, 1:] += apart
        sizes[:, :-1] += apart
        sizes[:, [0, -1]] += apart[:, [0, -1]]
        may = sizes >= (best + nothing)[:, None]
        may[every, top] = np.isfinite(best)
        number, node = np.divmod(np.flatnonzero(may), n)
        found.append((first * r + number) * (n + 1) + curves.cells[node])
    if curves.always is not None:
        every = (np.arange(k)[:, None, None] * r + np.arange(r)[:, None]) * (n + 1)
        found.append((every + curves.always[:, None]).ravel())
    code = np.sort(np.concatenate(found))
    code = code[np.append(True, np.diff(code) != 0)[: len(code)]]
    case, of_case = np.divmod(code, r * (n + 1))
    return Which(case, *np.divmod(of_case, n + 1))


def _coarse_tops(rows: Array, starts: Index, group: Index) -> tuple[Array, Index, Array]:
    """How high polynomials are at close places; which of them may be the highest of their group,
    and where these are so."""
    s = rows.shape[-1]
    fine = np.linspace(0.0, 1.0, _FINE * s + 1)
    heights = (rows.reshape(-1, s) @ polynomials_of(s).basis(fine).T).reshape(*rows.shape[:2], -1)
    heights = _size(heights.swapaxes(0, 1))
    at, every = np.argmax(heights, axis=1), np.arange(len(rows))
    high = heights[every, at]
    lower = heights[every, np.clip([at - 1, at + 1], 0, len(fine) - 1)].min(axis=0)
    best = np.repeat(np.maximum.reduceat(high, starts), np.diff(starts, append=len(rows)))
    near = np.flatnonzero(2.0 * high - lower >= best)
    return high, near, fine[at[near]]


def _top(rows: Array, x: Array) -> tuple[Array, Array]:
    """The size of polynomial vectors where it is largest near places, and these; shape (c,)."""
    series, step = series_of(rows.swapaxes(0, 1), 2), 1.0 / (_FINE * rows.shape[-1])
    low, high = np.clip(x - step, 0.0, 1.0), np.clip(x + step, 0.0, 1.0)
    for _ in range(_STEPS):
        value, slope, bend = summed(series, x)
        rise, steep = (value * slope).sum(axis=0), (slope**2 + value * bend).sum(axis=0)
        move = np.divide(rise, steep, out=np.zeros_like(rise), where=steep < 0.0)
        x = np.clip(x - move, low, high)
    return _size(summed(series[:, 0], x)), x


def _size(vectors: Array) -> Array:
    """Of vectors, shape (components, c) -> (c,)."""
    if len(vectors) == 1:
        return np.asarray(np.abs(vectors[0]))
    return np.asarray(np.sqrt((vectors**2).sum(axis=0)))
