"""A solved motion: the cells it was solved in, as a function of time and of crank angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples
from crankmbs.motion.cells import Acting, Cells, cell_of
from crankmbs.motion.states import samples_at
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.once import once

__all__ = ["Motion", "Passes"]

_SAME_TIME = 8 * float(np.finfo(float).eps)  # of it: rounding
_SAME_ANGLE = 1e-9  # rad: rounding of an angle must not lose a cycle


class _Solved(Protocol):
    """A stretch of a motion that can give its cells."""

    @property
    def cells(self) -> Cells:
        """All of them."""


@runtime_checkable
class _Long(Protocol):
    """One that can give those near its end alone."""

    def ending(self, turned: float) -> Cells:
        """Its cells from one on that begins so far before its end [rad], or all."""


class Motion:
    """A rotation as it was solved, from its begin to its end, or what is kept of it.

    train : the machine that moves
    """

    def __init__(self, train: CrankTrain, pieces: Sequence[_Solved | Cells]) -> None:
        self.train = train
        self._pieces = list(pieces)

    @classmethod
    def of_one(cls, train: CrankTrain, samples: Samples) -> Motion:
        """That of a run that ends where it begins: the first of its samples."""
        rows = (samples.time, samples.theta, samples.omega, samples.alpha)
        time, angle, speed, rate = (np.full((1, 3), row[0]) for row in rows)
        shares = samples.computed.get("fuel", np.empty((1, 0)))[:1]
        return cls(train, [Cells(time, angle, speed, Acting(0.0), shares, acceleration=rate)])

    @cached_property
    def cells(self) -> tuple[Cells, ...]:
        """All cells, stretch by stretch."""
        return tuple(self._cells(k) for k in range(len(self._pieces)))

    def _cells(self, k: int) -> Cells:
        """Of one stretch."""
        piece = self._pieces[k]
        return piece if isinstance(piece, Cells) else piece.cells

    def _ending(self, k: int, turned: float) -> Cells:
        """The cells of one stretch, as far as it turns through an angle [rad] up to its end."""
        piece = self._pieces[k]
        return piece.ending(turned) if isinstance(piece, _Long) else self._cells(k)

    @property
    def begin(self) -> float:
        """Time [s] at which it begins."""
        return float(self._cells(0).time[0, 0])

    @property
    def end(self) -> float:
        """Time [s] at which it ends."""
        return float(self._cells(len(self._pieces) - 1).time[-1, -1])

    @property
    def turned(self) -> float:
        """Crank angle at its end less that at its begin [rad]."""
        first, last = self._cells(0), self._cells(len(self._pieces) - 1)
        return float(last.angle[-1, -1] - first.angle[0, 0])

    @property
    def turns_one_way(self) -> bool:
        """Whether the crank neither rests nor turns back."""
        senses = {each.acting.sense for each in self.cells}
        return len(senses) == 1 and 0.0 not in senses

    def at(self, values: Array, *, in_time: bool) -> Samples:
        """The motion at times [s], or else at crank angles [rad], shape (p,) in any order.

        At a time at which a load sets in, ends or jumps it is the motion after, as a sample is.
        Values beyond an end are taken at the end. By angles only where the crank turns one way.
        """
        if in_time:
            begins = np.array([float(each.time[0, 0]) for each in self.cells[1:]])
            piece = np.searchsorted(begins, values + _SAME_TIME * np.abs(values), side="right")
        else:
            sense = self.cells[0].acting.sense
            ends = [sense * float(each.angle[-1, -1]) for each in self.cells]
            piece = cell_of(np.array(ends), sense * values)
        order = [np.flatnonzero(piece == number) for number in np.unique(piece)]
        parts = [
            samples_at(self.cells[piece[which[0]]], self.train, values[which], in_time=in_time)
            for which in order
        ]
        return Samples.joined(parts).select(np.argsort(np.concatenate(order)))

    def after(self, time: float) -> Motion:
        """Its part from a time [s] on."""
        for number in reversed(range(len(self._pieces))):
            cells = self._cells(number)
            if cells.time[0, 0] <= time or number == 0:
                k = max(int(np.searchsorted(cells.time[:, 0], time, side="right")) - 1, 0)
                at = np.array([max(time, float(cells.time[k, 0]))])
                x = float(cells.place(np.array([k]), at, in_time=True)[0])
                return Motion(self.train, [cells.since(k, x), *self._pieces[number + 1 :]])
        return self

    @once
    def last(self, turned: float) -> Motion | None:
        """Its end, in which the crank turns through an angle [rad]; None where it does not."""
        last = len(self._pieces) - 1
        cells = self._ending(last, turned)
        final = float(cells.angle[-1, -1])
        for number in reversed(range(last + 1)):
            cells = cells if number == last else self._ending(number, turned)
            away = np.abs(final - cells.angle[:, 0])
            before = np.flatnonzero(away >= turned - _SAME_ANGLE)
            if len(before):
                k = int(before[-1])
                x = 0.0
                if away[k] > turned + _SAME_ANGLE:
                    wanted = final + math.copysign(turned, cells.angle[k, 0] - final)
                    x = float(cells.place(np.array([k]), np.array([wanted]), in_time=False)[0])
                return Motion(self.train, [cells.since(k, x), *self._pieces[number + 1 :]])
        return None


class Passes(NamedTuple):
    """A motion that was solved several times: the answer, others that check it, and the share of
    the largest difference that is stated as error.

    The error of any number read from the motion is that share of the largest difference from the
    same number of the others; infinite where there is no other.
    """

    answer: Motion
    checks: tuple[Motion, ...]
    share: float = 1.0
