"""The mechanism of a scene in plain data: bodies, hinges and guides, as a textbook lists them.

Planar, in the engine's frame: X along the reference cylinder, Y is X turned by +90 degrees. The
order of bodies is that of the coordinates: x, y of the centre of mass [m] and the angle [rad], but
for point masses. That of hinges, then guides, is that of the multipliers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Body", "Guide", "Hinge", "Mechanism", "closed", "mechanism_of"]


class Body(NamedTuple):
    """Mass [kg] and moment of inertia about its centre of mass [kg m^2]; None: a point mass."""

    name: str
    mass: float
    inertia: float | None


class Hinge(NamedTuple):
    """Joins points of two bodies, x and y [m] in the axes of each; its force is on the second."""

    name: str
    bodies: tuple[str, str]
    points: tuple[tuple[float, float], tuple[float, float]]


class Guide(NamedTuple):
    """Keeps the distance [m] of a body from the crank axis along a normal."""

    name: str
    body: str
    normal: tuple[float, float]
    offset: float


class Mechanism(NamedTuple):
    """gravity [m/s^2]; bodies: the crank, then for each cylinder a rod and a piston."""

    gravity: tuple[float, float]
    bodies: tuple[Body, ...]
    hinges: tuple[Hinge, ...]
    guides: tuple[Guide, ...]


def mechanism_of(scene: Scene) -> Mechanism:
    """One crank that carries all throws; per cylinder a rod, a piston and the cylinder's wall.

    >>> [body.name for body in mechanism_of(load_scene("propeller")).bodies]
    ['crank', 'rod 1', 'piston 1']
    """
    crank, centre = scene.crank, scene.crank.center_of_mass
    inertia = max(crank.moment_of_inertia - crank.mass * centre**2, 0.0)
    bodies = [Body("crank", crank.mass, inertia)]
    hinges = [Hinge("main bearing", ("ground", "crank"), ((0.0, 0.0), (-centre, 0.0)))]
    guides = []
    for k, cylinder in enumerate(scene.cylinders, start=1):
        radius, rod, piston = scene.running_gear[k - 1]
        turn, a = cylinder.phase + cylinder.bank, rod.center_of_mass
        throw = radius * math.cos(turn) - centre, radius * math.sin(turn)
        big_end, small_end = (-a, 0.0), (rod.length - a, 0.0)
        bodies.append(Body(f"rod {k}", rod.mass, rod.moment_of_inertia))
        bodies.append(Body(f"piston {k}", piston.mass, None))
        hinges.append(Hinge(f"crank pin {k}", ("crank", f"rod {k}"), (throw, big_end)))
        points = small_end, (0.0, 0.0)
        hinges.append(Hinge(f"piston pin {k}", (f"rod {k}", f"piston {k}"), points))
        normal = -math.sin(cylinder.bank), math.cos(cylinder.bank)
        guides.append(Guide(f"wall {k}", f"piston {k}", normal, piston.offset))
    g = scene.gravity
    pull = (0.0, 0.0)
    if g is not None:
        pull = g.acceleration * math.cos(g.angle), g.acceleration * math.sin(g.angle)
    return Mechanism(pull, tuple(bodies), tuple(hinges), tuple(guides))


def closed(scene: Scene, theta: Array) -> Array:
    """Coordinates of all bodies on the closed loop at crank angles [rad], shape (m, q): the right
    one of the two ways in which a rod closes it."""
    centre = scene.crank.center_of_mass * np.exp(1j * theta)
    columns = [centre.real, centre.imag, theta]
    for cylinder, gear in zip(scene.cylinders, scene.running_gear, strict=True):
        loop = close_loop(theta + cylinder.phase, *gear.shape)
        axis, a = np.exp(1j * cylinder.bank), gear.rod.center_of_mass
        throw = gear.radius * (loop.cos_phi + 1j * loop.sin_phi)
        along = loop.cos_beta - 1j * loop.sin_beta
        middle, pin = axis * (throw + a * along), axis * (loop.x + 1j * gear.piston.offset)
        columns += [middle.real, middle.imag, cylinder.bank - loop.beta, pin.real, pin.imag]
    return np.stack(columns, axis=-1)
