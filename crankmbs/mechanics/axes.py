"""Where the cylinders of a scene stand, and the loop that each closes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.geometry import Loop, close_loops
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene

__all__ = ["Axes", "axes_of", "closed_loops", "gravity_vector"]


def gravity_vector(scene: Scene, bank: float = 0.0) -> tuple[float, float]:
    """Gravity [m/s2] in the frame of a cylinder at this bank [rad]; (0, 0) without gravity."""
    if scene.gravity is None:
        return 0.0, 0.0
    angle = scene.gravity.angle - bank
    g = scene.gravity.acceleration
    return g * math.cos(angle), g * math.sin(angle)


class Axes(NamedTuple):
    """Where the cylinders stand.

    phases : shape (cylinders,) [rad]
    cos, sin : of the banks, shape (cylinders,)
    gravity : along and across each axis, shape (2, cylinders, 1) [m/s2]
    """

    phases: Array
    cos: Array
    sin: Array
    gravity: Array


@once
def axes_of(scene: Scene) -> Axes:
    """The axes of a scene's cylinders.

    >>> axes_of(load_scene("v_twin")).phases.shape
    (2,)
    """
    banks = np.array([c.bank for c in scene.cylinders])
    gravity = np.array([gravity_vector(scene, c.bank) for c in scene.cylinders])
    phases = np.array([c.phase for c in scene.cylinders])
    return Axes(phases, np.cos(banks), np.sin(banks), gravity.T[:, :, np.newaxis])


def closed_loops(scene: Scene, theta: Array) -> Loop:
    """The closed loop of every cylinder at crank angles of shape (n,) [rad]; every field has shape
    (cylinders, n)."""
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    return close_loops(theta, axes_of(scene).phases, r, l, e)
