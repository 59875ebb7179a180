"""Curves of a comparison at its samples, and between them, where they are largest."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from crankmbs.compare.excerpt import Excerpt, at_fold
from crankmbs.compare.size import TIE, Size, top_of
from crankmbs.measures.span import passes_over
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.train import crank_angle_knots, friction_knots, knots_over_angle
from crankmbs.motion.motion import Motion
from crankmbs.motion.states import variables_at
from crankmbs.numerics.arrays import Array, Index

__all__ = ["Curves", "with_points_between"]

Key = TypeVar("Key", bound=tuple[str, ...])
Name = TypeVar("Name", bound=Hashable)

_ROUNDS = 2  # of parabolas: of samples 1 degree apart the first miss a peak by some 1e-5 of it
_NOTHING = 1e-9  # of the largest value of a quantity: rounding, or no more to be gained
_HAIR = 1e-9  # rad, to either side of an angle at which curves bend or jump


@dataclass(frozen=True)
class Curves(Generic[Key]):
    """Curves by reference, quantity and what else.

    sampled : at the samples of an excerpt, shape (n,) each; between : those that are known
        elsewhere, too, at points that are the samples and others
    """

    excerpt: Excerpt
    sampled: dict[Key, Array]
    points: Excerpt
    between: dict[Key, Array]

    def size(self, key: Key) -> Size:
        """RMS of a curve over the samples; its maximum over all points, where that is more than
        rounding above the samples'."""
        quantity, sampled = key[1], self.excerpt.size(key[1], self.sampled[key])
        if key not in self.between:
            return sampled
        more = self.points.size(quantity, self.between[key])
        above = more.largest > sampled.largest * (1.0 + TIE)
        return more._replace(rms=sampled.rms) if above else sampled

    def peak(self, key: Key) -> float:
        """The largest magnitude of a curve."""
        return peak(self.between.get(key, self.sampled[key]))

    def at_largest(self, key: Key, other: Key) -> float:
        """A curve where another, known at as many points, is largest."""
        known = key in self.between
        points, curves = (self.points, self.between) if known else (self.excerpt, self.sampled)
        top = top_of(curves[other], points.angles(key[1]), points.result.scene.period)
        return float(curves[key][top])


def with_points_between(
    excerpt: Excerpt,
    sampled: dict[Key, Array],
    evaluate: Callable[[Excerpt], dict[Key, Array]],
) -> Curves[Key]:
    """Curves at the samples of an excerpt and between them.

    Beside every sample at which a curve may be largest, points are put to either side of the angles
    at which pressures and loads bend or jump, and at the vertex of the parabola through the sample
    and its neighbours. There the motion is read as it was solved; without one the samples are all
    there is.

    evaluate : those of the curves that are known at any points
    """
    if excerpt.result.motion is None or len(excerpt.theta) < 3:
        return Curves(excerpt, sampled, excerpt, {})
    motion = passes_over(excerpt.result, excerpt.window).answer
    bends = _bends(excerpt, motion)
    points, curves = excerpt, evaluate(excerpt)
    for _ in range(_ROUNDS):
        time = points.variables["time"]
        more = _at(points, motion, _near_tops(time, _sizes(curves), bends))
        if more is None:
            break
        order = np.argsort(np.concatenate([time, more.variables["time"]]), kind="stable")
        points = replace(points, variables=_joined(points.variables, more.variables, order))
        curves = _joined(curves, evaluate(more), order)
    return Curves(excerpt, sampled, points, curves)


def _joined(some: dict[Name, Array], more: dict[Name, Array], order: Index) -> dict[Name, Array]:
    """Rows of both, in an order."""
    return {name: np.concatenate([rows, more[name]])[order] for name, rows in some.items()}


def _sizes(curves: dict[Key, Array]) -> Array:
    """Magnitudes of the curves that are something beside others of their quantity, shape (q, n)."""
    sizes = {key: np.abs(curve) for key, curve in curves.items()}
    largest: dict[str, float] = {}
    for key, size in sizes.items():
        largest[key[1]] = max(largest.get(key[1], 0.0), float(size.max()))
    return np.array([s for key, s in sizes.items() if s.max() > _NOTHING * largest[key[1]]])


def _near_tops(time: Array, sizes: Array, bends: Array) -> Array:
    """Times of vertices and bends beside the points at which one of the curves, shape (q, n), may
    be largest: it goes hardly farther beyond a value than neighbours lie apart."""
    change, largest = np.diff(sizes), sizes.max(axis=1, keepdims=True)
    end = np.zeros((len(sizes), 1))
    rise, fall = np.hstack([end, change]), np.hstack([-change, end])
    beyond = sizes + np.maximum(np.abs(rise), np.abs(fall))
    which, k = np.nonzero(beyond > largest * (1.0 + _NOTHING))
    near = np.zeros(len(time) + 1, bool)
    near[k] = near[k + 1] = True
    peaked = (rise[which, k] > 0.0) & (fall[which, k] >= 0.0) & (k < len(time) - 1)
    which, k = which[peaked], k[peaked]
    before, after = time[k] - time[k - 1], time[k + 1] - time[k]
    up, down = rise[which, k], fall[which, k]
    vertices = time[k] + 0.5 * (up * after**2 - down * before**2) / (up * after + down * before)
    return np.concatenate([bends[near[np.searchsorted(time, bends)]], vertices])


def _bends(excerpt: Excerpt, motion: Motion) -> Array:
    """Times a hair before and after the motion passes an angle at which curves bend or jump; none
    of a crank that rests or turns back."""
    if not motion.turns_one_way:
        return np.empty(0)
    train, sense = excerpt.train, motion.cells[0].acting.sense
    marks = [crank_angle_knots(train), knots_over_angle(train), friction_knots(train)]
    begin = float(motion.cells[0].angle[0, 0])
    low, high = sorted((begin, begin + motion.turned))
    periods = train.period * np.arange(np.floor(low / train.period), high // train.period + 1.0)
    angles = np.add.outer(periods, np.concatenate(marks)).ravel()
    angles = np.concatenate([angles - _HAIR, angles + _HAIR])
    angles = angles[(angles > low) & (angles < high)]
    return motion.at(angles, in_time=False).time if len(angles) and sense else np.empty(0)


def _at(excerpt: Excerpt, motion: Motion, times: Array) -> Excerpt | None:
    """The excerpt at times [s] other than its own, without those at which a rod is folded."""
    time = excerpt.variables["time"]
    new = np.setdiff1d(times, time)
    new = new[(new > max(time[0], motion.begin)) & (new < time[-1])]
    if len(new) == 0:
        return None
    variables = variables_at(motion.train, motion.at(new, in_time=True))
    unfolded = ~at_fold(variables["rod_angle"])
    if not np.any(unfolded):
        return None
    rows = {name: variables[name][unfolded] for name in excerpt.variables}
    return replace(excerpt, variables=rows)
