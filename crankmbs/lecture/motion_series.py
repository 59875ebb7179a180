"""The piston's motion truncated after the second harmonic: constant speed, offset as in S1."""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real, series_ratio


def piston_displacement_series(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Piston displacement: s = r [1 - cos phi + (lambda/4)(1 - cos 2 phi) - k lambda sin phi].

    Approximate, order 3 in lambda: with k = e/r short of the exact by r lambda k^2/2 (the datum:
        at phi = 0 this is 0) and by r lambda^3 (sin phi - k)^4 / 8.
    Error of s/r at lambda 0.20, 0.25, 0.30, 0.33: 1.02e-3, 2.02e-3, 3.54e-3, 4.75e-3;
        with k 0.0282: 1.22e-3, 2.36e-3, 4.08e-3, 5.46e-3 (order 1).
    Source: S0-F8, S1 Eq. 3, S2-F11.
    Misprint: S1 Table 1 prints s(240) = 74.369 mm for 74.512.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [m], positive towards the crank.
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{piston_displacement_series(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.027410'
    """
    ratio = series_ratio(crank_radius, rod_length)
    return (
        crank_radius * (1.0 - np.cos(crank_angle))
        + crank_radius * ratio / 4.0 * (1.0 - np.cos(2.0 * crank_angle))
        - offset * ratio * np.sin(crank_angle)
    )


def first_order_displacement(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Part of the truncated displacement at crank frequency: r (1 - cos phi - k lambda sin phi).

    Approximate: with the second order it is `piston_displacement_series`.
    Source: S2-F12; the offset's part from S1 Eq. 3.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [m].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{first_order_displacement(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.022985'
    """
    ratio = series_ratio(crank_radius, rod_length)
    return crank_radius * (1.0 - np.cos(crank_angle)) - offset * ratio * np.sin(crank_angle)


def second_order_displacement(crank_angle: Real, *, crank_radius: Real, rod_length: Real) -> Real:
    """Part of the truncated displacement at twice that frequency: (r lambda/4)(1 - cos 2 phi).

    Approximate: with the first order it is `piston_displacement_series`.
    Source: S2-F12.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m].
    Returns: shape (n,) [m].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{second_order_displacement(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.004425'
    """
    ratio = series_ratio(crank_radius, rod_length)
    return crank_radius * ratio / 4.0 * (1.0 - np.cos(2.0 * crank_angle))


def piston_velocity_series(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, omega: Real, offset: Real = 0.0
) -> Real:
    """Piston velocity: v = r omega [sin phi + (lambda/2) sin 2 phi - k lambda cos phi].

    Approximate, order 3 in lambda: off by -r omega lambda^3 (sin phi - k)^3 cos phi / 2.
    Error of v/(r omega) at lambda 0.20, 0.25, 0.30, 0.33: 1.33e-3, 2.63e-3, 4.62e-3, 6.22e-3;
        with k 0.0282: 1.47e-3, 2.90e-3, 5.10e-3, 6.88e-3.
    Source: S0-F11, S0-F12, S1 Eq. 4, S2-F13a.
    Misprint: S1 Table 1 prints v(30) = 9.9597 m/s for 9.597.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        omega [rad/s]; offset e [m].
    Returns: shape (n,) [m/s], positive towards the crank.
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{piston_velocity_series(1.0, crank_radius=0.05, rod_length=0.2, omega=100.0):.6f}"
    '4.775666'
    """
    ratio = series_ratio(crank_radius, rod_length)
    shape = (
        np.sin(crank_angle)
        + ratio / 2.0 * np.sin(2.0 * crank_angle)
        - offset / crank_radius * ratio * np.cos(crank_angle)
    )
    return crank_radius * omega * shape


def piston_acceleration_series(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, omega: Real, offset: Real = 0.0
) -> Real:
    """Piston acceleration: a = r omega^2 [cos phi + lambda cos 2 phi + k lambda sin phi].

    Approximate, order 3 in lambda: off by the derivative in phi of the velocity's error. Constant
        speed: an angular acceleration of the crank is left out.
    Error of a/(r omega^2) at lambda 0.20, 0.25, 0.30, 0.33: 4.12e-3, 8.20e-3, 1.45e-2, 1.96e-2;
        with k 0.0282: 4.49e-3, 8.94e-3, 1.58e-2, 2.14e-2.
    Source: S0-F14, S1 Eq. 5, S2-F14.
    Misprint: S1 Eq. 5 lacks omega^2 (its Table 1 has it); S2 prints aW/dphi for dW/dphi.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        omega [rad/s]; offset e [m].
    Returns: shape (n,) [m/s^2], positive towards the crank.
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{piston_acceleration_series(1.0, crank_radius=0.05, rod_length=0.2, omega=100.0):.4f}"
    '218.1328'
    """
    ratio = series_ratio(crank_radius, rod_length)
    shape = (
        np.cos(crank_angle)
        + ratio * np.cos(2.0 * crank_angle)
        + offset / crank_radius * ratio * np.sin(crank_angle)
    )
    return crank_radius * omega**2 * shape
