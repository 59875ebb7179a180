"""Where the cylinders of a scene stand, what moves in each, and the loop that each closes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.geometry import (
    Lengths,
    Loop,
    close_loops,
    dead_centres,
    lengths_of,
    top_position,
)
from crankmbs.mechanics.knots import KNOT
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene

__all__ = [
    "Axes",
    "Gears",
    "areas",
    "axes_of",
    "closed_loops",
    "displacements",
    "gears_of",
    "gravity_vector",
    "slides",
]


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


class Gears(NamedTuple):
    """What moves in the cylinders: one number for all, or shape (cylinders, 1) where they are
    unlike.

    radius, length, offset [m]; rod_mass [kg]; rod_centre [m] from the crank pin; rod_inertia
    [kg m2] about the centre of mass; piston_mass [kg]; area [m2], 0 where the machine has none;
    crank_end_share [1], of that area; top [m], position of displacement 0; top_centre,
    bottom_centre [rad], cycle angles of the dead centres
    """

    radius: Array | float
    length: Array | float
    offset: Array | float
    rod_mass: Array | float
    rod_centre: Array | float
    rod_inertia: Array | float
    piston_mass: Array | float
    area: Array | float
    crank_end_share: Array | float
    top: Array | float
    top_centre: Array | float
    bottom_centre: Array | float

    @property
    def over_motions(self) -> Gears:
        """The same for curves of shape (cylinders, u, n)."""
        return Gears(*(x[:, np.newaxis] if isinstance(x, np.ndarray) else x for x in self))


@once
def gears_of(scene: Scene) -> Gears:
    """What moves in a scene's cylinders.

    >>> gears_of(load_scene("two_stage_compressor")).area.shape
    (2, 1)
    """
    rows = []
    for gear in scene.running_gear:
        rod, piston = gear.rod, gear.piston
        masses = *gear.shape, rod.mass, rod.center_of_mass, rod.moment_of_inertia, piston.mass
        areas = piston.gas_area or 0.0, piston.crank_end_share
        rows.append((*masses, *areas, top_position(*gear.shape), *dead_centres(*gear.shape)))
    return Gears(*(np.array(rows).T[:, :, np.newaxis] if scene.unlike else rows[0]))


@once
def _lengths(scene: Scene) -> Lengths:
    return lengths_of(*gears_of(scene)[:3])


def areas(scene: Scene) -> tuple[Array, Array]:
    """What the gas of both ends presses on [m2], shape (cylinders,) each; 0 where there is none.

    >>> areas(load_scene("coasting"))[0].tolist()
    [0.0]
    """
    pistons = [gear.piston for gear in scene.running_gear]
    heads = np.array([piston.gas_area or 0.0 for piston in pistons])
    return heads, np.array([piston.crank_end_area for piston in pistons])


def closed_loops(scene: Scene, theta: Array) -> Loop:
    """The closed loop of every cylinder at crank angles of shape (n,) [rad]; every field has shape
    (cylinders, n)."""
    return close_loops(theta, axes_of(scene).phases, _lengths(scene))


def displacements(scene: Scene, loop: Loop) -> Array:
    """How far the pistons are from their true top dead centres [m], shape (cylinders, n).

    >>> scene = load_scene("coasting")
    >>> displacements(scene, closed_loops(scene, np.zeros(1)))
    array([[0.]])
    """
    return np.asarray(gears_of(scene).top - loop.x)


def slides(scene: Scene, theta: Array, sense: float) -> Array:
    """The signs of the pistons' velocities towards the crank just beyond crank angles of shape
    (n,) [rad], in a sense of rotation (a sign); shape (cylinders, n).

    >>> slides(load_scene("coasting"), np.array([0.0, 4.0]), 1.0)
    array([[ 1., -1.]])
    """
    gears, beyond = gears_of(scene), np.add.outer(axes_of(scene).phases, theta) + sense * KNOT
    behind = np.mod(beyond - gears.top_centre, 2.0 * math.pi)
    return np.where(behind < gears.bottom_centre - gears.top_centre, sense, -sense)
