"""The crank train reduced to one rotation: inertia and torque as functions of the crank angle.

Kinetic energy = J(theta) omega^2 / 2 with

    J = J_crank + sum over cylinders of  m_p x_1^2 + m_r (G_x1^2 + G_y1^2) + I_r beta_1^2

where G = (r cos(phi) + a cos(beta), r sin(phi) - a sin(beta)) is the rod's centre of mass. All
cylinders are an axis in front of the angles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.axes import Gears, axes_of, closed_loops, gears_of, gravity_vector
from crankmbs.mechanics.geometry import Loop
from crankmbs.mechanics.pressure import pressures_at
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = [
    "Reduction",
    "RodCentre",
    "crank_weight",
    "ends_at",
    "fired_torque",
    "gas_at",
    "inertia_alone",
    "moving_inertias",
    "reduce",
    "rod_centre",
]

_BLOCK = 2048  # angles at once: what four cylinders make of them stays in the processor's cache


class RodCentre(NamedTuple):
    """Derivatives of the rod's centre of mass in the cycle angle [m], in the cylinder's frame."""

    x_1: Array
    y_1: Array
    x_2: Array
    y_2: Array


def rod_centre(loop: Loop, radius: Array | float, share: Array | float) -> RodCentre:
    """First and second derivatives in phi of the rod's centre of mass, exact.

    It divides the line from the crank pin to the piston pin, which moves along the cylinder alone.

    share : from the crank pin to the centre of mass, of the length of the rod
    """
    near = (1.0 - share) * radius
    near_sin, near_cos = near * loop.sin_phi, near * loop.cos_phi
    return RodCentre(
        x_1=share * loop.x_1 - near_sin,
        y_1=near_cos,
        x_2=share * loop.x_2 - near_cos,
        y_2=-near_sin,
    )


def moving_inertias(gears: Gears, loop: Loop, centre: RodCentre) -> Array:
    """What piston and rod of each cylinder add to J [kg m2], of the shape of the loop."""
    inertia = gears.piston_mass * loop.x_1**2
    inertia += gears.rod_mass * (centre.x_1**2 + centre.y_1**2)
    inertia += gears.rod_inertia * loop.beta_1**2
    return np.asarray(inertia)


def _half_slopes(gears: Gears, loop: Loop, centre: RodCentre) -> Array:
    """Half of its derivative [kg m2/rad]."""
    slope = gears.piston_mass * loop.x_1 * loop.x_2
    slope += gears.rod_mass * (centre.x_1 * centre.x_2 + centre.y_1 * centre.y_2)
    slope += gears.rod_inertia * loop.beta_1 * loop.beta_2
    return np.asarray(slope)


class Reduction(NamedTuple):
    """The crank train at crank angles, all of one shape; exact.

    The equation of motion is inertia alpha + slope omega^2 / 2 = torque + torque from outside.

    inertia, slope : J [kg m2] and dJ/dtheta [kg m2/rad]
    torque : generalized force of gas and weights on the crank [N m]
    """

    inertia: Array
    slope: Array
    torque: Array

    def rest(self, omega: ArrayLike) -> Array:
        """Torque that is left to turn the crank where nothing acts from outside [N m], at speeds
        [rad/s].

        >>> float(reduce(crank_train(load_scene("torque_driven")), 0.0).rest(0.0))
        0.0
        """
        return np.asarray(self.torque - 0.5 * self.slope * np.asarray(omega) ** 2)


def inertia_alone(scene: Scene, theta: ArrayLike) -> Array:
    """J at crank angles, shape (...) [rad]; shape (...) [kg m2], exact.

    >>> float(inertia_alone(load_scene("torque_driven"), 0.0)) > 0.0
    True
    """
    return reduce(CrankTrain(scene, None), theta).inertia


def reduce(train: CrankTrain, theta: ArrayLike, shares: ArrayLike | None = None) -> Reduction:
    """Reduce the crank train to one rotation at crank angles, shape (...) [rad].

    shares : shape (cylinders,) or (..., cylinders), of the combustion of each cylinder; None leaves
        it out

    >>> inertia, slope, torque = reduce(crank_train(load_scene("torque_driven")), 0.0)
    """
    theta = np.asarray(theta, dtype=np.float64)
    angles = theta.ravel()
    each = None
    if shares is not None and train.combustion is not None:
        each = np.broadcast_to(shares, (*theta.shape, len(train.combustion)))
        each = each.reshape(len(angles), each.shape[-1]).T
    reduced = np.empty((3, len(angles)))
    for begin in range(0, len(angles), _BLOCK):
        block = slice(begin, begin + _BLOCK)
        shared = None if each is None else each[:, block]
        reduced[:, block] = _reduced(train, angles[block], shared)
    return Reduction(*reduced.reshape(3, *theta.shape))


def _reduced(train: CrankTrain, theta: Array, shares: Array | None) -> tuple[Array, Array, Array]:
    """J, dJ/dtheta and the torque, shape (n,); shares : shape (cylinders, n)."""
    scene = train.scene
    gears, loop = gears_of(scene), closed_loops(scene, theta)
    g = rod_centre(loop, gears.radius, gears.rod_centre / gears.length)
    inertia = scene.crank.moment_of_inertia + moving_inertias(gears, loop, g).sum(axis=0)
    slope = 2.0 * _half_slopes(gears, loop, g).sum(axis=0)
    torque = np.zeros(len(theta))
    if scene.gravity is not None:
        torque += crank_weight(scene, theta)
        (gx, gy), mass = axes_of(scene).gravity, gears.rod_mass
        of_piston = (gears.piston_mass * gx) * loop.x_1
        torque += (of_piston + (mass * gx) * g.x_1 + (mass * gy) * g.y_1).sum(axis=0)
    gas = gas_at(train, theta, shares)
    if gas is not None:
        torque -= (gears.area * (gas * loop.x_1)).sum(axis=0)
    return inertia, slope, torque


def crank_weight(scene: Scene, theta: Array) -> Array | float:
    """Torque of the crank's own weight [N m] at crank angles of shape (n,) [rad]."""
    moment = scene.crank.mass * scene.crank.center_of_mass
    if moment == 0.0:
        return 0.0
    gx, gy = gravity_vector(scene)
    return np.asarray(moment * (gy * np.cos(theta) - gx * np.sin(theta)))


def gas_at(train: CrankTrain, theta: Array, shares: Array | None = None) -> Array | None:
    """Pressure difference across every piston [Pa] at crank angles of shape (n,) [rad], with these
    shares of the combustion, shape (cylinders, n); None without gas.

    >>> gas_at(crank_train(load_scene("coasting")), np.zeros(1)) is None
    True
    """
    if train.pressure is None:
        return None
    phi = np.add.outer(axes_of(train.scene).phases, theta)
    gas = pressures_at(train.pressure, phi)
    if shares is not None and train.combustion is not None:
        gas += shares * pressures_at(train.combustion, phi)
    return gas


def ends_at(train: CrankTrain, theta: Array, net: Array) -> dict[str, Array]:
    """The pressures of both ends of the cylinders less ambient [Pa] at crank angles of shape (n,)
    [rad], by variable; without crank ends nothing.

    net : gas forces over the piston's area [Pa], shape (cylinders, n)

    >>> ends_at(crank_train(load_scene("propeller")), np.zeros(1), np.zeros((1, 1)))
    {}
    """
    if train.crank_end is None:
        return {}
    below = pressures_at(train.crank_end, np.add.outer(axes_of(train.scene).phases, theta))
    head = net + gears_of(train.scene).crank_end_share * below
    return {"gas_pressure": head, "crank_end_pressure": below}


def fired_torque(train: CrankTrain, theta: ArrayLike) -> Array:
    """What the combustion of each cylinder, of share 1, adds to the torque [N m] at crank angles,
    shape (...) [rad]; shape (..., cylinders).

    >>> fired_torque(crank_train(load_scene("v_twin")), [1.0]).shape
    (1, 0)
    """
    scene, theta = train.scene, np.asarray(theta, dtype=np.float64)
    if train.combustion is None:
        return np.empty((*theta.shape, 0))
    angles = theta.ravel()
    more = pressures_at(train.combustion, np.add.outer(axes_of(scene).phases, angles))
    torque = -gears_of(scene).area * more * closed_loops(scene, angles).x_1
    return np.asarray(torque.T.reshape(*theta.shape, len(torque)))
