"""Newton-Euler: every joint force from crank angle, speed and acceleration. Exact.

Body by body from the piston down, in each cylinder's frame: the piston's X balance gives the rod
on piston along the axis, the rod's moment about the crank pin gives it across, the piston's Y
balance the wall, the rod's balance the crank pin, and the crank's balance the main bearing and
the torque from outside. Gas pushes the piston towards the crank, -X.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crankmbs.geometry import close_loop, top_position
from crankmbs.inertia import gravity_vector, rod_centre
from crankmbs.pressure import PeriodicPressure
from crankmbs.sampling import one_period
from crankmbs.scene import Scene

__all__ = ["reactions"]

Array = NDArray[np.float64]


def reactions(
    scene: Scene,
    pressure: PeriodicPressure | None,
    theta: ArrayLike,
    omega: ArrayLike,
    alpha: ArrayLike,
) -> dict[str, Array]:
    """Motion of every part and force in every joint.

    Parameters
    ----------
    pressure : `crankmbs.pressure.pressure_of` the scene
    theta, omega, alpha : shape (n,) [rad, rad/s, rad/s2]; any motion, prescribed or free

    Returns
    -------
    dict of the variables of a result by name, in SI units: shape (n,) those of the crank,
    (n, cylinders) those of a cylinder; signs and frames as in `crankmbs.result.VARIABLES`

    >>> scene = load_scene("torque_driven")
    >>> float(reactions(scene, None, [0.0], [10.0], [0.0])["side_force"][0, 0])
    0.0
    """
    theta, omega, alpha = (np.asarray(q, dtype=np.float64) for q in (theta, omega, alpha))
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    area = piston.gas_area or 0.0
    r, l, a = crank.radius, rod.length, rod.center_of_mass
    top = top_position(r, l, piston.offset)
    square = omega**2

    first_moment = crank.mass * crank.center_of_mass
    once, which = one_period(theta, scene.period)
    sin_theta, cos_theta = np.sin(once)[which], np.cos(once)[which]
    gx, gy = gravity_vector(scene)
    bearing_x = first_moment * (-cos_theta * square - sin_theta * alpha) - crank.mass * gx
    bearing_y = first_moment * (-sin_theta * square + cos_theta * alpha) - crank.mass * gy
    torque = crank.inertia * alpha - first_moment * (cos_theta * gy - sin_theta * gx)
    kinetic = 0.5 * crank.inertia * square
    columns: list[dict[str, Array]] = []

    for cylinder in scene.cylinders:
        gx, gy = gravity_vector(scene, cylinder.bank)
        phi = once + cylinder.phase
        closed = close_loop(phi, r, l, piston.offset)
        loop, g = closed.at(which), rod_centre(closed, r, a).at(which)
        sin_b, cos_b = loop.sin_beta, loop.cos_beta
        x_tt = loop.x_2 * square + loop.x_1 * alpha
        g_xtt = g.x_2 * square + g.x_1 * alpha
        g_ytt = g.y_2 * square + g.y_1 * alpha
        beta_tt = loop.beta_2 * square + loop.beta_1 * alpha
        gas = (pressure(phi) if pressure is not None else np.zeros_like(phi))[which]

        pin_x = piston.mass * (x_tt - gx) + gas * area
        weight = rod.mass * (cos_b * (g_ytt - gy) + sin_b * (g_xtt - gx))
        pin_y = ((rod.moment_of_inertia * beta_tt - a * weight) / l - pin_x * sin_b) / cos_b
        throw_x = rod.mass * (g_xtt - gx) + pin_x
        throw_y = rod.mass * (g_ytt - gy) + pin_y
        crank_torque = r * (loop.sin_phi * throw_x - loop.cos_phi * throw_y)

        torque = torque - crank_torque
        cos_bank, sin_bank = np.cos(cylinder.bank), np.sin(cylinder.bank)
        bearing_x = bearing_x + cos_bank * throw_x - sin_bank * throw_y
        bearing_y = bearing_y + sin_bank * throw_x + cos_bank * throw_y
        kinetic = kinetic + 0.5 * square * (
            piston.mass * loop.x_1**2
            + rod.mass * (g.x_1**2 + g.y_1**2)
            + rod.moment_of_inertia * loop.beta_1**2
        )
        columns.append(
            {
                "rod_angle": loop.beta,
                "piston_position": loop.x,
                "piston_displacement": top - loop.x,
                "piston_velocity": -loop.x_1 * omega,
                "piston_acceleration": -x_tt,
                "gas_pressure": gas,
                "gas_force": gas * area,
                "side_force": -pin_y - piston.mass * gy,
                "piston_pin_force_x": pin_x,
                "piston_pin_force_y": pin_y,
                "crank_pin_force_x": throw_x,
                "crank_pin_force_y": throw_y,
                "crank_torque": crank_torque,
            }
        )
    whole = {
        "external_torque": torque,
        "main_bearing_force_x": bearing_x,
        "main_bearing_force_y": bearing_y,
        "kinetic_energy": kinetic,
    }
    parts = {name: _side_by_side([c[name] for c in columns]) for name in columns[0]}
    return whole | parts


def _side_by_side(columns: list[Array]) -> Array:
    """Shape (n, cylinders); of one cylinder nothing is copied."""
    return columns[0][:, np.newaxis] if len(columns) == 1 else np.array(columns).T
