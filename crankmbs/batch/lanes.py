"""Cases beside one another, as compiled loops take them."""

from __future__ import annotations

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["LANES", "laid", "taken"]

LANES = 32
"""So many at most: several times what the processor's vectors hold, since a compiled loop over
fewer numbers is not worth its check that the arrays are apart, and runs one number after the
other."""


def laid(values: Array) -> Array:
    """What cases have, shape (k, n), in groups of LANES beside one another, or of all where they
    are fewer, shape (groups, n, lanes); the last one fills up its group.

    >>> laid(np.array([[1.0], [2.0]]))
    array([[[1., 2.]]])
    >>> laid(np.arange(33.0)[:, None])[1, 0, :3]
    array([32., 32., 32.])
    """
    lanes = min(LANES, len(values))
    groups = -(-len(values) // lanes)
    full = values[np.minimum(np.arange(groups * lanes), len(values) - 1)]
    return np.ascontiguousarray(full.reshape(groups, lanes, -1).swapaxes(1, 2))


def taken(values: Array, count: int) -> Array:
    """What groups of cases have, shape (groups, n, lanes), one case after the other, shape (k, n).

    >>> taken(laid(np.array([[1.0], [2.0]])), 2)
    array([[1.],
           [2.]])
    """
    return values.swapaxes(1, 2).reshape(-1, values.shape[1])[:count]
