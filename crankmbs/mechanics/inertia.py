"""The crank train reduced to one rotation: inertia and torque as functions of the crank angle.

Kinetic energy = J(theta) omega^2 / 2 with

    J = J_crank + sum over cylinders of  m_p x_1^2 + m_r (G_x1^2 + G_y1^2) + I_r beta_1^2

where G = (r cos(phi) + a cos(beta), r sin(phi) - a sin(beta)) is the rod's centre of mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.geometry import Loop, close_loop
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = [
    "Reduction",
    "RodCentre",
    "fired_torque",
    "gravity_vector",
    "inertia_alone",
    "reduce",
    "rod_centre",
]


@dataclass(frozen=True)
class RodCentre:
    """Derivatives of the rod's centre of mass in the cycle angle [m], in the cylinder's frame."""

    x_1: Array
    y_1: Array
    x_2: Array
    y_2: Array


def rod_centre(loop: Loop, radius: float, center_of_mass: float) -> RodCentre:
    """First and second derivatives in phi of the rod's centre of mass, exact."""
    r, a = radius, center_of_mass
    sin_b, cos_b, b_1, b_2 = loop.sin_beta, loop.cos_beta, loop.beta_1, loop.beta_2
    return RodCentre(
        x_1=-r * loop.sin_phi - a * sin_b * b_1,
        y_1=r * loop.cos_phi - a * cos_b * b_1,
        x_2=-r * loop.cos_phi - a * (cos_b * b_1**2 + sin_b * b_2),
        y_2=-r * loop.sin_phi - a * (cos_b * b_2 - sin_b * b_1**2),
    )


def gravity_vector(scene: Scene, bank: float = 0.0) -> tuple[float, float]:
    """Gravity [m/s2] in the frame of a cylinder at this bank [rad]; (0, 0) without gravity."""
    if scene.gravity is None:
        return 0.0, 0.0
    angle = scene.gravity.angle - bank
    g = scene.gravity.acceleration
    return g * math.cos(angle), g * math.sin(angle)


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
    scene, pressure = train.scene, train.pressure
    theta = np.asarray(theta, dtype=np.float64)
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    inertia = np.full(theta.shape, crank.moment_of_inertia)
    slope = np.zeros(theta.shape)
    gx, gy = gravity_vector(scene)
    torque = (crank.mass * crank.center_of_mass) * (gy * np.cos(theta) - gx * np.sin(theta))
    for k, cylinder in enumerate(scene.cylinders):
        loop = close_loop(theta + cylinder.phase, crank.radius, rod.length, piston.offset)
        g = rod_centre(loop, crank.radius, rod.center_of_mass)
        inertia += piston.mass * loop.x_1**2
        slope += 2.0 * piston.mass * loop.x_1 * loop.x_2
        if rod.mass or rod.moment_of_inertia:
            inertia += rod.mass * (g.x_1**2 + g.y_1**2) + rod.moment_of_inertia * loop.beta_1**2
            slope += 2.0 * (
                rod.mass * (g.x_1 * g.x_2 + g.y_1 * g.y_2)
                + rod.moment_of_inertia * loop.beta_1 * loop.beta_2
            )
        gx, gy = gravity_vector(scene, cylinder.bank)
        if pressure is not None:
            torque -= (piston.gas_area or 0.0) * pressure[k](theta + cylinder.phase) * loop.x_1
        torque += piston.mass * gx * loop.x_1 + rod.mass * (gx * g.x_1 + gy * g.y_1)
    if shares is not None and train.combustion is not None:
        torque += np.sum(fired_torque(train, theta) * np.asarray(shares), axis=-1)
    return Reduction(inertia, slope, torque)


def fired_torque(train: CrankTrain, theta: ArrayLike) -> Array:
    """What the combustion of each cylinder, of share 1, adds to the torque [N m] at crank angles,
    shape (...) [rad]; shape (..., cylinders).

    >>> fired_torque(crank_train(load_scene("v_twin")), [1.0]).shape
    (1, 0)
    """
    scene, theta = train.scene, np.asarray(theta, dtype=np.float64)
    area, shape = scene.piston.gas_area or 0.0, (scene.crank.radius, scene.rod.length)
    found = np.empty((*theta.shape, len(train.combustion or ())))
    for k, (more, cylinder) in enumerate(
        zip(train.combustion or (), scene.cylinders, strict=False)
    ):
        phi = theta + cylinder.phase
        found[..., k] = -area * more(phi) * close_loop(phi, *shape, scene.piston.offset).x_1
    return found
