"""Valid scenes of a free crank under tables over its angle of any period, drawn from a seed: those
of `random_turning`, the tables stretched to multiples of half a revolution."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs import Scene
from crankmbs.scene.loads import AngleTable
from crankmbs.scene.run import Extent
from crankmbs.scene.tables import Table
from validation.random_turning import random_turning

__all__ = ["random_periods"]

_HALVES = (1, 3, 5, 6, 7, 9, 10)  # half revolutions of a period; few divide the engine's


def random_periods(seed: int) -> Scene:
    """The scene of a seed."""
    rng, base = np.random.default_rng([44, seed]), random_turning(seed)
    tables = tuple(_stretched(load, rng) for load in base.torque if isinstance(load, AngleTable))
    run = replace(base.run, until=Extent(value=float(rng.uniform(4.0, 40.0)), unit="rad"))
    return replace(base, torque=tables, run=run)


def _stretched(load: AngleTable, rng: np.random.Generator) -> AngleTable:
    """Over a period of its own, the torque as large as the work of a period remains."""
    own = load.parts.period
    assert own is not None
    period = math.pi * int(rng.choice(_HALVES))
    angles = tuple(angle * period / own for angle in load.file.x)
    torques = tuple(torque * own / period for torque in load.file.y)
    return replace(load, file=Table(angles, torques), period=period)
