"""A prescribed speed that is known over the crank angle: t = int d theta / omega(theta), and back.

The integral is Gauss quadrature on panels, each halved until two orders agree to rounding, so that
what is left of it is the rounding of the speed itself.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.numerics.roots import invert_monotone

__all__ = ["AngleLaw", "Panels"]

_NODES, _FEWER = 12, 8  # of Gauss on a panel: it is narrow enough where both give the same
_EPSILON = float(np.finfo(float).eps)
_SAME = 16 * _EPSILON  # of two orders, where neither is better
_OFF = 4 * _EPSILON  # of the larger row beside it: so far a speed may be off
_HALVINGS = 60  # rounds: beside a speed near 0 panels are halved again and again


class AngleLaw:
    """omega a piecewise cubic in the crank angle, of one sign.

    knots, coefficients : as in `scipy.interpolate.PPoly`, angles [rad] and speeds [rad/s]
    start : crank angle [rad] at time 0; repeats : whether the pieces are one period of many
    panels : on which the quadrature is exact, of the nodes and weights of ``rule``
    """

    def __init__(self, knots: Array, coefficients: Array, start: float, *, repeats: bool) -> None:
        self._knots, self._coefficients = knots, coefficients
        self._repeats, self._start = repeats, start
        self._sense = math.copysign(1.0, float(coefficients[-1, 0]))
        self.panels = self._halved()
        self._period = float(knots[-1] - knots[0])
        self._elapsed = np.append(0.0, np.cumsum(self.panels.times))
        self._begun = self._slowly(np.asarray(start))

    @property
    def rule(self) -> Rule:
        """Of the quadrature."""
        return gauss(_NODES)

    @property
    def turning_times(self) -> tuple[float, ...]:
        """The time [s] at which the rows end."""
        if self._repeats:
            return (math.inf,)
        last = self._knots[-1] if self._sense > 0.0 else self._knots[0]
        return (float(self.time_at(last, 0.0, math.inf)[0]),)

    def corners(self, begin: float, end: float) -> Array:
        """Times [s] strictly between two others at which the crank passes a row."""
        first, last = sorted(float(x) for x in self.at_time([begin, end])[0])
        knots = self._knots
        if self._repeats:
            low, high = (math.floor((x - knots[0]) / self._period) for x in (first, last))
            turns = self._period * np.arange(low, high + 1.0)[:, None]
            knots = (turns + knots[:-1]).ravel()
        times = np.sort(self.time_at(knots, begin, end))
        return np.asarray(times[(times > begin) & (times < end)])

    def at_time(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """theta, omega, alpha [rad, rad/s, rad/s2] at times [s] of any shape."""
        aim = self._sense * np.asarray(t, dtype=np.float64) + self._begun
        whole = self._elapsed[-1]
        turns = np.floor(aim / whole) if self._repeats else np.zeros_like(aim)
        inside = np.clip(aim - turns * whole, 0.0, whole)
        beyond = aim - turns * whole - inside  # where the rows end it goes on as it was
        k = self._panel(self._elapsed, inside)
        width = self.panels.width[k]

        def elapsed(x: Array) -> tuple[Array, Array]:
            return self._within(flat, x), 1.0 / np.abs(self._speed(flat, x)[0])

        flat = k.ravel()
        aims = (inside - self._elapsed[k]).ravel()
        x = invert_monotone(elapsed, aims, np.zeros(flat.shape), width.ravel()).reshape(k.shape)
        omega, slope = self._speed(k, x)
        theta = self.panels.begin[k] + x + turns * self._period + beyond * np.abs(omega)
        return np.asarray(theta), omega, slope * omega

    def time_at(self, theta: ArrayLike, begin: float, end: float) -> Array:
        """Times [s] at which crank angles are reached; the crank turns one way for good."""
        theta = np.atleast_1d(np.asarray(theta, dtype=np.float64))
        return np.asarray(self._sense * (self._slowly(theta) - self._begun))

    @cached_property
    def perturbed(self) -> AngleLaw:
        """The law for a speed as far from this one as rounding may have it."""
        speeds = np.abs(self._coefficients[-1])
        largest = np.maximum(speeds, np.roll(speeds, -1))
        moved = self._coefficients + np.vstack([np.zeros((3, len(speeds))), _OFF * largest])
        return AngleLaw(self._knots, moved, self._start, repeats=self._repeats)

    def _slowly(self, theta: Array) -> Array:
        """int d theta / |omega| from the first knot on [s]."""
        ahead = theta - self._knots[0]
        turns = np.floor(ahead / self._period) if self._repeats else np.zeros_like(ahead)
        inside = np.clip(ahead - turns * self._period, 0.0, self._period)
        k = self._panel(self.panels.begin - self._knots[0], inside)
        x = inside - (self.panels.begin[k] - self._knots[0])
        return np.asarray(turns * self._elapsed[-1] + self._elapsed[k] + self._within(k, x))

    def _panel(self, edges: Array, at: Array) -> Index:
        k = np.searchsorted(edges, at, side="right") - 1
        return np.asarray(np.clip(k, 0, len(self.panels.begin) - 1))

    def _within(self, k: Index, x: Array, count: int = _NODES) -> Array:
        """int d theta / |omega| over the first x [rad] of panels k [s]."""
        rule = gauss(count)
        slowness = 1.0 / np.abs(self._speed(k[..., None], x[..., None] * rule.nodes)[0])
        return np.asarray(x * (slowness @ rule.weights))

    def _speed(self, k: Index, x: Array) -> tuple[Array, Array]:
        """omega and d omega / d theta at x [rad] from the beginning of panels k."""
        piece = self.panels.piece[k]
        x = x + self.panels.lead[k]
        a, b, c, d = self._coefficients[:, piece]
        return np.asarray(((a * x + b) * x + c) * x + d), np.asarray((3 * a * x + 2 * b) * x + c)

    def _halved(self) -> Panels:
        """Panels on which the quadrature is exact but for rounding."""
        knots, speeds = self._knots, np.abs(self._coefficients[-1])
        largest = np.maximum(speeds, np.roll(speeds, -1))
        piece, lead, width = np.arange(len(speeds)), np.zeros(len(speeds)), np.diff(knots)
        for _ in range(_HALVINGS):
            self.panels = Panels(knots[piece] + lead, width, piece, lead, np.empty(0))
            every = np.arange(len(piece))
            coarse, fine = (self._within(every, width, count) for count in (_FEWER, _NODES))
            slowest = np.minimum(*(np.abs(self._speed(every, x)[0]) for x in (0.0 * width, width)))
            wide = np.abs(fine - coarse) > _SAME * fine * largest[piece] / slowest
            if not wide.any():
                break
            width = np.where(wide, 0.5 * width, width)
            piece, behind = np.append(piece, piece[wide]), lead[wide] + width[wide]
            lead, width = np.append(lead, behind), np.append(width, width[wide])
            order = np.lexsort((lead, piece))
            piece, lead, width = piece[order], lead[order], width[order]
        return self.panels._replace(times=fine)


class Panels(NamedTuple):
    """Panels of a quadrature, shape (n,) each.

    begin, width [rad] : where they lie; piece, lead [rad] : in which piece, how far behind its
    beginning; times [s] : how long the crank takes
    """

    begin: Array
    width: Array
    piece: Index
    lead: Array
    times: Array
