"""Cases beside one another, as compiled loops take them."""

from __future__ import annotations

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["LANES", "laid", "taken"]

LANES = 8
"""So many as the processor's vectors hold numbers, or some times that."""


def laid(values: Array) -> Array:
    """What cases have, shape (k, n), in groups of LANES beside one another, shape (groups, n,
    LANES); the last one fills up its group.

    >>> laid(np.array([[1.0], [2.0]]))[0, 0].tolist()
    [1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    """
    groups = -(-len(values) // LANES)
    full = values[np.minimum(np.arange(groups * LANES), len(values) - 1)]
    return np.ascontiguousarray(full.reshape(groups, LANES, -1).swapaxes(1, 2))


def taken(values: Array, count: int) -> Array:
    """What groups of cases have, shape (groups, n, LANES), one case after the other, shape (k, n).

    >>> taken(laid(np.array([[1.0], [2.0]])), 2)
    array([[1.],
           [2.]])
    """
    return values.swapaxes(1, 2).reshape(-1, values.shape[1])[:count]
