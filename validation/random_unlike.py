"""Valid scenes of a free crank with unlike cylinders, drawn from a seed: those of `random_forces`,
each of whose cylinders has a throw, a rod and a piston of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crankmbs import Cylinder, Layout, Scene
from crankmbs.scene.parts import OwnPiston, OwnRod
from validation.random_forces import random_forces

__all__ = ["random_unlike"]

_KEPT = 0.3  # of the cylinders but the first have the scene's rod, and as many its piston


def random_unlike(seed: int) -> Scene:
    """The scene of a seed."""
    rng, scene = np.random.default_rng([17, seed]), random_forces(seed)
    first, *others = (_own(rng, scene, cylinder) for cylinder in scene.cylinders)
    others = [_partly(rng, cylinder) for cylinder in others]
    return replace(scene, layout=Layout(cylinders=(first, *others)))


def _own(rng: np.random.Generator, scene: Scene, cylinder: Cylinder) -> Cylinder:
    """With a shorter throw, so that tables over the travel cover every stroke, a rod that closes
    the loop, and bodies from half to twice as heavy."""
    rod, piston = scene.rod, scene.piston
    radius = scene.crank.radius * float(rng.uniform(0.6, 0.95))
    offset = piston.offset + 0.1 * radius * float(rng.uniform(-1.0, 1.0))
    least = 1.1 * (radius + abs(offset))
    length = max(rod.length * float(rng.uniform(0.7, 1.3)), least)
    stretch, heavier = length / rod.length, float(rng.uniform(0.5, 2.0))
    inertia = rod.inertia if rod.inertia == "two-mass" else rod.inertia * heavier * stretch**2
    own_rod = OwnRod(
        length=length,
        mass=rod.mass * heavier,
        center_of_mass=rod.center_of_mass * stretch,
        inertia=inertia,
    )
    own_piston = OwnPiston(mass=piston.mass * float(rng.uniform(0.5, 2.0)), offset=offset)
    if piston.gas_area is not None:
        own_piston = replace(own_piston, area=piston.gas_area * float(rng.uniform(0.4, 1.0)))
    return replace(cylinder, radius=radius, rod=own_rod, piston=own_piston)


def _partly(rng: np.random.Generator, cylinder: Cylinder) -> Cylinder:
    """With the scene's rod or piston, or with everything of the scene's."""
    rod, piston, every = (bool(rng.random() < _KEPT) for _ in range(3))
    return replace(
        cylinder,
        radius=None if every else cylinder.radius,
        rod=None if rod or every else cylinder.rod,
        piston=None if piston or every else cylinder.piston,
    )
