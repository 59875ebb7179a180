"""Dead centres, stroke and Brix correction: where the piston turns and how far it goes."""

from __future__ import annotations

import numpy as np

from crankmbs.lecture._domain import Real, require_turning, series_ratio


def top_dead_centre(*, crank_radius: Real, rod_length: Real, offset: Real = 0.0) -> Real:
    """Crank angle of the true top dead centre: asin(e/(l + r)), rod and crank in line.

    Exact; S1 takes 0.
    Error of S1's 0 in degrees at lambda 0.20, 0.25, 0.30, 0.33: 0, 0, 0, 0;
        with k 0.0282: 0.27, 0.32, 0.37, 0.40.
    Source: S1 Eq. 3 to 5 (corrected).
    Arguments: crank_radius r [m]; rod_length l [m]; offset e [m].
    Returns: phi [rad].
    Raises: InputError if the crank cannot turn round.

    >>> f"{top_dead_centre(crank_radius=0.05, rod_length=0.2, offset=0.001):.6f}"
    '0.004000'
    """
    require_turning(crank_radius, rod_length, offset)
    angle: Real = np.arcsin(offset / (rod_length + crank_radius))
    return angle


def bottom_dead_centre(*, crank_radius: Real, rod_length: Real, offset: Real = 0.0) -> Real:
    """Crank angle of the true bottom dead centre: pi + asin(e/(l - r)), rod and crank folded.

    Exact; S1 takes pi.
    Error of S1's pi in degrees at lambda 0.20, 0.25, 0.30, 0.33: 0, 0, 0, 0;
        with k 0.0282: 0.40, 0.54, 0.69, 0.80.
    Source: S1 Eq. 3 to 5 (corrected).
    Arguments: crank_radius r [m]; rod_length l [m]; offset e [m].
    Returns: phi [rad].
    Raises: InputError if the crank cannot turn round, or the rod is as long as the crank radius.

    >>> f"{bottom_dead_centre(crank_radius=0.05, rod_length=0.2, offset=0.001):.6f}"
    '3.148259'
    """
    require_turning(crank_radius, rod_length, offset)
    series_ratio(crank_radius, rod_length)
    return np.pi + np.arcsin(offset / (rod_length - crank_radius))


def datum_shift(*, crank_radius: Real, rod_length: Real, offset: Real = 0.0) -> Real:
    """Lecture displacement at the true top dead centre: l + r - sqrt((l + r)^2 - e^2).

    Exact.
    Source: S1 Eq. 3 (corrected), which calls it 0.
    Arguments: crank_radius r [m]; rod_length l [m]; offset e [m].
    Returns: [m], 0 without an offset.
    Raises: InputError if the crank cannot turn round.

    >>> f"{datum_shift(crank_radius=0.05, rod_length=0.2, offset=0.001):.3e}"
    '2.000e-06'
    """
    require_turning(crank_radius, rod_length, offset)
    reach = rod_length + crank_radius
    return offset**2 / (reach + np.sqrt(reach**2 - offset**2))


def stroke(*, crank_radius: Real, rod_length: Real, offset: Real = 0.0) -> Real:
    """Piston stroke between the true dead centres: sqrt((l + r)^2 - e^2) - sqrt((l - r)^2 - e^2).

    Exact.
    Source: S1 "S = 2R" (corrected).
    Arguments: crank_radius r [m]; rod_length l [m]; offset e [m].
    Returns: [m].
    Raises: InputError if the crank cannot turn round.

    >>> f"{stroke(crank_radius=0.05, rod_length=0.2, offset=0.001):.8f}"
    '0.10000133'
    """
    require_turning(crank_radius, rod_length, offset)
    far = np.sqrt((rod_length + crank_radius) ** 2 - offset**2)
    near = np.sqrt((rod_length - crank_radius) ** 2 - offset**2)
    length: Real = far - near
    return length


def stroke_central(*, crank_radius: Real) -> Real:
    """Piston stroke of a central gear: 2 r.

    Exact without offset, else too short by k^2 lambda^2 / (2 (1 - lambda^2)) of it.
    Relative error of 2 r at lambda 0.20, 0.25, 0.30, 0.33: 0, 0, 0, 0;
        with k 0.0282: 1.7e-5, 2.7e-5, 3.9e-5, 4.9e-5.
    Source: S1 "S = 2R", S2-V2.
    Arguments: crank_radius r [m].
    Returns: [m].

    >>> stroke_central(crank_radius=0.05)
    0.1
    """
    return 2.0 * crank_radius


def brix_correction(*, crank_radius: Real, rod_length: Real) -> Real:
    """Displacement at 90 degrees beyond half the stroke: r [1 - sqrt(1 - lambda^2)]/lambda.

    Exact, central gear.
    Source: S2-V3 before its truncation.
    Misprint: S2 says that the first quarter turn gains (1 + lambda/2) over the second; the
        quarters are, truncated, r (1 + lambda/2) and r (1 - lambda/2).
    Arguments: crank_radius r [m]; rod_length l [m].
    Returns: [m].
    Raises: InputError if the crank cannot turn round.

    >>> f"{brix_correction(crank_radius=0.05, rod_length=0.2):.6f}"
    '0.006351'
    """
    require_turning(crank_radius, rod_length, 0.0)
    return rod_length - np.sqrt(rod_length**2 - crank_radius**2)


def brix_correction_series(*, crank_radius: Real, rod_length: Real) -> Real:
    """Brix correction, truncated: r lambda/2.

    Approximate, relative order 2 in lambda: too small by r lambda^3/8, lambda^2/4 of itself.
    Relative error of the correction at lambda 0.20, 0.25, 0.30, 0.33: 1.01e-2, 1.59e-2, 2.30e-2,
        2.80e-2.
    Source: S2-V3.
    Arguments: crank_radius r [m]; rod_length l [m].
    Returns: [m].
    Raises: InputError for a rod ratio of 1 or more.

    >>> brix_correction_series(crank_radius=0.05, rod_length=0.2)
    0.00625
    """
    return crank_radius * series_ratio(crank_radius, rod_length) / 2.0
