"""Crank speed, crank angle at constant speed, mean and maximum piston speed."""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real, falling_root, require_turning
from crankmbs.lecture.dead_centres import bottom_dead_centre, top_dead_centre
from crankmbs.lecture.motion import piston_acceleration, piston_velocity


def angular_speed(*, rotational_frequency: Real) -> Real:
    """Angular speed of the crank: omega = 2 pi n.

    Exact.
    Source: S2-F1, with n in 1/min: pi n / 30.
    Arguments: rotational_frequency n, revolutions per second [1/s].
    Returns: omega [rad/s].

    >>> f"{angular_speed(rotational_frequency=3200 / 60):.6f}"
    '335.103216'
    """
    return 2.0 * np.pi * rotational_frequency


def crank_angle_at(*, time: Real, omega: Real) -> Real:
    """Crank angle at constant speed: phi = omega t.

    Exact.
    Source: S2-F2.
    Misprint: S2 adds "or 6 pi n t"; 6 n t is right, in degrees with n in 1/min.
    Arguments: time t, shape (n,) [s]; omega [rad/s].
    Returns: phi, shape (n,) [rad].

    >>> crank_angle_at(time=0.5, omega=3.0)
    1.5
    """
    return omega * time


def mean_piston_speed(*, stroke: Real, omega: Real) -> Real:
    """Mean piston speed: c_s = 2 z n = z omega / pi, with the stroke z.

    Exact.
    Source: S0-F9, S2-F13 (S n / 30, n in 1/min); S2-V4 calls 5 to 15 m/s usual.
    Misprint: S1-V5 takes 7 m/s, which its stroke and speed make 9.81 m/s.
    Arguments: stroke z [m]; omega [rad/s].
    Returns: [m/s].

    >>> f"{mean_piston_speed(stroke=0.092, omega=335.103216):.6f}"
    '9.813333'
    """
    return stroke * omega / np.pi


def maximum_piston_speed_sqrt(*, crank_radius: Real, rod_length: Real, omega: Real) -> Real:
    """Maximum piston speed taken where the rod is square to the crank: r omega sqrt(1 + lambda^2).

    Approximate, order 6 in lambda: the exact speed there, but too small as a maximum, which comes
        0.4 to 1.6 degrees later at lambda 0.20 to 0.33. It knows no offset.
    Relative error of c_max at lambda 0.20, 0.25, 0.30, 0.33: 2.9e-5, 1.03e-4, 2.89e-4, 4.91e-4;
        with k 0.0282: 1.15e-3, 1.85e-3, 2.79e-3, 3.50e-3.
    Source: S0-F13, not marked there as approximate.
    Arguments: crank_radius r [m]; rod_length l [m]; omega [rad/s].
    Returns: [m/s].

    >>> f"{maximum_piston_speed_sqrt(crank_radius=0.05, rod_length=0.2, omega=100.0):.6f}"
    '5.153882'
    """
    return crank_radius * omega * np.sqrt(1.0 + (crank_radius / rod_length) ** 2)


def maximum_speed_angle(*, crank_radius: Real, rod_length: Real, offset: Real = 0.0) -> Real:
    """Crank angle of the greatest piston speed on the downstroke, at constant crank speed.

    The root of s''(phi) = 0 between the true dead centres, by bisection; without offset sin^2 phi
    is the root below 1 of lambda^4 u^3 - lambda^2 u^2 - u + 1 = 0. On the upstroke the angle is
    2 pi minus that of the opposite offset.
    Exact.
    Source: S0-F13 (corrected).
    Arguments: crank_radius r [m]; rod_length l [m]; offset e [m].
    Returns: phi [rad].
    Raises: InputError if the crank cannot turn round.

    >>> f"{maximum_speed_angle(crank_radius=0.3, rod_length=1.0):.6f}"
    '1.300775'
    """
    require_turning(crank_radius, rod_length, offset)
    top = top_dead_centre(crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    bottom = bottom_dead_centre(crank_radius=crank_radius, rod_length=rod_length, offset=offset)

    def acceleration(angle: Real) -> Real:
        return piston_acceleration(
            angle, crank_radius=crank_radius, rod_length=rod_length, omega=1.0, offset=offset
        )

    return falling_root(acceleration, top, bottom)


def maximum_piston_speed(
    *, crank_radius: Real, rod_length: Real, omega: Real, offset: Real = 0.0
) -> Real:
    """Greatest piston speed on the downstroke: v at `maximum_speed_angle`.

    Exact at constant crank speed; on the upstroke it is that of the opposite offset.
    Source: S0-F13 (corrected).
    Arguments: crank_radius r [m]; rod_length l [m]; omega [rad/s]; offset e [m].
    Returns: [m/s].
    Raises: InputError if the crank cannot turn round.

    >>> f"{maximum_piston_speed(crank_radius=0.3, rod_length=1.0, omega=20.943951):.6f}"
    '6.561732'
    """
    angle = maximum_speed_angle(crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return piston_velocity(
        angle, crank_radius=crank_radius, rod_length=rod_length, omega=omega, offset=offset
    )
