"""Valid scenes of a crank whose speed is a table over its angle, drawn from a seed: the machines of
`random_scene`, their rows from nearly even to nearly at rest, of one cycle or of the whole run."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from crankmbs import Scene
from crankmbs.scene.drives import Motion, SpeedFile
from crankmbs.scene.scene import Extent, Run
from crankmbs.scene.speed_rows import check_over_angle
from crankmbs.scene.tables import Table
from validation.random_scenes import random_scene

__all__ = ["random_speeds"]

_SPARE = 1.001  # times the shortest rod
_HELD = 0.99  # of the way from the mean to where the speed would come to 0


def random_speeds(seed: int) -> Scene:
    """The scene of a seed."""
    rng, base = np.random.default_rng([41, seed]), random_scene(seed)
    least = _SPARE * (base.crank.radius + abs(base.piston.offset))
    rod = replace(base.rod, length=max(base.rod.length, least))
    mean = math.exp(rng.uniform(math.log(3.0), math.log(600.0)))
    sense = -1.0 if rng.random() < 0.3 else 1.0
    turns, begin = rng.uniform(1.0, 3.0), float(rng.uniform(-7.0, 7.0))
    kind: Literal["pchip", "cubic"] = "cubic" if rng.random() < 0.5 else "pchip"
    period = 2.0 * math.pi * int(rng.integers(1, 3)) if rng.random() < 0.6 else None
    reach = sense * 2.0 * math.pi * turns
    low = float(rng.uniform(-7.0, 7.0)) if period else min(begin, begin + reach) - 0.1
    span = period or abs(reach) + 0.2
    file = _rows(rng, low, span, kind, closes=period is not None)
    speed = SpeedFile(file=file.scaled(sense * mean), interpolation=kind, kind="angle_table")
    duration = 2.0 * math.pi * turns / mean
    until = Extent(value=abs(reach), unit="rad")
    if period and rng.random() < 0.5:
        until = Extent(value=duration, unit="s")
    spacings = (
        Extent(value=math.radians(rng.uniform(20.0, 60.0)), unit="rad"),
        Extent(value=duration / rng.uniform(8.0, 24.0), unit="s"),
    )
    run = Run(until=until, every=spacings[int(rng.random() < 0.4)])
    motion = Motion(speed=speed, angle=begin)
    return replace(base, rod=rod, motion=motion, start=None, torque=(), run=run)


def _rows(
    rng: np.random.Generator, low: float, span: float, kind: Literal["pchip", "cubic"], closes: bool
) -> Table:
    """Rows about 1, as far from it as the sign of what is between them allows."""
    count = int(rng.integers(4, 40))
    even = np.arange(count + 1) + np.append(0.0, rng.uniform(-0.45, 0.45, count))
    even[-1] = count
    angle = low + even * span / count
    shape = rng.uniform(-1.0, 1.0, count + 1)
    shape[-1] = shape[0] if closes else shape[-1]
    swing = math.exp(rng.uniform(math.log(1e-3), math.log(10.0)))
    while True:
        table = Table(tuple(angle.tolist()), tuple((1.0 + swing * shape).tolist()))
        try:
            check_over_angle(table, kind)
        except ValueError:
            swing *= _HELD
        else:
            return table
