"""How a run ends: a status, and the sentence that says so."""

from __future__ import annotations

import math
from enum import Enum

from crankmbs.scene.units import RPM

__all__ = ["Ending"]


class Ending(Enum):
    """Status 0: the end of the run is reached; 1: a physical end before it; -1: a numerical one."""

    COMPLETE = 0, "reached the end of the run"
    STUCK = 1, "at rest at {angle:.6g} degrees: no torque moves the crank from here"
    UNMOVED = 1, "did not move: at rest at {angle:.6g} degrees, where no torque turns the crank"
    HELD = (
        1,
        "held at {speed:.6g} rpm at {angle:.6g} degrees: a jump of the loads drives the speed back "
        "from both sides",
    )
    STICKS = (
        1,
        "at rest at {angle:.6g} degrees: friction, or a force against the sliding of a piston, "
        "holds the crank there",
    )
    REST = 1, "came to rest at {angle:.6g} degrees"
    SLOWED = 1, "came to rest at {angle:.6g} degrees, {time:.6g} s, before the end of the run"
    LAW_RESTS = (
        1,
        "the prescribed speed comes to rest at {angle:.6g} degrees, before the end of the run",
    )
    SWING = (
        1,
        "swings without reaching the end: {reversals} reversals, the last at {angle:.6g} degrees",
    )
    FOLD = (
        1,
        "the rod folds onto the crank at {angle:.6g} degrees, where the motion is not determined",
    )
    STALLS = (
        1,
        "does not settle: what the crank gets in a period is less than what its loads take at any "
        "lower speed, and it comes to a stop; give a smaller load, or one that grows with the "
        "speed",
    )
    FADES = (
        1,
        "does not settle: the loads take a part of the crank's energy in every period, at any "
        "speed, and it turns ever slower; give it a drive, such as gas or a torque",
    )
    SLOWS_DOWN = (
        1,
        "does not settle: the loads take more in a period than the crank gets, and it stops at "
        "{time:.6g} s, at {angle:.6g} degrees, where it {then}; give a smaller load, or one that "
        "grows with the speed",
    )
    TOO_LIGHT = (
        1,
        "does not settle: before its first cycle is over it stops at {time:.6g} s, at {angle:.6g} "
        "degrees, where it {then}, as its kinetic energy of {energy:.4g} J at the start carries it "
        "no farther; give a larger crank.inertia, a higher speed at the start, or a smaller load",
    )
    RUNS_AWAY = (
        1,
        "does not settle: what the crank gets in a period is more than what its loads take at any "
        "higher speed, and its speed grows without bound; give a load that grows with the speed",
    )
    BALANCED = (
        1,
        "does not settle: gas and loads balance one another at any speed, so that the motion from "
        "the start repeats itself; a load that grows with the speed settles it",
    )
    HUNTS = (
        1,
        "does not settle: the governor hunts, as what is off its steady motion grows by "
        "{factor:.4g} in a period; lower its gains",
    )
    SWINGS = (
        1,
        "does not settle: the governor hunts, from its least share to its greatest and back; lower "
        "its gains",
    )
    WANDERS = -1, "no periodic motion found within {periods} periods"
    COSTLY = (
        -1,
        "stopped at {angle:.6g} degrees: to follow the motion over time beyond it takes more than "
        "the {allowed} evaluations that the cost cap allows; raise it or ask for less",
    )
    LABOURS = (
        -1,
        "the step is not taken: the {allowed} evaluations of the motion that it may take lead to "
        "{angle:.6g} degrees; take shorter ones",
    )
    FAILED = -1, "stopped at {angle:.6g} degrees: no step over time is short enough there"
    PARTED = (
        -1,
        "two passes of different order end differently, at {angle:.6g} degrees and later",
    )
    DIVERGED = (
        -1,
        "stopped at {angle:.6g} degrees, {time:.6g} s: exudyn's Newton iteration does not "
        "converge, or a rod turns over at a fold",
    )
    CALLED_OFF = (
        -1,
        "stopped at {angle:.6g} degrees, {time:.6g} s: the whole run would take about {whole:g} "
        "s, above the cost cap of {cap:g} s",
    )

    def said(
        self, angle: float, speed: float = math.nan, **numbers: float | str
    ) -> tuple[int, str]:
        """Status and sentence.

        Parameters
        ----------
        angle [rad], speed [rad/s] : of the crank at the end; numbers : what else the sentence names

        >>> Ending.REST.said(angle=0.0)
        (1, 'came to rest at 0 degrees')
        """
        status, sentence = self.value
        return status, sentence.format(angle=math.degrees(angle), speed=speed / RPM, **numbers)
