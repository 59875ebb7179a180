"""Newton-Euler: every joint force, body by body from the piston down, in each cylinder's frame.

The piston's X balance gives the rod on piston along the axis, the rod's moment about the crank pin
gives it across, the piston's Y balance the wall, the rod's balance the crank pin, and the crank's
balance the main bearing and the torque from outside. Gas pushes the piston towards the crank, -X.
The frame, on mounts, feels m (g - a) of every moving part and, about the crank axis, the walls and
the gas on the heads.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.geometry import close_loop, top_position
from crankmbs.mechanics.inertia import gravity_vector, rod_centre
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Cylinder", "Powers", "of_crank", "of_cylinder"]


class Powers(NamedTuple):
    """omega^2, alpha and 1 at the samples, shape (n,); or three units of them, shape (3, 1)."""

    square: Array
    alpha: Array
    one: Array


class Cylinder(NamedTuple):
    """The variables of one cylinder by name, for velocities those per speed; what it adds to the
    balance of the crank and of the frame, in the engine's frame."""

    variables: dict[str, Array]
    pull_x: Array
    pull_y: Array
    kinetic_energy: Array
    shake_x: Array
    shake_y: Array
    moment: Array


def of_cylinder(
    train: CrankTrain,
    theta: Array,
    motion: Powers,
    number: int,
) -> Cylinder:
    """The variables of the cylinder with an index, at crank angles of shape (n,) [rad]; balance
    after balance, in the order in which each needs the one before, hence over 50 lines."""
    scene, cylinder = train.scene, train.scene.cylinders[number]
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    area = piston.gas_area or 0.0
    r, l, a = crank.radius, rod.length, rod.center_of_mass
    square, alpha, one = motion
    gx, gy = gravity_vector(scene, cylinder.bank)
    phi = theta + cylinder.phase
    loop = close_loop(phi, r, l, piston.offset)
    g = rod_centre(loop, r, a)
    sin_b, cos_b = loop.sin_beta, loop.cos_beta
    gas = np.zeros_like(phi) if train.pressure is None else train.pressure[number](phi)

    x_tt = loop.x_2 * square + loop.x_1 * alpha
    beta_tt = loop.beta_2 * square + loop.beta_1 * alpha
    felt_x = g.x_2 * square + g.x_1 * alpha - gx * one  # the rod's acceleration minus gravity
    felt_y = g.y_2 * square + g.y_1 * alpha - gy * one
    felt = x_tt - gx * one  # the piston's, along the cylinder
    pin_x = piston.mass * felt + gas * area * one
    weight = rod.mass * (cos_b * felt_y + sin_b * felt_x)
    pin_y = ((rod.moment_of_inertia * beta_tt - a * weight) / l - pin_x * sin_b) / cos_b
    throw_x = rod.mass * felt_x + pin_x
    throw_y = rod.mass * felt_y + pin_y
    side = -pin_y - piston.mass * gy * one
    shake_x = -rod.mass * felt_x - piston.mass * felt
    shake_y = -rod.mass * felt_y + piston.mass * gy * one
    cos_bank, sin_bank = np.cos(cylinder.bank), np.sin(cylinder.bank)
    inertia = (
        piston.mass * loop.x_1**2
        + rod.mass * (g.x_1**2 + g.y_1**2)
        + rod.moment_of_inertia * loop.beta_1**2
    )
    variables = {
        "rod_angle": loop.beta,
        "rod_angular_speed": loop.beta_1,
        "rod_angular_acceleration": beta_tt,
        "piston_position": loop.x,
        "piston_displacement": top_position(r, l, piston.offset) - loop.x,
        "piston_velocity": -loop.x_1,
        "piston_acceleration": -x_tt,
        "gas_pressure": gas,
        "gas_force": gas * area,
        "side_force": side,
        "piston_pin_force_x": pin_x,
        "piston_pin_force_y": pin_y,
        "crank_pin_force_x": throw_x,
        "crank_pin_force_y": throw_y,
        "crank_torque": r * (loop.sin_phi * throw_x - loop.cos_phi * throw_y),
    }
    return Cylinder(
        variables,
        cos_bank * throw_x - sin_bank * throw_y,
        sin_bank * throw_x + cos_bank * throw_y,
        0.5 * inertia * square,
        cos_bank * shake_x - sin_bank * shake_y,
        sin_bank * shake_x + cos_bank * shake_y,
        -loop.x * side - piston.offset * gas * area * one,
    )


def of_crank(
    scene: Scene, theta: Array, motion: Powers, cylinders: list[Cylinder]
) -> dict[str, Array]:
    """The variables of the crank and of the frame, at crank angles of shape (n,) [rad]; without
    cylinders what belongs to the crank alone."""
    crank, (square, alpha, one) = scene.crank, motion
    first_moment = crank.mass * crank.center_of_mass
    sin_theta, cos_theta = np.sin(theta), np.cos(theta)
    gx, gy = gravity_vector(scene)
    x_tt = -cos_theta * square - sin_theta * alpha
    y_tt = -sin_theta * square + cos_theta * alpha
    weight = first_moment * (cos_theta * gy - sin_theta * gx)
    return _rocking(scene, cylinders) | {
        "external_torque": crank.moment_of_inertia * alpha
        - weight * one
        - sum(c.variables["crank_torque"] for c in cylinders),
        "main_bearing_force_x": first_moment * x_tt
        - crank.mass * gx * one
        + sum(c.pull_x for c in cylinders),
        "main_bearing_force_y": first_moment * y_tt
        - crank.mass * gy * one
        + sum(c.pull_y for c in cylinders),
        "frame_force_x": crank.mass * gx * one
        - first_moment * x_tt
        + sum(c.shake_x for c in cylinders),
        "frame_force_y": crank.mass * gy * one
        - first_moment * y_tt
        + sum(c.shake_y for c in cylinders),
        "frame_moment": np.asarray(sum(c.moment for c in cylinders)),
        "kinetic_energy": 0.5 * crank.moment_of_inertia * square
        + sum(c.kinetic_energy for c in cylinders),
    }


def _rocking(scene: Scene, cylinders: list[Cylinder]) -> dict[str, Array]:
    """Moments about the middle of the crank, where every cylinder has its place along it."""
    if scene.levers is None or not cylinders:
        return {}
    levers = np.array(scene.levers)
    return {
        "rocking_moment_x": -np.tensordot(levers, [c.shake_y for c in cylinders], 1),
        "rocking_moment_y": np.tensordot(levers, [c.shake_x for c in cylinders], 1),
    }
