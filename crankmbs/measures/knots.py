"""The largest values of quantities along a motion, with the knots of the pressure in view."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.measures.between import Between
from crankmbs.measures.peak import highest
from crankmbs.measures.span import Span
from crankmbs.mechanics.knots import KNOT
from crankmbs.mechanics.train import crank_angle_knots
from crankmbs.numerics.arrays import Array

__all__ = ["Tops", "tops"]

_LANDINGS = 4  # towards a time: the interval's speed is nearly constant


class Tops(NamedTuple):
    """The largest values of q quantities, each of shape (q,).

    time [s], angle : of the crank, there [rad]; beside : how far the value may rise just before a
        knot of the pressure
    """

    time: Array
    angle: Array
    value: Array
    beside: Array


def tops(
    between: Between, window: Span, samples: tuple[Array, Array], at: Callable[[Array], Array]
) -> Tops:
    """The largest values over a window, from its very beginning on, as `highest` finds them.

    A piece of the pressure that may lie between two samples gets samples of its own.

    Parameters
    ----------
    samples : times from the first one within the window on [s], shape (n,), and values there, shape
        (q, n)
    at : values of shape (q, m) at times of shape (m,)
    """
    time, values = samples
    if window.first < window.inside:
        begin = np.array([window.begin])
        time, values = np.append(begin, time), np.hstack([at(begin), values])
    theta = between.state(time)[0]
    more = _narrow_pieces(between, time, theta)
    where = np.searchsorted(time, more)
    fine = np.insert(values, where, at(more), axis=1) if len(more) else values
    when, top = highest(np.insert(time, where, more), fine, at)
    angle = between.state(when)[0]
    return Tops(when, angle, top, _beside(between, (time, theta, values), (when, angle)))


def _narrow_pieces(between: Between, time: Array, theta: Array) -> Array:
    """When narrow pieces of the pressure are entered, half passed and left [s], in order."""
    knots, period = crank_angle_knots(between.train), between.train.period
    widths = np.diff(np.append(knots, knots[:1] + period))
    widest = float(np.max(np.abs(np.diff(theta)), initial=0.0))
    narrow = (widths > 2.0 * KNOT) & (widths < widest)
    if not narrow.any():
        return np.empty(0)
    inside = knots[narrow, None] + widths[narrow, None] * np.array([0.0, 0.5, 1.0])
    turns = np.arange(theta.min() // period - 1.0, theta.max() // period + 1.0)
    angles = np.unique(inside.ravel() + period * turns[:, None])
    low, high = np.minimum(theta[:-1], theta[1:]), np.maximum(theta[:-1], theta[1:])
    first, last = np.searchsorted(angles, low, "right"), np.searchsorted(angles, high)
    count = np.maximum(last - first, 0)
    k = np.repeat(np.arange(len(count)), count)
    wanted = angles[first[k] + np.arange(len(k)) - (np.cumsum(count) - count)[k]]
    t = time[k] + (wanted - theta[k]) / (theta[k + 1] - theta[k]) * (time[k + 1] - time[k])
    for _ in range(_LANDINGS):
        angle, speed, _ = between.state(t)
        step = np.divide(wanted - angle, speed, out=np.zeros_like(t), where=speed != 0.0)
        t = np.clip(t + step, time[k], time[k + 1])
    return np.sort(t)


def _beside(
    between: Between, samples: tuple[Array, Array, Array], peaks: tuple[Array, Array]
) -> Array:
    """How far quantities may rise above their peaks, shape (q,), nothing but before a knot.

    So does a peak where the pressure falls at once: what lies less than KNOT before the knot is
    taken as on it, and the quantity rises by its slope over that.

    samples : times, crank angles, shape (n,), and values there, shape (q, n); peaks : times and
        crank angles, shape (q,)
    """
    (time, theta, values), (when, angle) = samples, peaks
    knots, period = crank_angle_knots(between.train), between.train.period
    ahead = np.mod(knots - angle[:, None], period)
    short = np.any((ahead > 0.999 * KNOT) & (ahead <= 2.0 * KNOT), axis=1)
    slopes = _slopes(theta, values, np.searchsorted(time, when))
    return np.where(short, 2.0 * KNOT * slopes, 0.0)  # at the knot it may be steeper


def _slopes(theta: Array, values: Array, k: NDArray[np.intp]) -> Array:
    """How steep each quantity is beside its peak, before the sample k, shape (q,) per angle. By the
    two samples that follow the next one, on either side, and so not by a jump at the knot."""
    last, rows = len(theta) - 1, np.arange(len(values))
    steepest = np.zeros(len(values))
    for first, second in ((k + 1, k + 2), (k - 2, k - 3)):
        a, b = np.clip(first, 0, last), np.clip(second, 0, last)
        turned = np.abs(theta[b] - theta[a])
        change = np.abs(values[rows, b] - values[rows, a])
        slope = np.divide(change, turned, out=np.zeros_like(change), where=turned > 0.0)
        steepest = np.maximum(steepest, slope)
    return steepest
