"""What has been decided on the way: the discrete state that travels with a free motion.

A `Mode` is a part of every `crankmbs.motion.base.State`, so it goes through both passes, across
hand-overs between the formulations, and is what it was when whole periods are skipped. Between
decisions it is fixed, and with it the equation of motion is smooth. A decision falls where the
motion meets a time or a speed (ends of a branch of the loads) or a crank angle (`low` and `high` of
the mode): there a window or a stretch ends, landed on exactly, its `end` carries the mode that
`decided` makes of it, and the next one begins on the branch of that mode. A new kind of decision
is a field here, its value at the start in `begun`, and its rule in `decided`; where the loads or
the gas depend on it, they take the mode. Without anything to decide the mode is empty and costs
nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from crankmbs.mechanics.firing import Firing, FuelLaw
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phases, first_phases, later_phases

__all__ = ["Mode", "begun", "decided"]


class Mode(NamedTuple):
    """loads : phase of each load's window; low, high [rad] : the crank angles, backwards and
    forwards, at which the next decision falls; firing : what has been decided of the fuel;
    held : torque [N m] beside the scene's loads."""

    loads: Phases = ()
    low: float = -math.inf
    high: float = math.inf
    firing: Firing | None = None
    held: float = 0.0

    @property
    def shares(self) -> tuple[float, ...]:
        """The share of the combustion of each cylinder's firing; empty without fuel."""
        return self.firing.shares if self.firing else ()


def begun(train: CrankTrain) -> Mode:
    """The mode at the start.

    >>> begun(crank_train(load_scene("propeller"))).loads
    ()
    """
    scene, law = train.scene, train.law
    mode = Mode(first_phases(train.loads, scene.start.speed if scene.start else math.nan))
    return _fired(mode, law, law.first) if law else mode


def decided(train: CrankTrain, mode: Mode, time: float, theta: float, omega: float) -> Mode:
    """The mode after a window or stretch of this one has ended, at a time [s], a crank angle [rad]
    and a speed [rad/s].

    >>> train = crank_train(load_scene("propeller"))
    >>> decided(train, begun(train), 1.0, 300.0, 300.0) == begun(train)
    True
    """
    if mode.loads:
        phases = later_phases(train.loads, mode.loads, time, omega)
        mode = mode._replace(loads=phases)
    law, firing = train.law, mode.firing
    if law and firing and theta in (mode.low, mode.high):
        return _fired(mode, law, law.decided(firing, time, theta, omega))
    return mode


def _fired(mode: Mode, law: FuelLaw, firing: Firing) -> Mode:
    low, high = law.next(firing)
    return mode._replace(low=low, high=high, firing=firing)
