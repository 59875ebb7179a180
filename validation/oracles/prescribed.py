"""Prescribed speeds: omega = mean + amplitude cos(order theta + phase), polynomials in time or in
the angle."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np

from validation.oracles.arithmetic import LONG, Array, Number
from validation.oracles.free_motion import Motion
from validation.oracles.pressure import pchip_slopes, spline_slopes_between
from validation.oracles.taylor import derivative, evaluate

NODES = 16
DIGITS = 50
HAIR = 1e-9
"""rad: so near below a knot an angle is on it."""


def oscillating_motion(
    angles: Array, mean: Number, amplitude: Number = 0, order: Number = 1, phase: Number = 0
) -> Motion:
    """The motion at the given angles [rad], the first of them at t = 0.

    t = int dtheta / omega by Gauss quadrature between neighbours (angles a few degrees apart), all
    else by differentiation: alpha = omega domega/dtheta. Without amplitude a constant speed.
    """
    number = LONG.number
    theta = LONG.array(angles)
    mean, amplitude, order, phase = (number(x) for x in (mean, amplitude, order, phase))

    def speed(at: Array) -> Array:
        result: Array = mean + amplitude * np.cos(order * at + phase)
        return result

    nodes, weights = (LONG.array(x) for x in np.polynomial.legendre.leggauss(NODES))
    half = np.diff(theta) / 2
    inside = theta[:-1, None] + half[:, None] * (1 + nodes)
    steps = half * (weights / speed(inside)).sum(axis=1) * 2 / weights.sum()
    omega = speed(theta)
    return Motion(
        time=np.append(theta[:1] * 0, np.cumsum(steps)),
        theta=theta,
        omega=omega,
        alpha=-amplitude * order * np.sin(order * theta + phase) * omega,
        steps=len(steps),
    )


def polynomial_motion(
    times: Array, breaks: Sequence[Number], coefficients: Sequence[Array], angle: Number
) -> Motion:
    """The motion at the given times [s], from `angle` [rad] at the first break on.

    coefficients[i][j] multiplies (t - breaks[i])**j in omega from break i on. Exact.
    """
    time = LONG.array(times)
    theta, omega, alpha = (time * 0 for _ in range(3))
    begin = LONG.number(angle)
    for i, low in enumerate(LONG.array(breaks)):
        speed = LONG.array(coefficients[i])
        turned = np.append(begin, speed / np.arange(1, len(speed) + 1))
        after = time >= low
        since = time[after] - low
        theta[after], omega[after] = evaluate(turned, since), evaluate(speed, since)
        alpha[after] = evaluate(np.append(derivative(speed), 0), since)
        if i + 1 < len(breaks):
            begin = evaluate(turned, LONG.number(breaks[i + 1]) - low)
    return Motion(time, theta, omega, alpha, len(breaks))


def pchip(times: Sequence[Number], values: Sequence[Number]) -> list[Array]:
    """Cubic pieces between three or more rows: Fritsch and Carlson's, as SciPy's.

    At the ends the slope is that of the parabola through three rows, held back to keep the shape.
    """
    width, rise = np.diff(LONG.array(times)), np.diff(LONG.array(values))
    chord = rise / width
    slope = np.append(pchip_slopes(width, chord), 0 * chord[:1])
    slope[0] = _end_slope(*width[:2], *chord[:2])
    slope[-1] = _end_slope(*width[:-3:-1], *chord[:-3:-1])
    second = (3 * chord - 2 * slope[:-1] - slope[1:]) / width
    third = (slope[:-1] + slope[1:] - 2 * chord) / width**2
    return list(np.stack([LONG.array(values)[:-1], slope[:-1], second, third], axis=1))


def _end_slope(width: Number, next_width: Number, chord: Number, next_chord: Number) -> Number:
    slope = ((2 * width + next_width) * chord - width * next_chord) / (width + next_width)
    if slope * chord <= 0:
        return 0 * slope
    if chord * next_chord <= 0 and abs(slope) > 3 * abs(chord):
        return 3 * chord
    return slope


def motion_over_angle(
    angles: Array,
    knots: Sequence[Number] | Array,
    coefficients: Sequence[Array],
    period: Number = 0,
) -> Motion:
    """The motion at the given angles [rad], the first of them at t = 0, of a speed over the angle.

    coefficients[i][j] multiplies (angle - knots[i])**j in omega from knot i on, periodic where a
    period [rad] is given. t = int dtheta / omega in closed form in 50 digits: with the roots r of
    omega the sum of log((b - r) / (a - r)) / omega'(r), one piece after the other.
    """
    with mpmath.workdps(DIGITS):
        wide = [_Reciprocal([_wide(c) for c in row]) for row in coefficients]
        at, theta = [_wide(knot) for knot in knots], [_wide(angle) for angle in angles]
        length = 2 * mpmath.pi * round(float(period) / (2 * np.pi)) if period else mpmath.inf
        time = [mpmath.mpf(0)]
        for begin, end in pairwise(theta):
            sense = 1 if end >= begin else -1
            time.append(time[-1] + sense * _passage(wide, at, length, *sorted((begin, end))))
        here = [_place(at, length, angle) for angle in theta]
        omega = [wide[k].value(x) for k, x in here]
        alpha = [wide[k].slope(x) * v for (k, x), v in zip(here, omega, strict=True)]
        t, v, a = (LONG.array(part) for part in (time, omega, alpha))
    return Motion(t, LONG.array(angles), v, a, len(theta) - 1)


def spline(angles: Sequence[Number], values: Sequence[Number]) -> list[Array]:
    """Cubic pieces between two or more rows, two derivatives continuous, not-a-knot at the ends."""
    width, rise = np.diff(LONG.array(angles)), np.diff(LONG.array(values))
    chord = rise / width
    slope = spline_slopes_between(width, chord)
    second = (3 * chord - 2 * slope[:-1] - slope[1:]) / width
    third = (slope[:-1] + slope[1:] - 2 * chord) / width**2
    return list(np.stack([LONG.array(values)[:-1], slope[:-1], second, third], axis=1))


class _Reciprocal:
    """1 / p of a polynomial without a double root, and its integral."""

    def __init__(self, coefficients: list[Any]) -> None:
        while len(coefficients) > 1 and coefficients[-1] == 0:
            coefficients = coefficients[:-1]
        self._coefficients = coefficients
        self._roots = [(r, self.slope(r)) for r in _roots(coefficients)]

    def value(self, x: Any) -> Any:
        return _horner(self._coefficients, x)

    def slope(self, x: Any) -> Any:
        return _horner([k * c for k, c in enumerate(self._coefficients)][1:], x)

    def integral(self, begin: Any, end: Any) -> Any:
        if not self._roots:
            return (end - begin) / self._coefficients[0]
        parts = (mpmath.log((end - r) / (begin - r)) / slope for r, slope in self._roots)
        return mpmath.re(mpmath.fsum(parts))


def _roots(rising: list[Any]) -> list[Any]:
    """Roots of a polynomial as the eigenvalues of its companion matrix, with digits to spare."""
    degree = len(rising) - 1
    if degree == 0:
        return []
    with mpmath.extradps(DIGITS):
        companion = mpmath.zeros(degree)
        for k in range(degree):
            companion[k, degree - 1] = -rising[k] / rising[degree]
            if k:
                companion[k, k - 1] = 1
        return list(mpmath.eig(companion, left=False, right=False))


def _horner(rising: list[Any], x: Any) -> Any:
    total = mpmath.mpf(0)
    for coefficient in reversed(rising):
        total = total * x + coefficient
    return total


def _passage(pieces: list[_Reciprocal], knots: list[Any], period: Any, begin: Any, end: Any) -> Any:
    """int dtheta / omega from one angle up to another."""
    total = mpmath.mpf(0)
    while begin < end:
        k, x = _place(knots, period, begin)
        last = knots[k + 1] if k + 1 < len(knots) else knots[0] + period
        step = min(last - knots[k] - x, end - begin)
        total += pieces[k].integral(x, x + step)
        begin = end if step == end - begin else begin + step
    return total


def _place(knots: list[Any], period: Any, angle: Any) -> tuple[int, Any]:
    """The piece that begins at or before an angle, a hair before a knot the one behind it; and how
    far it is in."""
    turns = 0 if mpmath.isinf(period) else mpmath.floor((angle - knots[0] + HAIR) / period)
    angle = angle - turns * period if turns else angle
    k = max(k for k, knot in enumerate(knots) if k == 0 or knot <= angle + HAIR)
    return k, angle - knots[k]


def _wide(value: Number) -> Any:
    leading = float(value)
    return mpmath.mpf(leading) + mpmath.mpf(float(value - leading))
