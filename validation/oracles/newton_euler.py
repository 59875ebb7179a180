"""Inverse dynamics: every joint force and the torque needed for a given theta, omega, alpha."""

from dataclasses import dataclass

import numpy as np

from validation.oracles import bodies
from validation.oracles.arithmetic import LONG, Arithmetic, Array
from validation.oracles.linear import solve
from validation.oracles.machine import Machine, Pressure
from validation.oracles.pressure import evaluate_pressure


@dataclass(frozen=True)
class Reactions:
    """Forces [N] by the earlier body on the later one, torques [N m], and the motion they need.

    Crank quantities have shape (samples,) and stand in the engine's frame; the others have shape
    (samples, cylinders) and stand in their cylinder's frame. external_torque is what everything
    outside (drive and loads) puts on the crank; crank_torque is the moment of the rod's force on
    the crank about its axis, journal_torque that of this rod and all before it, and pin_torque
    that of all before it and half of this one.
    """

    external_torque: Array
    main_bearing_force_x: Array
    main_bearing_force_y: Array
    crank_pin_force_x: Array
    crank_pin_force_y: Array
    piston_pin_force_x: Array
    piston_pin_force_y: Array
    side_force: Array
    crank_torque: Array
    gas_pressure: Array
    crank_end_pressure: Array
    gas_force: Array
    rod_angle: Array
    piston_position: Array
    piston_displacement: Array
    piston_velocity: Array
    piston_acceleration: Array
    rod_angular_speed: Array
    rod_angular_acceleration: Array
    journal_torque: Array
    pin_torque: Array


def newton_euler(
    machine: Machine, theta: Array, omega: Array, alpha: Array, arithmetic: Arithmetic = LONG
) -> Reactions:
    """Solve the Newton-Euler equations of all bodies at once; exact up to rounding.

    theta [rad], omega [rad/s], alpha [rad/s2]: shape (samples,), any numbers. The loads of the
    machine are not used: external_torque is what their sum would have to be.
    """
    theta, omega, alpha = (arithmetic.array(values) for values in (theta, omega, alpha))
    system = bodies.build(machine, bodies.ALPHA, arithmetic)
    angle, rate = bodies.pose(machine, theta, omega, arithmetic)
    cosine, sine = arithmetic.cos(angle), arithmetic.sin(angle)
    count = len(machine.cylinders)
    throws = angle[:, 1 : 1 + count]
    pressure = _gas_pressure(machine.pressures, throws, arithmetic)
    below = _gas_pressure(machine.crank_ends, throws, arithmetic)
    gas_force = pressure * arithmetic.number(machine.piston_area)
    gas_force = gas_force - below * arithmetic.number(machine.crank_end_area)

    right = np.repeat(system.right[None], len(theta), axis=0)
    turning = system.turning(cosine * rate * rate, sine * rate * rate)
    for k, row in enumerate(system.turn_row):
        right[:, row] += turning[:, k]
    right[:, system.gas_row] -= gas_force
    right[:, system.given_row] += alpha
    unknown = solve(system.matrix(cosine, sine), right[..., None])[..., 0]

    def per_cylinder(first: int) -> Array:
        return unknown[:, first :: bodies.PER_CYLINDER]

    radius, length, offset = (
        arithmetic.number(value)
        for value in (machine.crank_radius, machine.rod_length, machine.offset)
    )
    cos_throw, sin_throw = cosine[:, 1 : 1 + count], sine[:, 1 : 1 + count]
    cos_rod, sin_rod = cosine[:, 1 + count :], sine[:, 1 + count :]
    pin_x, pin_y = per_cylinder(bodies.CRANK_PIN_X), per_cylinder(bodies.CRANK_PIN_Y)
    position = radius * cos_throw + length * cos_rod
    torque = radius * (sin_throw * pin_x - cos_throw * pin_y)
    journals = np.cumsum(torque, axis=1)
    return Reactions(
        external_torque=unknown[:, bodies.TORQUE],
        main_bearing_force_x=unknown[:, bodies.BEARING_X],
        main_bearing_force_y=unknown[:, bodies.BEARING_Y],
        crank_pin_force_x=pin_x,
        crank_pin_force_y=pin_y,
        piston_pin_force_x=per_cylinder(bodies.PISTON_PIN_X),
        piston_pin_force_y=per_cylinder(bodies.PISTON_PIN_Y),
        side_force=per_cylinder(bodies.SIDE),
        crank_torque=torque,
        gas_pressure=pressure,
        crank_end_pressure=below,
        gas_force=gas_force,
        rod_angle=-angle[:, 1 + count :],
        piston_position=position,
        piston_displacement=((length + radius) ** 2 - offset * offset) ** 0.5 - position,
        piston_velocity=-radius * sin_throw * rate[:, 1 : 1 + count]
        - length * sin_rod * rate[:, 1 + count :],
        piston_acceleration=per_cylinder(bodies.PISTON_X),
        rod_angular_speed=-rate[:, 1 + count :],
        rod_angular_acceleration=-per_cylinder(bodies.ROD_SPIN),
        journal_torque=journals,
        pin_torque=journals - torque / 2,
    )


def _gas_pressure(pressures: tuple[Pressure, ...], throws: Array, arithmetic: Arithmetic) -> Array:
    if not pressures:
        return throws * 0
    columns = [
        evaluate_pressure(pressure, throws[:, k], arithmetic)
        for k, pressure in enumerate(pressures)
    ]
    return np.stack(columns, axis=1)
