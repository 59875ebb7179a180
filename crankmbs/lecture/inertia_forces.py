"""Inertia forces of the reciprocating and rotating masses, and their orders.

S0 prints magnitudes "acting against" the motion; here, as in S1, a force towards the crank is
positive, so that the gas force and the inertia force add up to the net force.
"""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real, series_ratio


def rotating_inertia_force(*, rotating_mass: Real, crank_radius: Real, omega: Real) -> Real:
    """Centrifugal force of the rotating mass: F_zr = m_B r omega^2, outwards along the throw.

    Exact for the two-mass rod.
    Source: S0-F20, S0-F21, S1 Eq. 10.
    Arguments: rotating_mass m_B [kg]; crank_radius r [m]; omega [rad/s].
    Returns: [N].

    >>> rotating_inertia_force(rotating_mass=2.0, crank_radius=0.05, omega=100.0)
    1000.0
    """
    return rotating_mass * crank_radius * omega**2


def inertia_force(*, reciprocating_mass: Real, piston_acceleration: Real) -> Real:
    """Inertia force of the reciprocating mass: F_zp = -m_A a.

    Exact with the exact acceleration and the two-mass rod.
    Source: S0-F22.
    Misprint: S0 prints the magnitude, +m_A a; its F_v = F_p + F_zp needs the sign.
    Arguments: reciprocating_mass m_A [kg]; piston_acceleration a, shape (n,) [m/s^2].
    Returns: shape (n,) [N], positive towards the crank.

    >>> inertia_force(reciprocating_mass=2.0, piston_acceleration=100.0)
    -200.0
    """
    return -reciprocating_mass * piston_acceleration


def inertia_force_series(
    crank_angle: Real,
    *,
    reciprocating_mass: Real,
    crank_radius: Real,
    rod_length: Real,
    omega: Real,
    offset: Real = 0.0,
) -> Real:
    """Inertia force: F_i = -m_A r omega^2 [cos phi + lambda cos 2 phi + k lambda sin phi].

    Approximate, order 3 in lambda, as `piston_acceleration_series`. Constant speed.
    Error of F/(m_A r omega^2) at lambda 0.20, 0.25, 0.30, 0.33: 4.12e-3, 8.20e-3, 1.45e-2,
        1.96e-2; with k 0.0282: 4.49e-3, 8.94e-3, 1.58e-2, 2.14e-2.
    Source: S0-F24 to S0-F26, S1 Eq. 22.
    Misprint: S1 Table 4 prints F_i(360) = -1356.098 kgf for -1056.098.
    Arguments: crank_angle phi, shape (n,) [rad]; reciprocating_mass m_A [kg]; crank_radius r [m];
        rod_length l [m]; omega [rad/s]; offset e [m].
    Returns: shape (n,) [N], positive towards the crank.
    Raises: InputError for a rod ratio of 1 or more.

    >>> machine = {"crank_radius": 0.05, "rod_length": 0.2, "omega": 100.0}
    >>> f"{inertia_force_series(0.0, reciprocating_mass=2.0, **machine):.1f}"
    '-1250.0'
    """
    return first_order_inertia_force(
        crank_angle,
        reciprocating_mass=reciprocating_mass,
        crank_radius=crank_radius,
        rod_length=rod_length,
        omega=omega,
        offset=offset,
    ) + second_order_inertia_force(
        crank_angle,
        reciprocating_mass=reciprocating_mass,
        crank_radius=crank_radius,
        rod_length=rod_length,
        omega=omega,
    )


def first_order_inertia_force(
    crank_angle: Real,
    *,
    reciprocating_mass: Real,
    crank_radius: Real,
    rod_length: Real,
    omega: Real,
    offset: Real = 0.0,
) -> Real:
    """Inertia force at crank frequency: F_zpI = -m_A r omega^2 [cos phi + k lambda sin phi].

    Approximate: with the second order it is `inertia_force_series`.
    Source: S0-F25, S0-F26; the offset's part from S1 Eq. 22.
    Arguments: crank_angle phi, shape (n,) [rad]; reciprocating_mass m_A [kg]; crank_radius r [m];
        rod_length l [m]; omega [rad/s]; offset e [m].
    Returns: shape (n,) [N], positive towards the crank.
    Raises: InputError for a rod ratio of 1 or more.

    >>> machine = {"crank_radius": 0.05, "rod_length": 0.2, "omega": 100.0}
    >>> f"{first_order_inertia_force(0.0, reciprocating_mass=2.0, **machine):.1f}"
    '-1000.0'
    """
    skew = offset / crank_radius * series_ratio(crank_radius, rod_length)
    shape = np.cos(crank_angle) + skew * np.sin(crank_angle)
    return -reciprocating_mass * crank_radius * omega**2 * shape


def second_order_inertia_force(
    crank_angle: Real,
    *,
    reciprocating_mass: Real,
    crank_radius: Real,
    rod_length: Real,
    omega: Real,
) -> Real:
    """Inertia force at twice the crank frequency: F_zpII = -m_A r omega^2 lambda cos 2 phi.

    Approximate: with the first order it is `inertia_force_series`.
    Source: S0-F25, S0-F26.
    Arguments: crank_angle phi, shape (n,) [rad]; reciprocating_mass m_A [kg]; crank_radius r [m];
        rod_length l [m]; omega [rad/s].
    Returns: shape (n,) [N], positive towards the crank.
    Raises: InputError for a rod ratio of 1 or more.

    >>> machine = {"crank_radius": 0.05, "rod_length": 0.2, "omega": 100.0}
    >>> f"{second_order_inertia_force(0.0, reciprocating_mass=2.0, **machine):.1f}"
    '-250.0'
    """
    shape = series_ratio(crank_radius, rod_length) * np.cos(2.0 * crank_angle)
    return -reciprocating_mass * crank_radius * omega**2 * shape
