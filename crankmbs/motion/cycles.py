"""What each whole cycle of the engine amounts to, by quadrature over the cells of the motion.

A cycle begins where the crank passes the angle of the start, or that a whole number of periods from
it, and ends where it has turned through one period from there without turning back.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.axes import areas, axes_of, closed_loops, gears_of
from crankmbs.mechanics.inertia import ends_at, gas_at, inertia_alone
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.reactions import places_of
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots
from crankmbs.mechanics.windows import acting
from crankmbs.motion.account import Rows, beside
from crankmbs.motion.base import Samples, Segment
from crankmbs.motion.cells import Cells
from crankmbs.motion.states import balances_of, inner_samples, samples_at
from crankmbs.numerics.arrays import Array
from crankmbs.scene.torque import Acting

__all__ = ["MOST_CYCLES", "Cycles", "cycles_of"]

MOST_CYCLES = 10_000
"""Of more cycles the last ones are kept."""

_SAME = 1e-9  # of a period: what is nearer to its end is at its end
_SAME_ANGLE = 1e-9  # rad
_STEEP = 16.0  # per radian, of the largest work: what the rounding of the crank angle may change
_EPS = float(np.finfo(float).eps)
_NEAR = 1e-7  # rad: a decision so near the end of a cycle belongs to the next
_ROUNDS = 2  # of the secant method; what it leaves is of second order in the speed's slope


class _Open(NamedTuple):
    """A cycle that has begun: its number along the crank angle, from 0 at the start; time [s] and
    kinetic energy [J] there; the shares that its first stretch has."""

    place: int
    time: float
    kinetic: float
    shares: tuple[float, ...]


class _Done(NamedTuple):
    """A whole cycle; its shares in its first and in its last stretch, its works [J]."""

    number: int
    place: int
    sense: float
    time: float
    duration: float
    gained: float
    slowest: float
    fastest: float
    before: tuple[float, ...]
    after: tuple[float, ...]
    works: tuple[float, ...]


class Cycles:
    """The whole cycles of one pass over a motion, from its pieces as they come."""

    def __init__(self, train: CrankTrain, start: float) -> None:
        self._train, self._start = train, start
        self._period = train.scene.period
        self._open: _Open | None = None
        self._sense, self._reached = 0.0, start
        scene, count = train.scene, len(train.scene.cylinders)
        counts = {
            "load_work": len(scene.torque),
            "force_work": len(scene.force),
            "drive_work": int(scene.motion is not None),
            "friction_work": count if scene.friction else 0,
            "gas_work": count if scene.gas else 0,
            "crank_end_work": count if scene.double_acting else 0,
        }
        self._columns = {name: k for name, k in places_of(counts).items() if counts[name]}
        self._works, self._speeds = np.zeros(sum(counts.values())), np.empty(0)
        begins = start + self._period * np.arange(round(train.period / self._period))
        self._knots = np.append(crank_angle_knots(train), begins % train.period)
        self._passed = 0
        self.done: deque[_Done] = deque(maxlen=MOST_CYCLES)

    @property
    def left_out(self) -> int:
        """How many cycles were passed that are not kept."""
        return self._passed - len(self.done)

    def add(self, piece: Segment) -> None:
        """One piece more of the motion."""
        begin, end = piece.begin, piece.end
        if begin.theta == end.theta:
            self._speeds = np.append(self._speeds, 0.0)
            return
        sense = math.copysign(1.0, end.theta - begin.theta)
        self._go_on(begin.theta, sense)
        places, period = self._places(begin.theta, end.theta), self._train.period
        marks = self._start + sense * self._period * np.array(places, dtype=np.float64)
        cells = piece.cells.cut_at(self._knots, period)
        low, high = sorted((begin.theta, end.theta))
        at = samples_at(cells, self._train, np.clip(marks, low, high), in_time=False)
        time = np.clip(at.time, begin.time, end.time)
        time[marks == begin.theta] = begin.time  # as it is known, without rounding
        kinetic = 0.5 * inertia_alone(self._train.scene, at.theta) * at.omega**2
        works, speeds = self._summed(cells, acting(self._train.loads, begin.mode.loads), at)
        for k in range(len(places) + 1):
            self._works = self._works + works[k]
            self._speeds = np.append(self._speeds, speeds[k])
            if k < len(places):
                before, after = _shares_beside(piece, float(marks[k]), sense)
                here = _Open(places[k], float(time[k]), float(kinetic[k]), after)
                self._close(here, before, float(at.omega[k]))
                self._open, self._works = here, np.zeros_like(self._works)
                self._speeds = at.omega[k : k + 1]
        self._speeds = np.array([np.nanmin(self._speeds), np.nanmax(self._speeds)])
        self._reached = end.theta

    def _go_on(self, theta: float, sense: float) -> None:
        """Where a piece begins elsewhere than the last one ended, whole cycles were passed; where
        it turns back, none is."""
        if sense != self._sense:
            self._open, self._sense = None, sense
        if abs(theta - self._reached) > _SAME * self._period:
            passed = len(self._places(self._reached, theta))
            self._passed += max(passed - (self._open is None), 0)
            self._open = None

    def _places(self, begin: float, end: float) -> list[int]:
        """The ends of cycles passed from one angle to another; at the first of them only where none
        is open."""
        x, y = (self._sense * (theta - self._start) / self._period for theta in (begin, end))
        places = range(math.ceil(x - _SAME), math.floor(y + _SAME) + 1)
        return [k for k in places if k > x + _SAME or self._open is None]

    def _close(self, here: _Open, after: tuple[float, ...], speed: float) -> None:
        begun = self._open
        if begun is None:
            return
        self._passed += 1
        self.done.append(
            _Done(
                number=self._passed,
                place=begun.place,
                sense=self._sense,
                time=begun.time,
                duration=here.time - begun.time,
                gained=here.kinetic - begun.kinetic,
                slowest=float(np.nanmin([*self._speeds, speed])),
                fastest=float(np.nanmax([*self._speeds, speed])),
                before=begun.shares,
                after=after,
                works=tuple(self._works.tolist()),
            )
        )

    def _summed(
        self, cells: Cells, loads: Sequence[tuple[int, Acting]], marks: Samples
    ) -> tuple[Array, Array]:
        """Between marks, at which cells end, and the ends of all: works [J], shape (n + 1,
        columns), of loads by number; least and largest speed [rad/s], shape (n + 1, 2)."""
        points, sense = inner_samples(cells, self._train), cells.acting.sense
        works = np.zeros((len(marks.time) + 1, len(self._works)))
        middle = 0.5 * (cells.angle[:, 0] + cells.angle[:, -1])
        segment = np.searchsorted(sense * marks.theta, sense * middle)
        by_cell = self._works_of(points, loads, (cells.turned * cells.weights).ravel())
        by_cell = by_cell.reshape(*cells.time.shape, -1).sum(axis=1)
        np.add.at(works, segment, by_cell)
        return works, _extremes(cells, self._train, marks.time, points)

    def _works_of(
        self, points: Samples, loads: Sequence[tuple[int, Acting]], turned: Array
    ) -> Array:
        """Work [J] at points that stand for angles turned [rad], shape (n,); shape (n, columns)."""
        train, scene, theta, omega = self._train, self._train.scene, points.theta, points.omega
        works = np.zeros((len(omega), len(self._works)))
        of, fuel = self._columns, points.computed.get("fuel")
        towards = -closed_loops(scene, theta).x_1 * turned
        for number, load in loads:
            works[:, number - 1] = load(points.time, theta, omega) * turned
        if scene.motion is not None:
            drive = points.computed.get("external_torque")
            if drive is None:
                drive = balances_of(train, points).row("external_torque")
            works[:, of["drive_work"]] = (drive * turned)[:, None]
        if scene.friction is not None:
            works[:, of["friction_work"]] = points.computed["friction_force"] * towards.T
        gas = gas_at(train, theta, None if fuel is None else fuel.T)
        if gas is not None:
            works[:, of["gas_work"]] = (gears_of(scene).area * gas * towards).T
            for below in [*ends_at(train, theta, gas).values()][1:]:
                on_crank = areas(scene)[1][:, None]
                works[:, of["crank_end_work"]] = -(on_crank * below * towards).T
        return works

    def rows(self, count: int) -> Rows:
        """The last cycles, as many as are asked for."""
        done = list(self.done)[len(self.done) - count :]
        columns = {name: np.array([getattr(one, name) for one in done]) for name in _Done._fields}
        scene, sense = self._train.scene, columns["sense"]
        works = columns["works"].reshape(count, len(self._works))
        table = {
            "number": columns["number"].astype(np.float64),
            "time": columns["time"],
            "crank_angle": self._start + sense * self._period * columns["place"],
            "duration": columns["duration"],
            "mean_speed": sense * self._period / columns["duration"],
            "least_speed": columns["slowest"],
            "largest_speed": columns["fastest"],
            "kinetic_energy_gained": columns["gained"],
        }
        table |= {name: works[:, at] for name, at in self._columns.items()}
        if scene.gas is not None:
            on_head, on_crank = areas(scene)
            stroke = np.array([gear.stroke for gear in scene.running_gear])
            work, below = table["gas_work"], table.pop("crank_end_work", None)
            head = work if below is None else work - below
            table["imep"] = head / (on_head * stroke)
            if below is not None:
                table["imep_crank_end"] = below / (on_crank * stroke)
        if scene.fuel is not None:
            fired = len(scene.cylinders)  # given, as there may be no cycle
            before, after = (columns[name].reshape(count, fired) for name in ("before", "after"))
            table["fuel"] = self._shares(sense, before, after)
        if scene.motion is not None:
            table["drive_work"] = table["drive_work"][:, 0]
        rounding = _STEEP * _EPS * peak(table["crank_angle"])
        errors = {name: rounding * peak(works[:, at]) for name, at in self._columns.items()}
        errors |= {name: rounding * peak(table[name]) for name in table if name.startswith("imep")}
        # of large energies a small difference
        whole = inertia_alone(scene, np.array([self._start])) * peak(table["largest_speed"]) ** 2
        errors["kinetic_energy_gained"] = _EPS * float(whole[0])
        return Rows(table, errors, self.left_out + len(self.done) - count)

    def _shares(self, sense: Array, before: Array, after: Array) -> Array:
        """The share of the firing whose dead centre a cycle holds, shape (n, cylinders)."""
        behind = axes_of(self._train.scene).phases + self._start
        decides, ahead = ((angle - behind) % self._period for angle in (math.pi, 2.0 * math.pi))
        decides = np.where(self._period - decides < _SAME_ANGLE, 0.0, decides)
        rising = np.where(decides <= ahead + _SAME_ANGLE, after, before)
        falling = np.where(decides >= ahead - _SAME_ANGLE, after, before)
        return np.asarray(np.where(sense[:, None] > 0.0, rising, falling))


def _extremes(cells: Cells, train: CrankTrain, marks: Array, points: Samples) -> Array:
    """Least and largest speed [rad/s] between times [s], shape (n + 1, 2): of the values at points
    in the cells, and where the acceleration vanishes beside those that might be it."""
    time, speed = points.time, points.omega
    segment = np.searchsorted(marks, time)
    low, high = np.full((2, len(marks) + 1), np.nan)
    for into, least in ((low, np.fmin), (high, np.fmax)):
        least.at(into, segment, speed)
    before, after = speed[1:-1] - speed[:-2], speed[2:] - speed[1:-1]
    lift = np.maximum(np.abs(before), np.abs(after))
    of = segment[1:-1]
    may = (speed[1:-1] - lift < low[of]) | (speed[1:-1] + lift > high[of])
    k = 1 + np.flatnonzero((before * after < 0.0) & may)
    if len(k):
        a, b, c = (_moving(cells, train, time[at]) for at in (k - 1, k, k + 1))
        falls = b[1] * c[1] < 0.0
        a, c = (np.where(falls, one, other) for one, other in ((b, a), (c, b)))
        for _ in range(_ROUNDS):
            steep = np.where(c[1] != a[1], c[1] - a[1], np.inf)
            b = _moving(cells, train, np.clip(a[0] - a[1] * (c[0] - a[0]) / steep, a[0], c[0]))
            inside = np.searchsorted(marks, b[0])
            np.fmin.at(low, inside, b[2])
            np.fmax.at(high, inside, b[2])
            left = a[1] * b[1] < 0.0
            a, c = np.where(left, a, b), np.where(left, b, c)
    return np.column_stack([low, high])


def _moving(cells: Cells, train: CrankTrain, time: Array) -> Array:
    """Times [s], acceleration [rad/s2] and speed [rad/s] there, shape (3, n)."""
    there = samples_at(cells, train, time, in_time=True)
    return np.array([time, there.alpha, there.omega])


def _shares_beside(
    piece: Segment, theta: float, sense: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The shares of the combustion that act up to a crank angle [rad] and from there on."""
    before = after = piece.begin.mode.shares
    for state in (*piece.decisions, piece.end):
        if sense * (theta - state.theta) > _NEAR:
            before = state.mode.shares
        if sense * (theta - state.theta) >= -_NEAR:
            after = state.mode.shares
    return before, after


def cycles_of(passes: Sequence[Cycles], share: float) -> Rows:
    """The cycles of a motion that was followed several times, with their errors: those that all
    have.

    share : of the largest difference, that is stated
    """
    count = min(len(one.done) for one in passes)
    return beside([one.rows(count) for one in passes], share)
