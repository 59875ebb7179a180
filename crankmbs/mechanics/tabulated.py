"""The crank train at many angles in compiled loops: reduced to one rotation, and every balance.

What `crankmbs.mechanics.inertia.reduce` and `crankmbs.mechanics.newton_euler` give, to rounding,
without their hundreds of passes over arrays: a free motion asks for it at a thousand angles at
once, and at single ones between its steps.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crankmbs.mechanics.geometry import top_position
from crankmbs.mechanics.inertia import Reduction, fired_torque, gravity_vector
from crankmbs.mechanics.newton_euler import Powers
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene

__all__ = ["balanced", "rows_of", "tabulate"]

_CRANK = (
    "external_torque",
    "main_bearing_force_x",
    "main_bearing_force_y",
    "frame_force_x",
    "frame_force_y",
    "frame_moment",
    "kinetic_energy",
)
_CYLINDER = (
    "rod_angle",
    "rod_angular_speed",
    "rod_angular_acceleration",
    "piston_position",
    "piston_displacement",
    "piston_velocity",
    "piston_acceleration",
    "gas_pressure",
    "gas_force",
    "side_force",
    "piston_pin_force_x",
    "piston_pin_force_y",
    "crank_pin_force_x",
    "crank_pin_force_y",
    "crank_torque",
    "journal_torque",
    "pin_torque",
)


class _Numbers(NamedTuple):
    """A crank train in bare numbers.

    lengths : radius, rod length, from the crank pin to the rod's centre of mass, offset [m]
    masses : J of crank and rod [kg m2], rod, piston [kg], the crank's first moment [kg m]
    gravity : along the engine's X and Y [m/s2]
    cylinders : shape (n, 3), phase [rad], gravity along and across the axis [m/s2]
    """

    lengths: tuple[float, float, float, float]
    masses: tuple[float, float, float, float, float]
    gravity: tuple[float, float]
    cylinders: Array


class _More(NamedTuple):
    """What balances need beside: mass of the crank [kg], top position of the piston pin [m]; bank
    of each cylinder [rad] and its place along the crank [m], shape (n,), or none."""

    mass: float
    top: float
    banks: Array
    levers: Array


class _Gas(NamedTuple):
    """The cubics of all cylinders' pressures, those that differ one behind the other.

    area [m2] : of a piston, 0 without gas
    places : shape (n, 2), where the cubics of each cylinder begin and end
    firsts : shape (n, 2), first knot of its pressure, and its period [rad]
    starts : first knot of each cubic behind that of its pressure [rad]
    coefficients : shape (4, ...) [Pa, by descending power of the angle behind its first knot]
    """

    area: float
    places: NDArray[np.intp]
    firsts: Array
    starts: Array
    coefficients: Array


def tabulate(train: CrankTrain, theta: ArrayLike, shares: ArrayLike | None = None) -> Reduction:
    """The crank train reduced to one rotation at crank angles, shape (...) [rad].

    Parameters are those of `crankmbs.mechanics.inertia.reduce`.

    >>> float(tabulate(crank_train(load_scene("torque_driven")), 0.0).torque)
    0.0
    """
    from crankmbs.mechanics import reduced  # numba is loaded only where a run needs it

    angles = np.array(theta, dtype=np.float64, order="C")  # a loop is made for every kind of array
    found = np.empty((3, *angles.shape))
    numbers, _, gas = _bare(train)
    reduced.reduced(angles.ravel(), numbers, gas, found.reshape(3, -1))
    inertia, slope, torque = found
    if shares is not None and train.combustion is not None:
        torque = torque + np.sum(fired_torque(train, angles) * np.asarray(shares), axis=-1)
    return Reduction(inertia, slope, torque)


def rows_of(scene: Scene) -> dict[str, int]:
    """How many rows `balanced` has of each variable, in its order: one, or one a cylinder.

    >>> sum(rows_of(load_scene("v_twin")).values())
    41
    """
    count = len(scene.cylinders)
    rocking = () if scene.levers is None else ("rocking_moment_x", "rocking_moment_y")
    return dict.fromkeys((*rocking, *_CRANK), 1) | dict.fromkeys(_CYLINDER, count)


def balanced(train: CrankTrain, theta: Array, motion: Powers) -> Array:
    """What the balances of `crankmbs.mechanics.newton_euler` say of every variable but friction,
    velocities per speed: shape (rows, u, n), in SI units.

    theta : shape (n,) [rad]; motion : shape (u, n) or (u, 1) each

    >>> train = crank_train(load_scene("torque_driven"))
    >>> balanced(train, np.zeros(2), Powers(*np.eye(3)[:, :, np.newaxis])).shape
    (24, 3, 2)
    """
    from crankmbs.mechanics import reduced

    numbers, more, gas = _bare(train)
    found = np.empty((sum(rows_of(train.scene).values()), len(motion.one), len(theta)))
    bare = motion.square, motion.alpha, motion.one
    reduced.balances(theta, bare, numbers, more, gas, found)
    return found


@once
def _bare(train: CrankTrain) -> tuple[tuple[Any, ...], ...]:
    """The numbers, those of all balances and the gas, without names: numba's cache must not name a
    class."""
    scene = train.scene
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    axes = [(c.phase, *gravity_vector(scene, c.bank)) for c in scene.cylinders]
    numbers = _Numbers(
        lengths=(crank.radius, rod.length, rod.center_of_mass, piston.offset),
        masses=(
            crank.moment_of_inertia,
            rod.moment_of_inertia,
            rod.mass,
            piston.mass,
            crank.mass * crank.center_of_mass,
        ),
        gravity=gravity_vector(scene),
        cylinders=np.array(axes),
    )
    more = _More(
        mass=crank.mass,
        top=top_position(crank.radius, rod.length, piston.offset),
        banks=np.array([c.bank for c in scene.cylinders]),
        levers=np.array(scene.levers or ()),
    )
    return tuple(numbers), tuple(more), tuple(_gas(train))


def _gas(train: CrankTrain) -> _Gas:
    pressures = train.pressure or ()
    once = list(dict.fromkeys(pressures))
    ends = np.cumsum([0, *(len(each.knots) - 1 for each in once)])
    places = [(ends[k], ends[k + 1]) for k in map(once.index, pressures)]
    return _Gas(
        area=(train.scene.piston.gas_area or 0.0) if pressures else 0.0,
        places=np.array(places, dtype=np.intp).reshape(-1, 2),
        firsts=np.array([(p.knots[0], p.period) for p in pressures]).reshape(-1, 2),
        starts=np.concatenate([np.empty(0), *(p.knots[:-1] - p.knots[0] for p in once)]),
        coefficients=np.hstack([np.empty((4, 0)), *(p.coefficients for p in once)]),
    )
