"""Valid scenes of a free crank under what changes on its way, drawn from a seed: the machines of
`random_scene` with windows, pressures by cylinder and by cycle, firings, functions, or all."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from crankmbs import Load, Scene
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.mechanics.train import crank_train
from crankmbs.scene.fuel import Fuel, Governor, Misfire
from crankmbs.scene.gas import Gas
from crankmbs.scene.loads import Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Friction
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from validation.oracles.changes import Curve, Line, Pull
from validation.random_scenes import random_scene

__all__ = ["KINDS", "function_with", "random_changes"]

KINDS = ("windows", "pressures", "fuel", "functions", "all")

_SPARE = 1.1  # times the shortest rod: the oracle would need too many steps beside a fold
_HEAVY = 5.0  # times the energy at the start: more work than this the gas does not do in a stroke
_LOOKS = 2000
_INTERPOLATIONS: tuple[Literal["pchip", "linear", "cubic", "step"], ...]
_INTERPOLATIONS = ("pchip", "linear", "cubic", "step")


def random_changes(kind: str, seed: int) -> Scene:
    """The scene of a seed, of one of `KINDS`."""
    return _Draw(kind, seed).scene()


class _Draw:
    def __init__(self, kind: str, seed: int) -> None:
        self.rng, self.kind = np.random.default_rng([14, KINDS.index(kind), seed]), kind
        base = random_scene(seed)
        least = _SPARE * (base.crank.radius + abs(base.piston.offset))
        base = replace(base, rod=replace(base.rod, length=max(base.rod.length, least)))
        start = base.start
        assert start is not None
        self.speed = abs(start.speed) or 20.0
        fires = kind in ("fuel", "all")
        sense = 1.0 if fires or self.chance(0.7) else -1.0
        begin = replace(start, speed=0.0 if self.chance(0.05) else sense * self.speed)
        self.base = replace(base, start=begin)
        self.energy = 0.5 * float(inertia_alone(base, start.angle)) * self.speed**2
        self.turns = float(self.rng.uniform(2.0, 5.0 if fires else 3.0))
        self.duration = self.turns * 2.0 * math.pi / self.speed

    def scene(self) -> Scene:
        kind, base = self.kind, self.base
        gas, fuel = base.gas, None
        if gas is not None and (gas.indicator is not None or self.swings_under(gas)):
            gas = None
        if kind in ("pressures", "fuel", "all"):
            gas = self.gas(fires=kind != "pressures")
        if kind in ("fuel", "all"):
            fuel = self.fuel()
        loads = [self.load() for _ in range(int(self.rng.integers(1, 4)))]
        if kind in ("functions", "all"):
            loads[0] = self.function()
        if kind in ("windows", "all"):
            loads = [replace(load, **self.window()) for load in loads]  # type: ignore[arg-type]
        run = Run(
            until=Extent(value=self.duration, unit="s"),
            every=Extent(value=self.duration / int(self.rng.integers(7, 15)), unit="s"),
            rtol=self.log(1e-10, 1e-4),
        )
        rings = self.friction() if kind == "all" and self.chance(0.5) else None
        return replace(base, gas=gas, fuel=fuel, torque=tuple(loads), friction=rings, run=run)

    def swings_under(self, gas: Gas) -> bool:
        """Whether a pressure, drawn for another speed or a cubic through two rows that nearly meet,
        would turn the crank so often that the oracle takes minutes."""
        assert self.base.piston.area is not None
        train = crank_train(replace(self.base, gas=gas))
        assert train.pressure is not None
        found = train.pressure[0](np.linspace(0.0, gas.period, _LOOKS))
        most = float(np.max(np.abs(found))) * self.base.piston.area
        return most * self.base.crank.radius > _HEAVY * self.energy

    def gas(self, *, fires: bool) -> Gas:
        """A table for each cylinder or one for all, of one cycle or several, or a constant."""
        assert self.base.piston.area is not None
        most = 0.3 * self.energy / (self.base.piston.area * self.base.crank.radius)
        stroke: Literal[2, 4] = 4 if self.chance(0.7) else 2
        period = stroke * math.pi
        cycles = 1 if self.chance(0.6) else int(self.rng.integers(2, 4))
        kind = _INTERPOLATIONS[int(self.rng.integers(4))]
        options: dict[str, Any] = {"cycles": "sequence"} if cycles > 1 else {}
        if not fires and self.chance(0.15):
            return Gas(pressure=self.part(most), absolute=False, stroke=stroke)
        count = len(self.base.cylinders)
        each = tuple(self.rows(most, period, cycles) for _ in range(count))
        pressure = each if count > 1 and self.chance(0.6) else each[0]
        if fires:
            one = self.rows(0.3 * most, period, 1)
            options["motored"] = 0.0 if self.chance(0.2) else one
        return Gas(pressure=pressure, absolute=False, stroke=stroke, interpolation=kind, **options)

    def rows(self, most: float, period: float, cycles: int) -> Table:
        """Rows of so many cycles, perhaps with a jump."""
        count = int(self.rng.integers(4, 14)) * cycles
        even = (np.arange(count) + self.rng.uniform(-0.3, 0.3, count)) * period * cycles / count
        if self.chance(0.4):
            k = int(self.rng.integers(1, count))
            even = np.insert(even, k, even[k])
        values = most * self.rng.uniform(-0.3, 1.0, len(even)) ** 3
        return Table(tuple(even.tolist()), tuple(values.tolist()))

    def fuel(self) -> Fuel:
        """Misfires, scatter, a window and a governor, each or not; it clips where its gains or its
        limits are such."""
        misfire = [Misfire(cylinder=1, cycles=str(self.rng.choice(["1", "2", "1-2", "every 2"])))]
        governor = None
        if self.chance(0.7):
            low, high = sorted(self.rng.uniform(0.0, 1.5, 2).tolist())
            governor = Governor(
                speed=self.speed * float(self.rng.uniform(0.8, 1.2)),
                kp=self.log(0.1, 10.0) / self.speed,
                ki=self.log(0.01, 1.0),
                min=low,
                max=high,
                initial=float(self.rng.uniform(low, high)),
            )
        window: dict[str, Any] = {}
        if self.chance(0.4):
            window = self.window()
        scatter = 0.3 if self.chance(0.5) else 0.0
        struck = tuple(misfire) if self.chance(0.5) else None
        seed = int(self.rng.integers(100))
        return Fuel(misfire=struck, scatter=scatter, seed=seed, governor=governor, **window)

    def window(self) -> dict[str, float]:
        """When a load acts: some of its four ends."""
        after = float(self.rng.uniform(0.0, 0.5)) * self.duration
        sense = math.copysign(1.0, self.base.start.speed) if self.base.start else 1.0
        speeds = sense * self.speed * self.rng.uniform(0.8, 1.2, 2)
        ends = {
            "after": after,
            "until": after + float(self.rng.uniform(0.1, 0.6)) * self.duration,
            "from_speed": float(speeds[0]),
            "until_speed": float(speeds[1]),
        }
        return {name: value for name, value in ends.items() if self.chance(0.4)}

    def load(self) -> Torque:
        torque = self.energy * self.log(0.01, 0.3) / 4.0
        pushes = torque * self.rng.uniform(-1.0, 1.0, 6)
        at = self.speed * np.sort(self.rng.uniform(-2.0, 2.0, 4))
        when = self.duration * np.sort(self.rng.uniform(0.0, 1.0, 3))
        times = np.concatenate([[0.0], when[[0, 1, 1, 2]], [self.duration]])
        kinds: list[Torque] = [
            Constant(torque=float(pushes[0])),
            Viscous(coefficient=torque / self.speed),
            Quadratic(coefficient=torque / self.speed**2),
            TimeTable(file=Table(tuple(times.tolist()), tuple(pushes.tolist()))),
            SpeedTable(file=Table(tuple(at.tolist()), tuple(pushes[:4].tolist()))),
        ]
        return kinds[int(self.rng.integers(5))]

    def function(self) -> Load:
        """A function of Python with a kink or a jump over time, angle or speed, or with none;
        declared or not."""
        torque = self.energy * self.log(0.01, 0.3) / 4.0
        share = float(self.rng.uniform(0.2, 0.8))
        declared, over = self.chance(0.5), int(self.rng.integers(5))
        at = share * self.duration
        kinks: dict[str, tuple[float, ...]] = {}
        if over == 0:
            kinks = {"kink_times": (at,)}
            function = _bent_in_time(torque, at)
        elif over == 1:
            at = 2.0 * math.pi * share
            kinks = {"kink_angles": (at,)}
            function = _jumps_at_angle(torque, at)
        elif over == 2:
            kinks = {"kink_angles": (0.0, math.pi)}
            function = _rectified(torque)
        elif over == 3:
            at = self.speed * (0.7 + 0.6 * share)
            kinks = {"kink_speeds": (at,)}
            function = _bent_in_speed(torque, at)
        else:
            function = _smooth(torque, self.speed, self.duration)
        return Load(function, **(kinks if declared else {}))  # type: ignore[call-arg, arg-type]

    def friction(self) -> Friction:
        way = 8.0 * self.base.crank.radius * len(self.base.cylinders)
        return Friction(
            ring_force=self.energy / way * self.log(1e-3, 0.3),
            ring_pressure=self.log(1e-3, 0.1) if self.chance(0.5) else 0.0,
            viscous=self.energy / (way * self.base.crank.radius * self.speed) * self.log(1e-3, 0.1),
        )

    def part(self, most: float) -> float:
        return most * float(self.rng.uniform(-1.0, 1.0))

    def log(self, low: float, high: float) -> float:
        return math.exp(self.rng.uniform(math.log(low), math.log(high)))

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)


Function = Callable[[float, float, float], float]


def function_with(function: Any, pieces: Pull) -> Function:
    """A function with the smooth pieces that the oracle takes for it."""
    function.pieces = pieces
    made: Function = function
    return made


def _bent_in_time(torque: float, at: float) -> Function:
    def bent(t: float, theta: float, omega: float) -> float:
        return torque * abs(t - at) / at

    line = Line((at,), (lambda t: torque * (at - t) / at, lambda t: torque * (t - at) / at))
    return function_with(bent, Pull(over_time=line))


def _jumps_at_angle(torque: float, at: float) -> Function:
    turn = 2.0 * math.pi

    def jumps(t: float, theta: float, omega: float) -> float:
        return torque if theta % turn >= at else -0.5 * torque

    pieces = (lambda x: -0.5 * torque, lambda x: torque)
    return function_with(jumps, Pull(over_angle=Curve((0.0, at), pieces, turn)))


def _rectified(torque: float) -> Function:
    def rectified(t: float, theta: float, omega: float) -> float:
        return torque * abs(math.sin(theta))

    curve = Curve((0.0,), (lambda x: torque * math.sin(x),), math.pi)
    return function_with(rectified, Pull(over_angle=curve))


def _bent_in_speed(torque: float, at: float) -> Function:
    def bent(t: float, theta: float, omega: float) -> float:
        return -torque * max(0.0, omega / at - 1.0) * (2.0 + math.cos(theta))

    line = Line((at,), (lambda w: 0.0, lambda w: -torque * (w / at - 1.0)))
    return function_with(
        bent, Pull(over_speed=line, smooth=lambda t, theta, w: 2.0 + math.cos(theta))
    )


def _smooth(torque: float, speed: float, duration: float) -> Function:
    def smooth(t: float, theta: float, omega: float) -> float:
        return torque * math.sin(3.0 * theta + t / duration) * math.tanh(omega / speed)

    return function_with(smooth, Pull(smooth=smooth))
