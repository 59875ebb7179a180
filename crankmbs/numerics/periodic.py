"""What depends on an angle within a period is computed once a period."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array

__all__ = ["one_period"]


def one_period(theta: Array, period: float) -> tuple[Array, NDArray[np.intp]]:
    """The angles of one period, and for every angle which of them it is, whole periods apart.

    What depends on the angle alone is so computed once, and not in every cycle. Evenly spaced
    angles repeat when a whole number of them makes a period; others are all returned.

    theta : shape (n,) [rad], equal to the rounding of the largest after a period

    >>> one_period(np.array([0.0, 1.0, 2.0, 2.5]), 2.0)
    (array([0. , 1. , 2.5]), array([0, 1, 0, 2]))
    """
    n = len(theta)
    step = abs(float(theta[1] - theta[0])) if n > 1 else 0.0
    count = round(min(period / step, n)) if step > 0.0 else n
    if count == n:
        return theta, np.arange(n)
    close = 4 * np.finfo(float).eps * max(float(theta.max()), -float(theta.min()))
    missed = np.abs(theta[count:] - theta[: n - count])
    missed -= period
    beyond = np.abs(missed, out=missed) > close
    first = int(beyond.argmax())
    repeating = count + first if beyond[first] else n
    if repeating == count:
        return theta, np.arange(n)
    turns = np.empty((-(-n // count), count), np.intp)
    turns[:] = np.arange(count)
    which = turns.ravel()[:n]
    which[repeating:] = np.arange(count, count + n - repeating)
    return np.concatenate([theta[:count], theta[repeating:]]), which
