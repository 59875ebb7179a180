"""The lectures' formulas for a scene at crank angles: truncated, or exact for two masses.

Their model: gas and inertia force of the reciprocating mass act along the cylinder, the rod is two
masses on a massless bar, the crank is a mass at its radius, and there is no gravity.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from crankmbs import lecture
from crankmbs.compare.bodies import Bodies, bodies_of
from crankmbs.compare.quantities import cycle_angles
from crankmbs.errors import InputError, shown
from crankmbs.mechanics.axes import axes_of
from crankmbs.mechanics.inertia import gas_at
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import there_are

__all__ = [
    "LECTURES",
    "S0",
    "S1",
    "UNTRUNCATED",
    "Formulas",
    "Motion",
    "RodForces",
    "lectured",
    "quantities_by",
    "row_of",
    "short_name",
]


class _Row(Protocol):
    """A comparison of one quantity with one reference."""

    @property
    def quantity(self) -> str: ...

    @property
    def reference(self) -> str: ...


_RowT = TypeVar("_RowT", bound=_Row)


class Motion(NamedTuple):
    """Of a piston at cycle angles: displacement; velocity over omega; the factors of omega^2 and of
    alpha in its acceleration."""

    displacement: Array | float
    velocity: Array | float
    square: Array | float
    alpha: Array | float


class RodForces(NamedTuple):
    """Forces over the net force on a piston pin, at cycle angles."""

    side_thrust: Array | float
    rod: Array | float
    tangential: Array | float
    radial: Array | float


class Formulas(NamedTuple):
    """A choice among the lectures' formulas: the piston's motion, the forces in the train."""

    motion: Callable[[Array, Bodies], Motion]
    forces: Callable[[Array, Bodies], RodForces]


def _exact_motion(phi: Array, bodies: Bodies) -> Motion:
    lengths = bodies.lengths
    velocity = lecture.piston_velocity(phi, omega=1.0, **lengths)
    return Motion(
        lecture.piston_displacement(phi, **lengths),
        velocity,
        lecture.piston_acceleration(phi, omega=1.0, alpha=0.0, **lengths),
        velocity,
    )


def _truncated_motion(phi: Array, bodies: Bodies) -> Motion:
    lengths = bodies.lengths
    return Motion(
        lecture.piston_displacement_series(phi, **lengths),
        lecture.piston_velocity_series(phi, omega=1.0, **lengths),
        lecture.piston_acceleration_series(phi, omega=1.0, **lengths),
        0.0,
    )


def _exact_forces(phi: Array, bodies: Bodies) -> RodForces:
    lengths = bodies.lengths
    rod = lecture.rod_force(phi, net_force=1.0, **lengths)
    return RodForces(
        lecture.side_thrust(phi, net_force=1.0, **lengths),
        rod,
        lecture.tangential_force(phi, rod_force=rod, **lengths),
        lecture.radial_force(phi, rod_force=rod, **lengths),
    )


def _truncated_forces(phi: Array, bodies: Bodies) -> RodForces:
    lengths = bodies.lengths
    r, l = bodies.crank_radius, bodies.rod_length
    return RodForces(
        lecture.side_thrust_series(phi, net_force=1.0, **lengths),
        lecture.rod_force_series(phi, net_force=1.0, crank_radius=r, rod_length=l),
        lecture.tangential_force_series(phi, net_force=1.0, **lengths),
        lecture.radial_force_series(phi, net_force=1.0, **lengths),
    )


UNTRUNCATED = Formulas(_exact_motion, _exact_forces)
S0 = Formulas(_truncated_motion, _exact_forces)
S1 = Formulas(_truncated_motion, _truncated_forces)

LECTURES = {
    "untruncated lecture": UNTRUNCATED,
    "S0 (motion truncated)": S0,
    "S1 (motion and forces truncated)": S1,
}
"""The lectures' formulas by the names under which they are compared; the last truncates most."""

_, _S0, _S1 = LECTURES
_CALLED = {_S0: ("Grega", "S0"), _S1: ("Yi et al.", "S1")}  # authors, key


def short_name(reference: str) -> str:
    """What a reference is called in a heading, a headline and a legend: its authors or its label.

    >>> short_name("S0 (motion truncated)"), short_name("closed form")
    ('Grega', 'closed form')
    """
    return _CALLED.get(reference, (reference,))[0]


def row_of(rows: Sequence[_RowT], quantity: str, reference: str | None) -> _RowT:
    """That of a quantity, with its unit or without, by a reference, as tables or files call it, or
    None, by the lectures.

    Raises
    ------
    InputError : there is none
    """
    name = quantity.partition(" [")[0]
    alike = [row for row in rows if row.quantity == name]
    if not alike:
        known = there_are(name, list(dict.fromkeys(row.quantity for row in rows)))
        raise InputError(f"no {shown(quantity)} here{known}")
    for row in alike:
        by_lecture = reference is None and row.reference in LECTURES
        if by_lecture or reference in (row.reference, *_CALLED.get(row.reference, ())):
            return row
    known = there_are(reference or "", [short_name(row.reference) for row in alike])
    by = "the lectures" if reference is None else shown(reference)
    raise InputError(f"no {shown(quantity)} by {by} here{known}")


def lectured(
    formulas: Formulas,
    train: CrankTrain,
    theta: Array,
    omega: Array,
    alpha: Array,
) -> dict[str, Array]:
    """The compared quantities by the lectures' formulas.

    Exact for the two-mass rod without gravity if UNTRUNCATED; S0 and S1 then take alpha as 0.

    Parameters
    ----------
    theta, omega, alpha : shape (n,) [rad, rad/s, rad/s2]

    Returns
    -------
    dict over `crankmbs.compare.quantities.QUANTITIES`, in the shapes of `observed`; displacement
    from the lectures' datum l + r

    Raises
    ------
    InputError : truncated formulas with a rod ratio of 1
    """
    scene, phi = train.scene, cycle_angles(train.scene, theta)
    gas, bodies = gas_at(train, theta), bodies_of(scene)
    difference = np.zeros_like(phi) if gas is None else gas.T
    factors = formulas.motion(phi, bodies), formulas.forces(phi, bodies)
    return quantities_by(scene, bodies, factors, theta, difference, (omega, alpha))


def quantities_by(
    scene: Scene,
    bodies: Bodies,
    factors: tuple[Motion, RodForces],
    theta: Array,
    difference: Array,
    motion: tuple[Array, Array],
) -> dict[str, Array]:
    """The quantities by what a choice of formulas gives at the cycle angles.

    Parameters
    ----------
    theta : shape (n,) [rad]; difference : pressure difference across the pistons [Pa], shape
        (..., n, cylinders)
    motion : omega [rad/s] and alpha [rad/s2], shape (..., n) or (..., 1). All but displacement is
        linear in alpha, in the pressure and in omega^2, the velocity in omega

    Returns
    -------
    dict over QUANTITIES, shape (..., n, cylinders), those of the whole engine (..., n)
    """
    piston, forces = factors
    omega, alpha = (part[..., None] for part in motion)
    phi, r, masses = cycle_angles(scene, theta), bodies.crank_radius, bodies.masses
    reciprocating = lecture.reciprocating_mass(
        piston_mass=bodies.piston_mass, rod_piston_pin_mass=masses.piston_pin
    )
    gas = lecture.gas_force(
        gas_pressure=difference, ambient_pressure=0.0, piston_area=bodies.piston_area
    )
    acceleration = piston.square * omega**2 + piston.alpha * alpha

    def force_with(mass: Array | float) -> Array:
        inertia = lecture.inertia_force(reciprocating_mass=mass, piston_acceleration=acceleration)
        return np.asarray(lecture.net_force(gas_force=gas, inertia_force=inertia))

    net = force_with(reciprocating)
    side_thrust, tangential = net * forces.side_thrust, net * forces.tangential
    turning_x, turning_y = _inertia_at_throw(masses.crank_pin, r, phi, omega, alpha)
    throw_x, throw_y = net + turning_x, turning_y - side_thrust
    drive = lecture.crank_torque(tangential_force=tangential, crank_radius=r)
    from_gas = gas * forces.tangential
    bearing_x, bearing_y = _main_bearing(scene, theta, motion, throw_x, throw_y)
    return {
        "piston displacement": np.asarray(piston.displacement),
        "piston velocity": piston.velocity * omega,
        "piston acceleration": acceleration,
        "net force": net,
        "side thrust": side_thrust,
        "rod force": net * forces.rod,
        "tangential force": tangential,
        "radial force": net * forces.radial,
        "torque": drive - masses.crank_pin * r**2 * alpha,
        "gas torque": np.asarray(lecture.crank_torque(tangential_force=from_gas, crank_radius=r)),
        "piston pin force x": force_with(bodies.piston_mass),
        "piston pin force y": -side_thrust,
        "crank pin force x": throw_x,
        "crank pin force y": throw_y,
        "main bearing force x": bearing_x,
        "main bearing force y": bearing_y,
    }


def _inertia_at_throw(
    mass: Array | float,
    radius: Array | float,
    angle: Array,
    omega: Array,
    alpha: Array,
) -> tuple[Array, Array]:
    """Force on a mass turning at the crank radius: inwards, and forwards with alpha."""
    inwards = lecture.rotating_inertia_force(rotating_mass=mass, crank_radius=radius, omega=omega)
    forwards = mass * radius * alpha
    sin, cos = np.sin(angle), np.cos(angle)
    return -inwards * cos - forwards * sin, -inwards * sin + forwards * cos


def _main_bearing(
    scene: Scene, theta: Array, motion: tuple[Array, Array], throw_x: Array, throw_y: Array
) -> tuple[Array, Array]:
    """Every throw's force in the engine's frame, and that on the crank's reduced mass."""
    crank, axes = scene.crank, axes_of(scene)
    mass = lecture.reduced_web_mass(
        web_mass=crank.mass, center_of_mass=crank.center_of_mass, crank_radius=crank.radius
    )
    crank_x, crank_y = _inertia_at_throw(mass, crank.radius, theta, *motion)
    cos, sin = axes.cos, axes.sin
    return crank_x + throw_x @ cos - throw_y @ sin, crank_y + throw_x @ sin + throw_y @ cos
