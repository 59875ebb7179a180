"""Means over the last cycle, against Gauss's rule between the pressure's knots."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.measures import Estimate, Measures, measure
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from validation.adapter import machine_of
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import LONG
from validation.oracles.free_motion import series_path
from validation.oracles.many_turns import many_turns
from validation.oracles.means import Means, Stretch, means
from validation.oracles.rubbing import Rings
from validation.runs import run

__all__ = ["between_samples", "joint_forces"]

_ROUNDING = 1e-12  # of the value: what the oracle errs, with room for rounding in the measures


class _Compared(NamedTuple):
    """What a measure is called, what it is, and what it should be."""

    name: str
    ours: Estimate
    theirs: float


def joint_forces(case: Case) -> Outcome:
    """The mean of every joint's force: its true error over the stated one and rounding, and the
    stated one over what it may be, the worst of both over all joints.

    Parameters of the case: `coarsest`, the largest error that may be stated, of the mean.
    """
    result, scene = run(case.ours()), case.theirs()
    found = means(machine_of(scene), _last_cycle(scene))
    return _judged(_joints(measure(result), found), case.number("coarsest"))


def between_samples(case: Case) -> Outcome:
    """The same of all means, of a run in time whose last cycle begins between two samples: speed,
    torques and joint forces."""
    result, scene = run(case.ours()), case.theirs()
    found = means(machine_of(scene), _cycle_before(result, scene))
    ours = measure(result)
    speed = float(scene.period) / found.duration
    compared = [
        _Compared("mean speed", ours.mean_speed, speed),
        _Compared("crank torque", ours.crank_torque, found.crank_torque),
        _Compared("external torque", ours.external_torque, found.external_torque),
    ]
    return _judged([*compared, *_joints(ours, found)], case.number("coarsest"))


def _judged(compared: list[_Compared], coarsest: float) -> Outcome:
    worst, what = 0.0, ""
    for name, (value, stated), true in compared:
        error = abs(value - true)
        share = max(error / (stated + _ROUNDING * abs(true)), stated / (coarsest * abs(true)))
        if not share <= worst:
            worst = share if math.isfinite(share) else math.inf
            what = f"{name} {value:.10g}, stated error {stated:.1e}, true {true:.10g}"
    return Outcome(worst, what)


def _joints(ours: Measures, found: Means) -> list[_Compared]:
    pairs = []
    for joint in ours.joints:
        theirs = getattr(found, joint.joint.replace(" ", "_"))
        number = joint.cylinder
        name = joint.joint if number is None else f"{joint.joint} {number}"
        value = float(theirs if number is None else theirs[number - 1])
        pairs.append(_Compared(f"mean force of the {name}", joint.mean, value))
    return pairs


def _last_cycle(scene: Scene) -> Stretch:
    """Of a run to an angle: where it begins, and how fast the crank turns there."""
    until, in_time = scene.end
    assert not in_time
    before = until - scene.period
    if scene.motion is not None:
        assert isinstance(scene.motion.speed, float)
        rings = None
        if scene.friction is not None:
            friction = scene.friction
            rings = Rings(friction.ring_force, friction.ring_pressure, friction.viscous)
        begin = scene.motion.angle + before
        return Stretch(begin, scene.period, scene.motion.speed, free=False, rings=rings)
    assert scene.start is not None
    begin = scene.start.angle + before
    motion = many_turns(machine_of(scene), scene.start.angle, scene.start.speed, np.array([begin]))
    return Stretch(begin, scene.period, motion.omega[0], free=True)


def _cycle_before(result: Result, scene: Scene) -> Stretch:
    """The cycle before the end in time of a free run."""
    until, in_time = scene.end
    assert in_time
    assert result.status == 0
    assert scene.start is not None
    machine, start = machine_of(scene), scene.start
    path = series_path(machine, start.angle, start.speed)
    begin = path.at_times(LONG.array([until])).theta[0] - LONG.whole_turns(scene.period)
    motion = many_turns(machine, start.angle, start.speed, np.array([begin]))
    return Stretch(begin, LONG.whole_turns(scene.period), motion.omega[0], free=True)
