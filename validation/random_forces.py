"""Valid scenes of a free crank with forces from outside on the pistons, drawn from a seed: those of
`random_changes`, with one to three forces of any kind."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from crankmbs import Scene
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.scene.force import PistonForce
from crankmbs.scene.forces import (
    ConstantForce,
    Damper,
    ForceAngleTable,
    ForceTimeTable,
    Spring,
    TravelTable,
)
from crankmbs.scene.python_force import Force
from crankmbs.scene.tables import CylinderTable, Table
from validation.oracles.changes import Curve, Line, Push
from validation.random_changes import random_changes

__all__ = ["random_forces"]

_BENEATH = ("windows", "pressures", "fuel", "windows", "all")  # whose scenes, in turn
_INTERPOLATIONS: tuple[Literal["linear", "pchip", "cubic"], ...] = ("linear", "pchip", "cubic")


def random_forces(seed: int) -> Scene:
    """The scene of a seed."""
    return _Draw(seed).scene()


class _Draw:
    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([16, seed])
        base = random_changes(_BENEATH[seed % len(_BENEATH)], seed)
        start, (r, l, e) = base.start, (base.crank.radius, base.rod.length, base.piston.offset)
        assert start is not None
        self.base, self.duration = base, base.end[0]
        self.speed = abs(start.speed) or 6.0 * math.pi / self.duration
        self.stroke = math.sqrt((l + r) ** 2 - e * e) - math.sqrt((l - r) ** 2 - e * e)
        self.energy = 0.5 * float(inertia_alone(base, start.angle)) * self.speed**2

    def scene(self) -> Scene:
        forces = [self.force() for _ in range(int(self.rng.integers(1, 4)))]
        return replace(self.base, force=tuple(forces))

    def force(self) -> PistonForce:
        """A force that does a part of the energy at the start in a stroke of all pistons."""
        cylinders = len(self.base.cylinders)
        most = self.energy * self.log(0.01, 0.3) / (2.0 * self.stroke * cylinders)
        kinds: list[Callable[[float], PistonForce]] = [
            lambda most: Spring(
                stiffness=most / self.stroke,
                relaxed_at=self.stroke * float(self.rng.uniform(-0.5, 1.5)),
            ),
            lambda most: Damper(coefficient=most / (self.stroke * self.speed)),
            lambda most: ConstantForce(force=most * float(self.rng.uniform(-1.0, 1.0))),
            self.over_travel,
            self.over_travel,
            self.over_angle,
            self.over_time,
            self.function,
        ]
        found = kinds[int(self.rng.integers(len(kinds)))](most)
        if self.chance(0.4):
            found = replace(found, cylinder=int(self.rng.integers(1, cylinders + 1)))
        return replace(found, **self.window()) if self.chance(0.4) else found  # type: ignore[arg-type]

    def over_travel(self, most: float) -> TravelTable:
        """Rows over the stroke, one force or two, perhaps with a jump."""
        count = int(self.rng.integers(2, 7))
        at = self.stroke * np.linspace(
            -0.1 * self.rng.random(), 1.0 + 0.1 * self.rng.random(), count
        )
        at[1:-1] += self.stroke / count * self.rng.uniform(-0.3, 0.3, count - 2)
        if self.chance(0.4) and count > 2:
            at = np.insert(at, 1, at[1])
        rows = tuple(at.tolist())
        ways = [tuple((most * self.rng.uniform(-1.0, 1.0, len(at))).tolist()) for _ in range(2)]
        if self.chance(0.4):
            return TravelTable(file=Table(rows, ways[0]))
        return TravelTable(file=CylinderTable(rows, (ways[0], ways[1])))

    def over_angle(self, most: float) -> ForceAngleTable:
        """Rows of one turn or two, perhaps with a jump."""
        count, turn = int(self.rng.integers(4, 10)), math.pi * float(self.rng.choice([2, 4]))
        at = (np.arange(count) + self.rng.uniform(0.0, 0.4, count)) * turn / count
        if self.chance(0.4):
            at = np.insert(at, 2, at[2])
        values = most * self.rng.uniform(-1.0, 1.0, len(at))
        kind = _INTERPOLATIONS[int(self.rng.integers(3))]
        rows = Table(tuple(at.tolist()), tuple(values.tolist()))
        return ForceAngleTable(file=rows, interpolation=kind)

    def over_time(self, most: float) -> ForceTimeTable:
        when = self.duration * np.sort(self.rng.uniform(0.0, 1.0, 3))
        times = np.concatenate([[0.0], when[[0, 1, 1, 2]], [self.duration]])
        values = most * self.rng.uniform(-1.0, 1.0, 6)
        return ForceTimeTable(file=Table(tuple(times.tolist()), tuple(values.tolist())))

    def function(self, most: float) -> Force:
        """A function of Python with a kink or a jump, declared, or smooth."""
        over = int(self.rng.integers(5))
        share = float(self.rng.uniform(0.2, 0.8))
        if over == 0:
            at = share * self.duration
            return Force(function=_bent_in_time(most, at), kink_times=(at,))
        if over == 1:
            at = 2.0 * math.pi * share
            return Force(function=_jumps_at_angle(most, at), kink_angles=(at,))
        if over == 2:
            at = share * self.stroke
            return Force(function=_bent_in_travel(most, at), kink_displacements=(at,))
        if over == 3:
            return Force(function=_against(most, self.stroke))
        return Force(function=_smooth(most, self.stroke, self.speed, self.duration))

    def window(self) -> dict[str, float]:
        """When it acts: some of its four ends."""
        after = float(self.rng.uniform(0.0, 0.5)) * self.duration
        start = self.base.start
        sense = math.copysign(1.0, start.speed) if start else 1.0
        speeds = sense * self.speed * self.rng.uniform(0.8, 1.2, 2)
        ends = {
            "after": after,
            "until": after + float(self.rng.uniform(0.1, 0.6)) * self.duration,
            "from_speed": float(speeds[0]),
            "until_speed": float(speeds[1]),
        }
        return {name: value for name, value in ends.items() if self.chance(0.4)}

    def log(self, low: float, high: float) -> float:
        return math.exp(self.rng.uniform(math.log(low), math.log(high)))

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)


Function = Callable[[float, float, float, float], float]


def _with(function: Any, pieces: Push) -> Function:
    """A function with the smooth pieces that the oracle takes for it."""
    function.pieces = pieces
    made: Function = function
    return made


def _bent_in_time(most: float, at: float) -> Function:
    def bent(t: float, angle: float, s: float, v: float) -> float:
        return most * abs(t - at) / at

    line = Line((at,), (lambda t: most * (at - t) / at, lambda t: most * (t - at) / at))
    return _with(bent, Push(over_time=line))


def _jumps_at_angle(most: float, at: float) -> Function:
    turn = 2.0 * math.pi

    def jumps(t: float, angle: float, s: float, v: float) -> float:
        return most if angle % turn >= at else -0.5 * most

    pieces = (lambda x: -0.5 * most, lambda x: most)
    return _with(jumps, Push(over_angle=Curve((0.0, at), pieces, turn)))


def _bent_in_travel(most: float, at: float) -> Function:
    def bent(t: float, angle: float, s: float, v: float) -> float:
        return -most * max(0.0, s / at - 1.0)

    line = Line((at,), (lambda s: 0.0, lambda s: -most * (s / at - 1.0)))
    return _with(bent, Push(forward=line, back=line))


def _against(most: float, stroke: float) -> Function:
    """As a press does: against the way towards the crank, and little on the way back."""

    def against(t: float, angle: float, s: float, v: float) -> float:
        return -most * s / stroke if v > 0.0 else 0.1 * most

    forward, back = Line((), (lambda s: -most * s / stroke,)), Line((), (lambda s: 0.1 * most,))
    return _with(against, Push(forward=forward, back=back))


def _smooth(most: float, stroke: float, speed: float, duration: float) -> Function:
    def smooth(t: float, angle: float, s: float, v: float) -> float:
        return most * math.sin(3.0 * angle + t / duration) * math.tanh(v / (speed * stroke))

    return _with(smooth, Push(smooth=smooth))
