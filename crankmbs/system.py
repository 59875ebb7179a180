"""What `crankmbs.stepper` solves, and by what method, in plain numbers and arrays."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

__all__ = ["Machine", "Method", "System", "dop853"]

Array = NDArray[np.float64]


class Machine(NamedTuple):
    """The reduced crank train.

    radius, rod_length, center_of_mass, offset [m]; crank_inertia, rod_inertia [kg m2]; rod_mass,
    piston_mass [kg]; area [m2]; first_moment [kg m] of the crank; gravity_x, gravity_y [m/s2]
    cylinders : shape (n, 3), phase [rad], gravity along and across the axis [m/s2]
    knots : shape (k,) [rad], crank angles in one period where a step must end
    period, first [rad] : of the crank train; first knot of the pressure
    starts, coefficients : knots of the pressure behind its first one, and its cubics; may be empty
    """

    radius: float
    rod_length: float
    center_of_mass: float
    offset: float
    crank_inertia: float
    rod_inertia: float
    rod_mass: float
    piston_mass: float
    area: float
    first_moment: float
    gravity_x: float
    gravity_y: float
    cylinders: Array
    knots: Array
    period: float
    first: float
    starts: Array
    coefficients: Array


class Method(NamedTuple):
    """Coefficients of the pair: 12 stages, the slope at the end, 3 more for the interpolant."""

    a: Array
    c: Array
    e3: Array
    e5: Array
    d: Array


class System(NamedTuple):
    """The equation of motion between two knots: ``pieces`` as `enter` fills them, and the load's
    c0, ct, c1, c2 of `crankmbs.torque`; and the method that solves it."""

    machine: Machine
    pieces: Array
    load: tuple[float, float, float, float]
    method: Method


@cache
def dop853() -> Method:
    """The method of order 8 of Dormand and Prince, with SciPy's coefficients."""
    a, c = np.zeros((16, 16)), np.ones(16)
    a[:12, :12], a[12, :12], a[13:] = DOP853.A, DOP853.B, DOP853.A_EXTRA
    c[:12], c[13:] = DOP853.C, DOP853.C_EXTRA
    return Method(a, c, DOP853.E3.copy(), DOP853.E5.copy(), DOP853.D.copy())
