"""A free crank under all that changes on its way, over time, by SciPy: from one event to the next,
between which every formula is smooth.

Events are knots over angle, displacement, speed and time, dead centres where pistons rub or are
pushed otherwise on the way back, decisions on the fuel, ends of windows, and rest. The error is
DOP853's at 1e-13, some 1e-11 after a few turns.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from validation.oracles.changes import Changes, Curve, Pull, Push, marks
from validation.oracles.deciding import Decider
from validation.oracles.stretch import (
    NEAR,
    Acting,
    GasPiece,
    Pushing,
    Stretch,
    meets,
    piece_at,
    press,
)
from validation.oracles.travel import angles_at, dead_centres, displacement_at

__all__ = ["Changed", "changing_motion"]

Floats = NDArray[np.float64]

_STUCK = 40  # events at one time
_AT_ONCE = 1e-9  # s: so near a change over time either value is right
_WIDEST = 0.03  # rad: a step; at 1e-13 alone 45 reversals add up to 8e-11 of the peak, and the
# estimate of a wide step may vanish by chance
_FINER = 50.0  # steps in a stretch in which the speed turns beside a bound
_FAR = 9.0  # rad: beyond any stretch
_BESIDE = 1e-6  # of an angle [rad] or a speed: so near a knot either value is right


def _passed(found: Any, slow: float, fast: float) -> bool:
    """Whether the speed of a solution passes a bound inside a step, there and back."""
    within = np.linspace(0.0, 1.0, 11)[1:-1]
    times = found.t[:-1, None] + np.diff(found.t)[:, None] * within
    speeds = found.sol(times.ravel())[1]
    spare = _BESIDE * max(float(np.max(np.abs(speeds))), 1e-300)
    return bool(np.any(speeds < slow - spare) or np.any(speeds > fast + spare))


@dataclass(frozen=True)
class Changed:
    """Samples: shape (n,) [rad], [rad/s], [rad/s2], [N m]; of each cylinder shape (n, cylinders):
    gas force, friction and force from outside [N] towards the crank, share; clear : not beside a
    knot, shape (n,);
    events : (time, angle, speed, kind), "fuel", "load on", "load off" or "reversal"."""

    theta: Floats
    omega: Floats
    alpha: Floats
    external: Floats
    gas: Floats
    friction: Floats
    applied: Floats
    shares: Floats
    clear: NDArray[np.bool_]
    events: tuple[tuple[float, float, float, str], ...]


class _State(NamedTuple):
    time: float
    theta: float
    omega: float


def changing_motion(
    changes: Changes,
    theta: float,
    omega: float,
    times: Floats,
    stretch: Callable[..., Stretch] = Stretch,
) -> Changed:
    """The motion from a crank angle and speed, at increasing times [s].

    stretch : makes what the crank is between two events; another class of them accelerates it by
    other equations

    Raises
    ------
    ArithmeticError : a speed that is held at a knot of the loads, events without end, overflow
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return _Walk(changes, theta, omega, stretch).samples(times)


class _Walk:
    def __init__(
        self, changes: Changes, theta: float, omega: float, stretch: Callable[..., Stretch]
    ) -> None:
        self.changes, self.state, self.stretch = changes, _State(0.0, theta, omega), stretch
        self.events: list[tuple[float, float, float, str]] = []
        machine = changes.machine
        self.phases = [float(phase) for phase, _ in machine.cylinders]
        self.decider = Decider(changes, theta, omega) if changes.firings is not None else None
        self.loads: tuple[Pull | Push, ...] = (*changes.pulls, *changes.pushes)
        self.stage = ["waiting"] * len(self.loads)
        self.switches = any(push.back is not push.forward for push in changes.pushes)
        self.holds = changes.rings is not None or self.switches
        self.side = self.came = 0.0  # how the speed grows; in which sense the crank came to rest
        self.marks = self._marks()
        self._settle_windows()

    def samples(self, times: Floats) -> Changed:
        rows = []
        for time in times.tolist():
            stuck, last = 0, -1.0
            while self.state.time < time:
                self._on(time)
                stuck = stuck + 1 if self.state.time == last else 0
                last = self.state.time
                if stuck > _STUCK:
                    raise ArithmeticError("events without end")
            rows.append(self._row())
        columns = [np.array(column) for column in zip(*rows, strict=True)]
        theta, omega, alpha, external, gas, friction, applied, shares, clear = columns
        events = tuple(self.events)
        return Changed(theta, omega, alpha, external, gas, friction, applied, shares, clear, events)

    def _marks(self) -> list[Curve]:
        """Angles at which pistons turn back, and those of knots over their displacement."""
        machine, found = self.changes.machine, []
        if self.holds:
            found += [c - p for k, p in enumerate(self.phases) for c in dead_centres(machine.of(k))]
        for push in self.changes.pushes:
            knots = {x for way in (push.forward, push.back) if way for x in way.knots}
            for k in self._pistons(push):
                angles = [angle for x in knots for angle in angles_at(machine.of(k), x)]
                found += [angle - self.phases[k] for angle in angles]
        return [marks(found, 2.0 * math.pi)] if found else []

    def _pistons(self, push: Push) -> list[int]:
        """On which a force acts, from 0."""
        return list(range(len(self.phases))) if push.cylinder is None else [push.cylinder]

    def _settle_windows(self) -> None:
        """Loads that set in or end at this time and speed, met exactly."""
        t, theta, omega = self.state
        for k, pull in enumerate(self.loads):
            before = self.stage[k]
            if t >= pull.until:
                self.stage[k] = "over"
            if self.stage[k] == "acting" and omega == pull.until_speed:
                self.stage[k] = "over"
            if self.stage[k] == "waiting" and pull.from_speed in (None, omega):
                self.stage[k] = "due"
            if self.stage[k] == "due" and t >= pull.after:
                self.stage[k] = "acting"
            if before != "acting" and self.stage[k] == "acting":
                self.events.append((t, theta, omega, "load on"))
            if before == "acting" and self.stage[k] == "over":
                self.events.append((t, theta, omega, "load off"))

    def _bounds(self) -> tuple[list[float], list[float]]:
        """Times and speeds at which a window of a load may open or close, or a piece ends."""
        times, speeds = [math.inf], [-math.inf, math.inf]
        for pull, stage in zip(self.loads, self.stage, strict=True):
            if stage == "waiting" and pull.from_speed is not None:
                speeds.append(pull.from_speed)
            times += [pull.after] if stage == "due" else []
            times += [pull.until] if stage != "over" else []
            if stage == "acting":
                speeds += [] if pull.until_speed is None else [pull.until_speed]
                times += pull.over_time.knots if pull.over_time else ()
                if isinstance(pull, Pull) and pull.over_speed:
                    speeds += pull.over_speed.knots
        return times, speeds

    def _stretch(self, sense: float, side: float) -> Stretch:
        """From the state on, in a sense of rotation, the speed growing or falling where it stands
        on a knot."""
        t, theta, omega = self.state
        times, speeds = self._bounds()
        speeds.sort()
        k = bisect_right(speeds, omega) if side > 0.0 else bisect_left(speeds, omega)
        slow, fast = speeds[k - 1], speeds[k]
        end = min(time for time in times if time > t)
        ahead = theta + sense * NEAR
        edges: list[tuple[float, float]] = [mark.at(ahead)[1:] for mark in self.marks]
        gas = [self._gas(j, ahead, edges) for j in range(len(self.changes.fired))]
        acting = [
            load for load, stage in zip(self.loads, self.stage, strict=True) if stage == "acting"
        ]
        loads = [self._load(load, ahead, side, edges) for load in acting if isinstance(load, Pull)]
        pushes = [load for load in acting if isinstance(load, Push)]
        for push in pushes:
            if push.over_angle is not None:
                for p in (self.phases[k] for k in self._pistons(push)):
                    since, until = push.over_angle.at(ahead + p)[1:]
                    edges.append((since - p, until - p))
        if self.decider is not None:
            edges.append(self.decider.bounds)
        low = max([theta - 1.0, *(edge[0] for edge in edges)])
        high = min([theta + 1.0, *(edge[1] for edge in edges)])
        shares = tuple(self.decider.shares) if self.decider else (1.0,) * len(gas)
        at = self.stretch(
            self.changes, shares, low, high, slow, fast, end, gas, loads, [], [1.0] * len(gas), []
        )
        middle = theta + sense * min(1e-7, 0.5 * (high - low))
        at.slides = [-sense * math.copysign(1.0, place.x_1) for place in at.places(middle)]
        amid = 0.5 * (theta + (high if sense > 0.0 else low))
        at.pushed = [
            self._push(push, k, ahead, amid, at.slides[k])
            for push in pushes
            for k in self._pistons(push)
        ]
        if self.changes.rings is not None and self.changes.rings[1] > 0.0:
            press(at, ahead, sense)
        return at

    def _gas(self, j: int, ahead: float, edges: list[tuple[float, float]]) -> GasPiece:
        phase, firings = self.phases[j], self.changes.firings
        fired, low, high = self.changes.fired[j].at(ahead + phase)
        edges.append((low - phase, high - phase))
        piece = GasPiece(fired, low - phase, None, 0.0)
        if self.changes.crank_ends:
            below, under, high = self.changes.crank_ends[j].at(ahead + phase)
            edges.append((under - phase, high - phase))
            piece = piece._replace(below=below, under=under - phase)
        if firings is None:
            return piece
        motored, since, high = firings.motored[j].at(ahead + phase)
        edges.append((since - phase, high - phase))
        return piece._replace(motored=motored, since=since - phase)

    def _load(
        self, pull: Pull, ahead: float, side: float, edges: list[tuple[float, float]]
    ) -> Acting:
        t, _, omega = self.state
        over_angle, origin = None, 0.0
        if pull.over_angle is not None:
            over_angle, origin, high = pull.over_angle.at(ahead)
            edges.append((origin, high))
        over_speed = piece_at(pull.over_speed, omega, side)
        over_time = piece_at(pull.over_time, t, 1.0)
        return Acting(pull, over_time, over_speed, over_angle, origin)

    def _push(self, push: Push, k: int, ahead: float, amid: float, slides: float) -> Pushing:
        """A force on the piston of a cylinder, in a stretch with an angle amid it."""
        phase, over_angle, origin = self.phases[k], None, 0.0
        if push.over_angle is not None:
            over_angle, origin, _ = push.over_angle.at(ahead + phase)
        over_time = piece_at(push.over_time, self.state.time, 1.0)
        way = push.forward if slides > 0.0 else push.back
        displacement = displacement_at(self.changes.machine.of(k), amid + phase)
        over_travel = piece_at(way, displacement, 1.0)
        return Pushing(push, k, phase, over_time, over_travel, over_angle, origin)

    def _ahead(self) -> tuple[float, Stretch | None]:
        """The sense in which the crank turns on and the stretch; 0 and None where it is held."""
        t, theta, omega = self.state
        senses = [math.copysign(1.0, omega)] if omega != 0.0 else [1.0, -1.0]
        on_knot = omega in self._bounds()[1]
        for sense in senses:
            sides = [sense] if omega == 0.0 else [self.side, -self.side] if on_knot else [1.0]
            for side in sides:
                at = self._stretch(sense, side or 1.0)
                rate = at.alpha(t, theta, omega)
                if (omega == 0.0 and sense * rate > 0.0) or (omega != 0.0 and not on_knot):
                    return sense, at
                if omega != 0.0 and side * rate > 0.0:
                    return sense, at
        if omega != 0.0:
            raise ArithmeticError("the speed is held at a knot")
        return 0.0, None

    def _on(self, until: float) -> None:
        """To a time, or to the first event before it."""
        sense, at = self._ahead()
        t, theta, _ = self.state
        if at is None:  # held: until something changes over time
            if not self.holds:
                raise ArithmeticError("in balance at rest")
            end = min(time for time in (*self._bounds()[0], until) if time > t)
            self.state = _State(end, theta, 0.0)
            self._settle_windows()
            return
        if sense == -self.came:
            self.events.append((*self.state, "reversal"))
        self._go(at, sense, min(until, at.end))
        self.came = sense if self.state.omega == 0.0 else 0.0
        self._settle_windows()
        decider = self.decider
        if decider is not None and self.state.theta in decider.bounds:
            decider.decide(*self.state)
            self.events.append((*self.state, "fuel"))

    def _go(self, at: Stretch, sense: float, end: float) -> None:
        bound = at.high if sense > 0.0 else at.low
        start, y = self.state.time, np.array(self.state[1:])

        def slopes(t: float, y: Floats) -> list[float]:
            if not abs(y[0] - self.state.theta) < _FAR:  # a step that is too wide is taken back
                return [math.nan, math.nan]
            return [float(y[1]), at.alpha(t, float(y[0]), float(y[1]))]

        def passes(_: float, y: Floats) -> float:
            return float(sense * (y[0] - bound))

        slow, fast = (max(at.slow, 0.0), at.fast) if sense > 0.0 else (at.slow, min(at.fast, 0.0))
        bounds = {-1.0: slow, 1.0: fast}
        events: list[Any] = [passes, *(meets(speed, way) for way, speed in bounds.items())]
        passes.terminal, passes.direction = True, 1.0  # type: ignore[attr-defined]
        alpha = abs(slopes(start, y)[1])  # from rest it turns by no more than a radian here
        scale = abs(float(y[1])) + min(alpha * (end - start), math.sqrt(2.0 * alpha)) + 1e-9
        options: dict[str, Any] = {"method": "DOP853", "rtol": 1e-13}
        options["atol"] = [1e-15, 1e-14 * scale]
        options["max_step"] = _WIDEST / scale
        found = solve_ivp(slopes, (start, end), y, events=events, dense_output=True, **options)
        if at.may_touch(found.t, found.y) or _passed(found, slow, fast):
            finer = (float(found.t[-1]) - start) / _FINER
            options["max_step"] = min(options["max_step"], finer)
            found = solve_ivp(slopes, (start, end), y, events=events, **options)
        if found.status < 0:
            raise ArithmeticError(found.message)
        last = found.y[:, -1]
        if found.status != 1:
            self.side = math.copysign(1.0, slopes(end, last)[1])
            self.state = _State(end, float(last[0]), float(last[1]))
            return
        met = float(found.t[-1])
        before = (float(found.t[-2]), found.y[:, -2]) if len(found.t) > 1 else (start, y)
        if met > before[0]:
            last = solve_ivp(slopes, (before[0], met), before[1], **options).y[:, -1]
        theta, omega = float(last[0]), float(last[1])
        rate = slopes(met, last)[1]
        self.side = math.copysign(1.0, rate)
        of_each = found.t_events
        assert of_each is not None
        if len(of_each[0]):  # on the knot of the angle by one step of Newton's
            late = (bound - theta) / omega if omega != 0.0 else 0.0
            late = late if abs(late) < 1e-6 * (met - start) else 0.0
            self.state = _State(met + late, bound, omega + rate * late)
            return
        self.side = -1.0 if len(of_each[1]) else 1.0
        speed = bounds[self.side]
        late = (speed - omega) / rate if rate != 0.0 else 0.0
        late = late if abs(late) < 1e-6 * (met - start) else 0.0
        self.state = _State(met + late, theta + omega * late, speed)

    def _row(self) -> tuple[Any, ...]:
        t, theta, omega = self.state
        try:
            sense, at = self._ahead()
        except ArithmeticError:
            sense, at = math.copysign(1.0, omega), None
        clear = at is not None
        at = at or self._stretch(sense or 1.0, 1.0)
        edges = min(abs(theta - at.low), abs(at.high - theta)) > _BESIDE
        speeds = min(abs(omega - at.slow), abs(at.fast - omega)) > _BESIDE * max(abs(omega), 1.0)
        times = [abs(t - knot) for knot in self._bounds()[0]]
        alpha = at.alpha(*self.state) if clear else 0.0
        shares = list(self.decider.shares) if self.decider else [1.0] * len(self.phases)
        clear = clear and edges and speeds and min(times) > _AT_ONCE
        if omega == 0.0 and sense != 0.0:  # a function of the velocity may have any value there
            clear = clear and not self.switches
        forces, rubbed = at.forces(theta), at.friction(theta, omega)
        applied, external = at.applied(*self.state), at.external(*self.state)
        return theta, omega, alpha, external, forces, rubbed, applied, shares, clear
