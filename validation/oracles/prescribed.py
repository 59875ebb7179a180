"""Prescribed speeds: omega = mean + amplitude cos(order theta + phase), or polynomials in time."""

from collections.abc import Sequence

import numpy as np

from validation.oracles.arithmetic import LONG, Array, Number
from validation.oracles.free_motion import Motion
from validation.oracles.pressure import pchip_slopes
from validation.oracles.taylor import derivative, evaluate

NODES = 16


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
