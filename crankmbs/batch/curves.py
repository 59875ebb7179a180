"""Curves over the angle turned as the walk takes them (`crankmbs.batch.walk`): at the nodes, and in
straight lines over cells and blocks of cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import DEGREE

__all__ = ["WIDEST", "Curves", "Grid", "curves_of", "cut", "grid_of", "twins"]

WIDEST = 12.0 * DEGREE
"""Of a cell, and of a block of cells."""

_SLIVER = 1e-9  # rad: what rounding may add to it

Curves = tuple[Array, Array, Array, Array]
"""A and B, C and D, of `crankmbs.batch.walk.walk`, and both in straight lines."""

Grid = tuple[Array, NDArray[np.intp], Array]
"""Where the nodes of a period are: edges of the m cells, angle turned to there [rad], shape (m +
1,); the first cell of every block of cells, and m; and of the s nodes of a cell, shape (8, s):
places, 0 to 1; barycentric weights; what makes of the values there those at both ends of the cell,
and the slopes there; and how far a parabola may rise above a node: parts of what both neighbours
lie below it."""


def grid_of(width: Array, nodes: Array, barycentric: Array) -> Grid:
    """Of cells of those widths [rad], whose nodes lie there, from 0 to 1."""
    gauss = np.empty((8, len(nodes)))
    gauss[0], gauss[1] = nodes, barycentric
    for side in (0, 1):
        inverse = 1.0 / (side - nodes)
        gauss[2 + side] = barycentric * inverse / np.sum(barycentric * inverse)
        gauss[4 + side] = gauss[2 + side] * (np.sum(inverse) - inverse)
    gaps = np.diff(nodes, prepend=0.0, append=1.0)
    gauss[6] = 1.0 + 0.25 * gaps[1:] / gaps[:-1]
    gauss[7] = 1.0 + 0.25 * gaps[:-1] / gaps[1:]
    return np.append(0.0, np.cumsum(width)), _blocks(width), gauss


def curves_of(of: Array, rest: Array, grid: Grid) -> Curves:
    """With their straight lines."""
    return of, rest, _lines(of, grid), _lines(rest, grid)


def twins(rest: Array) -> NDArray[np.intp]:
    """For every curve of a quantity the number of the first one that is the same: what two lectures
    say in the same way is sought once. rest : their C and D, shape (q, 1 + lectures, 2, n)."""
    found = np.zeros(rest.shape[:2], dtype=np.intp)
    for q, of in enumerate(rest):
        for k in range(1, len(of)):
            found[q, k] = next(j for j in range(1, k + 1) if j == k or np.array_equal(of[j], of[k]))
    return found


def cut(table: Array, shape: tuple[int, ...], cell: int, parts: Array) -> Array:
    """A table over the n = m s nodes, shape (..., n), cut as `Pass.cut` of tables
    says."""
    whole = table.reshape(*table.shape[:-1], *shape)
    before, after = (whole[..., cell : cell + 1, :] @ part.T for part in parts)
    pieces = [after, whole[..., cell + 1 :, :], whole[..., :cell, :], before]
    return np.concatenate(pieces, axis=-2).reshape(*table.shape[:-1], -1)


def _blocks(width: Array) -> NDArray[np.intp]:
    """The first of the cells that together are no wider than the widest, and how many cells there
    are."""
    starts, begin = [0], 0.0
    for cell, end in enumerate(np.cumsum(width)):
        if end - begin > WIDEST + _SLIVER and cell > starts[-1]:
            starts, begin = [*starts, cell], end - width[cell]
    return np.array([*starts, len(width)])


def _lines(values: Array, grid: Grid) -> Array:
    """In straight lines, those of cells, then of blocks, of two curves each, shape (..., 2, n) ->
    (..., 6, m + b)."""
    from crankmbs.batch.straight import straighten  # numba is loaded only when it is used

    edges, starts, gauss = grid
    n, pieces = values.shape[-1], len(edges) + len(starts) - 2
    lines = np.empty((*values.shape[:-2], 6, pieces))
    flat = np.ascontiguousarray(values).reshape(-1, n)
    straighten(flat, gauss[0], edges, starts, lines.reshape(-1, 3, pieces))
    return lines
