"""What the moving parts do to the frame: its joints' forces, and the balance about the crank."""

from validation.oracles import bodies
from validation.oracles.arithmetic import LONG, Arithmetic, Array
from validation.oracles.machine import Machine
from validation.oracles.newton_euler import newton_euler


def frame_loads(
    machine: Machine, theta: Array, omega: Array, alpha: Array, arithmetic: Arithmetic = LONG
) -> dict[str, Array]:
    """Force [N] and moment [N m] on the frame, shape (samples,), in the engine's axes.

    The force is the opposite of what the bearing and the walls do to the parts, and the gas on the
    heads. The moment about the crank axis is that from outside and of the weights, less the rate of
    angular momentum, body by body. Rocking moments are those of each cylinder's weight and inertia
    about the middle of the crank.
    """
    number, count = arithmetic.number, len(machine.cylinders)
    found = newton_euler(machine, theta, omega, alpha, arithmetic)
    theta, omega, alpha = (arithmetic.array(q) for q in (theta, omega, alpha))
    bank = arithmetic.array([bank for _, bank in machine.cylinders])
    cos_bank, sin_bank = arithmetic.cos(bank), arithmetic.sin(bank)
    gas, side = found.gas_force, found.side_force
    loads = {
        "frame_force_x": (cos_bank * gas + sin_bank * side).sum(axis=1)
        - found.main_bearing_force_x,
        "frame_force_y": (sin_bank * gas - cos_bank * side).sum(axis=1)
        - found.main_bearing_force_y,
    }

    gx, gy = (number(component) for component in machine.gravity)
    pull_x, pull_y = cos_bank * gx + sin_bank * gy, cos_bank * gy - sin_bank * gx
    angle, rate = bodies.pose(machine, theta, omega, arithmetic)
    cosine, sine = arithmetic.cos(angle), arithmetic.sin(angle)
    throw, rod = slice(1, 1 + count), slice(1 + count, None)
    spin, spun = rate[:, rod], -found.rod_angular_acceleration
    radius, to_rod = number(machine.crank_radius), number(machine.rod_center_of_mass)
    square, turn = (omega * omega)[:, None], alpha[:, None]
    x = radius * cosine[:, throw] + to_rod * cosine[:, rod]
    y = radius * sine[:, throw] + to_rod * sine[:, rod]
    x_tt = -radius * (cosine[:, throw] * square + sine[:, throw] * turn)
    y_tt = -radius * (sine[:, throw] * square - cosine[:, throw] * turn)
    x_tt = x_tt - to_rod * (cosine[:, rod] * spin * spin + sine[:, rod] * spun)
    y_tt = y_tt - to_rod * (sine[:, rod] * spin * spin - cosine[:, rod] * spun)
    rod_mass, piston_mass = number(machine.rod_mass), number(machine.piston_mass)
    rod_x, rod_y = rod_mass * (pull_x - x_tt), rod_mass * (pull_y - y_tt)
    piston_x = piston_mass * (pull_x - found.piston_acceleration)
    piston_y = piston_mass * pull_y
    lever = number(machine.crank_mass) * number(machine.crank_center_of_mass)
    moment = x * rod_y - y * rod_x - number(machine.rod_inertia) * spun
    moment = moment + found.piston_position * piston_y - number(machine.offset) * piston_x
    loads["frame_moment"] = (
        found.external_torque
        - number(machine.crank_inertia) * alpha
        + lever * (cosine[:, 0] * gy - sine[:, 0] * gx)
        + moment.sum(axis=1)
    )
    if machine.levers:
        along = arithmetic.array(machine.levers)
        force_x, force_y = rod_x + piston_x, rod_y + piston_y
        loads["rocking_moment_x"] = -(along * (sin_bank * force_x + cos_bank * force_y)).sum(axis=1)
        loads["rocking_moment_y"] = (along * (cos_bank * force_x - sin_bank * force_y)).sum(axis=1)
    return loads
