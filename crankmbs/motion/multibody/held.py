"""What the gas, and rings, alone do in every joint while the crank is held.

It is taken off the recorded forces before they are interpolated between the steps and put back
after, at the sample's own crank angle: kinks of the pressure between two steps then do not bend
the interpolation. What is taken off is put back, so it can be anything; no error comes from it.
"""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["held_by"]


def held_by(scene: Scene, gas: Array, theta: Array) -> dict[str, Array]:
    """Joint forces [N] and torques [N m] of gas and rings, shape (m, n), at crank angles (m,).

    The rod pushes along itself: (P, -P tan(beta)) on the piston and on the crank pin. Empty
    without both.
    """
    if scene.gas is None and scene.friction is None:
        return {}
    phi = theta[:, None] + np.array([c.phase for c in scene.cylinders])
    bank = np.array([c.bank for c in scene.cylinders])
    loop = close_loop(phi, scene.crank.radius, scene.rod.length, scene.piston.offset)
    across = -gas * loop.sin_beta / loop.cos_beta
    torque = scene.crank.radius * (loop.sin_phi * gas - loop.cos_phi * across)
    return {
        "main_bearing_force_x": (gas * np.cos(bank) - across * np.sin(bank)).sum(axis=1),
        "main_bearing_force_y": (gas * np.sin(bank) + across * np.cos(bank)).sum(axis=1),
        "external_torque": -torque.sum(axis=1) if scene.motion is not None else 0.0 * theta,
        "side_force": -across,
        "piston_pin_force_x": gas,
        "piston_pin_force_y": across,
        "crank_pin_force_x": gas,
        "crank_pin_force_y": across,
        "crank_torque": torque,
        "journal_torque": np.cumsum(torque, axis=1),
        "pin_torque": np.cumsum(torque, axis=1) - 0.5 * torque,
        "frame_moment": -torque.sum(axis=1),
    }
