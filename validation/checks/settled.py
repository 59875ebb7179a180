"""Settled motions and the flywheels sized on them, against the oracles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from crankmbs.design import flywheel, freed
from crankmbs.result import Result
from crankmbs.scene.parts import Friction
from crankmbs.scene.scene import Scene
from validation.adapter import machine_of
from validation.case import Case
from validation.checks.honest import scales, true_errors
from validation.judge import Outcome
from validation.oracles.free_motion import Motion
from validation.oracles.many_turns import many_turns
from validation.oracles.rubbing import Rings, rubbed_motion
from validation.oracles.settled import settled_motion
from validation.runs import run

__all__ = ["fluctuation", "long_run", "set_free", "stated_errors", "stated_ratio"]

_LEFT = 1e-14  # of a disturbance, after so many cycles
_FLOOR = 2e-11  # of the peak of what has the same unit: there no statement is asked for
_FACTOR = 1e-11  # the oracle's own error of the factor
_RANDOM = 2.0  # the true error may be this many times the stated one
_FINE = math.radians(0.5)


def long_run(case: Case) -> Outcome:
    """Every variable over the peak of its unit, against an oracle's run of as many cycles as it
    takes until nothing is left of a disturbance."""
    result, scene = run(case.ours()), case.theirs()
    assert result.decay is not None
    assert scene.start is not None
    cycles = math.ceil(math.log(_LEFT) / math.log(result.decay.factor))
    before = cycles * scene.settled_period
    angles = result.data["crank_angle"].values + before
    late = many_turns(machine_of(scene), scene.start.angle, scene.start.speed, angles)
    motion = Motion(late.time - late.time[0], late.theta - before, late.omega, late.alpha, 0)
    true, peaks = true_errors(result, scene, motion)
    scale = scales(peaks)
    errors = {name: error / scale[name] for name, error in true.items() if scale[name] > 0.0}
    worst = max(errors, key=lambda name: errors[name])
    return Outcome(errors[worst], f"{worst} {errors[worst]:.1e} after {cycles} cycles")


def stated_errors(case: Case) -> Outcome:
    """True error over twice the stated one, worst variable, and of the factor."""
    result = run(case.ours(), case.word("formulation"))
    ratio, what = stated_ratio(result, case.theirs())
    return Outcome(ratio / _RANDOM, what)


def fluctuation(case: Case) -> Outcome:
    """The oracle's fluctuation with the inertia found, over the one wanted, less 1; of a scene
    without a load also its mean speed over that of the start."""
    wanted = case.number("fluctuation")
    found, scene = flywheel(case.ours(), wanted), case.theirs()
    if found.status != 0:
        raise RuntimeError(found.message)
    crank = replace(scene.crank, inertia=found.inertia.value)
    if scene.torque:
        motion = _settled(found.result, replace(scene, crank=crank), _FINE)
        off = {}
    else:
        ours = found.result.scene
        free = replace(scene, crank=crank, motion=None, start=ours.start, torque=ours.torque)
        motion, mean = _one_period(free), abs(case.number("mean_speed"))
        passed = scene.settled_period / float(motion.time[-1])
        off = {"mean speed": abs(passed / mean - 1.0)}
        off["periodic"] = abs(float(motion.omega[-1] / motion.omega[0]) - 1.0)
    time, speed, rate = (
        np.asarray(part, dtype=np.float64) for part in (motion.time, motion.omega, motion.alpha)
    )
    path = CubicHermiteSpline(time, speed, rate)
    turns = path(path.derivative().roots(extrapolate=False))
    mean = (motion.theta[-1] - motion.theta[0]) / motion.time[-1]
    off["fluctuation"] = abs(float(np.ptp(turns) / abs(float(mean))) / wanted - 1.0)
    detail = ", ".join(f"{name} off by {value:.1e}" for name, value in off.items())
    return Outcome(max(off.values()), f"{found.inertia.value:.6g} kg m^2; {detail}")


def set_free(case: Case) -> Outcome:
    """What the oracle's crank misses of one period, and gains of its speed, in the time that a
    period takes at the speed prescribed, from the start and under the load of `freed`."""
    ours, scene = freed(case.ours()), case.theirs()
    assert ours.start is not None
    crank = replace(scene.crank, inertia=ours.crank.moment_of_inertia)
    free = replace(scene, crank=crank, motion=None, start=ours.start, torque=ours.torque)
    friction = free.friction or Friction()
    rings = Rings(friction.ring_force, friction.ring_pressure, friction.viscous)
    taken = np.array([0.0, free.settled_period / abs(case.number("mean_speed"))])
    found = rubbed_motion(machine_of(free), rings, ours.start.angle, ours.start.speed, taken)
    off = {
        "mean speed": abs(abs(float(np.ptp(found.theta))) / free.settled_period - 1.0),
        "periodic": abs(float(found.omega[-1] / found.omega[0]) - 1.0),
    }
    detail = ", ".join(f"{name} off by {value:.1e}" for name, value in off.items())
    (load,) = ours.torque
    return Outcome(max(off.values()), f"{load(0.0, 0.0, 0.0):.6g} N m; {detail}")


def stated_ratio(result: Result, scene: Scene) -> tuple[float, str]:
    """The worst true over stated error of a settled result, and where."""
    assert result.decay is not None
    theta = result.data["crank_angle"].values
    start = float(result.data["crank_speed"].values[0])
    found = settled_motion(
        machine_of(scene), theta[0], start, scene.settled_period, np.abs(theta - theta[0])
    )
    true, peaks = true_errors(result, scene, found.motion)
    scale = scales(peaks)
    ratios = {
        name: error / max(float(result.data[name].attrs["error_estimate"]), _FLOOR * scale[name])
        for name, error in true.items()
        if scale[name] > 0.0
    }
    apart = abs(found.factor - result.decay.factor)
    ratios["decay"] = apart / max(result.decay.error, _FACTOR)
    worst = max(ratios, key=lambda name: ratios[name])
    return ratios[worst], f"{worst}: true {true.get(worst, apart):.2e}, {ratios[worst]:.2g} stated"


def _settled(result: Result, scene: Scene, spacing: float) -> Motion:
    assert scene.start is not None
    offsets = np.arange(round(scene.settled_period / spacing) + 1) * spacing
    speed = float(result.data["crank_speed"].values[0])
    period = scene.settled_period
    return settled_motion(machine_of(scene), scene.start.angle, speed, period, offsets).motion


def _one_period(scene: Scene) -> Motion:
    assert scene.start is not None
    angles = np.arange(round(scene.settled_period / _FINE) + 1) * _FINE + scene.start.angle
    return many_turns(machine_of(scene), scene.start.angle, scene.start.speed, angles)
