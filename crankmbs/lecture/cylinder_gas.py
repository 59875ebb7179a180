"""Cylinder volumes, the gas force, and the polytropes with Brauer's construction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.lecture._domain import Real, require
from crankmbs.lecture.dead_centres import datum_shift
from crankmbs.lecture.motion import piston_displacement
from crankmbs.lecture.motion_series import piston_displacement_series


def piston_area(*, bore: Real) -> Real:
    """Piston area: A_p = pi D^2 / 4.

    Exact.
    Source: S1 Eq. 9; S in S0-F19.
    Arguments: bore D [m].
    Returns: [m^2].

    >>> f"{piston_area(bore=0.1):.8f}"
    '0.00785398'
    """
    return np.pi * bore**2 / 4.0


def gas_force(*, gas_pressure: Real, ambient_pressure: Real, piston_area: Real) -> Real:
    """Gas force on the piston: P_G = (p_g - p_0) A_p.

    Exact.
    Source: S0-F19 (F_p = S p, where p must be the difference), S1 Eq. 9.
    Misprint: S1 Table 2 prints p(30) = 0.97275; its Table 4 has used 0.97928.
    Arguments: gas_pressure p_g, absolute, shape (n,) [Pa]; ambient_pressure p_0 [Pa];
        piston_area A_p [m^2].
    Returns: shape (n,) [N], positive towards the crank.

    >>> gas_force(gas_pressure=3e5, ambient_pressure=1e5, piston_area=0.005)
    1000.0
    """
    return (gas_pressure - ambient_pressure) * piston_area


def clearance_volume(*, swept_volume: Real, compression_ratio: Real) -> Real:
    """Clearance volume: V_c = V_h / (r_c - 1).

    Exact.
    Source: S1 Eq. 6, where AB is the swept volume.
    Misprint: S1 prints AB/r^(c-1).
    Arguments: swept_volume V_h [m^3]; compression_ratio r_c [1].
    Returns: [m^3].
    Raises: InputError for a compression ratio of 1 or less.

    >>> f"{clearance_volume(swept_volume=475e-6, compression_ratio=20.0):.3e}"
    '2.500e-05'
    """
    require(
        np.greater(compression_ratio, 1.0),
        "compression_ratio",
        "must be above 1",
        compression_ratio,
        "give (swept + clearance) / clearance volume",
    )
    return swept_volume / (compression_ratio - 1.0)


def cylinder_volume(
    crank_angle: Real,
    *,
    crank_radius: Real,
    rod_length: Real,
    piston_area: Real,
    clearance_volume: Real,
    offset: Real = 0.0,
) -> Real:
    """Cylinder volume: V = V_c + A_p (s - s_TDC), V_c being at the true top dead centre.

    Exact.
    Source: S1 Sec. 2.1 with S0-F7.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        piston_area A_p [m^2]; clearance_volume V_c [m^3]; offset e [m].
    Returns: shape (n,) [m^3].
    Raises: InputError if the crank cannot turn round.

    >>> geometry = {"crank_radius": 0.05, "rod_length": 0.2}
    >>> f"{cylinder_volume(0.0, **geometry, piston_area=0.01, clearance_volume=5e-5):.1e}"
    '5.0e-05'
    """
    travel = piston_displacement(
        crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset
    ) - datum_shift(crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return clearance_volume + piston_area * travel


def cylinder_volume_series(
    crank_angle: Real,
    *,
    crank_radius: Real,
    rod_length: Real,
    piston_area: Real,
    clearance_volume: Real,
    offset: Real = 0.0,
) -> Real:
    """Cylinder volume from the truncated displacement: V = V_c + A_p s.

    Approximate, order 3 in lambda, as `piston_displacement_series`, counted from phi = 0.
    Error of (V - V_c)/(A_p r) at lambda 0.20, 0.25, 0.30, 0.33: 1.02e-3, 2.02e-3, 3.54e-3,
        4.75e-3; with k 0.0282: 1.16e-3, 2.28e-3, 3.99e-3, 5.36e-3.
    Source: S1 Sec. 2.1 with S1 Eq. 3.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        piston_area A_p [m^2]; clearance_volume V_c [m^3]; offset e [m].
    Returns: shape (n,) [m^3].
    Raises: InputError for a rod ratio of 1 or more.

    >>> geometry = {"crank_radius": 0.05, "rod_length": 0.2}
    >>> f"{cylinder_volume_series(0.0, **geometry, piston_area=0.01, clearance_volume=5e-5):.1e}"
    '5.0e-05'
    """
    travel = piston_displacement_series(
        crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset
    )
    return clearance_volume + piston_area * travel


def polytropic_pressure(
    volume: Real, *, reference_volume: Real, reference_pressure: Real, exponent: Real
) -> Real:
    """Pressure on the polytrope through a reference state: p = p_0 (V_0/V)^n.

    Exact.
    Source: S1 Eq. 7, 8 draw it; S1-V4: n_1 1.32 to 1.40 (compression), n_2 1.18 to 1.28.
    Arguments: volume V, shape (n,) [m^3]; reference_volume V_0 [m^3]; reference_pressure p_0,
        absolute [Pa]; exponent n [1].
    Returns: shape (n,), absolute [Pa].

    >>> polytropic_pressure(0.5, reference_volume=1.0, reference_pressure=1e5, exponent=1.0)
    200000.0
    """
    pressure: Real = reference_pressure * (reference_volume / volume) ** exponent
    return pressure


def brauer_angle(*, volume_angle: Real, exponent: Real) -> Real:
    """Brauer's angle at the pressure axis: beta = atan((1 + tan alpha)^n - 1).

    Exact.
    Source: S1 Eq. 7 (compression), 8 (expansion).
    Misprint: S1 prints tan beta_1 in both (Eq. 8 is beta_2), and the indices of n_1, n_2 as powers.
    Arguments: volume_angle alpha, at the volume axis [rad]; exponent n [1].
    Returns: beta [rad].
    Raises: InputError for an angle outside 0 to pi/2.

    >>> f"{brauer_angle(volume_angle=0.2617993878, exponent=1.32):.6f}"
    '0.352643'
    """
    require(
        np.greater(volume_angle, 0.0) & np.less(volume_angle, 0.5 * np.pi),
        "volume_angle",
        "must lie between 0 and pi/2",
        volume_angle,
        "take about 0.26 rad (15 degrees)",
    )
    beta: Real = np.arctan((1.0 + np.tan(volume_angle)) ** exponent - 1.0)
    return beta


def brauer_points(
    step: NDArray[np.int_],
    *,
    volume_angle: Real,
    exponent: Real,
    reference_volume: Real,
    reference_pressure: Real,
) -> tuple[Real, Real]:
    """Points of Brauer's construction: V_i = V_0 (1 + tan alpha)^i, p_i = p_0 (1 + tan beta)^-i.

    Each step multiplies the volume and divides the pressure by one factor: the 45-degree lines
    between the axes and the lines at alpha and beta. Steps below 0 compress.
    Exact: the points lie on the polytrope.
    Source: S1 Eq. 7, 8.
    Arguments: step i, whole numbers, shape (n,) [1]; volume_angle alpha [rad]; exponent n [1];
        reference_volume V_0 [m^3]; reference_pressure p_0, absolute [Pa].
    Returns: volumes, shape (n,) [m^3], and pressures, shape (n,), absolute [Pa].
    Raises: InputError for an angle outside 0 to pi/2.

    >>> start = {"reference_volume": 1.0, "reference_pressure": 8.0}
    >>> v, p = brauer_points(
    ...     np.array([0, 1, 2]), volume_angle=np.pi / 4, exponent=1.0, **start
    ... )
    >>> print(v.round(9), p.round(9))
    [1. 2. 4.] [8. 4. 2.]
    """
    beta = brauer_angle(volume_angle=volume_angle, exponent=exponent)
    volumes: Real = reference_volume * (1.0 + np.tan(volume_angle)) ** step
    pressures: Real = reference_pressure * (1.0 + np.tan(beta)) ** -step
    return volumes, pressures
