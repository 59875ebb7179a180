"""Where a motion that is stepped stands, and what a step is told."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from crankmbs.motion.assemble import Assembled
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending

__all__ = ["AT_REST", "Moving", "Standing", "Steps", "commanded", "said"]

AT_REST = (Ending.REST, Ending.STUCK, Ending.STICKS, Ending.HELD)
"""How a motion may end at rest; a step from there on rests."""


class Standing(NamedTuple):
    """Where a motion stands; all that its next step needs.

    states : of the answer, and of the other passes where there are
    ahead [rad], faster [rad/s] : the most by which the passes have differed so far, at equal time
    edges [rad] : of the crank angle's cells, where steps so far needed finer ones than at first
    ending : of the last step; COMPLETE where it came to its time. A broken one was not taken
    angle [rad] : crank angle at which it ended, or broke
    """

    states: tuple[State, ...]
    ahead: float = 0.0
    faster: float = 0.0
    ending: Ending = Ending.COMPLETE
    angle: float = math.nan
    edges: tuple[float, ...] = ()


class Moving(NamedTuple):
    """Crank angle [rad], speed [rad/s], acceleration [rad/s2], and the errors of the first two."""

    theta: float
    omega: float
    alpha: float
    ahead: float
    faster: float


class Steps(Protocol):
    """How a motion is stepped."""

    def begin(self) -> Standing:
        """Where it starts."""

    def advance(
        self, standing: Standing, until: float, torque: float, share: float | None
    ) -> Standing:
        """One step, up to a time [s], with a torque [N m] held throughout beside the scene's own
        loads, and the share of the combustion that decisions take; None: the scene's own."""

    def moving(self, standing: Standing) -> Moving:
        """The motion where it stands."""

    def said(self, standing: Standing) -> tuple[int, str]:
        """Status and sentence of its last step."""

    def assembled(self, standing: Standing) -> Assembled:
        """Every variable of a result where it stands, with its error."""


def commanded(state: State, torque: float, share: float | None) -> State:
    """A state with what a step is told.

    >>> commanded(State(0.0, 0.0, 1.0, 0.0), 2.0, None).mode.held
    2.0
    """
    firing = state.mode.firing
    firing = firing and firing._replace(imposed=share)
    return state._replace(mode=state.mode._replace(held=torque, firing=firing))


def said(standing: Standing, allowed: int = 0) -> tuple[int, str]:
    """Status and sentence of the last step; a crank at rest has come to its time.

    allowed : evaluations of a step

    >>> said(Standing((State(0.0, 0.0, 0.0, 0.0),), ending=Ending.STUCK, angle=0.0))
    (0, 'at rest at 0 degrees: no torque moves the crank from here')
    """
    omega = standing.states[0].omega
    if standing.ending is Ending.COMPLETE:
        return 0, "reached the time that was asked for"
    status, text = standing.ending.said(standing.angle, omega, allowed=allowed)
    return (0 if standing.ending in AT_REST and omega == 0.0 else status), text
