"""Gravity: a crank train that hardly moves carries its weight, wherever its cylinders lean."""

from __future__ import annotations

import numpy as np

from crankmbs.scene.scene import Scene
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import LONG, Array
from validation.runs import run

__all__ = ["at_rest"]

_NUDGE = 1e-5  # rad: the difference of two heights then errs by 1e-10 of their change per radian


def at_rest(case: Case) -> Outcome:
    """Force on the bearing and the walls against the whole weight, and the drive's torque against
    what the heights of all centres of mass change by per radian; over the weight, and over the
    weight at the crank radius."""
    data, scene = run(case.ours()).data, case.theirs()
    assert scene.gravity is not None
    theta = LONG.array(data["crank_angle"].values)
    g = scene.gravity.acceleration
    pull = np.exp(1j * LONG.number(scene.gravity.angle))
    rods = len(scene.cylinders) * (scene.rod.mass + scene.piston.mass)
    weight = (scene.crank.mass + rods) * g
    ours = data["main_bearing_force_x"].values + 1j * data["main_bearing_force_y"].values
    thrust = data["side_force"].values
    for k, cylinder in enumerate(scene.cylinders):  # the walls carry the rest
        ours = ours + 1j * np.exp(1j * cylinder.bank) * thrust[:, k]
    of_bearings = np.max(np.abs(ours + weight * pull)) / weight
    fallen = (_fallen(scene, theta + _NUDGE) - _fallen(scene, theta - _NUDGE)) / (2 * _NUDGE)
    apart = np.abs(data["external_torque"].values + fallen)
    of_torque = np.max(apart) / (weight * scene.crank.radius)
    return Outcome(
        float(max(of_bearings, of_torque)),
        f"weight {weight:.4f} N, largest torque of the drive {float(np.max(np.abs(fallen))):.5f} "
        f"N m; forces {float(of_bearings):.1e}, torque {float(of_torque):.1e}",
    )


def _fallen(scene: Scene, theta: Array) -> Array:
    """Sum of m g times what every centre of mass has fallen below the crank axis [J], from
    places in the complex plane of the engine."""
    crank, rod, piston, gravity = scene.crank, scene.rod, scene.piston, scene.gravity
    assert gravity is not None
    moment = crank.mass * crank.center_of_mass * np.exp(1j * theta)
    for cylinder in scene.cylinders:
        phi, axis = theta + cylinder.phase, np.exp(1j * LONG.number(cylinder.bank))
        across = crank.radius * np.sin(phi) - piston.offset
        pin = crank.radius * np.cos(phi) + np.sqrt(LONG.number(rod.length) ** 2 - across**2)
        throw, top = axis * crank.radius * np.exp(1j * phi), axis * (pin + 1j * piston.offset)
        share = LONG.number(rod.center_of_mass) / rod.length
        moment = moment + piston.mass * top + rod.mass * (throw + share * (top - throw))
    fallen: Array = gravity.acceleration * (moment * np.exp(-1j * LONG.number(gravity.angle))).real
    return fallen
