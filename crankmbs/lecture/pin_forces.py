"""The net force's way through the rod to the torque, exact: two-mass rod, no friction, no gravity.

A force towards the crank is positive; S0's side thrust N is S1's Q, S0's F_R is S1's N.
"""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real
from crankmbs.lecture.rod_angles import cos_beta, rod_angle, tan_beta


def net_force(*, gas_force: Real, inertia_force: Real) -> Real:
    """Net force on the piston pin along the cylinder axis: F_v = F_p + F_zp.

    Exact.
    Source: S0-F27, S1 Eq. 24.
    Misprint: S1 prints P_G +- F_i; with F_i signed as in its Eq. 22 it must be plus. Its Table 4
        prints F(330) = 172.097 kgf for -172.097.
    Arguments: gas_force F_p, shape (n,) [N]; inertia_force F_zp, signed, shape (n,) [N].
    Returns: shape (n,) [N], positive towards the crank.

    >>> net_force(gas_force=1000.0, inertia_force=-200.0)
    800.0
    """
    return gas_force + inertia_force


def side_thrust(
    crank_angle: Real,
    *,
    net_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Side thrust of the piston against the cylinder wall: N = F_v tan beta (S1's Q).

    Exact for the two-mass rod.
    Source: S0-F28, S1 Eq. 25 before its truncation.
    Arguments: crank_angle phi, shape (n,) [rad]; net_force F_v, shape (n,) [N]; crank_radius r [m];
        rod_length l [m]; offset e [m].
    Returns: shape (n,) [N], positive where the wall pushes the piston towards +Y.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{side_thrust(1.0, net_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '215.183'
    """
    return net_force * tan_beta(
        crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset
    )


def rod_force(
    crank_angle: Real,
    *,
    net_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Force along the connecting rod: F_oj = F_v / cos beta (S1's K).

    Exact for the two-mass rod.
    Source: S0-F29, S1 Eq. 26 before its truncation.
    Arguments: crank_angle phi, shape (n,) [rad]; net_force F_v, shape (n,) [N]; crank_radius r [m];
        rod_length l [m]; offset e [m].
    Returns: shape (n,) [N], positive in compression.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{rod_force(1.0, net_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '1022.890'
    """
    return net_force / cos_beta(
        crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset
    )


def tangential_force(
    crank_angle: Real,
    *,
    rod_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Tangential force on the crank pin: F_T = F_oj sin(phi + beta).

    Exact for the two-mass rod.
    Source: S0-F30, S1 Eq. 27 before its truncation.
    Arguments: crank_angle phi, shape (n,) [rad]; rod_force F_oj, shape (n,) [N]; crank_radius r
        [m]; rod_length l [m]; offset e [m].
    Returns: shape (n,) [N], positive where it drives the crank on.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{tangential_force(1.0, rod_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '936.303'
    """
    beta = rod_angle(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return rod_force * np.sin(crank_angle + beta)


def radial_force(
    crank_angle: Real,
    *,
    rod_force: Real,
    crank_radius: Real,
    rod_length: Real,
    offset: Real = 0.0,
) -> Real:
    """Radial force on the crank pin: F_R = F_oj cos(phi + beta) (S1's N).

    Exact for the two-mass rod.
    Source: S0-F31, S1 Eq. 28 before its truncation.
    Arguments: crank_angle phi, shape (n,) [rad]; rod_force F_oj, shape (n,) [N]; crank_radius r
        [m]; rod_length l [m]; offset e [m].
    Returns: shape (n,) [N], positive towards the crank axis.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{radial_force(1.0, rod_force=1000.0, crank_radius=0.05, rod_length=0.2):.3f}"
    '351.193'
    """
    beta = rod_angle(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return rod_force * np.cos(crank_angle + beta)


def crank_torque(*, tangential_force: Real, crank_radius: Real) -> Real:
    """Torque of one cylinder on the crank: M_k = F_T r.

    Exact.
    Source: S0-F32, S1 Eq. 29.
    Arguments: tangential_force F_T, shape (n,) [N]; crank_radius r [m].
    Returns: shape (n,) [N m], positive where it drives the crank on.

    >>> crank_torque(tangential_force=1000.0, crank_radius=0.05)
    50.0
    """
    return tangential_force * crank_radius
