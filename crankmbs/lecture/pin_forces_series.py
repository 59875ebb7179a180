"""S1's truncated side thrust, rod force, tangential and radial force, with its offset."""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real, series_ratio
from crankmbs.lecture.rod_angles import secant_beta_series, tan_beta_series


def side_thrust_series(
    crank_angle: Real,
    *,
    net_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Side thrust of the piston against the cylinder wall: Q = F lambda (sin phi - k).

    Approximate, order 3 in lambda: off by -F lambda^3 (sin phi - k)^3 / 2.
    Error of Q/F at lambda 0.20, 0.25, 0.30, 0.33: 4.12e-3, 8.20e-3, 1.45e-2, 1.96e-2;
        with k 0.0282: 4.49e-3, 8.94e-3, 1.58e-2, 2.14e-2.
    Source: S1 Eq. 25.
    Arguments: crank_angle phi, shape (n,) [rad]; net_force F, shape (n,) [N]; crank_radius r [m];
        rod_length l [m]; offset e [m].
    Returns: shape (n,) [N].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{side_thrust_series(1.0, net_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '210.368'
    """
    return net_force * tan_beta_series(
        crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset
    )


def rod_force_series(
    crank_angle: Real, *, net_force: Real, crank_radius: Real, rod_length: Real
) -> Real:
    """Force along the connecting rod: K = F [1 + (lambda^2/4)(1 - cos 2 phi)].

    Approximate, order 4 in lambda: too small by 3/8 F lambda^4 sin^4 phi. It knows no offset.
    Error of K/F at lambda 0.20, 0.25, 0.30, 0.33: 6.21e-4, 1.55e-3, 3.28e-3, 4.89e-3;
        with k 0.0282: 1.84e-3, 3.52e-3, 6.26e-3, 8.62e-3 (order 2).
    Source: S1 Eq. 26.
    Misprint: S1 Table 5 prints K(180) = 562.06 kgf for 562.97.
    Arguments: crank_angle phi, shape (n,) [rad]; net_force F, shape (n,) [N]; crank_radius r [m];
        rod_length l [m].
    Returns: shape (n,) [N].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{rod_force_series(1.0, net_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '1022.127'
    """
    return net_force * secant_beta_series(
        crank_angle, crank_radius=crank_radius, rod_length=rod_length
    )


def tangential_force_series(
    crank_angle: Real,
    *,
    net_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Tangential crank-pin force: F_t = F [sin phi + (lambda/2) sin 2 phi - k lambda cos phi].

    Approximate, order 3 in lambda, as `piston_velocity_series`: off by
        -F lambda^3 (sin phi - k)^3 cos phi / 2.
    Error of F_t/F at lambda 0.20, 0.25, 0.30, 0.33: 1.33e-3, 2.63e-3, 4.62e-3, 6.22e-3;
        with k 0.0282: 1.47e-3, 2.90e-3, 5.10e-3, 6.88e-3.
    Source: S1 Eq. 27.
    Misprint: S1 Table 5 prints F_t(120) = 373.91 kgf for 374.09.
    Arguments: crank_angle phi, shape (n,) [rad]; net_force F, shape (n,) [N]; crank_radius r [m];
        rod_length l [m]; offset e [m].
    Returns: shape (n,) [N].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{tangential_force_series(1.0, net_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '955.133'
    """
    ratio = series_ratio(crank_radius, rod_length)
    shape = (
        np.sin(crank_angle)
        + ratio / 2.0 * np.sin(2.0 * crank_angle)
        - offset / crank_radius * ratio * np.cos(crank_angle)
    )
    return net_force * shape


def radial_force_series(
    crank_angle: Real,
    *,
    net_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Radial crank-pin force: N = F [cos phi - (lambda/2)(1 - cos 2 phi) + k lambda sin phi].

    Approximate, order 3 in lambda: off by F lambda^3 sin phi (sin phi - k)^3 / 2.
    Error of N/F at lambda 0.20, 0.25, 0.30, 0.33: 4.12e-3, 8.20e-3, 1.45e-2, 1.96e-2;
        with k 0.0282: 4.49e-3, 8.94e-3, 1.58e-2, 2.14e-2.
    Source: S1 Eq. 28.
    Misprint: S1 Table 5 prints N(120) = -362.59 kgf for -362.63.
    Arguments: crank_angle phi, shape (n,) [rad]; net_force F, shape (n,) [N]; crank_radius r [m];
        rod_length l [m]; offset e [m].
    Returns: shape (n,) [N].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{radial_force_series(1.0, net_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '363.284'
    """
    ratio = series_ratio(crank_radius, rod_length)
    shape = (
        np.cos(crank_angle)
        - ratio / 2.0 * (1.0 - np.cos(2.0 * crank_angle))
        + offset / crank_radius * ratio * np.sin(crank_angle)
    )
    return net_force * shape
