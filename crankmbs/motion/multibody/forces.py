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
from crankmbs.mechanics.forces import OnCrank
from crankmbs.mechanics.knots import KNOT, apart, repeat
from crankmbs.mechanics.pressure import pressures_at
from crankmbs.mechanics.train import (
    CrankTrain,
    crank_angle_knots,
    friction_knots,
    knots_over_angle,
    times_of,
)
from crankmbs.mechanics.windows import acting, phase_ends
from crankmbs.motion.base import State
from crankmbs.motion.mode import Mode
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.parts import Friction
from crankmbs.scene.torque import Torque

__all__ = ["EVERYWHERE", "Bounds", "Forces", "Limits", "Push"]

Range = tuple[float, float]
Push = Callable[[float, float, float, float], float]
"""A force [N] on a piston towards the crank: of time [s], crank angle [rad], displacement from the
top dead centre [m] and velocity towards the crank [m/s]."""

EVERYWHERE: Range = (-math.inf, math.inf)

_TURN = 2.0 * math.pi
_JUMP = 1e-4  # of the largest value: less is a bend
_MOST_CUTS = 60  # over the angle in a period: of more a run is cut at the jumps alone
_MOST_BENDS = 12  # of a function of time or speed: more are run over
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
    """

    def __init__(self, train: CrankTrain) -> None:
        self.train, scene = train, train.scene
        self._areas, self._crank_ends = areas(scene)
        self._phases, self._friction = axes_of(scene).phases, scene.friction or Friction()
        self._gases: dict[int, tuple[float, Piecewise | Cycle]] = {}  # as it was last asked for
        angles = apart(np.concatenate([crank_angle_knots(train), knots_over_angle(train)]))
        bends = self._bends(angles)
        hard = angles[bends > _BESIDE]  # by all of a force in a radian
        self.jumps = angles[bends > _JUMP]
        cuts = hard if len(hard) <= _MOST_CUTS else self.jumps
        self.angles = apart(np.append(cuts, friction_knots(train)))

    def _bends(self, knots: Array) -> Array:
        """By what share of its largest value a force bends at crank angles [rad] within 1e-6."""

        def forces(theta: Array, sense: float) -> Array:
            omega = np.full_like(theta, sense)
            motion = np.array([np.zeros_like(theta), theta, omega])
            torque, pushes = self.outside(Mode(), motion, omega)
            gas = (self.gas(theta, np.array([share]))["gas_force"] for share in (0.0, 1.0))
            return np.column_stack([*gas, pushes, torque])

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

    # on arrays

    def gas(self, theta: Array, shares: Array | None) -> dict[str, Array]:
        """Gas forces [N] towards the crank, and the pressures [Pa] of the ends of the cylinders, at
        crank angles (m,); by variable, shape (m, n) each."""
        train, angles = self.train, np.add.outer(self._phases, theta)
        if train.pressure is None:
            none = np.zeros_like(angles.T)
            return {"gas_force": none, "gas_pressure": none}
        net = pressures_at(train.pressure, angles).T
        if train.combustion is not None:
            assert shares is not None
            net = net + shares * pressures_at(train.combustion, angles).T
        gas = self._areas * net
        if train.crank_end is None:
            return {"gas_force": gas, "gas_pressure": net}
        crank_end = pressures_at(train.crank_end, angles).T
        head = (gas + self._crank_ends * crank_end) / self._areas
        return {"gas_force": gas, "gas_pressure": head, "crank_end_pressure": crank_end}

    def friction(self, theta: Array, omega: Array, gas: Array, sense: Array) -> Array:
        """Friction [N] towards the crank, shape (m, n), of pistons that slide in this sense of
        rotation; on a dead centre that after it."""
        scene, rubs = self.train.scene, self._friction
        signs = np.where(sense >= 0.0, *(slides(scene, theta, side) for side in (1.0, -1.0))).T
        dry = signs * (rubs.ring_force + rubs.ring_pressure * np.abs(gas))
        sliding = (-closed_loops(scene, theta).x_1 * omega).T
        return np.asarray(-dry - rubs.viscous * sliding)

    def outside(self, mode: Mode, motion: Array, sense: Array) -> tuple[Array, Array]:
        """Torque [N m] of all torques that act, shape (m,), and forces from outside on the pistons
        [N] towards the crank, shape (m, n), that slide in this sense of rotation.

        motion : times [s], crank angles [rad] and speeds [rad/s], shape (3, m)
        """
        time, theta, omega = motion
        torque, pushes = np.zeros_like(time), np.zeros((len(time), len(self._phases)))
        for _, load in acting(self.train.loads, mode.loads):
            if isinstance(load, OnCrank):
                pushes += load.forces(time, theta, omega, sense)
            else:
                torque += load(time, theta, omega)
        return torque, pushes

    # number by number, on one stretch

    def bounds(self, state: State, sense: float, limits: Limits) -> Bounds:
        """What ends the stretch that begins in a state: the next time, angle or speed on either
        side; on one of them that beyond it.

        sense : sign in which the speed leaves the state, and at rest the crank angle
        """
        time, theta, omega, _, mode = state
        ends = phase_ends(self.train.loads, mode.loads)
        speeds = {0.0, *ends[1]}
        for _, load in acting(self.train.scene.torque, mode.loads):
            parts = load.parts
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

    def load(self, bounds: Bounds, mode: Mode) -> Callable[[float, float, float], float]:
        """Torque [N m] of the loads that act, of time [s], crank angle [rad] and speed [rad/s]."""
        loads = (load for _, load in acting(self.train.loads, mode.loads))
        parts = [load.parts for load in loads if isinstance(load, Torque)]
        by_each = ((each.over_time, each.over_angle, each.over_speed) for each in parts)
        terms = [term for each in by_each for term in _terms(each, bounds)]
        return _total(terms, [each.function.number for each in parts if each.function])

    def pushes(self, bounds: Bounds, mode: Mode, theta: float, sense: float) -> list[Push]:
        """For each cylinder the force of gas, friction and from outside towards the crank, beyond a
        crank angle [rad] in a sense of rotation."""
        scene, (low, high) = self.train.scene, bounds.angles
        inside = np.array([theta + _BESIDE * sense, low + _BESIDE, high - _BESIDE])
        loop = closed_loops(scene, np.where(np.isfinite(inside), inside, theta))
        travel, slides = displacements(scene, loop)[:, 1:].tolist(), -sense * loop.x_1[:, 0]
        return [
            self._push(k, (ends[0], ends[1]), sign, bounds, mode)
            for k, (ends, sign) in enumerate(zip(travel, slides.tolist(), strict=True))
        ]

    def _push(self, k: int, travel: Range, slides: float, bounds: Bounds, mode: Mode) -> Push:
        """That on the piston of the cylinder k, which slides with this sign and at the angles that
        bound it is displaced so far."""
        rubs, phase = self._friction, float(self._phases[k])
        viscous, whole = rubs.viscous, list[Push]()
        gas = self._gas(k, mode.shares[k] if mode.shares else 0.0).by_number(*bounds.angles)
        terms = [(1, gas)]
        for _, load in acting(self.train.loads, mode.loads):
            if not isinstance(load, OnCrank) or not load.pistons[k]:
                continue
            law = load.force.law
            way = law.forward if slides > 0.0 else law.back
            over_angle = law.over_angle and _turned(law.over_angle, phase)
            terms += _terms((law.over_time, over_angle), bounds[:2])
            viscous += law.viscous
            if way is not None:
                whole.append(_over_travel(way, bounds.angles, travel))
            if law.python is not None:
                whole.append(_at_cycle_angle(law.python.function, phase))
        if viscous:
            terms.append((3, lambda velocity: -viscous * velocity))
        if rubs.ring_force or rubs.ring_pressure:
            ring = math.copysign(rubs.ring_force, slides)
            pressed = math.copysign(rubs.ring_pressure, slides)
            whole.append(lambda _time, theta, _s, _v: -ring - pressed * abs(gas(theta)))
        return _total(terms, whole)

    def _gas(self, k: int, share: float) -> Piecewise | Cycle:
        """The gas force [N] of a cylinder over the crank angle [rad], by its share of the
        combustion."""
        train = self.train
        if train.pressure is None:
            return Piecewise((), ((0.0, 0.0, 0.0),))
        if k not in self._gases or self._gases[k][0] != share:
            cubics = train.pressure[k].coefficients
            if train.combustion is not None:
                cubics = cubics + share * train.combustion[k].coefficients
            gas = Cycle(train.pressure[k].knots, self._areas[k] * cubics)
            self._gases[k] = share, _turned(gas, self._phases[k])
        return self._gases[k][1]


def _turned(cycle: Cycle, phase: float) -> Cycle:
    """A function of the cycle angle over the crank angle."""
    return Cycle(cycle.knots - phase, cycle.coefficients)


def _at_cycle_angle(function: Push, phase: float) -> Push:
    return lambda time, theta, s, v: function(time, theta + phase, s, v)


def _over_travel(way: Piecewise, angles: Range, ends: Range) -> Push:
    """A force over the displacement, which beyond crank angles goes on by the pieces that hold at
    these displacements."""
    low, high = angles
    below, above = (way.by_number(end, end) for end in ends)
    inside = way.by_number()
    return lambda _time, theta, s, _v: (
        below(s) if theta < low else above(s) if theta > high else inside(s)
    )


def _terms(
    parts: Sequence[Piecewise | Cycle | None], ranges: Sequence[Range]
) -> list[tuple[int, Callable[[float], float]]]:
    """Functions of one argument, by its number, that go on beyond their range as in it."""
    pairs = enumerate(zip(parts, ranges, strict=True))
    return [(slot, part.by_number(*ends)) for slot, (part, ends) in pairs if part is not None]


def _total(
    terms: list[tuple[int, Callable[[float], float]]], whole: Sequence[Callable[..., float]]
) -> Callable[..., float]:
    """The sum of functions of one argument, by its number, and of all."""
    if len(terms) == 1 and not whole:
        slot, term = terms[0]
        return lambda *at: term(at[slot])

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
