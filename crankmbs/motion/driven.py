"""A prescribed motion in pieces, on each of which the crank turns one way or rests."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.knots import KNOT, apart, repeat
from crankmbs.mechanics.speed import SpeedLaw
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots
from crankmbs.motion.base import Nodes, Points, Samples, State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode, begun, decided
from crankmbs.motion.observer import Observer
from crankmbs.motion.plan import Wanted
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.scene.units import DEGREE

__all__ = ["Driven", "Moving", "Way", "decisions", "driven", "driven_observer", "own_energy"]


Moving = Callable[[Array, Array | None], Samples]
"""Samples at times [s] and the shares of the combustion there, shape (n, cylinders), if any; they
have "kinetic_energy" and "external_torque" of their own."""

_PANEL = 5.0 * DEGREE  # widest panel of a quadrature over the angle
_TURNS = 100  # periods in a piece


class Way(NamedTuple):
    """A prescribed motion: its law, its samples, and into how many points of Gauss a panel of a
    quadrature is divided, that ends at the knots of the pressure."""

    train: CrankTrain
    law: SpeedLaw
    moving: Moving
    points: int


@dataclass(frozen=True)
class Driven:
    """A stretch of a prescribed motion; exact but for rounding.

    decisions : the states at which the fuel is decided, each with the mode after
    """

    way: Way
    begin: State
    end: State
    decisions: tuple[State, ...]

    def cells(self) -> Cells:
        """Its panels as cells of a motion."""
        law, points = self.way.law, self.way.points
        edges, places = self.nodes().edges, ends_and_nodes(points).places
        time = edges[:-1, None] + np.diff(edges)[:, None] * places
        angle, speed, rate = law.at_time(time)
        rate[:, -1] = law.at_time(np.nextafter(time[:, -1], -math.inf))[2]  # before a corner
        sense = float(np.sign(self.end.theta - self.begin.theta))
        modes = [self.begin.mode, *(state.mode for state in self.decisions)]
        which = np.searchsorted([state.time for state in self.decisions], time[:, points // 2])
        shares = np.array([mode.shares for mode in modes])[which]
        return Cells(time, angle, speed, Acting(sense), shares, acceleration=rate)

    def nodes(self) -> Nodes:
        """Panels of at most 5 degrees, and Gauss points in them."""
        begin, end = self.begin, self.end
        count = math.ceil(abs(end.theta - begin.theta) / _PANEL)
        low, high = sorted((begin.theta, end.theta))
        train, law = self.way.train, self.way.law
        knots = repeat(crank_angle_knots(train), train.period, low, high)
        decided = [state.theta for state in self.decisions]
        angles = apart(np.concatenate([np.linspace(low, high, count + 1)[1:-1], knots, decided]))
        corners = np.unique([begin.time, *law.corners(begin.time, end.time), end.time])
        at = np.sort(law.at_time(corners)[0])
        after = np.clip(np.searchsorted(at, angles), 1, len(at) - 1)
        away = np.minimum(angles - at[after - 1], at[after] - angles)
        edges = np.unique([*corners, *self._times(angles[away > KNOT])])
        width = np.diff(edges)[:, None]
        places, weights = np.polynomial.legendre.leggauss(self.way.points)
        time = edges[:-1, None] + 0.5 * width * (1.0 + places)
        theta, omega, _ = law.at_time(time)
        return Nodes(
            edges, law.at_time(edges)[1], Points(time, theta, omega, 0.5 * width * weights * omega)
        )

    def sample(self, plan: Wanted) -> Samples:
        """Its samples where they are wanted."""
        if plan.in_time:
            time = plan.between(self.begin.time, self.end.time)
        else:
            time = self._times(plan.between(self.begin.theta, self.end.theta))
        modes = [self.begin.mode, *(state.mode for state in self.decisions)]
        if not modes[0].shares:
            return self.way.moving(time, None)
        which = np.searchsorted([state.time for state in self.decisions], time)
        return self.way.moving(time, np.array([mode.shares for mode in modes])[which])

    def _times(self, angles: Array) -> Array:
        """When it passes crank angles [rad]."""
        return self.way.law.time_at(angles, self.begin.time, self.end.time)


def driven(way: Way, stretches: Iterable[tuple[float, float]]) -> Iterator[Driven]:
    """The pieces on stretches of time [s], as `crankmbs.motion.prescribed` finds them."""
    train, law = way.train, way.law
    mode = begun(train)
    stretches = tuple(stretches)
    for k, (begin, end) in enumerate(stretches):
        first = _state(law, begin, mode, turns=k > 0)
        last = _state(law, end, mode, turns=k + 1 < len(stretches))
        if float(law.at_time(0.5 * (begin + end))[1]) == 0.0:
            yield Driven(way, first, last._replace(theta=first.theta), ())
            continue
        for state in _apart(law, first, last, _TURNS * train.scene.period):
            first = first._replace(mode=mode)
            found = tuple(decisions(train, law, first, state))
            mode = found[-1].mode if found else mode
            state = state._replace(mode=mode)
            yield Driven(way, first, state, found)
            first = state


def _apart(law: SpeedLaw, first: State, last: State, most: float) -> Iterator[State]:
    """States on the way from one to another, no more than an angle [rad] apart, and the last."""
    count = math.ceil(abs(last.theta - first.theta) / most)
    for angle in np.linspace(first.theta, last.theta, count + 1)[1:-1].tolist():
        time = float(law.time_at(np.array([angle]), first.time, last.time)[0])
        yield State(time, angle, float(law.at_time(time)[1]), 0.0)
    yield last


def driven_observer(
    train: CrankTrain, pieces: Iterable[Driven], *, finer: bool, rests: bool
) -> Observer:
    """What is seen of a prescribed motion.

    rests : whether the law comes to rest at the end of the pieces
    """
    observer = Observer(train, own_energy, finer=finer)
    last = None
    for piece in pieces:
        if last is None:
            observer.start(piece.begin)
        observer.add(piece)
        last = piece.end
    assert last is not None
    observer.close(Ending.LAW_RESTS if rests else Ending.COMPLETE, last)
    return observer


def own_energy(samples: Samples) -> Array:
    """The kinetic energy [J] that samples have of their own."""
    return samples.own["kinetic_energy"]


def _state(law: SpeedLaw, time: float, mode: Mode, *, turns: bool) -> State:
    theta, omega, _ = law.at_time(time)
    return State(time, float(theta), 0.0 if turns else float(omega), 0.0, mode)


def decisions(train: CrankTrain, law: SpeedLaw, first: State, last: State) -> Iterator[State]:
    """The decisions on the fuel from one state to another, the end included."""
    mode = first.mode
    while True:
        angle = mode.high if last.theta > first.theta else mode.low
        if not min(first.theta, last.theta) <= angle <= max(first.theta, last.theta):
            return
        time = float(law.time_at(np.array([angle]), first.time, last.time)[0])
        omega = float(law.at_time(time)[1])
        mode = decided(train, mode, time, angle, omega)
        yield State(time, angle, omega, 0.0, mode)
