"""What depends on an angle within a period is computed once a period."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array, Index

__all__ = ["Period", "period_of", "single"]


Term = tuple[Array, Array | None]
"""Something of the angles, shape (..., n), and what it is times at the samples, shape (...,
samples); None for 1."""


class Period(NamedTuple):
    """Angles that come back.

    angles : shape (n,) [rad], those of one period, then those that do not come back
    which : shape (samples,), which of them every sample is at, whole periods apart
    size, within : so many angles come back, in order, in so many samples, the first ones
    """

    angles: Array
    which: Index
    size: int
    within: int

    def times(self, part: Array, size: Array) -> Array:
        """What a term is at every sample, shape (..., samples)."""
        shape = np.broadcast_shapes(part.shape[:-1], size.shape[:-1])
        out = np.empty((*shape, len(self.which)))
        self.join([(part, size)], out)
        return out

    def join(self, terms: list[Term], out: Array) -> None:
        """The sum of terms at every sample, of the shape of ``out``, (..., samples): whole turns
        at once, as looking up each sample takes longer."""
        whole = np.empty((*out.shape[:-1], *self._turns))
        room = np.empty_like(whole) if len(terms) > 1 else whole
        for number, (part, size) in enumerate(terms):
            ahead = part[..., np.newaxis, : self.size]
            if size is None:
                np.add(ahead, whole if number else 0.0, out=whole)
            elif number == 0:
                np.multiply(ahead, self._folded(size), out=whole)
            else:
                whole += np.multiply(ahead, self._folded(size), out=room)
        out[..., : self.within] = whole.reshape(*out.shape[:-1], -1)[..., : self.within]
        if self.within < len(self.which):
            rest, alone = slice(self.within, None), slice(self.size, None)
            parts = (
                part[..., alone] if size is None else part[..., alone] * size[..., rest]
                for part, size in terms
            )
            out[..., rest] = sum(parts)

    @property
    def _turns(self) -> tuple[int, int]:
        return -(-self.within // self.size) if self.size else 1, self.size

    def _folded(self, size: Array) -> Array:
        """A size, shape (..., samples), turn by turn; the last one filled up."""
        turns, count = self._turns
        if turns * count == self.within:
            return size[..., : self.within].reshape(*size.shape[:-1], turns, count)
        folded = np.zeros((*size.shape[:-1], turns * count))
        folded[..., : self.within] = size[..., : self.within]
        return folded.reshape(*size.shape[:-1], turns, count)


def single(theta: Array) -> Period:
    """Angles of shape (n,), none of which comes back."""
    return Period(theta, np.arange(len(theta)), len(theta), len(theta))


def period_of(theta: Array, period: float) -> Period:
    """The angles of one period, and which of them every sample is at.

    What depends on the angle alone is so computed once, and not in every cycle. Evenly spaced
    angles repeat when a whole number of them makes a period; others are all returned.

    theta : shape (n,) [rad], equal to the rounding of the largest after a period

    >>> period_of(np.array([0.0, 1.0, 2.0, 2.5]), 2.0)[:2]
    (array([0. , 1. , 2.5]), array([0, 1, 0, 2]))
    """
    n = len(theta)
    step = abs(float(theta[1] - theta[0])) if n > 1 else 0.0
    count = round(min(period / step, n)) if step > 0.0 else n
    if count == n:
        return single(theta)
    close = 4 * np.finfo(float).eps * max(float(theta.max()), -float(theta.min()))
    missed = np.abs(theta[count:] - theta[: n - count])
    missed -= period
    beyond = np.abs(missed, out=missed) > close
    first = int(beyond.argmax())
    repeating = count + first if beyond[first] else n
    if repeating == count:
        return single(theta)
    which = np.resize(np.arange(count), n)
    which[repeating:] = np.arange(count, count + n - repeating)
    angles = np.concatenate([theta[:count], theta[repeating:]])
    return Period(angles, which, count, repeating)
