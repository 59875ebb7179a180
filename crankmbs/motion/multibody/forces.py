"""Gas, friction and loads: on whole arrays as they are, and number by number as exudyn calls them.

While exudyn integrates, nothing jumps: a run is cut at the crank angles, times and speeds at which
a force jumps or bends hard, and exudyn's last step goes beyond with the piece that ends there.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.axes import areas, axes_of, closed_loops, displacements, slides
from crankmbs.mechanics.knots import KNOT, apart, repeat
from crankmbs.mechanics.pressure import pressures_at
from crankmbs.mechanics.train import (
    CrankTrain,
    crank_angle_knots,
    friction_knots,
    knots_over_angle,
    times_of,
)
from crankmbs.mechanics.windows import Phase, Phases, phase_ends
from crankmbs.motion.base import State
from crankmbs.motion.mode import Mode
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.force import Law
from crankmbs.scene.parts import Friction
from crankmbs.scene.torque import Parts

__all__ = ["EVERYWHERE", "Bounds", "Forces", "Limits", "Push"]

Range = tuple[float, float]
Push = Callable[[float, float, float, float], float]
"""A force [N] on a piston towards the crank: of time [s], crank angle [rad], displacement from the
top dead centre [m] and velocity towards the crank [m/s]."""

EVERYWHERE: Range = (-math.inf, math.inf)

_TURN = 2.0 * math.pi
_JUMP = 1e-4  # of the largest value: less is a bend
_MOST_CUTS = 60  # over the angle in a period: a table of more steps is run over as it is
_MOST_BENDS = 12  # of a function of time or travel: more are run over
_SAME = 1e-12  # relative: times nearer than this are one
_BESIDE = 1e-6  # rad: so far beyond a cut it is clear on which side a piston is


class Limits(NamedTuple):
    """Time [s] and crank angles [rad] at which a run ends, and steps that it may take."""

    time: float
    angles: Range
    steps: int


class Bounds(NamedTuple):
    """Times [s], crank angles [rad] and speeds [rad/s] between which no force jumps."""

    times: Range
    angles: Range
    speeds: Range


class Forces:
    """The forces of a crank train.

    angles : crank angles [rad] in a period at which a run is cut
    jumps : crank angles in a period at which a force jumps [rad]
    smooth : whether a run is cut at all of them
    """

    def __init__(self, train: CrankTrain) -> None:
        self.train, scene = train, train.scene
        self._areas, self._crank_ends = areas(scene)
        self._phases, self._friction = axes_of(scene).phases, scene.friction or Friction()
        knots = [crank_angle_knots(train), knots_over_angle(train)]
        angles = apart(np.concatenate(knots))
        bends = self._bends(angles)
        hard = angles[bends > _BESIDE]  # by all of a force in a radian
        self.jumps, self.smooth = angles[bends > _JUMP], len(hard) <= _MOST_CUTS
        hard = hard if self.smooth else np.empty(0)
        self.angles = apart(np.concatenate([hard, friction_knots(train)]))

    def _bends(self, knots: Array) -> Array:
        """By what share of its largest value a force bends at crank angles [rad] within 1e-6."""
        acts = np.ones((len(knots), len(self.train.loads)), dtype=bool)

        def forces(theta: Array, sense: float) -> Array:
            motion = np.zeros_like(theta), theta, np.full_like(theta, sense)
            fuel = (self.gas(theta, np.full((1, len(self._phases)), share)) for share in (0.0, 1.0))
            of_loads = self.applied(*motion, motion[2], acts), self.torque(*motion, acts)[:, None]
            return np.hstack([*fuel, *of_loads])

        bends = np.zeros(len(knots))
        for sense in (1.0, -1.0):
            below, at, above = (forces(knots + d * _BESIDE, sense) for d in (-1.0, 0.0, 1.0))
            largest = np.abs(at).max(axis=0, initial=0.0)
            change = np.abs(above - 2.0 * at + below) / np.where(largest > 0.0, largest, 1.0)
            bends = np.maximum(bends, change.max(axis=1))
        return bends

    @cached_property
    def times(self) -> tuple[float, ...]:
        """Times [s] at which a load jumps; or bends, where these are few."""
        scene, laws = self.train.scene, [force.law for force in self.train.scene.force]
        tables = [*(one.parts.over_time for one in scene.torque), *(law.over_time for law in laws)]
        every = {time for table in tables if table is not None for time in _cuts_of(table)}
        declared = (law.python.times for law in laws if law.python)
        return tuple(every.union(times_of(scene.torque), *declared))

    def acting(self, phases: Phases) -> list[bool]:
        """Which of the loads act, torques first."""
        return [phase is Phase.ACTING for phase in phases] or [True] * len(self.train.loads)

    def _laws(self, k: int, phases: Phases = ()) -> list[Law]:
        """The forces from outside that act on the piston of the cylinder k."""
        scene = self.train.scene
        pairs = zip(scene.force, self.acting(phases)[len(scene.torque) :], strict=True)
        return [force.law for force, acts in pairs if acts and force.cylinder in (None, k + 1)]

    # on arrays

    def gas(self, theta: Array, shares: Array | None) -> Array:
        """Gas forces [N] towards the crank at crank angles (m,), shape (m, n)."""
        train, angles = self.train, np.add.outer(self._phases, theta)
        if train.pressure is None:
            return np.zeros_like(angles.T)
        pressure = pressures_at(train.pressure, angles).T
        if train.combustion is not None:
            assert shares is not None
            pressure = pressure + shares * pressures_at(train.combustion, angles).T
        return np.asarray(self._areas * pressure)

    def pressures(self, theta: Array, gas: Array) -> dict[str, Array]:
        """The pressures [Pa] of the ends of the cylinders under gas forces [N], by variable, shape
        (m, n) each."""
        ends, whole = self.train.crank_end, np.where(self._areas > 0.0, self._areas, 1.0)
        if ends is None:
            return {"gas_pressure": gas / whole}
        crank_end = pressures_at(ends, np.add.outer(self._phases, theta)).T
        head = (gas + self._crank_ends * crank_end) / whole
        return {"gas_pressure": head, "crank_end_pressure": crank_end}

    def friction(self, theta: Array, omega: Array, gas: Array, sense: Array) -> Array:
        """Friction [N] towards the crank, shape (m, n), of pistons that slide in this sense of
        rotation; on a dead centre that after it."""
        scene, rubs = self.train.scene, self._friction
        signs = np.where(sense >= 0.0, *(slides(scene, theta, side) for side in (1.0, -1.0))).T
        dry = signs * (rubs.ring_force + rubs.ring_pressure * np.abs(gas))
        sliding = (-closed_loops(scene, theta).x_1 * omega).T
        return np.asarray(-dry - rubs.viscous * sliding)

    def applied(self, time: Array, theta: Array, omega: Array, sense: Array, acts: Array) -> Array:
        """Forces from outside on the pistons [N] towards the crank, shape (m, n), that slide in
        this sense of rotation; acts : shape (m, loads), whether each does."""
        total, first = np.zeros((len(theta), len(self._phases))), len(self.train.scene.torque)
        for push, when in zip(self.train.pushes, acts.T[first:], strict=True):
            total += np.where(when[:, None], push.forces(time, theta, omega, sense), 0.0)
        return total

    def torque(self, time: Array, theta: Array, omega: Array, acts: Array) -> Array:
        """Torque [N m] of all torques, shape (m,); acts : shape (m, loads), whether each does."""
        total = np.zeros_like(theta)
        for load, when in zip(self.train.scene.torque, acts.T, strict=False):
            total += np.where(when, load(time, theta, omega), 0.0)
        return total

    # number by number, on one stretch

    def bounds(self, state: State, sense: float, limits: Limits) -> Bounds:
        """What ends the stretch that begins in a state: the next time, angle or speed on either
        side; on one of them that beyond it.

        sense : sign in which the speed leaves the state, and at rest the crank angle
        """
        time, theta, omega, _, mode = state
        ends = phase_ends(self.train.loads, mode.loads)
        speeds = {0.0, *ends[1]}
        for parts in self._torques(mode):
            speeds.update(_cuts_of(parts.over_speed) if parts.over_speed else ())
            speeds.update(parts.function.speeds if parts.function else ())
        at = theta + 2.0 * KNOT * math.copysign(1.0, omega or sense)
        reach = 1.5 * self.train.period
        low, high = _around(repeat(self.angles, self.train.period, at - reach, at + reach), at)
        return Bounds(
            _around((*ends[0], *self.times, limits.time), time * (1.0 + _SAME)),
            (max(low, mode.low, limits.angles[0]), min(high, mode.high, limits.angles[1])),
            _around(speeds, omega, sense),
        )

    def _torques(self, mode: Mode) -> list[Parts[Cycle]]:
        """What the torques that act are the sums of."""
        pairs = zip(self.train.scene.torque, self.acting(mode.loads), strict=False)
        return [torque.parts for torque, acts in pairs if acts]

    def load(self, bounds: Bounds, mode: Mode) -> Callable[[float, float, float], float]:
        """Torque [N m] of the loads that act, of time [s], crank angle [rad] and speed [rad/s]."""
        parts = self._torques(mode)
        terms = [
            (slot, part.by_number(*bounds[slot]))
            for each in parts
            for slot, part in enumerate((each.over_time, each.over_angle, each.over_speed))
            if part is not None
        ]
        return _total(terms, [each.function.number for each in parts if each.function])

    def pushes(self, bounds: Bounds, mode: Mode, theta: float, sense: float) -> list[Push]:
        """For each cylinder the force of gas, friction and from outside towards the crank, beyond a
        crank angle [rad] in a sense of rotation."""
        at = np.array([theta + _BESIDE * sense])
        loop = closed_loops(self.train.scene, at)
        ways = zip(
            displacements(self.train.scene, loop)[:, 0], -sense * loop.x_1[:, 0], strict=True
        )
        return [self._push(k, *way, bounds, mode) for k, way in enumerate(ways)]

    def _push(self, k: int, displacement: float, slides: float, bounds: Bounds, mode: Mode) -> Push:
        """That on the piston of the cylinder k, which is there and slides with this sign."""
        rubs, phase = self._friction, float(self._phases[k])
        viscous, whole = rubs.viscous, list[Push]()
        gas = self._gas(k, mode.shares).by_number(*bounds.angles)
        terms = [(1, gas)]
        for law in self._laws(k, mode.loads):
            way = law.forward if slides > 0.0 else law.back
            travel = _around(_cuts_of(way), displacement) if way else EVERYWHERE
            over_angle = law.over_angle and _turned(law.over_angle, phase)
            ranges = *bounds[:2], travel
            for slot, part in enumerate((law.over_time, over_angle, way)):
                if part is not None:
                    terms.append((slot, part.by_number(*ranges[slot])))
            viscous += law.viscous
            if law.python is not None:
                whole.append(_at_cycle_angle(law.python.function, phase))
        if viscous:
            terms.append((3, lambda velocity: -viscous * velocity))
        if rubs.ring_force or rubs.ring_pressure:
            ring = math.copysign(rubs.ring_force, slides)
            pressed = math.copysign(rubs.ring_pressure, slides)
            whole.append(lambda _time, theta, _s, _v: -ring - pressed * abs(gas(theta)))
        return _total(terms, whole)

    def _gas(self, k: int, shares: Sequence[float]) -> Piecewise | Cycle:
        """The gas force [N] of a cylinder over the crank angle [rad]."""
        train = self.train
        if train.pressure is None:
            return Piecewise((), ((0.0, 0.0, 0.0),))
        cubics = train.pressure[k].coefficients
        if train.combustion is not None:
            cubics = cubics + shares[k] * train.combustion[k].coefficients
        return _turned(Cycle(train.pressure[k].knots, self._areas[k] * cubics), self._phases[k])


def _turned(cycle: Cycle, phase: float) -> Cycle:
    """A function of the cycle angle over the crank angle."""
    return Cycle(cycle.knots - phase, cycle.coefficients)


def _at_cycle_angle(function: Push, phase: float) -> Push:
    return lambda time, theta, s, v: function(time, theta + phase, s, v)


def _total(
    terms: list[tuple[int, Callable[[float], float]]], whole: Sequence[Callable[..., float]]
) -> Callable[..., float]:
    """The sum of functions of one argument, by its number, and of all."""
    if len(terms) == 1 and not whole:
        slot, alone = terms[0]
        return lambda *at: alone(at[slot])

    def total(*at: float) -> float:
        value = 0.0
        for slot, term in terms:
            value += term(at[slot])
        for function in whole:
            value += function(*at)
        return value

    return total


def _around(stops: Iterable[float], x: float, sense: float = 1.0) -> Range:
    """The stops next to a number; of one on a stop those on the side of ``sense``."""
    ends = [-math.inf, *sorted(stops), math.inf]
    k = (bisect_right if sense > 0.0 else bisect_left)(ends, x, 1, len(ends) - 1)
    return ends[k - 1], ends[k]


def _cuts_of(part: Piecewise) -> tuple[float, ...]:
    """Where a run is cut: at the bends of a function where these are few, else at its jumps."""
    return part.bends if len(part.bends) <= _MOST_BENDS else part.jumps
