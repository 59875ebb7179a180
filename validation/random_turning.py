"""Valid scenes of a free crank under tables over its angle, drawn from a seed: the machines and
loads of `random_scene`, and tables of every interpolation, with and without jumps."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from crankmbs import Scene
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.scene.loads import AngleTable
from crankmbs.scene.scene import Extent
from crankmbs.scene.tables import Table
from validation.random_scenes import random_scene

__all__ = ["random_turning"]

_KINDS: tuple[Literal["linear", "pchip", "cubic"], ...] = ("linear", "pchip", "cubic")


def random_turning(seed: int) -> Scene:
    """The scene of a seed."""
    rng, base = np.random.default_rng([43, seed]), random_scene(seed)
    start = base.start
    assert start is not None
    least = 1.01 * (base.crank.radius + abs(base.piston.offset))
    base = replace(base, rod=replace(base.rod, length=max(base.rod.length, least)))
    speed = math.exp(rng.uniform(math.log(3.0), math.log(300.0)))
    speed *= -1.0 if rng.random() < 0.3 else 1.0
    energy = 0.5 * float(inertia_alone(base, start.angle)) * speed**2
    tables = tuple(_table(rng, 0.05 * energy) for _ in range(int(rng.integers(1, 3))))
    run = replace(base.run, until=Extent(value=float(rng.uniform(4.0, 14.0)), unit="rad"))
    return replace(
        base,
        gas=base.gas if rng.random() < 0.3 else None,
        gravity=None,
        start=replace(start, speed=speed),
        torque=tables,
        run=run,
    )


def _table(rng: np.random.Generator, size: float) -> AngleTable:
    """Rows over one or two revolutions, perhaps with a jump inside or where they close."""
    period = 2.0 * math.pi * int(rng.integers(1, 3))
    count = int(rng.integers(4, 20))
    even = np.arange(count) + rng.uniform(-0.3, 0.3, count)
    angle = float(rng.uniform(-7.0, 7.0)) + even * period / count
    if rng.random() < 0.4:
        angle = np.insert(angle, k := int(rng.integers(1, count)), angle[k])
    if rng.random() < 0.5:
        angle = np.append(angle, angle[0] + period)
    torque = size * rng.uniform(-1.0, 1.0, len(angle))
    kind = _KINDS[int(rng.integers(3))]
    return AngleTable(file=Table(tuple(angle.tolist()), tuple(torque.tolist())), interpolation=kind)
