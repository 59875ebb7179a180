"""The crank train reduced to one rotation, piece by piece: between two knots of gas, loads and
friction everything that depends on the angle is smooth, and a polynomial to rounding.

A `Piece` gives them from number to number, and continues them a little beyond its knots.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.friction import friction_torque, rubbing
from crankmbs.mechanics.inertia import fired_torque, reduce
from crankmbs.mechanics.knots import KNOT, apart
from crankmbs.mechanics.torque import over_angle
from crankmbs.mechanics.train import (
    CrankTrain,
    edges_over_angle,
    sign_changes,
)
from crankmbs.mechanics.windows import Phases
from crankmbs.motion.mode import Mode
from crankmbs.numerics.arrays import Array, Index

__all__ = ["Piece", "Pieces", "Reduced"]

_TERMS, _MORE = 12, 2  # of the polynomials; more of them in a reduction that checks another, whose
# pieces are the same: they bound the steps
_ROUGH, _ROUNDING = 1e-14, 1e-16  # of the largest value: last terms of more want narrower pieces;
# terms of less are left out
_NOISE, _FALLS = 1e-11, 0.25  # what is less may be rounding; by halving of what is none is left
_ANGLE = 4 * float(np.finfo(float).eps)  # of a period: what rounding may make of an angle, or more
_ALONE = 5  # functions of the angle that are the train's, not a cylinder's
_PASSED = 8 * float(np.finfo(float).eps)  # of the angle: a knot this close ahead has been passed


class Piece(NamedTuple):
    """Two neighbouring knots low, high [rad], and what holds between them.

    middle, half [rad] : of the polynomials, whose variable is (theta - middle) / half
    powers : coefficients of J, dJ/dtheta, torque and drag, as they are given, highest power first
    """

    low: float
    high: float
    middle: float
    half: float
    powers: list[tuple[float, float, float, float]]

    def __call__(self, ahead: float) -> tuple[float, float, float, float]:
        """J [kg m2], dJ/dtheta [kg m2/rad], torque over the angle without viscous friction [N m],
        and the torque of that per speed [N m s/rad], at an angle ``ahead`` of the middle [rad]."""
        x = ahead / self.half
        inertia = slope = torque = drag = 0.0
        for a, b, c, d in self.powers:
            inertia = inertia * x + a
            slope = slope * x + b
            torque = torque * x + c
            drag = drag * x + d
        return inertia, slope, torque, drag


class _Fits(NamedTuple):
    """Chebyshev coefficients in every piece of one period, by ascending degree.

    edges : of the pieces [rad], from 0 to one period
    inertia, slope, torque, rings, drag : shape (n, terms); the slope is that of J, the torque
        without friction and combustion
    gas, combustion : shape (n, terms, cylinders) [N m], what presses rings, and what firings of
        share 1 add; no cylinders where there is none
    """

    edges: list[float]
    inertia: Array
    slope: Array
    torque: Array
    rings: Array
    drag: Array
    gas: Array
    combustion: Array


@dataclass(frozen=True)
class Reduced:
    """The crank train reduced to one rotation, with the loads and shares of a mode.

    checks : whether it is there to check another, which has fewer terms
    """

    train: CrankTrain
    checks: bool = False

    def at(self, mode: Mode) -> Pieces:
        """What acts in a mode."""
        key = mode.loads, mode.shares
        if key not in self._known:
            self._known.clear()  # shares come once; phases seldom come back
            self._known[key] = Pieces(self, *key)
        return self._known[key]

    @cached_property
    def _known(self) -> dict[tuple[Phases, tuple[float, ...]], Pieces]:
        return {}

    @cached_property
    def torque_scale(self) -> float:
        """Largest torque of gas and gravity over one period, and of the loads at their knots
        [N m]."""
        parts = (part for load in self.train.loads for part in load.parts[:3])
        load = sum(part.largest for part in parts if part is not None)
        start = self.train.scene.start
        for torque in self.train.loads:
            if torque.parts.function is not None and start is not None:
                load += abs(torque.parts.function.number(0.0, start.angle, start.speed))
        period = self.train.period
        count = 720 * round(period / self.train.scene.period) + 1
        angles = 0.1 + np.linspace(0.0, period, count)  # no fold lies there
        share = self.train.law.most if self.train.law else 0.0
        shares = np.full(len(self.train.scene.cylinders), share)
        most = np.abs(reduce(self.train, angles, shares).torque)
        rubbed = friction_torque(self.train, angles, 0.0, 1.0, shares)
        return load + float(np.max(most - rubbed))

    def fits(self, phases: Phases) -> _Fits:
        """The polynomials of one period in these phases of the loads; pieces in which they do not
        fall are halved."""
        key = phases if self.train.loads_over_angle else ()
        if key not in self._fits:
            self._fits[key] = self._fitted(key)
        return self._fits[key]

    @cached_property
    def _fits(self) -> dict[Phases, _Fits]:
        return {}

    def _fitted(self, phases: Phases) -> _Fits:
        train, period = self.train, self.train.period
        marks = apart(np.append(edges_over_angle(train), 0.0))
        edges = np.append(marks[marks < period - KNOT], period)
        parts, before = np.ones(len(edges) - 1, dtype=np.intp), np.full(len(edges) - 1, np.inf)
        while True:
            edges, before = _split(edges, parts), np.repeat(before, parts)
            rows = self._coefficients(edges, phases)
            inside = rows.reshape(*rows.shape[:2], -1)
            largest = np.abs(inside).max(axis=(0, 1), initial=1e-300)
            last = (np.abs(inside[:, _TERMS - 2 : _TERMS]) / largest).max(axis=(1, 2))
            noise = np.maximum(_NOISE, 2.0 * _ANGLE * period / np.diff(edges))
            rough = (last > noise) | ((last > _ROUGH) & (last < _FALLS * before))
            if not rough.any():
                break
            parts, before = np.where(rough, 2, 1), np.where(rough, last, before)
        end = _ALONE + len(train.scene.cylinders) * self._presses
        inertia, slope, torque, rings, drag = np.moveaxis(rows[..., :_ALONE], -1, 0)
        of_cylinders = rows[..., _ALONE:end], rows[..., end:]
        return _Fits(edges.tolist(), inertia, slope, torque, rings, drag, *of_cylinders)

    @property
    def _presses(self) -> bool:
        """Whether rings are pressed by the gas."""
        friction = self.train.scene.friction
        return friction is not None and friction.ring_pressure > 0.0

    def _coefficients(self, edges: Array, phases: Phases) -> Array:
        """Those of all that depends on the angle, shape (n, terms, functions)."""
        x = np.polynomial.chebyshev.chebpts1(self._terms)
        middle, half = _placed(edges[:-1], edges[1:])
        theta = np.asarray(middle[:, None] + half[:, None] * x)
        reduction, rubs = reduce(self.train, theta), rubbing(self.train, theta, phases)
        of_angle = over_angle(self.train, phases)
        torque = reduction.torque if of_angle is None else reduction.torque + of_angle(theta)
        alone = np.stack(
            [reduction.inertia, reduction.slope, torque, rubs.rings, rubs.drag], axis=-1
        )
        gas = rubs.gas if self._presses else rubs.gas[..., :0]
        values = np.concatenate([alone, gas, fired_torque(self.train, theta)], axis=-1)
        return np.asarray(self._to_chebyshev @ values)

    @property
    def _terms(self) -> int:
        return _TERMS + _MORE * self.checks

    @cached_property
    def _to_chebyshev(self) -> Array:
        """Values at the nodes to coefficients."""
        x = np.polynomial.chebyshev.chebpts1(self._terms)
        weights = np.full((self._terms, 1), 2.0 / self._terms)
        weights[0] = 1.0 / self._terms
        return np.asarray(weights * np.polynomial.chebyshev.chebvander(x, self._terms - 1).T)


class Pieces:
    """The pieces of a reduction in some phases of the loads, with shares of the combustion."""

    def __init__(self, base: Reduced, phases: Phases, shares: tuple[float, ...]) -> None:
        self.train, self.torque_scale = base.train, base.torque_scale
        self._fits, self._shares = base.fits(phases), np.array(shares)
        fired = base.train.combustion is not None
        self._bends = sign_changes(base.train, shares).tolist() if fired else []
        self._known: dict[tuple[int, int, float], Piece] = {}

    def around(self, theta: float, sense: float) -> Piece:
        """The piece that the motion enters at an angle [rad] in a sense of rotation."""
        fits, period = self._fits, self.train.period
        ahead = theta + sense * _PASSED * max(abs(theta), period)
        turns = math.floor(ahead / period)
        local = ahead - turns * period
        k = min(bisect_right(fits.edges, local), len(fits.edges) - 1) - 1
        i = bisect_right(self._bends, local)
        if (k, i, sense) not in self._known:
            low = max([fits.edges[k], *self._bends[max(i - 1, 0) : i]])
            high = min([fits.edges[k + 1], *self._bends[i : i + 1]])
            self._known[k, i, sense] = self._piece(k, low, high, sense)
        one, base = self._known[k, i, sense], turns * period
        if turns == 0:
            return one
        knots = one.low + base, one.high + base, one.middle + base
        return Piece(*knots, one.half, one.powers)

    def _piece(self, k: int, low: float, high: float, sense: float) -> Piece:
        """A part of the piece k, where friction keeps its signs."""
        fits = self._fits
        begin, end = np.array(fits.edges[k : k + 2])
        middle, half = (float(each) for each in _placed(begin, end))
        torque, more = fits.torque[k] + 0.0, np.zeros((1, 1))
        if len(self._shares):
            more = fits.combustion[k] * self._shares
            torque += more.sum(axis=-1)
        torque -= sense * fits.rings[k]
        friction, gas = self.train.scene.friction, fits.gas[k]
        if friction is not None and gas.shape[-1]:
            at = (0.5 * (low + high) - middle) / half
            gas = gas + more
            pressing = gas * np.sign(np.polynomial.chebyshev.chebval(at, gas))
            torque -= sense * friction.ring_pressure * pressing.sum(axis=-1)
        rows = np.stack([fits.inertia[k], fits.slope[k], torque, fits.drag[k]])
        matters = (np.abs(rows) > _ROUNDING * np.abs(rows).max(axis=1, keepdims=True)).any(axis=0)
        count = int(np.flatnonzero(matters)[-1]) + 1
        powers = rows[:, :count] @ _powers(count)
        return Piece(low, high, middle, half, [*map(tuple, powers.T[::-1].tolist())])


def _placed(begin: Array, end: Array) -> tuple[Array, Array]:
    """Middle and half [rad] of what pieces are fitted on: no angle so close to the end that it
    counts as on the knot there."""
    half = 0.5 * (end - begin)
    return 0.5 * (begin + end), np.maximum(half - KNOT, 0.5 * half)


def _split(edges: Array, parts: Index) -> Array:
    """Edges of pieces cut into equal parts."""
    cell = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(cell)) - (np.cumsum(parts) - parts)[cell]
    return np.append(edges[cell] + part * (np.diff(edges) / parts)[cell], edges[-1])


def _powers(count: int) -> Array:
    """Chebyshev coefficients to those of the powers, shape (count, count), as rows."""
    if count not in _POWERS:
        table = np.zeros((count, count))
        for j, unit in enumerate(np.eye(count)):
            row = np.polynomial.chebyshev.cheb2poly(unit)
            table[j, : len(row)] = row
        _POWERS[count] = table
    return _POWERS[count]


_POWERS: dict[int, Array] = {}
