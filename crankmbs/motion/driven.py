"""A prescribed motion in pieces, on each of which the crank turns one way or rests."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.errors import InputError
from crankmbs.mechanics.knots import KNOT, apart, repeat
from crankmbs.mechanics.speed import SpeedLaw
from crankmbs.mechanics.train import (
    CrankTrain,
    edges_over_angle,
    sign_changes,
    times_of,
)
from crankmbs.mechanics.windows import later_phases
from crankmbs.motion.base import State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.mode import Mode, begun, decided
from crankmbs.motion.plan import Plan
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.scene.units import DEGREE

__all__ = [
    "Driven",
    "Way",
    "begun_at",
    "decisions",
    "driven",
    "monotone_stretches",
    "windows_at",
]

_PANEL = 5.0 * DEGREE  # widest panel of a quadrature over the angle
_TURNS = 100  # periods in a piece


class Way(NamedTuple):
    """A prescribed motion: its law, and how many points of Gauss its cells have."""

    train: CrankTrain
    law: SpeedLaw
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

    @cached_property
    def cells(self) -> Cells:
        """Panels of at most 5 degrees, in which all that acts is smooth."""
        law, points = self.way.law, self.way.points
        edges, places = self._edges, ends_and_nodes(points).places
        time = edges[:-1, None] + np.diff(edges)[:, None] * places
        time[:, -1] = edges[1:]
        angle, speed, rate = law.at_time(time)
        rate[:, -1] = law.at_time(np.nextafter(time[:, -1], -math.inf))[2]  # before a corner
        sense = float(np.sign(self.end.theta - self.begin.theta))
        modes = [self.begin.mode, *(state.mode for state in self.decisions)]
        which = np.searchsorted([state.time for state in self.decisions], time[:, points // 2])
        shares = np.array([mode.shares for mode in modes])[which]
        acting = Acting(sense, phases=self.begin.mode.loads)
        return Cells(time, angle, speed, acting, shares, acceleration=rate)

    @property
    def _edges(self) -> Array:
        """Of the cells [s]."""
        begin, end = self.begin, self.end
        count = math.ceil(abs(end.theta - begin.theta) / _PANEL)
        low, high = sorted((begin.theta, end.theta))
        train, law = self.way.train, self.way.law
        panels = np.linspace(low, high, count + 1)[1:-1]
        inside = repeat(edges_over_angle(train), train.period, low, high)
        angles = apart(np.concatenate([panels, inside, *self._bends()]))
        kinks = [t for t in times_of(train.loads) if begin.time < t < end.time]
        corners = np.unique([begin.time, *law.corners(begin.time, end.time), *kinks, end.time])
        at = np.sort(law.at_time(corners)[0])
        after = np.clip(np.searchsorted(at, angles), 1, len(at) - 1)
        away = np.minimum(angles - at[after - 1], at[after] - angles)
        return np.unique([*corners, *law.time_at(angles[away > KNOT], begin.time, end.time)])

    def _bends(self) -> Iterator[Array]:
        """Crank angles [rad] at which fuel is decided, and between them those at which a gas force
        with the shares that act there changes its sign under rings."""
        train = self.way.train
        states = [self.begin, *self.decisions, self.end]
        yield np.array([state.theta for state in self.decisions])
        if train.combustion is not None:
            for state, after in pairwise(states):
                changes = sign_changes(train, state.mode.shares)
                yield repeat(changes, train.period, *sorted((state.theta, after.theta)))


def driven(way: Way, stretches: Iterable[tuple[float, float]]) -> Iterator[Driven]:
    """The pieces on stretches of time [s], as `monotone_stretches` finds them."""
    train, law = way.train, way.law
    mode = begun(train)
    stretches = tuple(stretches)
    for k, (begin, end) in enumerate(stretches):
        first = _state(law, begin, mode, turns=k > 0)
        last = _state(law, end, mode, turns=k + 1 < len(stretches))
        rests = float(law.at_time(0.5 * (begin + end))[1]) == 0.0
        last = last._replace(theta=first.theta) if rests else last
        for state in _apart(train, law, first, last):
            first = first._replace(mode=mode)
            inside = () if rests else tuple(decisions(train, law, first, state))
            mode = windows_at(train, inside[-1].mode if inside else mode, state.time)
            state = state._replace(mode=mode)
            yield Driven(way, first, state, inside)
            first = state


def _apart(train: CrankTrain, law: SpeedLaw, first: State, last: State) -> Iterator[State]:
    """States on the way from one to another, not too many periods apart and where a load's window
    begins or ends, and the last."""
    count = math.ceil(abs(last.theta - first.theta) / (_TURNS * train.scene.period))
    angles = np.linspace(first.theta, last.theta, count + 1)[1:-1]
    windows = [load.given for load in train.loads]
    ends = {end for one in windows for end in (one.after, one.until) if end is not None}
    inside = [end for end in ends if first.time < end < last.time]
    for time in np.unique([*law.time_at(angles, first.time, last.time), *inside]).tolist():
        theta, omega, _ = law.at_time(time)
        yield State(time, float(theta), float(omega), 0.0)
    yield last


def windows_at(train: CrankTrain, mode: Mode, time: float) -> Mode:
    """A mode with what the loads' windows are at a later time [s]."""
    return mode._replace(loads=later_phases(train.loads, mode.loads, time, math.nan))


def begun_at(way: Way) -> State:
    """The state in which a prescribed motion begins."""
    return _state(way.law, 0.0, begun(way.train), turns=False)


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


def monotone_stretches(plan: Plan, law: SpeedLaw) -> tuple[list[tuple[float, float]], bool]:
    """Stretches (begin, end) [s] up to the end of the run; and whether that comes.

    Raises
    ------
    InputError : a speed table that ends before the run does
    """
    stretches: list[tuple[float, float]] = []
    begin = 0.0
    for turn in law.turning_times:
        end = min(turn, plan.time_bound)
        sense = float(law.at_time(begin + 1.0 if math.isinf(end) else 0.5 * (begin + end))[1])
        bound = plan.angle_bounds[1 if sense > 0.0 else 0]
        if sense != 0.0 and math.isfinite(bound):
            passed = math.inf if math.isinf(end) else (float(law.at_time(end)[0]) - bound) * sense
            if passed >= -1e-13 * abs(bound):
                stretches.append((begin, float(law.time_at(bound, begin, end)[0])))
                return stretches, True
        if sense == 0.0 and math.isinf(end):
            return stretches, False
        stretches.append((begin, end))
        if end == plan.time_bound:
            return stretches, True
        begin = end
    degrees = float(law.at_time(begin)[0]) / DEGREE
    raise InputError(
        f"motion.speed: the speed table ends at {begin:g} s, before the run does, at "
        f"{degrees:g} degrees; lengthen the table or shorten the run"
    )
