"""The connecting rod's angle beta from the cylinder axis: exact, and the series of S1 and S2."""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real, require, require_turning, series_ratio


def rod_ratio(*, crank_radius: Real, rod_length: Real) -> Real:
    """Rod ratio: lambda = r/l.

    Exact.
    Source: S0-D1, S1 Eq. 1, S2-F3.
    Misprint: S1 prints R/"Load" for R/L_rod; S2 prints "approximately" where it is equality.
    Arguments: crank_radius r [m]; rod_length l [m].
    Returns: lambda [1].

    >>> rod_ratio(crank_radius=0.05, rod_length=0.2)
    0.25
    """
    return crank_radius / rod_length


def relative_offset(*, crank_radius: Real, offset: Real) -> Real:
    """Relative offset of the cylinder axis from the crank axis: k = e/r.

    Exact.
    Source: S1 Eq. 2 (its a is e); its engine has k = 0.0282.
    Arguments: crank_radius r [m]; offset e [m].
    Returns: k [1].

    >>> relative_offset(crank_radius=0.05, offset=0.001)
    0.02
    """
    return offset / crank_radius


def sin_beta(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Sine of the rod angle: sin beta = (r sin phi - e)/l = lambda (sin phi - k).

    Exact.
    Source: S0-F4, S2-F3, S2-F4; with offset the root of S1 Eq. 25.
    Misprint: S2 prints "approximately" where it is equality.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [1], from -1 to 1.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> sin_beta(1.5707963267948966, crank_radius=0.05, rod_length=0.2)
    np.float64(0.25)
    """
    reach = crank_radius * np.sin(crank_angle) - offset
    sine: Real = reach / rod_length
    require(
        np.abs(sine) <= 1.0,
        "rod_length",
        "must reach from the crank pin to the cylinder axis, |r sin phi - e| / l at most 1",
        sine,
        "take a longer rod or a smaller offset",
    )
    return sine


def rod_angle(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Rod angle: beta = asin(lambda (sin phi - k)).

    Exact.
    Source: S0-F5.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [rad], from -pi/2 to pi/2.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{rod_angle(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.211951'
    """
    beta: Real = np.arcsin(
        sin_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    )
    return beta


def cos_beta(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Cosine of the rod angle: cos beta = sqrt(1 - lambda^2 (sin phi - k)^2).

    Exact.
    Source: S0-F3, S0-F6, S2-F8.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [1], from 0 to 1.
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{cos_beta(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.977622'
    """
    sine = sin_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return np.sqrt((1.0 - sine) * (1.0 + sine))


def cos_beta_series(crank_angle: Real, *, crank_radius: Real, rod_length: Real) -> Real:
    """Cosine of the rod angle, truncated: 1 - lambda^2/4 + (lambda^2/4) cos 2 phi.

    Approximate, order 4 in lambda: too large by lambda^4 sin^4 phi / 8. It knows no offset.
    Error of cos beta at lambda 0.20, 0.25, 0.30, 0.33: 2.04e-4, 5.04e-4, 1.06e-3, 1.57e-3;
        with k 0.0282: 1.37e-3, 2.35e-3, 3.76e-3, 4.87e-3 (order 2).
    Source: S2-F9.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m].
    Returns: shape (n,) [1].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{cos_beta_series(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.977873'
    """
    ratio = series_ratio(crank_radius, rod_length)
    return 1.0 - ratio**2 / 4.0 + ratio**2 / 4.0 * np.cos(2.0 * crank_angle)


def secant_beta_series(crank_angle: Real, *, crank_radius: Real, rod_length: Real) -> Real:
    """Secant of the rod angle, truncated: 1/cos beta = 1 + (lambda^2/4)(1 - cos 2 phi).

    Approximate, order 4 in lambda: too small by 3/8 lambda^4 sin^4 phi. It knows no offset.
    Error of 1/cos beta at lambda 0.20, 0.25, 0.30, 0.33: 6.21e-4, 1.55e-3, 3.28e-3, 4.89e-3;
        with k 0.0282: 1.84e-3, 3.52e-3, 6.26e-3, 8.62e-3 (order 2).
    Source: the bracket of S1 Eq. 26.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m].
    Returns: shape (n,) [1].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{secant_beta_series(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '1.022127'
    """
    ratio = series_ratio(crank_radius, rod_length)
    return 1.0 + ratio**2 / 4.0 * (1.0 - np.cos(2.0 * crank_angle))


def tan_beta(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Tangent of the rod angle: tan beta = sin beta / cos beta.

    Exact.
    Source: S0-F28, S1 Eq. 25 before its truncation.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [1].
    Raises: InputError where the rod is too short to reach the cylinder axis.

    >>> f"{tan_beta(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.215183'
    """
    sine = sin_beta(crank_angle, crank_radius=crank_radius, rod_length=rod_length, offset=offset)
    return sine / np.sqrt((1.0 - sine) * (1.0 + sine))


def tan_beta_series(
    crank_angle: Real, *, crank_radius: Real, rod_length: Real, offset: Real = 0.0
) -> Real:
    """Tangent of the rod angle taken as its sine: tan beta = lambda (sin phi - k).

    Approximate, order 3 in lambda: off by -lambda^3 (sin phi - k)^3 / 2, 4.6 % of the greatest
        tan beta at lambda 0.3.
    Error of tan beta at lambda 0.20, 0.25, 0.30, 0.33: 4.12e-3, 8.20e-3, 1.45e-2, 1.96e-2;
        with k 0.0282: 4.49e-3, 8.94e-3, 1.58e-2, 2.14e-2.
    Source: S1 Eq. 25.
    Arguments: crank_angle phi, shape (n,) [rad]; crank_radius r [m]; rod_length l [m];
        offset e [m].
    Returns: shape (n,) [1].
    Raises: InputError for a rod ratio of 1 or more.

    >>> f"{tan_beta_series(1.0, crank_radius=0.05, rod_length=0.2):.6f}"
    '0.210368'
    """
    ratio = series_ratio(crank_radius, rod_length)
    return ratio * (np.sin(crank_angle) - offset / crank_radius)


def maximum_rod_angle(*, crank_radius: Real, rod_length: Real, offset: Real = 0.0) -> Real:
    """Greatest magnitude of the rod angle: asin((r + |e|)/l), at 270 degrees if e > 0.

    Exact.
    Source: S2-V1, which states at most 15 to 17 degrees: a rod ratio up to 0.259 to 0.292.
    Arguments: crank_radius r [m]; rod_length l [m]; offset e [m].
    Returns: [rad].
    Raises: InputError if the crank cannot turn round.

    >>> f"{maximum_rod_angle(crank_radius=0.05, rod_length=0.2):.6f}"
    '0.252680'
    """
    require_turning(crank_radius, rod_length, offset)
    beta: Real = np.arcsin((crank_radius + np.abs(offset)) / rod_length)
    return beta
