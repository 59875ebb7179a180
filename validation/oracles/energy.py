"""Kinetic energy and gravity potential of all bodies, summed body by body."""

from validation.oracles import bodies
from validation.oracles.arithmetic import LONG, Arithmetic, Array
from validation.oracles.machine import Machine


def kinetic_energy(
    machine: Machine, theta: Array, omega: Array, arithmetic: Arithmetic = LONG
) -> Array:
    """Kinetic energy [J] at theta [rad], omega [rad/s], shape (samples,); exact up to rounding."""
    number, count = arithmetic.number, len(machine.cylinders)
    theta, omega = arithmetic.array(theta), arithmetic.array(omega)
    angle, rate = bodies.pose(machine, theta, omega, arithmetic)
    throw, rod = slice(1, 1 + count), slice(1 + count, None)
    radius, length = number(machine.crank_radius), number(machine.rod_length)
    to_rod = number(machine.rod_center_of_mass)
    pin_x = -radius * arithmetic.sin(angle[:, throw]) * rate[:, throw]
    pin_y = radius * arithmetic.cos(angle[:, throw]) * rate[:, throw]
    along_x = -arithmetic.sin(angle[:, rod]) * rate[:, rod]
    along_y = arithmetic.cos(angle[:, rod]) * rate[:, rod]
    rod_speed2 = (pin_x + to_rod * along_x) ** 2 + (pin_y + to_rod * along_y) ** 2
    piston_speed2 = (pin_x + length * along_x) ** 2
    doubled = (
        number(machine.rod_mass) * rod_speed2
        + number(machine.rod_inertia) * rate[:, rod] ** 2
        + number(machine.piston_mass) * piston_speed2
    )
    result: Array = (number(machine.crank_inertia) * omega * omega + doubled.sum(axis=1)) / 2
    return result


def gravity_potential(machine: Machine, theta: Array, arithmetic: Arithmetic = LONG) -> Array:
    """Potential energy of gravity [J] at theta [rad], shape (samples,); exact up to rounding."""
    number, count = arithmetic.number, len(machine.cylinders)
    theta = arithmetic.array(theta)
    angle, _ = bodies.pose(machine, theta, theta * 0, arithmetic)
    cosine, sine = arithmetic.cos(angle), arithmetic.sin(angle)
    gx, gy = (number(component) for component in machine.gravity)
    crank_moment = number(machine.crank_mass) * number(machine.crank_center_of_mass)
    work: Array = crank_moment * (gx * cosine[:, 0] + gy * sine[:, 0])
    rod_mass, piston_mass = number(machine.rod_mass), number(machine.piston_mass)
    throw_moment = number(machine.crank_radius) * (rod_mass + piston_mass)
    rod_moment = rod_mass * number(machine.rod_center_of_mass)
    rod_moment = rod_moment + piston_mass * number(machine.rod_length)
    for k, (_, bank) in enumerate(machine.cylinders):
        cos_bank, sin_bank = arithmetic.cos(number(bank)), arithmetic.sin(number(bank))
        pull_x, pull_y = cos_bank * gx + sin_bank * gy, cos_bank * gy - sin_bank * gx
        x = throw_moment * cosine[:, 1 + k] + rod_moment * cosine[:, 1 + count + k]
        y = throw_moment * sine[:, 1 + k] + rod_moment * sine[:, 1 + count + k]
        work = work + pull_x * x + pull_y * y
    potential: Array = -work
    return potential
