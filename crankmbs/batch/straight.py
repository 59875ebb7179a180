"""Straight lines for curves over cells and blocks of cells: loops over curves, compiled by numba
(`crankmbs.numerics.kernels`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["straighten"]


@kernel
def straighten(
    values: Array, nodes: Array, edges: Array, starts: NDArray[np.intp], lines: Array
) -> None:
    """Fill the lines through the first and the last node of every cell, then of every block of
    cells: middle, by how much they rise, and by how much they miss a node at most.

    values : at the n = m s nodes, shape (k, n); nodes : of every cell, 0 to 1; edges : of the m
    cells; starts : the first cell of each of the b blocks, and m; lines : filled, shape (k, 3, m +
    b)
    """
    s, m, places = len(nodes), len(edges) - 1, np.empty(values.shape[1])
    for b in range(len(starts) - 1):
        begin, end = starts[b], starts[b + 1]
        for c in range(begin, end):
            for j in range(s):
                at = edges[c] + (edges[c + 1] - edges[c]) * nodes[j]
                places[c * s + j] = (at - edges[begin]) / (edges[end] - edges[begin]) - 0.5
    for k in range(len(values)):
        for piece in range(m + len(starts) - 1):
            b, worst = piece - m, 0.0
            first = (piece if b < 0 else starts[b]) * s
            last = (piece + 1 if b < 0 else starts[b + 1]) * s - 1
            low, high = values[k, first], values[k, last]
            if b < 0:
                middle, rise = 0.5 * (low + high), (high - low) / (nodes[s - 1] - nodes[0])
                for j in range(1, s - 1):
                    off = abs(values[k, first + j] - middle - rise * (nodes[j] - 0.5))
                    worst = off if off > worst else worst
            else:
                rise = (high - low) / (places[last] - places[first])
                middle = low - rise * places[first]
                for i in range(first + 1, last):
                    off = abs(values[k, i] - middle - rise * places[i])
                    worst = off if off > worst else worst
            lines[k, 0, piece], lines[k, 1, piece], lines[k, 2, piece] = middle, rise, worst
