"""What happens on the way of a motion, in its order, read off its pieces."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phase
from crankmbs.motion.account import Kind, Rows, beside
from crankmbs.motion.base import State, Stretched
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode

__all__ = ["MOST_EVENTS", "Log", "events_of"]

MOST_EVENTS = 10_000
"""More decisions on the fuel are left out, all of them; of other events the first are kept."""

_AT_REST = {
    Ending.REST,
    Ending.STUCK,
    Ending.STICKS,
    Ending.UNMOVED,
    Ending.SLOWED,
    Ending.LAW_RESTS,
}
_SAME = 1e-7  # rad: decisions so near one another are one


class _Event(NamedTuple):
    """Time [s], crank angle [rad] and speed [rad/s]; of which cylinder or load, from 1, or which
    sense (a sign); the share that is decided, else NaN."""

    time: float
    theta: float
    omega: float
    kind: Kind
    number: int
    share: float

    @property
    def name(self) -> tuple[int, int]:
        """What two passes over one motion both call it."""
        return self.kind, self.number


class Log:
    """The events of one motion, from its pieces as they come.

    A decision on the fuel stands at its crank angle, a load at the time or speed that it waits for,
    rest and reversal at speed 0; the other values there, and where a load over time or a table
    holds the crank no longer, are as exact as the solution.
    """

    def __init__(self, train: CrankTrain) -> None:
        self._train = train
        self._phases = np.array([c.phase for c in train.scene.cylinders])
        self._noted: list[_Event] = []
        self._count: Counter[bool] = Counter()  # by whether they are decisions on the fuel
        self._sense, self._rests = 0.0, False

    def start(self, state: State) -> None:
        """What is decided at the start."""
        before = tuple(
            Phase.WAITING if load.given.has_window else phase
            for load, phase in zip(self._train.loads, state.mode.loads, strict=False)
        )
        self._change(state.mode._replace(loads=before, firing=None), state, everywhere=True)

    def add(self, piece: Stretched) -> None:
        """One piece more of the motion."""
        begin, end, mode = piece.begin, piece.end, piece.begin.mode
        if begin.omega == 0.0 == end.omega and begin.theta == end.theta:
            self._come_to_rest(begin)
        else:
            # the speed keeps its sign in a piece, of which the angle may not change by a digit
            turns = begin.omega + end.omega or end.theta - begin.theta
            sense = math.copysign(1.0, turns)
            if self._rests:
                self._note(begin._replace(omega=0.0), Kind.START, int(sense))
            elif begin.omega == 0.0 and sense == -self._sense:
                self._note(begin, Kind.REVERSAL, int(sense))
            self._sense, self._rests = sense, False
        for state in (*piece.decisions, end):
            self._change(mode, state)
            mode = state.mode

    def close(self, ending: Ending, last: State) -> None:
        """The end of the motion: how it ended, and where."""
        if ending in _AT_REST or (ending is Ending.HELD and last.omega == 0.0):
            self._come_to_rest(last._replace(omega=0.0))

    def _come_to_rest(self, state: State) -> None:
        if not self._rests:
            self._note(state, Kind.REST, 0)
        self._rests = True

    def _change(self, before: Mode, state: State, *, everywhere: bool = False) -> None:
        """What a decision has changed.

        everywhere : whether every cylinder decides, not those alone whose angle it is
        """
        after = state.mode
        if after.loads != before.loads:
            for number, (old, new) in enumerate(zip(before.loads, after.loads, strict=True), 1):
                if new is Phase.ACTING and old is not new:
                    self._note(state, Kind.LOAD_ON, number)
                if new is Phase.OVER and old is Phase.ACTING:
                    self._note(state, Kind.LOAD_OFF, number)
        if after.firing != before.firing and after.firing is not None:
            period = self._train.scene.period
            off = np.remainder(state.theta + self._phases - math.pi + 0.5 * period, period)
            decide = np.abs(off - 0.5 * period) < _SAME
            for k in np.flatnonzero(decide | everywhere).tolist():
                self._note(state, Kind.FUEL, k + 1, after.shares[k])

    def _note(self, state: State, kind: Kind, number: int, share: float = math.nan) -> None:
        of_fuel = kind is Kind.FUEL
        self._count[of_fuel] += 1
        if self._count[of_fuel] <= MOST_EVENTS:
            self._noted.append(_Event(*state[:3], kind, number, share))

    @property
    def events(self) -> list[_Event]:
        """Those that are kept, in their order."""
        without = self._count[True] > MOST_EVENTS
        return [each for each in self._noted if not (without and each.kind is Kind.FUEL)]

    @property
    def left_out(self) -> int:
        """How many are not kept."""
        return self._count.total() - len(self.events)


def events_of(logs: Sequence[Log], share: float) -> Rows:
    """The events of a motion that was followed several times, with their errors.

    Those that all have: what comes after they part is left out, but for a rest at the end of all.

    share : of the largest difference, that is stated
    """
    noted = [log.events for log in logs]
    names = zip(*([event.name for event in each] for each in noted), strict=False)
    alike = itertools.takewhile(lambda row: len(set(row)) == 1, names)
    count = sum(1 for _ in alike)
    longer = [each for each in noted if len(each) > count]
    rests = len(longer) == len(noted) and all(each[-1].kind is Kind.REST for each in noted)
    kept = [each[:count] + each[-1:] if rests else each[:count] for each in noted]
    return beside([_rows(each, log.left_out) for each, log in zip(kept, logs, strict=True)], share)


def _rows(events: list[_Event], left_out: int) -> Rows:
    names = ("time", "crank_angle", "crank_speed", "kind", "number", "share")
    table = np.array(events, dtype=np.float64).reshape(-1, len(names)).T
    return Rows(dict(zip(names, table, strict=True)), {}, left_out)
