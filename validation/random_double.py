"""Valid scenes of a free crank with double-acting cylinders, drawn from a seed: those of
`random_changes` of every kind in turn, some from rest, with crank ends, piston rods, friction."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from crankmbs import Scene
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.scene.gas import Gas
from crankmbs.scene.parts import Friction
from crankmbs.scene.tables import Table
from validation.random_changes import KINDS, random_changes

__all__ = ["random_double"]

_FIRED = ("fuel", "all")
_FRESH = 20.0  # rad/s, where the crank starts from rest


def random_double(seed: int) -> Scene:
    """The scene of a seed."""
    return _Draw(seed).scene()


class _Draw:
    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([46, seed])
        self.base = random_changes(KINDS[seed % len(KINDS)], seed)
        start, self.area = self.base.start, self.base.piston.area
        assert start is not None
        assert self.area is not None
        self.speed = abs(start.speed) or _FRESH
        energy = 0.5 * float(inertia_alone(self.base, start.angle)) * self.speed**2
        self.way = 8.0 * self.base.crank.radius * len(self.base.cylinders)
        self.energy, self.most = energy, 0.3 * energy / (self.area * self.base.crank.radius)

    def scene(self) -> Scene:
        base, start, area = self.base, self.base.start, self.area
        assert start is not None
        assert area is not None
        if self.chance(0.15):
            start = replace(start, speed=0.0)
        gas = base.gas or Gas(pressure=self.rows(2.0 * math.pi, 1), absolute=False, stroke=2)
        gas = replace(gas, crank_end=self.crank_end(gas))
        if self.chance(0.5):
            gas = self.absolute(gas)
        piston = base.piston
        if self.chance(0.7):
            across = math.sqrt(4.0 / math.pi * area * float(self.rng.uniform(0.02, 0.6)))
            piston = replace(piston, rod_diameter=across)
        friction = base.friction or (self.friction() if self.chance(0.4) else None)
        return replace(base, start=start, gas=gas, piston=piston, friction=friction)

    def crank_end(self, gas: Gas) -> float | Table | tuple[Table, ...]:
        """A table for each cylinder or one for all, of one cycle or several, or a constant."""
        if self.chance(0.15):
            return self.most * float(self.rng.uniform(-1.0, 1.0))
        cycles = int(self.rng.integers(1, 3)) if gas.cycles == "sequence" else 1
        count = len(self.base.cylinders)
        each = tuple(self.rows(gas.period, cycles) for _ in range(count))
        return each if count > 1 and self.chance(0.5) else each[0]

    def rows(self, period: float, cycles: int) -> Table:
        """Rows of so many cycles, perhaps with a jump."""
        count = int(self.rng.integers(4, 14)) * cycles
        even = (np.arange(count) + self.rng.uniform(-0.3, 0.3, count)) * period * cycles / count
        if self.chance(0.4):
            k = int(self.rng.integers(1, count))
            even = np.insert(even, k, even[k])
        values = self.most * self.rng.uniform(-0.3, 1.0, len(even)) ** 3
        return Table(tuple(even.tolist()), tuple(values.tolist()))

    def absolute(self, gas: Gas) -> Gas:
        """The same over a crankcase's pressure, which is more than any is below it."""
        given = ("pressure", "motored", "crank_end")
        names = [name for name in given if getattr(gas, name) is not None]
        every = [value for name in names for value in _values(getattr(gas, name))]
        ambient = 1.5 * max(map(abs, every)) + 1.0
        moved: dict[str, Any] = {name: _lifted(getattr(gas, name), ambient) for name in names}
        return replace(gas, absolute=True, ambient=ambient, **moved)

    def friction(self) -> Friction:
        return Friction(
            ring_force=self.energy / self.way * self.log(1e-3, 0.3),
            ring_pressure=self.log(1e-3, 0.1) if self.chance(0.7) else 0.0,
            viscous=self.energy / (self.way * self.base.crank.radius * self.speed) * 1e-2,
        )

    def log(self, low: float, high: float) -> float:
        return math.exp(self.rng.uniform(math.log(low), math.log(high)))

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)


def _values(given: Any) -> tuple[float, ...]:
    if isinstance(given, float):
        return (given,)
    return tuple(y for table in (given if isinstance(given, tuple) else (given,)) for y in table.y)


def _lifted(given: Any, by: float) -> Any:
    if isinstance(given, float):
        return given + by
    if isinstance(given, tuple):
        return tuple(_lifted(each, by) for each in given)
    return Table(given.x, tuple(y + by for y in given.y), given.source)
