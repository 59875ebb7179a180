"""The lectures' formulas for a scene at crank angles: truncated, or exact for two masses.

Their model: gas and inertia force of the reciprocating mass act along the cylinder, the rod is two
masses on a massless bar, the crank is a mass at its radius, and there is no gravity.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs import lecture
from crankmbs.compare.bodies import bodies_of
from crankmbs.compare.quantities import cycle_angles
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = [
    "LECTURES",
    "S0",
    "S1",
    "UNTRUNCATED",
    "Formulas",
    "Gear",
    "Motion",
    "RodForces",
    "gear_of",
    "lectured",
    "of_cylinders",
    "turning_crank",
]


class Gear(NamedTuple):
    """What a cylinder's kinematics depend on [m], of all cylinders or shape (cylinders,)."""

    crank_radius: Array | float
    rod_length: Array | float
    offset: Array | float


class Motion(NamedTuple):
    """Of a piston at cycle angles: displacement; velocity over omega; the factors of omega^2 and of
    alpha in its acceleration."""

    displacement: Array
    velocity: Array
    square: Array
    alpha: Array | float


class RodForces(NamedTuple):
    """Forces over the net force on a piston pin, at cycle angles."""

    side_thrust: Array
    rod: Array
    tangential: Array
    radial: Array


class Formulas(NamedTuple):
    """A choice among the lectures' formulas: the piston's motion, the forces in the train."""

    motion: Callable[[Array, Gear], Motion]
    forces: Callable[[Array, Gear], RodForces]


def _exact_motion(phi: Array, gear: Gear) -> Motion:
    lengths = gear._asdict()
    velocity = np.asarray(lecture.piston_velocity(phi, omega=1.0, **lengths))
    return Motion(
        np.asarray(lecture.piston_displacement(phi, **lengths)),
        velocity,
        np.asarray(lecture.piston_acceleration(phi, omega=1.0, alpha=0.0, **lengths)),
        velocity,
    )


def _truncated_motion(phi: Array, gear: Gear) -> Motion:
    lengths = gear._asdict()
    return Motion(
        np.asarray(lecture.piston_displacement_series(phi, **lengths)),
        np.asarray(lecture.piston_velocity_series(phi, omega=1.0, **lengths)),
        np.asarray(lecture.piston_acceleration_series(phi, omega=1.0, **lengths)),
        0.0,
    )


def _exact_forces(phi: Array, gear: Gear) -> RodForces:
    lengths = gear._asdict()
    rod = lecture.rod_force(phi, net_force=1.0, **lengths)
    return RodForces(
        np.asarray(lecture.side_thrust(phi, net_force=1.0, **lengths)),
        np.asarray(rod),
        np.asarray(lecture.tangential_force(phi, rod_force=rod, **lengths)),
        np.asarray(lecture.radial_force(phi, rod_force=rod, **lengths)),
    )


def _truncated_forces(phi: Array, gear: Gear) -> RodForces:
    lengths = gear._asdict()
    central = {"crank_radius": gear.crank_radius, "rod_length": gear.rod_length}
    return RodForces(
        np.asarray(lecture.side_thrust_series(phi, net_force=1.0, **lengths)),
        np.asarray(lecture.rod_force_series(phi, net_force=1.0, **central)),
        np.asarray(lecture.tangential_force_series(phi, net_force=1.0, **lengths)),
        np.asarray(lecture.radial_force_series(phi, net_force=1.0, **lengths)),
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
    scene, pressure = train.scene, train.pressure
    phi, gear = cycle_angles(scene, theta), gear_of(scene)
    difference = np.zeros_like(phi)
    for k, pressure_at in enumerate(pressure or ()):
        difference[:, k] = pressure_at(phi[:, k])
    factors = formulas.motion(phi, gear), formulas.forces(phi, gear)
    answer = of_cylinders(scene, factors, phi, difference, (omega[:, None], alpha[:, None]))
    throw_x, throw_y = answer["crank pin force x"], answer["crank pin force y"]
    bearing_x, bearing_y = _main_bearing(scene, theta, omega, alpha, throw_x, throw_y)
    return answer | {"main bearing force x": bearing_x, "main bearing force y": bearing_y}


def gear_of(scene: Scene, cylinder: int | None = None) -> Gear:
    """The gear of every cylinder, or of one by its number.

    >>> gear_of(load_scene("propeller")).crank_radius
    0.046
    """
    return Gear(*bodies_of(scene, cylinder)[:3])


def of_cylinders(
    scene: Scene,
    factors: tuple[Motion, RodForces],
    phi: Array,
    difference: Array,
    motion: tuple[Array, Array | float],
) -> dict[str, Array]:
    """The quantities of cylinders by a choice of formulas, each cylinder by itself.

    Parameters
    ----------
    factors : what its formulas give at the cycle angles
    phi : cycle angles [rad], of any shape
    difference : pressure difference across the piston [Pa]; motion : omega [rad/s] and alpha
        [rad/s2]; shapes that broadcast with that of phi. All but displacement is linear in alpha,
        in the pressure and in omega^2, the velocity in omega

    Returns
    -------
    dict over those QUANTITIES that a cylinder has, of the shape they broadcast to
    """
    (piston, forces), (omega, alpha) = factors, motion
    bodies = bodies_of(scene)
    r, masses = bodies.crank_radius, bodies.masses
    reciprocating = lecture.reciprocating_mass(
        piston_mass=bodies.piston_mass, rod_piston_pin_mass=masses.piston_pin
    )
    gas = np.asarray(
        lecture.gas_force(
            gas_pressure=difference, ambient_pressure=0.0, piston_area=bodies.piston_area
        )
    )
    acceleration = piston.square * omega**2 + piston.alpha * alpha

    def force_with(mass: Array | float) -> Array:
        inertia = lecture.inertia_force(reciprocating_mass=mass, piston_acceleration=acceleration)
        return np.asarray(lecture.net_force(gas_force=gas, inertia_force=inertia))

    net = force_with(reciprocating)
    side_thrust, tangential = net * forces.side_thrust, net * forces.tangential
    turning_x, turning_y = _inertia_at_throw(masses.crank_pin, r, phi, omega, alpha)
    throw_x, throw_y = net + turning_x, turning_y - side_thrust
    drive = np.asarray(lecture.crank_torque(tangential_force=tangential, crank_radius=r))
    from_gas = gas * forces.tangential
    return {
        "piston displacement": piston.displacement,
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
    }


def _inertia_at_throw(
    mass: Array | float,
    radius: Array | float,
    angle: Array,
    omega: Array,
    alpha: Array | float,
) -> tuple[Array, Array]:
    """Force on a mass turning at the crank radius: inwards, and forwards with alpha."""
    inwards = np.asarray(
        lecture.rotating_inertia_force(rotating_mass=mass, crank_radius=radius, omega=omega)
    )
    forwards = mass * radius * alpha
    sin, cos = np.sin(angle), np.cos(angle)
    return -inwards * cos - forwards * sin, -inwards * sin + forwards * cos


def turning_crank(
    scene: Scene, theta: Array, omega: Array, alpha: Array | float
) -> tuple[Array, Array]:
    """Force of the main bearing on the crank's reduced mass, in the engine's frame [N], at crank
    angles [rad], speeds [rad/s] and accelerations [rad/s2] whose shapes broadcast."""
    crank = scene.crank
    mass = lecture.reduced_web_mass(
        web_mass=crank.mass, center_of_mass=crank.center_of_mass, crank_radius=crank.radius
    )
    return _inertia_at_throw(float(mass), crank.radius, theta, omega, alpha)


def _main_bearing(
    scene: Scene, theta: Array, omega: Array, alpha: Array, throw_x: Array, throw_y: Array
) -> tuple[Array, Array]:
    """Every throw's force in the engine's frame, and the crank's."""
    crank_x, crank_y = turning_crank(scene, theta, omega, alpha)
    bank = np.array([cylinder.bank for cylinder in scene.cylinders])
    sin, cos = np.sin(bank), np.cos(bank)
    return crank_x + throw_x @ cos - throw_y @ sin, crank_y + throw_x @ sin + throw_y @ cos
