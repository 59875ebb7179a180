"""The crank train reduced to one rotation, at one crank angle: what the `stepper` works on.

The pressure is given as the polynomials between two knots, which can be continued beyond them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.friction import friction_knots, friction_torque, sign_changes
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.torque import knots_over_angle, over_angle
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots, merged_knots
from crankmbs.mechanics.windows import Phases
from crankmbs.motion.minimal import stepper
from crankmbs.motion.minimal.system import Machine, bare
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import NEAR
from crankmbs.scene.parts import Friction

__all__ = ["KnotPair", "Reduced"]


class KnotPair(NamedTuple):
    """Two neighbouring knots [rad], and the pressure of every cylinder between them, as
    `stepper.enter` says."""

    low: float
    high: float
    pieces: Array


class Reduced:
    """J, J_1 and the torque of gas and gravity at one crank angle, in plain floats.

    missed : of the largest torque, what a step across knots may miss of the gas
    phases : of the loads' windows
    """

    def __init__(self, train: CrankTrain, missed: float = 0.0, phases: Phases = ()) -> None:
        self.train, scene, pressure = train, train.scene, train.pressure
        self._missed, self._known = missed, {phases: self}
        self._last: tuple[tuple[float, ...], Reduced] | None = None
        self.over_angle = load = over_angle(scene, phases)
        crank, rod, piston = scene.crank, scene.rod, scene.piston
        friction = scene.friction or Friction()
        knots = self._with_others(crank_angle_knots(train))
        if len(knots) == 0:  # no step of many turns: it would overlook a light rod near a fold
            knots = np.arange(0.0, train.period, 0.5)
        g = scene.gravity.acceleration if scene.gravity else 0.0
        pull = scene.gravity.angle if scene.gravity else 0.0
        firsts = [each.knots[0] for each in pressure] if pressure else [0.0] * len(scene.cylinders)
        axes = [
            (c.phase, g * math.cos(pull - c.bank), g * math.sin(pull - c.bank), first)
            for c, first in zip(scene.cylinders, firsts, strict=True)
        ]
        bends = knots
        if pressure and missed > 0.0 and train.combustion is None:
            lever = (piston.gas_area or 0.0) * crank.radius
            least = missed * self.torque_scale / lever
            bends = self._with_others(merged_knots(train, [each.bends(least) for each in pressure]))
        pressures = pressure or ()
        ends = np.cumsum([0, *(len(each.knots) for each in pressures)])
        machine = Machine(
            radius=crank.radius,
            rod_length=rod.length,
            center_of_mass=rod.center_of_mass,
            offset=piston.offset,
            crank_inertia=crank.moment_of_inertia,
            rod_inertia=rod.moment_of_inertia,
            rod_mass=rod.mass,
            piston_mass=piston.mass,
            area=piston.gas_area or 0.0,
            first_moment=crank.mass * crank.center_of_mass,
            gravity_x=g * math.cos(pull),
            gravity_y=g * math.sin(pull),
            cylinders=np.array(axes),
            knots=knots,
            period=train.period,
            places=np.column_stack([ends[:-1], ends[1:]]),
            starts=np.concatenate(
                [np.empty(0), *(each.knots - each.knots[0] for each in pressures)]
            ),
            coefficients=_side_by_side([p.coefficients for p in pressures]),
            bends=bends,
            combustion=_side_by_side([p.coefficients for p in train.combustion or ()]),
            load_first=float(load.knots[0]) if load else 0.0,
            load_starts=load.knots - load.knots[0] if load else np.empty(0),
            load_coefficients=load.coefficients.copy() if load else np.empty((4, 0)),
            ring_force=friction.ring_force,
            ring_pressure=friction.ring_pressure,
            viscous=friction.viscous,
        )
        self.machine = bare(machine)

    def at(self, phases: Phases) -> Reduced:
        """The same in other phases of the loads."""
        if phases not in self._known and not self._varies:
            return self
        if phases not in self._known:
            self._known[phases] = Reduced(self.train, self._missed, phases)
            self._known[phases]._known = self._known
        return self._known[phases]

    @cached_property
    def _varies(self) -> bool:
        """Whether a load depends on the angle."""
        return any(load.parts.over_angle is not None for load in self.train.scene.torque)

    def fired(self, shares: tuple[float, ...]) -> Reduced:
        """The same with knots where a gas force changes its sign with these shares of the
        combustion, where rings feel it."""
        if self.train.combustion is None or len(sign_changes(self.train, shares)) == 0:
            return self
        if self._last is None or self._last[0] != shares:
            again, machine = copy(self), Machine(*self.machine)
            knots = np.append(machine.knots, sign_changes(self.train, shares))
            knots = np.unique(knots)
            knots = knots[np.append(True, np.diff(knots) > NEAR)]
            again.machine = bare(machine._replace(knots=knots, bends=knots))
            self._last = shares, again
        return self._last[1]

    def _with_others(self, knots: Array) -> Array:
        """Knots of the pressures, and those of loads and friction."""
        own = np.concatenate([knots_over_angle(self.train), friction_knots(self.train)])
        if len(own) == 0:
            return knots
        merged = np.unique(np.concatenate([knots, own]))
        return np.asarray(merged[np.append(True, np.diff(merged) > NEAR)])

    def around(self, theta: float, sense: float, shares: Sequence[float] = ()) -> KnotPair:
        """The knots next to theta in the sense of rotation, and the polynomials between them, with
        these shares of the combustion."""
        count = len(self.train.scene.cylinders)
        pieces = np.zeros((count + (self.over_angle is not None), 9))
        pieces[:count, 6] = shares or 0.0
        low, high = stepper.enter(theta, sense, self.machine, pieces)
        return KnotPair(low, high, pieces)

    @cached_property
    def torque_scale(self) -> float:
        """Largest torque of gas and gravity over one period, and of the loads at their knots
        [N m]."""
        parts = (part for load in self.train.scene.torque for part in load.parts[:3])
        load = sum(part.largest for part in parts if part is not None)
        start = self.train.scene.start
        for given in self.train.scene.torque:
            if given.parts.function is not None and start is not None:
                load += abs(given.parts.function.number(0.0, start.angle, start.speed))
        period = self.train.period
        count = 720 * round(period / self.train.scene.period) + 1
        angles = 0.1 + np.linspace(0.0, period, count)  # no fold lies there
        share = self.train.law.most if self.train.law else 0.0
        shares = np.full(len(self.train.scene.cylinders), share)
        torque = reduce(self.train, angles, shares).torque
        most = np.abs(torque)
        if self.train.scene.friction is not None:
            most = most - friction_torque(self.train, angles, 0.0, 1.0, shares)
        return load + float(np.max(most))

    def __call__(self, theta: float, pieces: Array) -> tuple[float, float, float]:
        """J [kg m2], dJ/dtheta [kg m2/rad], torque over the angle [N m]."""
        return stepper.reduced(theta, self.machine, pieces)[:3]

    def drag(self, theta: float, pieces: Array) -> float:
        """Torque of viscous friction per speed [N m s/rad]."""
        return stepper.reduced(theta, self.machine, pieces)[3]


def _side_by_side(coefficients: Sequence[Array]) -> Array:
    """Cubics of every cylinder, shape (4, n); behind each cylinder's an empty column, as it has a
    knot more than cubics."""
    return np.hstack([np.empty((4, 0)), *(np.pad(each, ((0, 0), (0, 1))) for each in coefficients)])
