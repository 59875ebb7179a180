"""The account of a motion that can be followed again: its events and its whole cycles."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.account import Account
from crankmbs.motion.base import Segment, State
from crankmbs.motion.cycles import Cycles, cycles_of
from crankmbs.motion.ending import Ending
from crankmbs.motion.events import Log, events_of

__all__ = ["Followed", "account_of"]


class Followed(NamedTuple):
    """A pass over a motion: the state in which it begins, its pieces as they come, its ending."""

    train: CrankTrain
    begin: State
    pieces: Iterable[Segment]
    ending: Ending


def account_of(passes: Sequence[Followed], share: float) -> Account:
    """The account of a motion from several passes over it, the first of which is the answer.

    share : of the largest difference between them, that is stated as error
    """
    logs, cycles = [], []
    for train, begin, pieces, ending in passes:
        logs.append(Log(train))
        cycles.append(Cycles(train, begin.theta))
        if not train.scene.settles:  # a periodic motion has no start: what acts was decided before
            logs[-1].start(begin)
        last = begin
        for piece in pieces:
            logs[-1].add(piece)
            cycles[-1].add(piece)
            last = piece.end
        logs[-1].close(ending, last)
    return Account(events_of(logs, share), cycles_of(cycles, share))
