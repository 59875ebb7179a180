"""Prescribed speeds: crank angle, speed and acceleration over time, and back. Exact.

A law that is constant, ramped or tabled is a piecewise polynomial in time; the oscillating one
has a closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from crankmbs.mechanics.speed_over_angle import AngleLaw
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.roots import invert_monotone
from crankmbs.scene.drives import Motion, Oscillation, Ramp, SpeedFile
from crankmbs.scene.scene import Scene
from crankmbs.scene.speed_rows import over_angle, remarks_on, repeats

__all__ = ["SpeedLaw", "speed_law", "speed_pieces", "speed_remarks"]

_ROUNDING = 2 * float(np.finfo(float).eps)  # of an angle


class SpeedLaw(Protocol):
    """A prescribed rotation from time 0 on."""

    @property
    def turning_times(self) -> tuple[float, ...]:
        """Times [s] that split the law into stretches of monotone angle; the last is its end."""

    def corners(self, begin: float, end: float) -> Array:
        """Times [s] strictly between two others at which the acceleration or its slope jumps."""

    @property
    def perturbed(self) -> SpeedLaw:
        """The law as far from this one as what it is made from may be, in the last digits."""

    def at_time(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """theta, omega, alpha [rad, rad/s, rad/s2] at times [s]; right-hand limits at corners."""

    def time_at(self, theta: ArrayLike, begin: float, end: float) -> Array:
        """Times [s] between ``begin`` and ``end``, a monotone stretch, when angles are reached."""


def speed_law(motion: Motion) -> SpeedLaw:
    """The law of a scene's [motion].

    >>> float(speed_law(Motion(speed=10.0)).at_time(2.0)[0])
    20.0
    """
    speed = motion.speed
    if isinstance(speed, Oscillation):
        return _OscillatingLaw(speed, motion.angle)
    if isinstance(speed, SpeedFile) and speed.kind == "angle_table":
        pieces = over_angle(speed.file, speed.interpolation)
        return AngleLaw(*pieces, motion.angle, repeats=repeats(speed.file))
    return _PolynomialLaw(speed_pieces(speed), motion.angle)


def speed_pieces(speed: float | Ramp | SpeedFile) -> PPoly:
    """The speed [rad/s] over time [s] as polynomials, the last of which may be endless.

    >>> speed_pieces(3.0).x
    array([ 0., inf])
    """
    if isinstance(speed, Ramp):
        rate = (speed.to - speed.start) / speed.over
        return PPoly(
            np.array([[rate, 0.0], [speed.start, speed.to]]),
            np.array([0.0, speed.over, math.inf]),
        )
    if isinstance(speed, SpeedFile):
        kind = CubicSpline if speed.interpolation == "cubic" else PchipInterpolator
        return kind(speed.file.x, speed.file.y)
    return PPoly(np.array([[speed]]), np.array([0.0, math.inf]))


def speed_remarks(scene: Scene) -> tuple[str, ...]:
    """What a reader should know of what was made of a table of speeds, in sentences.

    >>> speed_remarks(load_scene("yi_diesel"))
    ()
    """
    speed = None if scene.motion is None else scene.motion.speed
    if not isinstance(speed, SpeedFile) or speed.kind == "time_table":
        return ()
    return remarks_on(speed.file)


class _PolynomialLaw:
    """omega(t) piecewise polynomial of degree at most 3; the angle is its antiderivative."""

    def __init__(self, omega: PPoly, start: float) -> None:
        self._omega = omega
        self._alpha = omega.derivative()
        self._theta = omega.antiderivative()
        self._theta.c[-1] += start - float(self._theta(0.0))
        self.turning_times = (*self._reversals(), float(omega.x[-1]))

    @property
    def perturbed(self) -> SpeedLaw:
        return self

    def corners(self, begin: float, end: float) -> Array:
        breaks = self._omega.x[1:]
        return np.asarray(breaks[(breaks > begin) & (breaks < end)])

    def at_time(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        t = np.asarray(t, dtype=np.float64)
        return (self._theta(t), self._omega(t), self._alpha(t))

    def time_at(self, theta: ArrayLike, begin: float, end: float) -> Array:
        theta = np.atleast_1d(np.asarray(theta, dtype=np.float64))
        breaks = self._theta.x[(self._theta.x > begin) & (self._theta.x < end)]
        edges = np.concatenate([[begin], breaks, [end]])
        reached = np.asarray(self._theta(np.where(np.isinf(edges), edges[-2], edges)))
        if math.isinf(end):
            reached[-1] = math.copysign(math.inf, float(self._omega(edges[-2])))
        sign = 1.0 if reached[-1] >= reached[0] else -1.0
        k = np.clip(np.searchsorted(sign * reached, sign * theta, side="left") - 1, 0, None)
        k = np.minimum(k, len(edges) - 2)
        low, high = edges[k], edges[k + 1]
        held = np.isinf(high)
        t = np.empty_like(theta)
        t[held] = low[held] + (theta[held] - reached[k[held]]) / self._omega(low[held])
        rest = ~held
        t[rest] = invert_monotone(
            lambda x: (self._theta(x), self._omega(x)), theta[rest], low[rest], high[rest]
        )
        return t

    def _reversals(self) -> list[float]:
        """Times at which the speed crosses zero, or from which it rests."""
        finite = self._omega.x[-2] if math.isinf(self._omega.x[-1]) else self._omega.x[-1]
        roots = np.asarray(self._omega.roots(discontinuity=False, extrapolate=False))
        resting = self._omega.x[:-1][np.all(self._omega.c == 0.0, axis=0)]
        times = np.concatenate([roots[np.isfinite(roots)], resting])
        return sorted({float(t) for t in times if 0.0 < t <= finite and t < self._omega.x[-1]})


@dataclass(frozen=True)
class _OscillatingLaw:
    """omega = m + A cos(psi), psi = n theta + phase.

    u(psi) = 2 atan(kappa tan(psi / 2)), kappa^2 = (m - A) / (m + A), grows evenly in time:
    u' = n sqrt(m^2 - A^2). The mean of omega over the angle is m.

    off : by what part of itself u is off at a time
    """

    speed: Oscillation
    start: float
    off: float = 0.0

    turning_times = (math.inf,)

    @property
    def perturbed(self) -> SpeedLaw:
        return replace(self, off=_ROUNDING)

    def corners(self, begin: float, end: float) -> Array:
        return np.empty(0)

    def at_time(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        law = self.speed
        u = self._even(self._psi(self.start)) + self._rate * np.asarray(t, dtype=np.float64)
        u = u * (1.0 + self.off)
        psi = u + _bend(u, 1.0 / self._kappa)
        omega = law.mean + law.amplitude * np.cos(psi)
        alpha = -law.amplitude * law.order * np.sin(psi) * omega
        return np.asarray((psi - law.phase) / law.order), omega, alpha

    def time_at(self, theta: ArrayLike, begin: float, end: float) -> Array:
        psi = self._psi(np.atleast_1d(np.asarray(theta, dtype=np.float64)))
        return np.asarray((self._even(psi) - self._even(self._psi(self.start))) / self._rate)

    @property
    def _kappa(self) -> float:
        m, a = self.speed.mean, self.speed.amplitude
        return math.sqrt((m - a) / (m + a))

    @property
    def _rate(self) -> float:
        m, a = self.speed.mean, self.speed.amplitude
        return math.copysign(self.speed.order * math.sqrt((m - a) * (m + a)), m)

    def _psi(self, theta: ArrayLike) -> Array:
        return np.asarray(self.speed.order * np.asarray(theta) + self.speed.phase)

    def _even(self, psi: Array) -> Array:
        return psi + _bend(psi, self._kappa)


def _bend(angle: Array, kappa: float) -> Array:
    """2 atan(kappa tan(angle / 2)) - angle, without a branch cut."""
    s, c = np.sin(0.5 * angle), np.cos(0.5 * angle)
    return np.asarray(2.0 * np.arctan2((kappa - 1.0) * s * c, c * c + kappa * s * s))
