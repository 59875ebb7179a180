"""What forces on the pistons alone do in every joint; no body needs them to move."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.axes import axes_of, closed_loops, gears_of
from crankmbs.mechanics.journals import of_rods
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import Period, single
from crankmbs.scene.scene import Scene

__all__ = ["pushed", "pushed_parts"]


def pushed(scene: Scene, period: Period, forces: Array) -> dict[str, Array]:
    """What forces on the pistons towards the crank add: the rods push along themselves.

    forces : shape (cylinders, samples) [N]

    Returns
    -------
    by variable of the result, in its unit: shape (1, samples) of the crank, (cylinders, samples) of
    each cylinder, as of each journal

    >>> scene = load_scene("coasting")
    >>> pushed(scene, single(np.zeros(1)), np.ones((1, 1)))["piston_pin_force_x"]
    array([[1.]])
    """
    axes, gears, loop = axes_of(scene), gears_of(scene), closed_loops(scene, period.angles)
    tangent = loop.sin_beta / loop.cos_beta
    lever = gears.radius * (loop.sin_phi + loop.cos_phi * tangent)
    across = period.times(-tangent, forces)
    torque = period.times(lever, forces)
    moment = period.times(-loop.x * tangent - gears.offset, forces)
    journal = np.cumsum(torque, axis=0)
    return of_rods(scene, forces, across) | {
        "external_torque": -journal[-1:],
        "main_bearing_force_x": (axes.cos @ forces - axes.sin @ across)[np.newaxis],
        "main_bearing_force_y": (axes.sin @ forces + axes.cos @ across)[np.newaxis],
        "frame_moment": moment.sum(axis=0, keepdims=True),
        "side_force": -across,
        "piston_pin_force_x": forces,
        "piston_pin_force_y": across,
        "crank_pin_force_x": forces,
        "crank_pin_force_y": across,
        "crank_torque": torque,
        "journal_torque": journal,
        "pin_torque": journal - 0.5 * torque,
    }


def pushed_parts(scene: Scene, theta: Array, forces: list[Array]) -> dict[str, list[list[Array]]]:
    """The same of every cylinder alone, at crank angles of shape (n,) [rad]: by variable, for each
    cylinder, what each adds."""
    found = pushed(scene, single(theta), np.array(forces))
    return {name: [[each] * len(forces) for each in values] for name, values in found.items()}
