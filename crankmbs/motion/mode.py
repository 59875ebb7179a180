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

from crankmbs.mechanics.windows import Phases, first_phases, later_phases
from crankmbs.scene.scene import Scene

__all__ = ["Mode", "begun", "decided"]


class Mode(NamedTuple):
    """loads : phase of each load's window; low, high [rad] : the crank angles, backwards and
    forwards, at which the next decision falls."""

    loads: Phases = ()
    low: float = -math.inf
    high: float = math.inf


def begun(scene: Scene) -> Mode:
    """The mode at the start of a free crank.

    >>> begun(load_scene("propeller")).loads
    ()
    """
    assert scene.start is not None
    return Mode(first_phases(scene.torque, scene.start.speed))


def decided(scene: Scene, mode: Mode, time: float, omega: float) -> Mode:
    """The mode after a window or stretch of this one has ended, at a time [s] and a speed [rad/s].

    >>> scene = load_scene("propeller")
    >>> decided(scene, begun(scene), 1.0, 300.0) == begun(scene)
    True
    """
    if not mode.loads:
        return mode
    return mode._replace(loads=later_phases(scene.torque, mode.loads, time, omega))
