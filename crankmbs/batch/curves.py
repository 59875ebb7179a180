"""Curves over the angle turned as the walk takes them (`crankmbs.batch.walk`): at the nodes, and in
straight lines over cells and blocks of cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import DEGREE

__all__ = ["WIDEST", "Curves", "Layout", "curves_of", "cut", "layout_of", "twins"]

WIDEST = 12.0 * DEGREE
"""Of a cell, and of a block of cells."""

_SLIVER = 1e-9  # rad: what rounding may add to it

Curves = tuple[Array, Array, Array, Array]
"""A and B, C and D, of `crankmbs.batch.walk.walk`, and both in straight lines."""


class Layout(NamedTuple):
    """Where the nodes of a period lie: width of the cells, angle turned to the nodes, the first
    cell of every block; and of cells and of blocks edges and where their nodes begin."""

    width: Array
    turned: Array
    starts: NDArray[np.intp]
    pieces: tuple[tuple[Array, NDArray[np.intp]], tuple[Array, NDArray[np.intp]]]


def layout_of(width: Array, nodes: Array) -> Layout:
    """Of cells whose nodes lie there, from 0 to 1."""
    edges, starts = np.append(0.0, np.cumsum(width)), _blocks(width)
    turned = (edges[:-1, None] + width[:, None] * nodes).ravel()
    first = np.arange(0, turned.size + 1, len(nodes))
    return Layout(width, turned, starts, ((edges, first), (edges[starts], first[starts])))


def curves_of(of: Array, rest: Array, layout: Layout) -> Curves:
    """With their straight lines."""
    return of, rest, _lines(of, layout), _lines(rest, layout)


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


def _lines(values: Array, layout: Layout) -> Array:
    """Straight lines for curves in the cells, then in the blocks of cells: their middle, by how
    much they rise, and by how much they miss a node at most; of two curves each, shape (..., 2, n)
    -> (..., 6, m + b)."""
    found = []
    for edges, nodes in layout.pieces:
        count, begin, end = np.diff(nodes), nodes[:-1], nodes[1:] - 1
        middle, wide = 0.5 * (edges[:-1] + edges[1:]), np.diff(edges)
        x = (layout.turned - np.repeat(middle, count)) / np.repeat(wide, count)
        rise = (values[..., end] - values[..., begin]) / (x[end] - x[begin])
        middle = values[..., begin] - rise * x[begin]
        off = np.abs(
            values - np.repeat(middle, count, axis=-1) - np.repeat(rise, count, axis=-1) * x
        )
        rest = np.maximum.reduceat(off, begin, axis=-1)
        found.append(np.stack([middle, rise, rest], axis=-2))
    lines = np.concatenate(found, axis=-1)
    return lines.reshape(*lines.shape[:-3], 6, -1)
