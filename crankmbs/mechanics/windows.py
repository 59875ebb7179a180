"""When a load acts: it sets in once a time and a speed have been met, and ends for good.

A load waits until its `from_speed` has been met, then until the time `after`; it acts; and it is
over at the time `until` or where, after it set in, `until_speed` is met. A speed is met when the
crank's, with its sign, first equals it, from either side. So each load goes through its phases in
one order, and within a phase nothing of this changes: a phase ends at a time or at a speed, on
which the solvers land.
"""

from __future__ import annotations

from enum import IntEnum

from crankmbs.scene.torque import Acting
from crankmbs.scene.windowed import Windowed

__all__ = [
    "Phase",
    "Phases",
    "acting",
    "first_phases",
    "later_phases",
    "phase_ends",
    "place_of",
]


class Phase(IntEnum):
    """Of one load: its speed is not met; it waits for its time; it acts; it is over."""

    WAITING = 0
    DUE = 1
    ACTING = 2
    OVER = 3


Phases = tuple[Phase, ...]
"""One for each load; empty where no load has a window, and all act throughout."""


def first_phases(torques: tuple[Acting, ...], omega: float) -> Phases:
    """The phases at time 0.

    >>> first_phases((Constant(torque=2.0, after=1.0),), 5.0)
    (<Phase.DUE: 1>,)
    """
    if not any(load.given.has_window for load in torques):
        return ()
    return later_phases(torques, (Phase.WAITING,) * len(torques), 0.0, omega)


def later_phases(torques: tuple[Acting, ...], phases: Phases, t: float, omega: float) -> Phases:
    """The phases after landing at a time [s] and a speed [rad/s], which must be met exactly."""
    return tuple(
        _later(load.given, phase, t, omega) for load, phase in zip(torques, phases, strict=False)
    )


def _later(load: Windowed, phase: Phase, t: float, omega: float) -> Phase:
    if load.until is not None and t >= load.until:
        return Phase.OVER
    if phase is Phase.ACTING and omega == load.until_speed:
        return Phase.OVER
    if phase is Phase.WAITING and load.from_speed in (None, omega):
        phase = Phase.DUE
    if phase is Phase.DUE and t >= (load.after or 0.0):
        phase = Phase.ACTING
    return phase


def acting(torques: tuple[Acting, ...], phases: Phases) -> tuple[tuple[int, Acting], ...]:
    """The loads that act, each with its number from 1."""
    numbered = tuple(enumerate(torques, start=1))
    return tuple(one for one in numbered if not phases or phases[one[0] - 1] is Phase.ACTING)


def place_of(loads: tuple[Acting | Windowed, ...], number: int) -> str:
    """Where in a scene the load with a number among all stands, as in every message.

    >>> place_of((Constant(torque=2.0), Constant(torque=1.0)), 2)
    'torque[2]'
    """
    headings = [load.given.heading for load in loads[:number]]
    return f"{headings[-1]}[{headings.count(headings[-1])}]"


def phase_ends(
    torques: tuple[Acting, ...], phases: Phases
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times [s] and speeds [rad/s] at which a phase may end."""
    times: list[float] = []
    speeds: list[float] = []
    for load, phase in zip((each.given for each in torques), phases, strict=False):
        if phase is Phase.WAITING and load.from_speed is not None:
            speeds.append(load.from_speed)
        if phase is Phase.DUE and load.after is not None:
            times.append(load.after)
        if phase is Phase.ACTING:
            times += [] if load.until is None else [load.until]
            speeds += [] if load.until_speed is None else [load.until_speed]
    return tuple(times), tuple(speeds)
