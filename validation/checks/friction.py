"""Friction of the pistons: against an oracle over random scenes, and the energy it takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson

from crankmbs.measures import measure
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.result import Result
from crankmbs.scene.parts import Friction
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import machine_of
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.rubbing import Rings, rubbed_motion
from validation.random_friction import random_friction
from validation.runs import run

__all__ = ["closes", "confirmed", "mean_pressure", "random_errors", "true_over_stated"]

Floats = NDArray[np.float64]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_FLOOR = 1e-10  # of the peak, what the oracle itself errs
_CONFIRMED = (
    "friction_force",
    "main_bearing_force_x",
    "crank_pin_force_x",
    "piston_pin_force_y",
    "side_force",
    "crank_torque",
    "external_torque",
)
_BESIDE = 1e-6  # rad: so near an angle where friction or gas jump either value is right


def random_errors(case: Case) -> Outcome:
    """True over twice the stated error of angle, speed, acceleration and friction, the worst of all
    scenes and formulations."""
    worst, what = 0.0, ""
    first, count = int(case.parameters["first"]), int(case.parameters["scenes"])
    for seed in range(first, first + count):
        scene = random_friction(seed)
        assert scene.friction is not None
        friction = _scaled(scene.friction, case.number("ring_force"), case.number("viscous"))
        for formulation in ("crank_angle", "minimal"):
            result = simulate(replace(scene, friction=friction), formulation=formulation)
            ratio, name = true_over_stated(result, scene)
            if ratio >= worst:
                worst, what = ratio, f"{name} of seed {seed}, {formulation}"
    return Outcome(worst / _TOO_SMALL, f"{what}: {worst:.2g} times stated; {count} scenes")


def true_over_stated(result: Result, scene: Scene) -> tuple[float, str]:
    """The worst true over stated error of a run, and of what."""
    assert scene.start is not None
    assert scene.friction is not None
    data = result.data
    rings = Rings(scene.friction.ring_force, scene.friction.ring_pressure, scene.friction.viscous)
    begin = scene.start.angle, scene.start.speed
    found = rubbed_motion(machine_of(scene), rings, *begin, data["time"].values)
    beside = np.mod(np.subtract.outer(found.theta, found.knots), scene.settled_period)
    beside = np.minimum(beside, scene.settled_period - beside).min(axis=1)
    clear = (beside > _BESIDE) & (found.omega != 0.0)
    moving = {"crank_acceleration": found.alpha, "friction_force": found.friction}
    ratios = {}
    for name, values in {
        "crank_angle": found.theta,
        "crank_speed": found.omega,
        **moving,
    }.items():
        ours = data[name].values
        apart = np.abs(ours - values)[clear if name in moving else slice(None)]
        stated = float(data[name].attrs["error_estimate"])
        if name == "friction_force":  # at the oracle's angle, at an equal time
            stated += _FLOOR * float(np.max(np.abs(data["gas_force"].values)))
        floor = _FLOOR * max(float(np.max(np.abs(ours))), 1e-30)
        ratios[name] = float(np.max(apart, initial=0.0)) / max(stated, floor)
    worst = max(ratios, key=lambda name: ratios[name])
    return ratios[worst], worst


def confirmed(case: Case) -> Outcome:
    """Forces of a multibody run against those of the closed form, each over its own peak."""
    ours, theirs = run(case.ours(), "multibody").data, run(case.theirs(), "kinetostatic").data
    errors = {
        name: float(abs(ours[name] - theirs[name].values).max() / abs(theirs[name]).max())
        for name in _CONFIRMED
    }
    worst = max(errors, key=lambda name: errors[name])
    return Outcome(errors[worst], f"{worst} {errors[worst]:.1e}")


def closes(case: Case) -> Outcome:
    """Energy gained less the work of gas, friction, drive and loads, by Simpson's rule over the
    reported forces between dead centres, over the work of friction; weight is left out."""
    result, friction = run(case.ours(), case.word("formulation")), case.theirs().friction
    assert friction is not None
    assert result.scene.gravity is None
    data, time = result.data, result.data["time"].values
    velocity = data["piston_velocity"].values
    towards = -np.sign(velocity) * (
        friction.ring_force + friction.ring_pressure * np.abs(data["gas_force"].values)
    )
    towards = towards - friction.viscous * velocity
    rubbed = _work(time, towards * velocity)
    gas = _work(time, data["gas_force"].values * velocity)
    outside = _work(time, (data["external_torque"] * data["crank_speed"]).values[:, None])
    gained = data["kinetic_energy"].values
    missed = gained - gained[0] - gas - rubbed - outside
    worst = float(np.max(np.abs(missed)) / np.max(np.abs(rubbed)))
    return Outcome(worst, f"{np.max(np.abs(missed)):.1e} J of {np.max(np.abs(rubbed)):.4g} J")


def mean_pressure(case: Case) -> Outcome:
    """Friction mean effective pressure of the run, work of a cycle over the displaced volume, over
    that of rings alone, less 1: they take F over four strokes, so it is 4 F / area."""
    result, scene = run(case.ours()), case.theirs()
    found = measure(result)
    assert found.friction_power is not None
    assert scene.friction is not None
    assert scene.piston.gas_area is not None
    area, shape = (
        scene.piston.gas_area,
        (scene.crank.radius, scene.rod.length, scene.piston.offset),
    )
    top, bottom = close_loop(dead_centres(*shape), *shape).x
    swept = area * float(top - bottom) * len(scene.cylinders)
    fmep = found.friction_power.value * found.window.duration / swept
    rings = 4.0 * scene.friction.ring_force / area
    return Outcome(abs(fmep / rings - 1.0), f"{fmep / 1e3:.8g} kPa, 4 F / area {rings / 1e3:.8g}")


def _scaled(friction: Friction, force: float, viscous: float) -> Friction:
    return replace(
        friction, ring_force=friction.ring_force * force, viscous=friction.viscous * viscous
    )


def _work(time: Floats, power: Floats) -> Floats:
    """Integral of the sum of powers, shape (n, any), from the first time to each."""
    return np.asarray(cumulative_simpson(power.sum(axis=1), x=time, initial=0.0))
