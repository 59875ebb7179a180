"""Valid scenes of a free crank whose pistons rub, drawn from a seed: the machines of `random_scene`
under loads that are functions of the speed, with friction that takes a part of their energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs import Scene
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.scene.loads import Constant, Quadratic, Viscous
from crankmbs.scene.parts import Friction
from crankmbs.scene.scene import Extent, Run
from validation.random_scenes import random_scene

__all__ = ["random_friction"]

_SPARE = 1.1  # times the shortest rod: SciPy would need too many steps beside a fold
_TURNS = 2.0


def random_friction(seed: int) -> Scene:
    """The scene of a seed."""
    rng, base = np.random.default_rng([15, seed]), random_scene(seed)
    least = _SPARE * (base.crank.radius + abs(base.piston.offset))
    base = replace(base, rod=replace(base.rod, length=max(base.rod.length, least)))
    assert base.start is not None
    speed = abs(base.start.speed) or 20.0
    energy = 0.5 * float(inertia_alone(base, base.start.angle)) * speed**2
    way = 4.0 * base.crank.radius * _TURNS * len(base.cylinders)
    kinds = rng.random(3) < 0.7
    ring, pressed, viscous = (
        float(kind) * math.exp(rng.uniform(math.log(1e-3), math.log(share)))
        for kind, share in zip(kinds, (1.5, 0.2, 0.5), strict=True)
    )
    friction = Friction(
        ring_force=ring * energy / way,
        ring_pressure=pressed if base.gas is not None else 0.0,
        viscous=viscous * energy / (way * base.crank.radius * speed),
    )
    duration = _TURNS * 2.0 * math.pi / speed
    run = Run(
        until=Extent(value=duration, unit="s"),
        every=Extent(value=duration / int(rng.integers(5, 12)), unit="s"),
        rtol=math.exp(rng.uniform(math.log(1e-10), math.log(1e-4))),
    )
    torque = tuple(one for one in base.torque if isinstance(one, Constant | Quadratic | Viscous))
    return replace(base, friction=friction, torque=torque, run=run)
