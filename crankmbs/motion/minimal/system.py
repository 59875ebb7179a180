"""What the `stepper` solves, in plain numbers and arrays."""

from __future__ import annotations

from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array

__all__ = ["Machine", "System", "bare"]


class Machine(NamedTuple):
    """The reduced crank train.

    radius, rod_length, center_of_mass, offset [m]; crank_inertia, rod_inertia [kg m2]; rod_mass,
    piston_mass [kg]; area [m2]; first_moment [kg m] of the crank; gravity_x, gravity_y [m/s2]
    cylinders : shape (n, 4), phase [rad], gravity along and across the axis [m/s2], and the first
        knot of the pressure [rad]
    knots : shape (k,) [rad], crank angles in one period where a step must end
    period [rad] : of the crank train
    places : shape (n, 2), where the knots of each cylinder's pressure begin and end in the next two
    starts, coefficients : knots of the pressures behind the first of each, and their cubics; may be
        empty
    bends [rad] : crank angles in one period where a long step must end
    combustion : what a share of 1 adds to the cubics; no columns without fuel
    load_first, load_starts, load_coefficients : of the loads over the crank angle [N m], the first
        knot, the knots behind it, and the cubics
    ring_force [N], ring_pressure, viscous [N s/m] : of the pistons' friction
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
    places: NDArray[np.intp]
    starts: Array
    coefficients: Array
    bends: Array
    combustion: Array
    load_first: float
    load_starts: Array
    load_coefficients: Array
    ring_force: float
    ring_pressure: float
    viscous: float


System = tuple[Machine, Array, tuple[float, float, float, float]]
"""The equation of motion between two knots: machine, its cubics as `stepper.enter` fills them,
and the load's c0, ct, c1, c2 of `crankmbs.mechanics.torque`."""


def bare(machine: Machine) -> Machine:
    """The same as a tuple without a name: numba's cache on disk is lost, with an error, when a
    class that it names changes its place."""
    return cast(Machine, tuple(machine))
