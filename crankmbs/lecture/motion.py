"""The piston's motion, exact: with offset, at any speed and angular acceleration of the crank."""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real
from crankmbs.lecture.rod_angles import cos_beta, tan_beta


def piston_displacement(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Piston displacement from l + r: s = r [1 - cos phi + (1 - cos beta)/lambda].

    Exact.
    Source: S0-F1, S0-F2, S0-F7, S2-F6, S2-F7.
    Misprint: S2 prints C'C - C'O - CO for C'C = C'O - CO.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [m], positive towards the crank, zero where the pin is l + r from the crank
        axis; with an offset the true top dead centre lies `datum_shift` further on.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{piston_displacement(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.027460'
    """
    cosine = cos_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return crank_radius * (1.0 - np.cos(crank_angle)) + rod_length * (1.0 - cosine)


def piston_velocity(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, omega: Real, offset: Real = 0.0
) -> Real:
    """Piston velocity: v = r omega (sin phi + cos phi tan beta) = r omega sin(phi + beta)/cos beta.

    Exact at any angular acceleration.
    Source: S0-F10, which is its central case.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        omega [rad/s]; offset e [m].
    Returns: shape (n,) [m/s], positive towards the crank.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{piston_velocity(1.0, crank_radius=0.05, rod_length=0.2, omega=100.0):.6f}"
    '4.788674'
    """
    slope = tan_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return crank_radius * omega * (np.sin(crank_angle) + np.cos(crank_angle) * slope)


def piston_acceleration(
    crank_angle: Real,
    *,
    crank_radius: Real,
    rod_length: Real,
    omega: Real,
    alpha: Real = 0.0,
    offset: Real = 0.0,
) -> Real:
    """Piston acceleration: a = s'' omega^2 + s' alpha, the dashes being derivatives in phi.

    s'' = r [cos phi - sin phi tan beta + lambda cos^2 phi / cos^3 beta]; s' as in the velocity.
    Exact at any angular acceleration.
    Source: S0-F14 before its truncation, which also takes omega as constant.
    Misprint: S0 prints dx^2/dt^2 for d2x/dt2.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        omega [rad/s]; alpha, its derivative [rad/s^2]; offset e [m].
    Returns: shape (n,) [m/s^2], positive towards the crank.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{piston_acceleration(1.0, crank_radius=0.05, rod_length=0.2, omega=100.0):.4f}"
    '218.6704'
    """
    cosine = cos_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    slope = tan_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    across, along = np.sin(crank_angle), np.cos(crank_angle)
    first = crank_radius * (across + along * slope)
    second = crank_radius * (
        along - across * slope + crank_radius / rod_length * (along / cosine) ** 2 / cosine
    )
    return second * omega**2 + first * alpha
