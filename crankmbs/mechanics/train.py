"""The crank train of a run: a scene with what its gas pressures became, made once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from scipy.interpolate import PPoly

from crankmbs.mechanics.firing import FuelLaw
from crankmbs.mechanics.forces import OnCrank
from crankmbs.mechanics.geometry import dead_centres
from crankmbs.mechanics.knots import KNOT, apart
from crankmbs.mechanics.pressure import (
    PeriodicPressure,
    combustion_of,
    crank_ends_of,
    motored_of,
    net_of,
    pressures_of,
)
from crankmbs.mechanics.speed import speed_law
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import common_period, tiled
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene
from crankmbs.scene.torque import Acting
from crankmbs.scene.units import DEGREE

__all__ = [
    "CrankTrain",
    "crank_angle_knots",
    "crank_train",
    "edges_over_angle",
    "friction_knots",
    "knots_over_angle",
    "merged_knots",
    "sign_changes",
    "times_of",
]

_WIDE = 6.0 * DEGREE  # rad: as far from a fold all is as smooth as elsewhere


@dataclass(frozen=True)
class CrankTrain:
    """The machine of a scene; data alone, so that formulations that share it share no mechanics.

    pressure : of the gas over the cycle angle of each cylinder, gas force over the piston's area;
        None without gas
    combustion : what a firing of share 1 adds to it, on the same knots, where `pressure` is that
        without combustion; None without fuel
    law : the decisions on the shares; None without fuel
    crank_end : of each crank end less ambient, which `pressure` holds on its share of the area; no
        motion needs it, but who tells the ends apart; None where cylinders are single-acting
    """

    scene: Scene
    pressure: tuple[PeriodicPressure, ...] | None
    combustion: tuple[PeriodicPressure, ...] | None = None
    law: FuelLaw | None = None
    crank_end: tuple[PeriodicPressure, ...] | None = None

    @cached_property
    def perturbed(self) -> CrankTrain:
        """The same with pressures as far from these as the true ones may be."""
        if all(
            each.perturbed is each for each in (*(self.pressure or ()), *(self.combustion or ()))
        ):
            return self
        pressure = self.pressure and tuple(each.perturbed for each in self.pressure)
        more = self.combustion and tuple(each.perturbed for each in self.combustion)
        return replace(self, pressure=pressure, combustion=more)

    @cached_property
    def pushes(self) -> tuple[OnCrank, ...]:
        """The forces from outside on the pistons."""
        return tuple(OnCrank(self.scene, force) for force in self.scene.force)

    @cached_property
    def loads(self) -> tuple[Acting, ...]:
        """All that acts from outside on the crank, in the order of the numbers of their phases:
        torques, then forces on the pistons."""
        return *self.scene.torque, *self.pushes

    @cached_property
    def loads_over_angle(self) -> bool:
        """Whether loads depend on the crank angle, or resist as friction does."""
        parts = (load.parts.over_angle for load in self.loads)
        return bool(self.pushes) or any(part is not None for part in parts)

    @cached_property
    def has_functions(self) -> bool:
        """Whether a load is a function of Python, which may do what it does not declare."""
        return bool(self.undeclared)

    @property
    def undeclared(self) -> list[str]:
        """The names of the functions of Python among the loads."""
        functions = (load.parts.function for load in self.loads)
        return [one.called for one in functions if one is not None and not one.declared]

    @cached_property
    def rubs(self) -> bool:
        """Whether something resists either sense of rotation, or with the speed: friction, or
        forces that change on the way back or with the piston's velocity."""
        return self.scene.friction is not None or self.drags or self.sticks

    @cached_property
    def drags(self) -> bool:
        """Whether something of this resists with the speed."""
        friction = self.scene.friction
        viscous = friction is not None and friction.viscous > 0.0
        return viscous or any(force.law.viscous for force in self.scene.force)

    @cached_property
    def sticks(self) -> bool:
        """Whether something may hold the crank at rest."""
        friction = self.scene.friction
        dry = friction is not None and friction.ring_force + friction.ring_pressure > 0.0
        return dry or any(force.law.switches for force in self.scene.force)

    @cached_property
    def repeats(self) -> float:
        """Crank angle [rad] after which what depends on it alone comes again: a revolution without
        gas, where no load has another."""
        loads = (load.parts.over_angle for load in self.loads)
        one = self.pressure is None and all(each is None for each in loads)
        return 2.0 * math.pi if one else self.period

    @cached_property
    def period(self) -> float:
        """Crank angle [rad] after which everything comes again: the least common multiple of the
        periods of the engine, the pressures and the loads, whole revolutions."""
        pressures = (pressure.period for pressure in self.pressure or ())
        return common_period([self.scene.load_period, *pressures])


@once
def crank_train(scene: Scene) -> CrankTrain:
    """The crank train of a scene.

    >>> crank_train(load_scene("coasting")).pressure is None
    True
    """
    fired, ends = pressures_of(scene), crank_ends_of(scene)
    if fired is not None and ends is not None:
        fired = _net(scene, fired, ends)
    if scene.fuel is None or fired is None:
        return CrankTrain(scene, fired, crank_end=ends)
    motored = motored_of(scene)
    if ends is not None:
        motored = _net(scene, motored, ends)
    without, more = zip(*map(cache(combustion_of), fired, motored), strict=True)
    start = scene.start
    begun = (start.angle, start.speed) if start else _beginning(scene)
    return CrankTrain(scene, without, more, FuelLaw(scene, scene.fuel, begun), ends)


def _net(
    scene: Scene, heads: tuple[PeriodicPressure, ...], ends: tuple[PeriodicPressure, ...]
) -> tuple[PeriodicPressure, ...]:
    """What pushes each piston; cylinders of one pair of pressures and areas share it."""
    shares = (gear.piston.crank_end_share for gear in scene.running_gear)
    return tuple(map(cache(net_of), heads, ends, shares))


def _beginning(scene: Scene) -> tuple[float, float]:
    """Crank angle [rad] and speed [rad/s] at the start of a prescribed motion."""
    assert scene.motion is not None
    theta, omega, _ = speed_law(scene.motion).at_time(0.0)
    return float(theta), float(omega)


def crank_angle_knots(train: CrankTrain) -> Array:
    """Crank angles in [0, period) at which the pressure of any cylinder changes its piece.

    Returns
    -------
    shape (n,) [rad], increasing, cylinders merged; empty without gas
    """
    return merged_knots(train, [pressure.knots[:-1] for pressure in train.pressure or ()])


def knots_over_angle(train: CrankTrain) -> Array:
    """Crank angles in [0, period) at which loads bend or jump, acting or not [rad]."""
    period = train.period
    parts = [load.parts for load in train.loads]
    cycles = [part.over_angle for part in parts if part.over_angle is not None]
    knots = [tiled(cycle.knots[:-1], cycle.period, period) for cycle in cycles]
    knots += [part.function.angles_in(period) for part in parts if part.function is not None]
    return np.unique(np.concatenate([np.empty(0), *knots]))


def _near_folds(train: CrankTrain) -> Array:
    """Crank angles [rad] around those where a rod is hardly longer than it must be, ever farther.

    The rod swings over within ``width`` of there, where its formulas have their singularity beside
    the real angles: in wider cells two rules err alike, if they see it at all.
    """
    period, marks = train.period, [np.empty(0)]
    cylinders = zip(train.scene.cylinders, train.scene.running_gear, strict=True)
    for cylinder, (radius, length, offset) in ((c, gear.shape) for c, gear in cylinders):
        for fold, gap in ((0.5, length - radius + offset), (-0.5, length - radius - offset)):
            width = math.sqrt(2.0 * max(gap, 0.0) / radius)
            if 0.0 < width < _WIDE:
                beside = width * 2.0 ** np.arange(math.ceil(math.log2(_WIDE / width)))
                around = fold * math.pi + np.concatenate([-beside, [0.0], beside])
                marks.append(tiled(around - cylinder.phase, 2.0 * math.pi, period))
    return np.concatenate(marks)


def edges_over_angle(train: CrankTrain) -> Array:
    """Crank angles in one period [rad], in any order, between which all that depends on the angle
    is smooth: knots of pressure, loads and friction, and those around folds that a rod just
    escapes.

    >>> edges_over_angle(crank_train(load_scene("coasting"))).size
    0
    """
    knots = [crank_angle_knots(train), knots_over_angle(train), friction_knots(train)]
    return np.concatenate([*knots, _near_folds(train)])


def times_of(loads: tuple[Acting, ...]) -> list[float]:
    """Times [s] at which functions of time bend or jump.

    >>> times_of((Constant(torque=2.0),))
    []
    """
    functions = (load.parts.function for load in loads)
    return [time for function in functions if function is not None for time in function.times]


def merged_knots(train: CrankTrain, knots: Sequence[Array]) -> Array:
    """Crank angles in [0, period) at which a cylinder passes one of its cycle angles [rad], given
    for each over the period of its pressure."""
    period = train.period
    angles = [
        tiled(each - c.phase, pressure.period, period)
        for each, pressure, c in zip(
            knots, train.pressure or (), train.scene.cylinders, strict=False
        )
    ]
    merged = apart(np.concatenate([np.empty(0), *angles]))
    if len(merged) and period - merged[-1] + merged[0] <= KNOT:
        merged = merged[:-1]
    return merged


def friction_knots(train: CrankTrain) -> Array:
    """Crank angles in [0, period) at which friction jumps or bends, or a force that is another on
    the way back: dead centres, and, without fuel, where a gas force changes its sign.

    Returns
    -------
    shape (n,) [rad], increasing; empty without friction. With fuel the latter depend on the shares:
    `sign_changes`

    >>> friction_knots(crank_train(load_scene("coasting"))).size
    0
    """
    scene = train.scene
    if scene.friction is None and not train.sticks:
        return np.empty(0)
    cylinders = zip(scene.cylinders, scene.running_gear, strict=True)
    angles = [
        tiled(np.array(dead_centres(*gear.shape)) - c.phase, 2.0 * math.pi, train.period)
        for c, gear in cylinders
    ]
    if train.combustion is None:
        angles.append(sign_changes(train))
    return apart(np.concatenate(angles))


def sign_changes(train: CrankTrain, shares: Sequence[float] = ()) -> Array:
    """Crank angles in [0, period) at which the gas force of a cylinder changes its sign with these
    shares of the combustion, where rings feel it: the roots of its cubics.

    Returns
    -------
    shape (n,) [rad], increasing

    >>> sign_changes(crank_train(load_scene("coasting"))).size
    0
    """
    friction = train.scene.friction
    if friction is None or friction.ring_pressure == 0.0 or train.pressure is None:
        return np.empty(0)
    pressures = list(train.pressure)
    if shares and train.combustion is not None:
        pressures = [
            PeriodicPressure(p.knots, p.coefficients + share * more.coefficients)
            for p, more, share in zip(pressures, train.combustion, shares, strict=True)
        ]
    return merged_knots(train, list(map(cache(_roots), pressures)))


def _roots(pressure: PeriodicPressure) -> Array:
    """Cycle angles [rad] of one period at which a pressure is 0 between two knots."""
    roots = PPoly(pressure.coefficients, pressure.knots).roots(
        discontinuity=False, extrapolate=False
    )
    return np.unique(roots[np.isfinite(roots)])
