"""Gas, friction and loads: on whole arrays as they are, and number by number as exudyn calls them.

While exudyn integrates, nothing jumps: between the crank angles, times and speeds at which a force
jumps, or a load bends over speed, each goes on straight beyond. The run is cut there.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.knots import KNOT, apart, repeat
from crankmbs.mechanics.pressure import PeriodicPressure
from crankmbs.mechanics.train import CrankTrain, merged_knots
from crankmbs.mechanics.windows import Phase, phase_ends
from crankmbs.motion.mode import Mode
from crankmbs.motion.multibody.applied import Applied, Push
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import Cycle
from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.torque import Torque

__all__ = ["EVERYWHERE", "Bounds", "Forces"]

Range = tuple[float, float]
Scalar = Callable[[float], float]

EVERYWHERE: Range = (-math.inf, math.inf)

_JUMP = 1e-9  # of the highest pressure: less is rounding
_MOST_JUMPS = 60  # over the angle in a period: a table of more steps is run over as it is
_MOST_BENDS = 12  # over time: more are run over
_SAME = 1e-12  # relative: times nearer than this are one
_SLOPE = 1e-4  # rad: over which a slope is taken
_BESIDE = 1e-6  # rad: so far beyond a dead centre a piston slides the other way


class Bounds(NamedTuple):
    """Times [s], crank angles [rad] and speeds [rad/s] between which no force jumps."""

    times: Range
    angles: Range
    speeds: Range


class Forces:
    """The forces of a crank train.

    angles : crank angles [rad] in a period at which a force jumps and a run is cut
    smooth : whether it is cut at every jump that is known beforehand
    """

    def __init__(self, train: CrankTrain) -> None:
        self.train, scene = train, train.scene
        self._stops = True
        self._areas = np.array([gear.piston.gas_area or 0.0 for gear in scene.running_gear])
        self._phases = np.array([cylinder.phase for cylinder in scene.cylinders])
        self._shapes = np.array([gear.shape for gear in scene.running_gear]).T
        gas = [
            np.unique(np.concatenate([_jumps(each) for each in parts]))
            for parts in zip(train.pressure or (), *filter(None, [train.combustion]), strict=True)
        ]
        self._applied = Applied(train)
        loads = [load.parts.over_angle for load in scene.torque]
        jumps = [merged_knots(train, gas)] if gas else []
        jumps += [_of_load(load, train.period) for load in loads if load is not None]
        angles = apart(np.concatenate([self._applied.angles, *jumps]))
        self.smooth = len(angles) <= _MOST_JUMPS
        self.angles = angles if self.smooth else np.empty(0)
        if self._sticks:
            turns = 2.0 * math.pi * np.arange(round(train.period / (2.0 * math.pi)))
            own = np.array([dead_centres(*gear.shape) for gear in scene.running_gear])
            centres = np.add.outer(own - self._phases[:, None], turns).ravel()
            self.angles = apart(np.concatenate([self.angles, np.mod(centres, train.period)]))

    @property
    def _sticks(self) -> bool:
        """Whether a force changes with the sense of sliding."""
        return self.train.scene.friction is not None or self._applied.switches

    @property
    def blind(self) -> Forces:
        """The same, over whose bends over speed a run is not cut."""
        other = copy(self)
        other._stops = False
        return other

    # on arrays

    def gas(self, theta: Array, shares: Array | None) -> Array:
        """Gas forces [N] towards the crank at crank angles (m,), shape (m, n)."""
        forces = np.zeros((len(theta), len(self._phases)))
        for k, pressure in enumerate(self.train.pressure or ()):
            forces[:, k] = self._areas[k] * pressure(theta + self._phases[k])
        for k, more in enumerate(self.train.combustion or ()):
            assert shares is not None
            forces[:, k] += shares[:, k] * self._areas[k] * more(theta + self._phases[k])
        return forces

    def pressures(self, theta: Array, gas: Array) -> dict[str, Array]:
        """The pressures [Pa] of the ends of the cylinders under gas forces [N], by variable, shape
        (m, n) each."""
        net, ends = gas / np.where(self._areas > 0.0, self._areas, 1.0), self.train.crank_end
        if ends is None:
            return {"gas_pressure": net}
        pairs = zip(ends, self._phases, strict=True)
        crank_end = np.array([each(theta + phase) for each, phase in pairs]).T
        below = np.array([gear.piston.crank_end_area for gear in self.train.scene.running_gear])
        head = (gas + below * crank_end) / self._areas
        return {"gas_pressure": head, "crank_end_pressure": crank_end}

    def friction(self, theta: Array, omega: Array, gas: Array, sense: Array) -> Array:
        """Friction [N] towards the crank, shape (m, n), of pistons that slide in this sense of
        rotation; on a dead centre that after it."""
        friction = self.train.scene.friction
        if friction is None:
            return np.zeros_like(gas)
        limit = friction.ring_force + friction.ring_pressure * np.abs(gas)
        dry = self.slides(theta, sense) * limit
        return np.asarray(-dry - friction.viscous * self.sliding(theta, omega))

    def slides(self, theta: Array, sense: Array) -> Array:
        """The sign of the pistons' velocities towards the crank just beyond crank angles."""
        beyond = (theta + _BESIDE * sense)[:, None] + self._phases
        return np.asarray(-np.sign(close_loop(beyond, *self._shapes).x_1) * sense[:, None])

    @property
    def jumps(self) -> bool:
        """Whether a force jumps anywhere over angle or time."""
        return bool(len(self.angles) or self.times or not self.smooth)

    def applied(self, time: Array, theta: Array, omega: Array, sense: Array, acts: Array) -> Array:
        """Forces from outside on the pistons [N] towards the crank, shape (m, n), that slide in
        this sense of rotation; acts : shape (m, loads), whether each does."""
        x = close_loop(theta[:, None] + self._phases, *self._shapes).x
        slides, velocity = self.slides(theta, sense), self.sliding(theta, omega)
        return self._applied.forces((time, theta, omega), acts, slides, x, velocity)

    def sliding(self, theta: Array, omega: Array) -> Array:
        """Velocities of the pistons towards the crank [m/s], shape (m, n)."""
        rise = close_loop(theta[:, None] + self._phases, *self._shapes).x_1
        return np.asarray(-rise * omega[:, None])

    def torque(self, time: Array, theta: Array, omega: Array, acts: Array) -> Array:
        """Torque [N m] of all torques, shape (m,); acts : shape (m, loads), whether each does."""
        total = np.zeros_like(theta)
        for load, when in zip(self.train.scene.torque, acts.T, strict=False):
            total += np.where(when, load(time, theta, omega), 0.0)
        return total

    # number by number, on one stretch

    def bounds(self, time: float, theta: float, omega: float, mode: Mode, senses: Range) -> Bounds:
        """What ends the stretch that begins in a state: the next time, angle or speed on either
        side; on one of them that beyond it.

        senses : signs in which the crank angle, and its speed, leave the state
        """
        ends = phase_ends(self.train.loads, mode.loads)
        times, speeds = {*ends[0], *self.times}, set(ends[1])
        for _, load in self._turning(mode) if self._stops else ():
            parts = load.parts
            speeds |= set(parts.over_speed.bends if parts.over_speed else ())
            speeds |= set(parts.function.speeds if parts.function else ())
        if self._sticks:
            speeds.add(0.0)
        at, period = theta + 2.0 * KNOT * senses[0], self.train.period
        knots = repeat(self.angles, period, at - 1.5 * period, at + 1.5 * period)
        low, high = _around(sorted(knots), at, 1.0)
        angles = max(low, mode.low), min(high, mode.high)
        return Bounds(
            _around(sorted(times), time * (1.0 + _SAME), 1.0),
            angles,
            _around(sorted(speeds), omega, senses[1]),
        )

    @cached_property
    def times(self) -> tuple[float, ...]:
        """Times [s] at which a load jumps; or bends, where these are few."""
        jumps, bends = set[float](), set[float](self._applied.times)
        for load in self.train.scene.torque:
            jumps |= set(load.parts.function.times if load.parts.function else ())
            if load.parts.over_time is not None:
                jumps |= set(load.parts.over_time.jumps)
                bends |= set(load.parts.over_time.bends)
        within = jumps | bends
        return tuple(within if len(bends) <= _MOST_BENDS else jumps)

    def pushes(self, bounds: Bounds, mode: Mode, theta: float, sense: float) -> list[Push]:
        """For each cylinder the force of gas, friction and from outside towards the crank."""
        friction = self.train.scene.friction
        slides = self.slides(np.array([theta]), np.array([sense]))[0].tolist()
        found: list[Push] = []
        for k, phase in enumerate(self._phases.tolist()):
            gas = _straight(self._gas_by_number(k, phase, mode.shares), *bounds.angles)
            if friction is None:
                found.append(_alone(gas))
            else:
                rubs = friction.ring_force, friction.ring_pressure, friction.viscous
                found.append(_rubbed(gas, slides[k], *rubs))
            more = self._applied.by_number(k, mode, slides[k])
            found[k] = _together([found[k], *more]) if more else found[k]
        return found

    def _turning(self, mode: Mode) -> tuple[tuple[int, Torque], ...]:
        """The torques that act."""
        numbered = tuple(enumerate(self.train.scene.torque, start=1))
        return tuple(
            one for one in numbered if not mode.loads or mode.loads[one[0] - 1] is Phase.ACTING
        )

    def load(self, bounds: Bounds, mode: Mode) -> Callable[[float, float, float], float]:
        """Torque [N m] of the loads that act, of time [s], crank angle [rad] and speed [rad/s]."""
        parts = [load.parts for _, load in self._turning(mode)]
        in_time = [_between(p.over_time, *bounds.times) for p in parts if p.over_time]
        in_speed = [_between(p.over_speed, *bounds.speeds) for p in parts if p.over_speed]
        in_angle = [
            _straight(p.over_angle.by_number(), *bounds.angles) for p in parts if p.over_angle
        ]
        functions = [p.function.number for p in parts if p.function]

        def torque(time: float, theta: float, omega: float) -> float:
            value = 0.0
            for function in in_time:
                value += function(time)
            for function in in_speed:
                value += function(omega)
            for function in in_angle:
                value += function(theta)
            for given in functions:
                value += given(time, theta, omega)
            return value

        return torque

    def _gas_by_number(self, k: int, phase: float, shares: Sequence[float]) -> Scalar:
        """The gas force [N] of a cylinder over the crank angle [rad]."""
        if self.train.pressure is None:
            return lambda theta: 0.0
        pressure = self.train.pressure[k]
        cubics = pressure.coefficients
        if shares and self.train.combustion is not None:
            cubics = cubics + shares[k] * self.train.combustion[k].coefficients
        return Cycle(pressure.knots - phase, self._areas[k] * cubics).by_number()


def _around(stops: Sequence[float], x: float, sense: float) -> Range:
    """The stops next to a number; of one on a stop those on the side of ``sense``."""
    k = (bisect_right if sense > 0.0 else bisect_left)(stops, x)
    ends = [-math.inf, *stops, math.inf]
    return ends[k], ends[k + 1]


def _straight(function: Scalar, low: float, high: float) -> Scalar:
    """A function of the angle [rad] between two ends, and straight on beyond."""
    high -= 2.0 * KNOT
    ends = {
        x: (function(x), (function(x + d) - function(x)) / d)
        for x, d in ((low, _SLOPE), (high, -_SLOPE))
        if math.isfinite(x)
    }

    def value(theta: float) -> float:
        if low <= theta <= high:
            return function(theta)
        end = low if theta < low else high
        at, slope = ends[end]
        return at + slope * (theta - end)

    return value if ends else function


def _between(part: Piecewise, begin: float, end: float) -> Scalar:
    """The pieces of a function from ``begin`` to ``end``; the outer ones go on."""
    low = bisect_right(part.knots, begin)
    high = max(bisect_left(part.knots, end), low)
    knots, pieces = part.knots[low:high], part.pieces[low : high + 1]

    def value(x: float) -> float:
        a, b, c = pieces[bisect_right(knots, x)]
        return a + (b + c * x) * x

    return value


def _alone(gas: Scalar) -> Push:
    return lambda _time, theta, _displacement, _speed: gas(theta)


def _together(pushes: list[Push]) -> Push:
    return lambda *at: sum(push(*at) for push in pushes)


def _rubbed(gas: Scalar, slides: float, ring: float, pressed: float, viscous: float) -> Push:
    """A gas force with the friction of a piston that slides with this sign."""

    def along(_time: float, theta: float, _displacement: float, speed: float) -> float:
        force = gas(theta)
        return force - slides * (ring + pressed * abs(force)) - viscous * speed

    return along


def _jumps(pressure: PeriodicPressure) -> Array:
    """Cycle angles [rad] at which a pressure jumps."""
    ends = pressure.piece(np.arange(len(pressure.knots) - 1), np.diff(pressure.knots))
    begins = pressure.coefficients[-1]
    rises = np.abs(begins - np.roll(ends, 1)) > _JUMP * np.max(np.abs(begins))
    return np.asarray(pressure.knots[:-1][rises])


def _of_load(load: Cycle, period: float) -> Array:
    """Crank angles [rad] in a period at which a load over the angle jumps."""
    knots = load.knots[:-1]
    rises = np.abs(load(knots) - load(knots - 3.0 * KNOT)) > 1e-6 * load.largest
    turns = load.period * np.arange(round(period / load.period))
    return np.asarray(np.mod(np.add.outer(turns, knots[rises]).ravel(), period))
