"""What the `stepper` solves, in plain numbers and arrays."""

from __future__ import annotations

from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array

__all__ = ["Gas", "Knots", "Machine", "Masses", "OverAngle", "Rubbing", "System", "bare"]


class Masses(NamedTuple):
    """Moments of inertia of the crank about its axis and of the rod about its centre of mass
    [kg m2]; masses of rod and piston [kg]; the crank's first moment [kg m]."""

    crank_inertia: float
    rod_inertia: float
    rod: float
    piston: float
    first_moment: float


class Knots(NamedTuple):
    """Crank angles in one period where a step must end, and where a long step must [rad]; and the
    period of the crank train [rad]."""

    every: Array
    bends: Array
    period: float


class Gas(NamedTuple):
    """The cubics of all cylinders' pressures.

    area [m2] : of a piston
    places : shape (n, 2), where the knots of each cylinder's pressure begin and end in the next two
    starts, coefficients : knots of the pressures behind the first of each, and their cubics; may be
        empty
    combustion : what a share of 1 adds to the cubics; no columns without fuel
    """

    area: float
    places: NDArray[np.intp]
    starts: Array
    coefficients: Array
    combustion: Array


class OverAngle(NamedTuple):
    """Of the loads over the crank angle [N m], the first knot [rad], the knots behind it, and the
    cubics."""

    first: float
    starts: Array
    coefficients: Array


class Rubbing(NamedTuple):
    """Friction of a piston: ring force [N], its share of the gas force, viscous [N s/m]."""

    ring_force: float
    ring_pressure: float
    viscous: float


class Machine(NamedTuple):
    """The reduced crank train.

    lengths : radius, rod length, from the crank pin to the rod's centre of mass, offset [m]
    gravity : along the engine's X and Y [m/s2]
    cylinders : shape (n, 4), phase [rad], gravity along and across the axis [m/s2], and the first
        knot of the pressure [rad]
    """

    lengths: tuple[float, float, float, float]
    masses: Masses
    gravity: tuple[float, float]
    cylinders: Array
    knots: Knots
    gas: Gas
    over_angle: OverAngle
    friction: Rubbing


System = tuple[Machine, Array, tuple[float, float, float, float]]
"""The equation of motion between two knots: machine, its cubics as `stepper.enter` fills them,
and the load's c0, ct, c1, c2 of `crankmbs.mechanics.torque`."""


def bare(machine: Machine) -> Machine:
    """The same as tuples without names: numba's cache on disk is lost, with an error, when a class
    that it names changes its place."""
    return cast(Machine, tuple(tuple(x) if isinstance(x, tuple) else x for x in machine))
