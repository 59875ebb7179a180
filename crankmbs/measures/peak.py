"""The largest value of a quantity: where it can be evaluated anywhere, and from samples alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array

__all__ = ["highest", "rise"]

Indices = NDArray[np.intp]

_MOST = 12  # candidates for one quantity's maximum
_ROUNDS = 12  # each looks sixteen times closer
_ROUNDING = 4.0 * np.finfo(float).eps
_AROUND = np.linspace(-1.0, 1.0, 33)  # a sixteenth of the reach apart
_CENTRE = 16

_T = np.linspace(-0.25, 1.25, 601)  # across one interval, and a little on either side
_JUMP = 10.0  # a difference so many times its neighbour is a jump
_INSIDE = (_T >= 0.0) & (_T <= 1.0)


def highest(time: Array, values: Array, at: Callable[[Array], Array] | None) -> tuple[Array, Array]:
    """The largest values of q quantities over a stretch of time, and when they are reached.

    Around every sample that none of its neighbours exceeds, and from which the quantity, bending
    as it does there, could rise to the largest, it is evaluated ever closer: exact to rounding
    where smooth or bent, and on either side of a jump.

    Parameters
    ----------
    time : shape (n,) [s]; values : shape (q, n), so fine that no maximum hides between two samples
        of which neither is one
    at : values of shape (q, m) at times of shape (m,), or None: the samples are all there is

    Returns
    -------
    times, values : shape (q,)
    """
    which, k = _candidates(values)
    last = len(time) - 1
    low, middle, high = time[np.maximum(k - 1, 0)], time[k], time[np.minimum(k + 1, last)]
    top, most, on = values[which, k], values.max(axis=1), np.arange(len(k))
    for _ in range(_ROUNDS):
        if at is None or len(on) == 0:
            break
        around, mine = np.unique(np.stack([low, middle, high])[:, on], axis=1, return_inverse=True)
        left, centre, right = around[:, :, None]
        t = centre + _AROUND * np.where(_AROUND < 0.0, centre - left, right - centre)
        found = at(t.ravel()).reshape(-1, *t.shape)[which[on], mine]
        t, row = t[mine], np.arange(len(on))
        best = np.argmax(found, axis=1)
        best = np.where(found[row, _CENTRE] == found[row, best], _CENTRE, best)
        before, after = np.clip([best - 1, best + 1], 0, len(_AROUND) - 1)
        low[on], middle[on], high[on] = t[row, before], t[row, best], t[row, after]
        top[on] = found[row, best]
        np.maximum.at(most, which[on], top[on])
        rises = top[on] - np.minimum(found[row, before], found[row, after])
        more = rises > _ROUNDING * np.abs(top[on])
        on = on[more & (top[on] + rises >= most[which[on]])]
    order = np.lexsort((-top, which))
    first = order[np.searchsorted(which[order], np.arange(len(values)))]
    return middle[first], top[first]


def _candidates(values: Array) -> tuple[Indices, Indices]:
    """Quantity and sample of every local maximum that may exceed all others between samples."""
    apart = np.diff(values, axis=1)
    ends = np.zeros((len(values), 1))
    before, after = np.hstack([ends, apart]), np.hstack([-apart, ends])
    kept = (before >= 0.0) & (after >= 0.0)
    kept &= values + before + after >= values.max(axis=1, keepdims=True)
    order = np.argsort(np.where(kept, -values, np.inf), axis=1, kind="stable")[:, :_MOST]
    which, k = np.repeat(np.arange(len(values)), order.shape[1]), order.ravel()
    chosen = kept[which, k]
    return which[chosen], k[chosen]


def rise(values: Array, at: int) -> float:
    """How far a quantity may go above its sample ``at``, the largest, before the next samples.

    Parabolas through the three samples on either side of an interval are continued into it. Where
    they agree the quantity is smooth, where they cross it has a kink there, and the lower one
    counts; where they miss one another it jumps, and the higher one counts, because the jump may
    be anywhere. A jump between the two farther of three samples leaves a line through the nearer.

    Parameters
    ----------
    values : shape (n,) [unit]; evenly spaced samples

    Returns
    -------
    float [unit], at least 0; third order in the spacing where smooth
    """
    mirrored = values[::-1]
    return max(0.0, _beyond(values, at), _beyond(mirrored, len(values) - 1 - at))


def _beyond(values: Array, at: int) -> float:
    """The highest value between the samples ``at`` and ``at + 1``, less that at ``at``."""
    before, after = values[max(at - 2, 0) : at + 1], values[at + 1 : at + 4]
    if len(after) == 0:
        return 0.0
    curves = [
        _continued(np.array(place), samples)
        for place, samples in (([0, -1, -2], before[::-1]), ([1, 2, 3], after))
        if len(samples) == 3
    ]
    if not curves:
        return 0.0
    gap = curves[0] - curves[-1]
    crossing = gap.min() <= 0.0 <= gap.max()
    curve = (np.minimum if crossing else np.maximum)(curves[0], curves[-1])
    return float(curve[_INSIDE].max() - values[at])


def _continued(place: Array, samples: Array) -> Array:
    """The parabola through three samples, nearest first, or the line through the nearer two."""
    near, far = np.abs(np.diff(samples))
    smooth = 3 if far <= _JUMP * near else 2
    return np.asarray(
        np.polynomial.Polynomial.fit(place[:smooth], samples[:smooth], smooth - 1)(_T)
    )
