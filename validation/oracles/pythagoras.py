"""The slider-crank at a crank angle by Pythagoras: the pin at (x, e), the rod's length between."""

import math
from typing import NamedTuple

from validation.oracles.machine import Machine

__all__ = ["Place", "cylinder_at", "inertia_and_torque"]


class Place(NamedTuple):
    """At a crank angle: velocity and acceleration of the pin per angle, and the same of the rod's
    centre and of its angle."""

    x_1: float
    x_2: float
    rod: tuple[float, float, float, float]
    b_1: float
    b_2: float


def cylinder_at(machine: Machine, theta: float, j: int) -> Place:
    """l^2 = (x - r cos)^2 + (e - r sin)^2, differentiated twice."""
    m = machine.of(j)
    r, l, e = float(m.crank_radius), float(m.rod_length), float(m.offset)
    phi, part = theta + float(m.cylinders[j][0]), float(m.rod_center_of_mass) / l
    c, s = r * math.cos(phi), r * math.sin(phi)
    u, u_1, u_2 = s - e, c, -s
    w = math.sqrt(l * l - u * u)
    w_1 = -u * u_1 / w
    w_2 = -(u_1 * u_1 + u * u_2 + w_1 * w_1) / w
    x_1, x_2 = -s + w_1, -c + w_2
    rod = (-s + part * w_1, c - part * u_1, -c + part * w_2, -s - part * u_2)
    return Place(x_1, x_2, rod, u_1 / w, (u_2 * w - u_1 * w_1) / (w * w))


def inertia_and_torque(
    machine: Machine, theta: float, places: list[Place], forces: list[float]
) -> tuple[float, float, float]:
    """J, dJ/dtheta and the torque on the crank of weights and of these forces on the pistons [N],
    towards the crank."""
    m = machine
    gx, gy = float(m.gravity[0]), float(m.gravity[1])
    unbalanced = float(m.crank_mass) * float(m.crank_center_of_mass)
    inertia, slope = float(m.crank_inertia), 0.0
    torque = unbalanced * (gy * math.cos(theta) - gx * math.sin(theta))
    for j, ((_, bank), c, force) in enumerate(zip(m.cylinders, places, forces, strict=True)):
        own = machine.of(j)
        mp, mr, ir = float(own.piston_mass), float(own.rod_mass), float(own.rod_inertia)
        a, b, a_2, b_2 = c.rod
        inertia += mp * c.x_1**2 + mr * (a * a + b * b) + ir * c.b_1**2
        slope += 2.0 * (mp * c.x_1 * c.x_2 + mr * (a * a_2 + b * b_2) + ir * c.b_1 * c.b_2)
        along = gx * math.cos(bank) + gy * math.sin(bank)
        across = gy * math.cos(bank) - gx * math.sin(bank)
        torque += mp * along * c.x_1 + mr * (along * a + across * b) - force * c.x_1
    return inertia, slope, torque
