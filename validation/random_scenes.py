"""Valid scenes of a free crank, drawn from a seed: usual machines, and far corners of each part.

Speeds and loads are drawn relative to one another (the energy that the crank starts with against
the work of gas and loads), so that some cranks hardly notice their loads and others stall, swing
back or tear away.
"""

import math
from collections.abc import Mapping
from typing import Literal, TypeVar

import numpy as np

from crankmbs import Scene
from crankmbs.scene.drives import Start
from crankmbs.scene.gas import Gas, Indicator
from crankmbs.scene.loads import Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Crank, Cylinder, Gravity, Layout, Piston, Rod
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from crankmbs.scene.units import DEGREE

__all__ = ["random_scene"]

T = TypeVar("T")

STARTS = {1.0: 6, -1.0: 3, 0.0: 2, 0.1: 1, -0.1: 1}  # of the speed, and how often
STROKES: dict[Literal[2, 4], int] = {4: 2, 2: 1}
ZEROS: dict[Literal["gas_exchange_tdc", "firing_tdc"], int] = {
    "gas_exchange_tdc": 1,
    "firing_tdc": 1,
}
INTERPOLATIONS: tuple[Literal["pchip", "linear", "cubic", "step"], ...] = (
    "pchip",
    "linear",
    "cubic",
    "step",
)


def random_scene(seed: int) -> Scene:
    """The scene of a seed."""
    return _Draw(seed).scene()


class _Draw:
    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([20, seed])

    def scene(self) -> Scene:
        crank, rod, piston = self._machine()
        layout = self._layout()
        speed = self._log(3.0, 600.0)
        swung = rod.mass * crank.radius**2 + piston.mass * crank.radius**2
        inertia = crank.moment_of_inertia + swung * len(layout.resolve(4 * math.pi))
        energy = 0.5 * inertia * speed**2
        assert piston.area is not None
        gas = self._gas(energy / (piston.area * crank.radius)) if self._chance(0.75) else None
        turns = self._uniform(1.0, 3.0)
        duration = turns * 2.0 * math.pi / speed
        torque = self._loads(energy, speed, duration)
        return Scene(
            crank=crank,
            rod=rod,
            piston=piston,
            layout=layout,
            gas=gas,
            gravity=self._gravity(),
            start=Start(angle=self._uniform(-7.0, 7.0), speed=speed * self._pick(STARTS)),
            torque=torque,
            run=self._run(turns, duration, torque),
        )

    def _machine(self) -> tuple[Crank, Rod, Piston]:
        radius = self._log(0.01, 0.3)
        offset = radius * self._pick({0.0: 2, self._uniform(-0.3, 0.3): 3})
        spare = {self._uniform(2.0, 4.0): 6, self._uniform(0.05, 2.0): 3, self._log(1e-6, 0.05): 1}
        length = (radius + abs(offset)) * (1.0 + self._pick(spare))
        usual = 1e3 * radius**3
        piston = usual * self._log(0.1, 3.0) * self._pick({1.0: 8, 1e-6: 1, 0.0: 1})
        mass = usual * self._log(0.1, 3.0) * self._pick({1.0: 8, 1e-9: 1, 0.0: 1})
        centre = length * self._uniform(-0.1, 1.1)
        turned = mass * length**2 * self._log(0.01, 0.3)
        rods: dict[tuple[float, float | Literal["two-mass"]], int]
        rods = {(centre, turned): 4, (0.3 * length, "two-mass"): 1}
        centre, inertia = self._pick(rods)
        flywheel = radius**2 * usual * self._log(0.1, 100.0) * self._pick({1.0: 9, 1e4: 1})
        heavy = self._pick({0.0: 1, usual * self._log(0.1, 10.0): 2})
        reach = math.sqrt(flywheel / heavy) if heavy else 0.0
        return (
            Crank(radius=radius, inertia=flywheel, mass=heavy, center_of_mass=self._part(reach)),
            Rod(length=length, mass=mass, center_of_mass=centre, inertia=inertia),
            Piston(mass=piston, area=radius**2 * self._log(1.0, 10.0), offset=offset),
        )

    def _layout(self) -> Layout:
        count = self._pick({1: 6, 2: 2, 3: 1, 4: 1})
        if self._chance(0.3):
            order = self._rng.permutation(count) + 1
            return Layout(firing_order=tuple(int(k) for k in order))
        phases, banks = self._rng.uniform(-7.0, 13.0, count), self._rng.uniform(-3.0, 3.0, count)
        return Layout(cylinders=tuple(map(_cylinder, phases.tolist(), banks.tolist())))

    def _gas(self, most: float) -> Gas:
        """A gas whose work over one stroke is up to a few times that of the pressure ``most``."""
        scale = most * self._log(1e-3, 3.0)
        stroke = self._pick(STROKES)
        if self._chance(0.05):
            ratio, intake = self._uniform(4.0, 18.0), 0.02 * scale
            indicator = Indicator(
                compression_ratio=ratio,
                n_compression=1.3,
                n_expansion=1.25,
                intake_pressure=intake,
                exhaust_pressure=1.1 * intake,
                peak_pressure=intake * ratio**1.3 * self._uniform(1.0, 2.5),
                pre_expansion=self._uniform(1.0, 1.5),
            )
            return Gas(indicator=indicator, ambient=intake, stroke=stroke)
        rows = self._pick({self._between(4, 12): 2, self._between(12, 73): 1})
        period = stroke * math.pi
        even = (np.arange(rows) + self._rng.uniform(-0.3, 0.3, rows)) * period / rows
        if self._chance(0.25):  # two rows very close
            k = self._between(0, rows)
            even = np.sort(np.append(even, even[k] + self._log(1e-7, 1e-3)))
        value = scale * self._rng.uniform(-0.3, 1.0, len(even)) ** 3
        table = Table(even.tolist(), value.tolist())
        zero = self._pick(ZEROS)
        kind = INTERPOLATIONS[self._between(0, 4)]
        return Gas(pressure=table, absolute=False, stroke=stroke, zero=zero, interpolation=kind)

    def _gravity(self) -> Gravity | None:
        if self._chance(0.5):
            return None
        return Gravity(acceleration=9.81, angle=self._uniform(-4.0, 4.0))

    def _loads(self, energy: float, speed: float, duration: float) -> tuple[Torque, ...]:
        torque = energy * self._log(1e-3, 1.0)
        at = speed * np.sort(self._rng.uniform(-2.0, 2.0, 4))
        when = duration * np.sort(self._rng.uniform(0.0, 1.0, 3))
        pushes = torque * self._rng.uniform(-1.0, 1.0, 6)
        times = np.concatenate([[0.0], when[[0, 1, 1, 2]], [duration]])
        jumping = self._pick({(0, 1, 2, 3): 2, (0, 1, 1, 2): 1})
        kinds: list[Torque] = [
            Constant(torque=float(pushes[0])),
            Viscous(coefficient=torque / speed * self._pick({1.0: 5, 1e3: 1})),
            Quadratic(coefficient=torque / speed**2),
            TimeTable(file=Table(times.tolist(), pushes.tolist())),
            SpeedTable(file=Table(at[list(jumping)].tolist(), pushes[:4].tolist())),
        ]
        count = self._pick({0: 2, 1: 4, 2: 3, 3: 1})
        return tuple(kinds[k] for k in self._rng.choice(5, count, replace=False))

    def _run(self, turns: float, duration: float, torque: tuple[Torque, ...]) -> Run:
        """A run of so many turns at the first speed; tables over time must not end before it."""
        timed = any(isinstance(load, TimeTable) for load in torque)
        until: dict[Extent | Literal["settled"], int] = {
            Extent(value=duration, unit="s"): 3,
            Extent(value=turns * 2 * math.pi, unit="rad"): 0 if timed else 1,
        }
        every = {
            Extent(value=self._uniform(20.0, 60.0) * DEGREE, unit="rad"): 2,
            Extent(value=duration / self._uniform(8.0, 24.0), unit="s"): 1,
        }
        return Run(until=self._pick(until), every=self._pick(every), rtol=self._log(1e-12, 1e-4))

    def _uniform(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))

    def _log(self, low: float, high: float) -> float:
        return math.exp(self._uniform(math.log(low), math.log(high)))

    def _between(self, low: int, high: int) -> int:
        return int(self._rng.integers(low, high))

    def _chance(self, share: float) -> bool:
        return bool(self._rng.random() < share)

    def _part(self, most: float) -> float:
        return most * self._uniform(-1.0, 1.0)

    def _pick(self, weights: Mapping[T, int]) -> T:
        choices, shares = list(weights), np.array(list(weights.values()), dtype=float)
        return choices[int(self._rng.choice(len(choices), p=shares / shares.sum()))]


def _cylinder(phase: float, bank: float) -> Cylinder:
    return Cylinder(phase=phase, bank=bank)
