"""What each whole cycle of the engine amounts to, by quadrature over the pieces of the motion.

A cycle begins where the crank passes the angle of the start, or that a whole number of periods from
it, and ends where it has turned through one period from there without turning back. What depends
on the angle alone, the work of the gas for shares of the combustion of 0 and 1, is integrated once
for all cycles (`crankmbs.motion.gas_work`); what depends on speed and time, over the solver's own
cells or steps.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import acting
from crankmbs.motion.account import Rows, beside
from crankmbs.motion.base import Points, Samples, Solved
from crankmbs.motion.extremes import extremes
from crankmbs.motion.gas_work import GasWork
from crankmbs.motion.plan import Chosen
from crankmbs.numerics.arrays import Array
from crankmbs.scene.parts import Friction

__all__ = ["MOST_CYCLES", "Cycles", "cycles_of"]

MOST_CYCLES = 10_000
"""Of more cycles the last ones are kept."""

_SAME = 1e-9  # of a period, and of a step: what is nearer to its end is at its end
_NEAR = 1e-7  # rad: a decision so near the end of a cycle belongs to the next
_POINTS = (8, 10)  # of Gauss in what is left of a step beside the end of a cycle, in either pass


class _Open(NamedTuple):
    """A cycle that has begun: its number along the crank angle, from 0 at the start; time [s] and
    kinetic energy [J] there; the shares that its first stretch has."""

    place: int
    time: float
    kinetic: float
    shares: tuple[float, ...]


class _Done(NamedTuple):
    """A whole cycle; its shares in its first and in its last stretch, its works [J] by load."""

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

    def __init__(
        self, train: CrankTrain, start: float, kinetic: Callable[[Samples], Array], *, finer: bool
    ) -> None:
        self._train, self._start, self._kinetic = train, start, kinetic
        self._period = train.scene.period
        nodes, weights = np.polynomial.legendre.leggauss(_POINTS[finer])
        self._rule = 0.5 * (1.0 + nodes), 0.5 * weights
        self._open: _Open | None = None
        self._sense, self._reached = 0.0, start
        scene = train.scene
        self._columns = len(scene.torque) + 1
        self._columns += len(scene.cylinders) if scene.friction else 0
        self._works, self._speeds = np.zeros(self._columns), np.empty(0)
        self._gas = GasWork(train, start, _POINTS[finer])
        self._passed = 0
        self.done: deque[_Done] = deque(maxlen=MOST_CYCLES)

    @property
    def left_out(self) -> int:
        """How many cycles were passed that are not kept."""
        return self._passed - len(self.done)

    def add(self, piece: Solved) -> None:
        """One piece more of the motion."""
        begin, end = piece.begin, piece.end
        if begin.theta == end.theta:
            self._speeds = np.append(self._speeds, 0.0)
            return
        sense = math.copysign(1.0, end.theta - begin.theta)
        self._go_on(begin.theta, sense)
        places = self._places(begin.theta, end.theta)
        marks = self._start + sense * self._period * np.array(places, dtype=np.float64)
        low, high = sorted((begin.theta, end.theta))
        at = piece.sample(Chosen(np.clip(marks, low, high), in_time=False))
        time = np.where(marks == begin.theta, begin.time, at.time)
        works, speeds = self._summed(piece, time)
        kinetic = self._kinetic(at)
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
        found = range(math.ceil(x - _SAME), math.floor(y + _SAME) + 1)
        return [k for k in found if k > x + _SAME or self._open is None]

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

    def _summed(self, piece: Solved, marks: Array) -> tuple[Array, Array]:
        """Between these times [s] and the ends of a piece: works [J], shape (n + 1, columns); least
        and largest speed [rad/s], shape (n + 1, 2)."""
        nodes = piece.nodes()
        edges = _merged(nodes.edges, np.append(marks, piece.end.time))
        panel = np.minimum(np.searchsorted(nodes.edges, edges[:-1]), len(nodes.points.time) - 1)
        whole = (nodes.edges[panel] == edges[:-1]) & (nodes.edges[panel + 1] == edges[1:])
        segment = np.searchsorted(marks, 0.5 * (edges[1:] + edges[:-1]))
        of_whole = Points(*(values[panel[whole]] for values in nodes.points))
        of_parts = self._between(piece, edges[:-1][~whole], edges[1:][~whole])
        works = np.zeros((len(marks) + 1, len(self._works)))
        for rows, points in ((whole, of_whole), (~whole, of_parts)):
            np.add.at(works, segment[rows], self._works_of(piece, points))
        time = np.concatenate([nodes.edges, of_whole.time.ravel(), of_parts.time.ravel()])
        speed = np.concatenate([nodes.speeds, of_whole.omega.ravel(), of_parts.omega.ravel()])
        order = np.argsort(time)
        return works, extremes(piece, marks, time[order], speed[order])

    def rows(self, count: int) -> Rows:
        """The last cycles, as many as are asked for."""
        done = list(self.done)[len(self.done) - count :]
        columns = {name: np.array([getattr(one, name) for one in done]) for name in _Done._fields}
        scene, sense = self._train.scene, columns["sense"]
        fired = len(scene.cylinders) if scene.fuel else 0  # given, as there may be no cycle
        before, after = (columns[name].reshape(count, fired) for name in ("before", "after"))
        works = columns["works"].reshape(count, self._columns)
        place = columns["place"].astype(np.int64)
        found = {
            "number": columns["number"].astype(np.float64),
            "time": columns["time"],
            "crank_angle": self._start + sense * self._period * place,
            "duration": columns["duration"],
            "mean_speed": sense * self._period / columns["duration"],
            "least_speed": columns["slowest"],
            "largest_speed": columns["fastest"],
            "kinetic_energy_gained": columns["gained"],
        }
        if scene.gas is not None:
            work = self._gas.works(place, sense, before, after)
            found |= {"gas_work": work, "imep": work / self._gas.swept}
        if scene.fuel is not None:
            found["fuel"] = self._gas.shares(sense, before, after)
        if scene.torque:
            found["load_work"] = works[:, : len(scene.torque)]
        if scene.motion is not None:
            found["drive_work"] = works[:, len(scene.torque)]
        if scene.friction is not None:
            found["friction_work"] = works[:, len(scene.torque) + 1 :]
        return Rows(found, {}, self.left_out + len(self.done) - count)

    def _between(self, piece: Solved, begin: Array, end: Array) -> Points:
        """Gauss points between times [s] of shape (n,)."""
        places, weights = self._rule
        width = (end - begin)[:, None]
        time = begin[:, None] + width * places
        found = piece.sample(Chosen(time.ravel(), in_time=True))
        theta, omega = (values.reshape(time.shape) for values in (found.theta, found.omega))
        return Points(time, theta, omega, width * weights * omega)

    def _works_of(self, piece: Solved, points: Points) -> Array:
        """Work [J] in each panel, shape (n, columns): of every load, of the drive, of the friction
        of every piston."""
        t, theta, omega, turned = points
        scene = self._train.scene
        works = np.zeros((len(t), self._columns))
        for number, load in acting(scene.torque, piece.begin.mode.loads):
            works[:, number - 1] = (load(t, theta, omega) * turned).sum(axis=1)
        if scene.motion is not None:
            drive = piece.sample(Chosen(t.ravel(), in_time=True)).own["external_torque"]
            works[:, len(scene.torque)] = (drive.reshape(t.shape) * turned).sum(axis=1)
        if scene.friction is not None:
            works[:, len(scene.torque) + 1 :] = self._rubbed(piece, points, scene.friction)
        return works

    def _rubbed(self, piece: Solved, points: Points, friction: Friction) -> Array:
        """Work of the friction of every piston [J], shape (n, cylinders)."""
        t, theta, omega, turned = points
        train, scene = self._train, self._train.scene
        shape = scene.crank.radius, scene.rod.length, scene.piston.offset
        modes = [piece.begin.mode, *(state.mode for state in piece.decisions)]
        which = np.searchsorted([state.time for state in piece.decisions], t)
        works = np.zeros((len(t), len(scene.cylinders)))
        for k, cylinder in enumerate(scene.cylinders):
            phi = theta + cylinder.phase
            rise, pressure = close_loop(phi, *shape).x_1, np.zeros_like(phi)
            if train.pressure is not None:
                pressure = train.pressure[k](phi)
            if train.combustion is not None and modes[0].shares:
                share = np.array([mode.shares[k] for mode in modes])[which]
                pressure = pressure + share * train.combustion[k](phi)
            force = friction.ring_force + friction.ring_pressure * np.abs(
                (scene.piston.gas_area or 0.0) * pressure
            )
            against = force * np.abs(rise * turned) + friction.viscous * rise**2 * omega * turned
            works[:, k] = -against.sum(axis=1)
        return works


def _merged(edges: Array, cuts: Array) -> Array:
    """Edges with cuts between them; a cut as near to an edge as rounding is none."""
    k = np.clip(np.searchsorted(edges, cuts), 1, len(edges) - 1)
    off = np.minimum(np.abs(cuts - edges[k - 1]), np.abs(cuts - edges[k]))
    return np.union1d(edges, cuts[off > _SAME * (edges[k] - edges[k - 1])])


def _shares_beside(
    piece: Solved, theta: float, sense: float
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
