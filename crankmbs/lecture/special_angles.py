"""S2's values at quarter turns, and where the acceleration's minimum leaves bottom dead centre."""

from __future__ import annotations

from math import sqrt
from typing import Final

import numpy as np

from crankmbs.lecture._domain import Real, converging, falling_root, series_ratio

ACCELERATION_MINIMUM_LIMIT: Final = (sqrt(21.0) - 3.0) / 6.0
"""Rod ratio up to which the exact acceleration is least at BDC: root of 3 x^3 - 4 x + 1 = 0."""

ACCELERATION_MINIMUM_LIMIT_SERIES: Final = 0.25
"""The same for the truncated acceleration; S2 says "at BDC" for every rod ratio."""


def quarter_displacements_series(*, crank_radius: Real, rod_length: Real) -> Real:
    """Displacement at 0, 90, 180, 270 degrees: 0, r (1 + lambda/2), 2 r, r (1 + lambda/2).

    Approximate, order 3 in lambda: at 90 and 270 degrees too small by r lambda^3 / 8, else exact.
    Error of s/r at lambda 0.20, 0.25, 0.30, 0.33: 1.02e-3, 2.02e-3, 3.54e-3, 4.75e-3.
    Source: S2-V2.
    Misprint: S2 prints "approximately 90" for phi = 90.
    Arguments: crank_radius r [m]; rod_length l [m].
    Returns: shape (4, ...) [m].
    Raises: InputError for a rod ratio of 1 or more.

    >>> print(quarter_displacements_series(crank_radius=0.05, rod_length=0.2))
    [0.      0.05625 0.1     0.05625]
    """
    half = crank_radius * (1.0 + series_ratio(crank_radius, rod_length) / 2.0)
    return np.stack(np.broadcast_arrays(0.0, half, 2.0 * crank_radius, half))


def quarter_velocities(*, crank_radius: Real, omega: Real) -> Real:
    """Velocity at 0, 90, 180, 270 degrees: 0, r omega, 0, -r omega, for any rod.

    Exact, central gear.
    Source: S2-F13a, the values below it.
    Arguments: crank_radius r [m]; omega [rad/s].
    Returns: shape (4, ...) [m/s].

    >>> print(quarter_velocities(crank_radius=0.05, omega=100.0))
    [ 0.  5.  0. -5.]
    """
    speed = crank_radius * omega
    return np.stack(np.broadcast_arrays(0.0, speed, 0.0, -speed))


def dead_centre_accelerations(*, crank_radius: Real, rod_length: Real, omega: Real) -> Real:
    """Acceleration at 0 and 180 degrees: r omega^2 (1 + lambda) and -r omega^2 (1 - lambda).

    Exact, central gear, constant speed.
    Source: S2-V5.
    Misprint: S2 calls the second "the maximum negative" for every rod ratio; that ends at
        `ACCELERATION_MINIMUM_LIMIT`.
    Arguments: crank_radius r [m]; rod_length l [m]; omega [rad/s].
    Returns: shape (2, ...) [m/s^2].

    >>> print(dead_centre_accelerations(crank_radius=0.05, rod_length=0.2, omega=100.0))
    [ 625. -375.]
    """
    unit = crank_radius * omega**2
    ratio = crank_radius / rod_length
    return np.stack(np.broadcast_arrays(unit * (1.0 + ratio), -unit * (1.0 - ratio)))


def acceleration_minimum_angle_series(*, rod_ratio: Real) -> Real:
    """Crank angle of the least truncated acceleration: acos(-1/(4 lambda)), or pi to lambda 1/4.

    Approximate; the other minimum lies at 2 pi minus this.
    Error of phi in degrees at lambda 0.20, 0.25, 0.30, 0.33: 0, 0, 1.79, 0.76.
    Source: S2-V5 (corrected), S2-F14.
    Arguments: rod_ratio lambda [1].
    Returns: phi [rad], from pi/2 to pi.
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{acceleration_minimum_angle_series(rod_ratio=0.3):.6f}"
    '2.555907'
    """
    angle: Real = np.arccos(-1.0 / np.maximum(4.0 * converging(rod_ratio), 1.0))
    return angle


def acceleration_minimum_angle(*, rod_ratio: Real) -> Real:
    """Crank angle of the least exact acceleration; pi up to `ACCELERATION_MINIMUM_LIMIT`.

    The root of s'''(phi) = 0 beside pi, by bisection: with q = 1 - lambda^2 sin^2 phi and
    u = sin^2 phi, lambda cos phi [3 lambda^2 (1 - 2 u + lambda^2 u^2) - 4 q^2] = q^(5/2).
    Exact, central gear, constant speed; the other minimum lies at 2 pi minus this.
    Source: S2-V5 (corrected).
    Arguments: rod_ratio lambda [1].
    Returns: phi [rad], from pi/2 to pi.
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{acceleration_minimum_angle(rod_ratio=0.3):.6f}"
    '2.587145'
    """
    ratio = converging(rod_ratio)

    def jerk_over_sine(angle: Real) -> Real:
        u = np.sin(angle) ** 2
        q = 1.0 - ratio**2 * u
        bracket = 3.0 * ratio**2 * (1.0 - 2.0 * u + ratio**2 * u**2) - 4.0 * q**2
        value: Real = ratio * np.cos(angle) * bracket - q**2.5
        return value

    return falling_root(jerk_over_sine, np.pi, 0.5 * np.pi)
