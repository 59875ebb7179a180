"""Sees the pieces of a motion as they come, and keeps the account of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.account import Account
from crankmbs.motion.base import Samples, Solved, State
from crankmbs.motion.cycles import Cycles, cycles_of
from crankmbs.motion.ending import Ending
from crankmbs.motion.events import Log, events_of
from crankmbs.numerics.arrays import Array

__all__ = ["Observer", "account_of"]


class Observer:
    """Of one pass over a motion.

    kinetic : the kinetic energy [J] at samples
    finer : whether it betters another pass, and is to be looked at in other places
    """

    def __init__(
        self, train: CrankTrain, kinetic: Callable[[Samples], Array], *, finer: bool
    ) -> None:
        self._train, self._kinetic, self._finer = train, kinetic, finer
        self.log = Log(train)

    def start(self, state: State) -> None:
        """The state in which the motion begins."""
        self.cycles = Cycles(self._train, state.theta, self._kinetic, finer=self._finer)
        if (
            not self._train.scene.settles
        ):  # a periodic motion has no start: what acts was decided before
            self.log.start(state)

    def add(self, piece: Solved) -> None:
        """The next piece of the motion."""
        self.log.add(piece)
        self.cycles.add(piece)

    def close(self, ending: Ending, last: State) -> None:
        """How the motion ended, and where."""
        self.log.close(ending, last)


def account_of(observers: Sequence[Observer], share: float) -> Account:
    """The account of a motion from several passes over it, the first of which is the answer.

    share : of the largest difference between them, that is stated as error
    """
    return Account(
        events_of([one.log for one in observers], share),
        cycles_of([one.cycles for one in observers], share),
    )
