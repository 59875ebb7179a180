"""Largest sizes of curves over the angle: the cells in which they may lie, and the tops of the
polynomials through the nodes there."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import gauss, summed
from crankmbs.numerics.lagrange import at_nodes
from crankmbs.numerics.magnitudes import size_of, tops
from crankmbs.scene.units import DEGREE

__all__ = ["Curves", "Peaks", "Which", "find_peaks", "sizes_at", "sparse_nodes"]

_APART = 6.0 * DEGREE  # nodes at which it is seen where a curve may be largest
_MANY = 40_000  # sizes at once: so many stay in the processor's cache
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
    sizes : of some cases at some nodes, so near to one another that a curve goes hardly farther
        beyond the values there than neighbours lie apart, shape (n, cases, r)
    cells : of these nodes, shape (n,)
    rows : values at all nodes of some cells, shape (s, components, c)
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


def sparse_nodes(width: Array, stages: int, jumps: NDArray[np.bool_]) -> Index:
    """Numbers of nodes that lie no more than some degrees apart, one or more of each cell; three or
    more where curves jump at an end of it, as its neighbours do not tell how they go there.

    width : of the cells [rad], jumps : which are beside a jump, shape (m,) each

    >>> sparse_nodes(np.array([0.01, 0.01, 0.2]), 5, np.array([False, True, False]))
    array([ 2,  5,  7,  9, 10, 12, 14])
    """
    counts = np.maximum(np.ceil(width / _APART).astype(np.intp), 2 * jumps)
    chosen = np.zeros((int(counts.max()) + 1, stages), bool)
    chosen[:2, stages // 2] = True
    for count in range(2, len(chosen)):
        chosen[count, np.linspace(0, stages - 1, count + 1).astype(np.intp)] = True
    return np.flatnonzero(chosen[counts])


def find_peaks(curves: Curves) -> Peaks:
    """The largest sizes."""
    which = _candidates(curves)
    size, place, missed = np.full((3, *curves.shape), np.nan)
    peaks = Peaks(size, np.zeros(curves.shape, np.intp), place, missed)
    if len(which.cell) == 0:
        return peaks
    rows = curves.rows(which)
    group = which.case * curves.shape[1] + which.curve
    starts = np.flatnonzero(np.append(True, np.diff(group) != 0))
    best = tops(at_nodes(len(rows)), rows, starts)
    tail = size_of(np.einsum("s,scp->cp", gauss(len(rows)).to_legendre[-1], rows))
    beyond = np.maximum.reduceat(best.heights + _TAILS * tail, starts) - best.size
    some = np.isfinite(best.size)
    at = which.case[starts][some], which.curve[starts][some]
    size[at], place[at], missed[at] = (each[some] for each in (best.size, best.place, beyond))
    peaks.cell[at] = which.cell[best.which][some]
    return peaks


def sizes_at(curves: Curves, peaks: Peaks) -> Array:
    """The sizes where the peaks of others are, shape (k, r)."""
    sizes = np.full(peaks.size.shape, np.nan)
    case, curve = np.nonzero(np.isfinite(peaks.size))
    if len(case):
        rows = curves.rows(Which(case, curve, peaks.cell[case, curve]))
        series = at_nodes(len(rows)).series(rows)[:, 0]
        sizes[case, curve] = size_of(summed(series, peaks.place[case, curve]))
    return sizes


def _candidates(curves: Curves) -> Which:
    """The cells in which a curve may be larger than at any node, case after case."""
    (k, r), n, codes = curves.shape, len(curves.cells), []
    many = max(1, _MANY // (r * n))
    for first in range(0, k, many):
        sizes = curves.sizes(slice(first, first + many))
        best = sizes.max(axis=0)
        nothing = _ROUNDING * np.repeat(best[:, :: curves.alike], curves.alike, axis=1)
        apart = np.abs(sizes[1:] - sizes[:-1])
        may = sizes == best
        sizes[1:] += apart
        sizes[:-1] += apart
        sizes[[0, -1]] += apart[[0, -1]]
        may |= sizes >= best + nothing
        node, number = np.divmod(np.flatnonzero(may), best.size)
        codes.append((first * r + number) * (n + 1) + curves.cells[node])
    if curves.always is not None:
        every = (np.arange(k)[:, None, None] * r + np.arange(r)[:, None]) * (n + 1)
        codes.append((every + curves.always[:, None]).ravel())
    code = np.sort(np.concatenate(codes))
    code = code[np.append(True, np.diff(code) != 0)[: len(code)]]
    case, of_case = np.divmod(code, r * (n + 1))
    return Which(case, *np.divmod(of_case, n + 1))
