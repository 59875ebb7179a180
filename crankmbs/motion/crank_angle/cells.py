"""Where consecutive cells of the crank angle lie: a loop over them, compiled by numba
(`crankmbs.numerics.kernels`)."""

from __future__ import annotations

import math

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

__all__ = ["lay"]


@kernel
def lay(
    edges: Array,
    begin: tuple[float, float, int],
    reach: float,
    sliver: float,
    cells: tuple[Index, Array, Array],
) -> int:
    """Fill numbers, widths and edges of the cells of a strip, until they reach so far; count them.

    edges : of one period; begin : crank angle [rad], sense of rotation, and the first cell's
    number; reach : angle to turn through [rad]; sliver [rad] : so near an edge is on it
    cells : as `crankmbs.motion.crank_angle.grid.Strip` has them, with room for as many as there may
    be
    """
    (theta, sense, first), (cell, width, turned) = begin, cells
    n, period, step = len(edges) - 1, edges[-1], 1 if sense > 0.0 else -1
    local = theta - math.floor((theta + sense * sliver) / period) * period
    turned[0] = 0.0
    for k in range(len(cell)):
        at = first + step * k
        cell[k] = at % n
        width[k] = edges[cell[k] + 1] - edges[cell[k]]
        # not the sum of so many widths, which every pass over the same cells would round alike
        turns, after = (at + step) // n, (at + step) % n
        ahead = edges[after] if step > 0 else edges[after + 1]
        turned[k + 1] = sense * (turns * period + ahead - local)
        if k == 0:
            width[0] = turned[1]
        if turned[k + 1] >= reach - sliver:
            if turned[k + 1] > reach:
                turned[k + 1], width[k] = reach, reach - turned[k]
            return k + 1
    return len(cell)
