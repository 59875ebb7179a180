"""A scene in steps over time, with a torque that is held over each, against the oracle."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.scene.loads import TimeTable
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.stepper import Stepper, StepperState
from validation.adapter_changes import changes_of
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.changing import changing_motion
from validation.random_changes import random_changes

__all__ = ["stated_scenes"]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_FLOOR = 1e-11  # of the angle turned and of the largest speed: of the oracle after a few turns
_LONGEST = 5.0  # times the shortest step
_PARTS = 8  # of a step, in each of which the oracle's integrator begins anew and errs less


def stated_scenes(case: Case) -> Outcome:
    """True error of angle and speed over twice the stated one, at the end of every step of all
    scenes; the oracle has the torques as a table over time with jumps."""
    first, count = int(case.parameters["first"]), int(case.parameters["count"])
    steps = int(case.parameters["steps"])
    worst, said, largest = 0.0, "", 0.0
    for seed in range(first, first + count):
        scene = random_changes(case.word("kind"), seed)
        torques, states = _stepped(scene, np.random.default_rng([15, seed]), steps, case)
        times = [0.0, *(state.time for state in states)]
        edges = np.repeat([*times[:-1], scene.end[0]], 2)[1:-1]
        rows = Table(tuple(edges.tolist()), tuple(np.repeat(torques, 2).tolist()))
        theirs = replace(scene, torque=(*scene.torque, TimeTable(file=rows)))
        assert scene.start is not None
        fine = np.interp(np.arange(_PARTS * steps + 1) / _PARTS, np.arange(steps + 1), times)
        found = changing_motion(changes_of(theirs), scene.start.angle, scene.start.speed, fine)
        scales = np.ptp(found.theta), np.max(np.abs(found.omega))
        for k, state in zip(range(_PARTS, len(fine), _PARTS), states, strict=True):
            pairs = (
                (state.crank_angle - found.theta[k], state.crank_angle_error, scales[0]),
                (state.crank_speed - found.omega[k], state.crank_speed_error, scales[1]),
            )
            for apart, stated, scale in pairs:
                ratio = abs(float(apart)) / (stated + _FLOOR / _TOO_SMALL * float(scale))
                largest = max(largest, abs(float(apart)) / float(scale))
                if not ratio <= worst:
                    worst = ratio if math.isfinite(ratio) else math.inf
                    at = f"seed {seed}, {state.time:.4g} s"
                    said = f"{at}: true {abs(apart):.1e}, stated {stated:.1e}"
        if case.mutated and worst > _TOO_SMALL:
            break
    return Outcome(
        worst / _TOO_SMALL,
        f"at most {worst:.2g} times stated; {said}; largest true error {largest:.1e} of the peak",
    )


def _stepped(
    scene: Scene, rng: np.random.Generator, steps: int, case: Case
) -> tuple[list[float], list[StepperState]]:
    """Torques [N m] as the oracle is told, and the state after each of so many odd steps."""
    assert scene.start is not None
    inertia = float(inertia_alone(scene, scene.start.angle))
    size = 0.5 * inertia * (scene.start.speed or 20.0) ** 2 / float(case.parameters["share"])
    stepper, end = Stepper(scene), scene.end[0]
    widths = rng.uniform(1.0, _LONGEST, steps)
    torques = size * rng.uniform(-1.0, 1.0, steps)
    states = []
    for dt, torque in zip(end * widths / widths.sum() * (1.0 - 1e-12), torques, strict=True):
        states.append(stepper.advance(float(dt), load=case.number("load") * float(torque)))
        if states[-1].status != 0:
            raise RuntimeError(f"{scene.title}: {states[-1].message}")
    return torques.tolist(), states
