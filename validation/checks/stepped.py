"""A scene in steps over time, with a torque that is held over each, against the oracle."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.numerics.arrays import Array
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

_TOO_SMALL = 2.0  # the true error may be this many times the stated one and the oracle's
_ROUNDING = 1e-13  # of the angle turned and of the largest speed, in the oracle
_LONGEST = 5.0  # times the shortest step
_PARTS = (8, 13)  # of a step, in each of which the oracle's integrator begins anew


def stated_scenes(case: Case) -> Outcome:
    """True error of angle and speed over twice the sum of the stated one and the oracle's own, at
    the end of every step of all scenes; the oracle has the torques as a table over time with jumps.
    """
    first, count = int(case.parameters["first"]), int(case.parameters["count"])
    steps = int(case.parameters["steps"])
    worst, said, largest = 0.0, "", 0.0
    for seed in range(first, first + count):
        scene = random_changes(case.word("kind"), seed)
        torques, states = _stepped(scene, np.random.default_rng([15, seed]), steps, case)
        times = np.array([0.0, *(state.time for state in states)])
        edges = np.repeat([*times[:-1], scene.end[0]], 2)[1:-1]
        rows = Table(tuple(edges.tolist()), tuple(np.repeat(torques, 2).tolist()))
        theirs = replace(scene, torque=(*scene.torque, TimeTable(file=rows)))
        true, unsure, peaks = _of_oracle(theirs, times)
        ours = np.array([(state.crank_angle, state.crank_speed) for state in states])
        stated = np.array([(state.crank_angle_error, state.crank_speed_error) for state in states])
        apart, allowed = np.abs(ours - true), stated + unsure + _ROUNDING * peaks
        largest = max(largest, float(np.max(apart / peaks)))
        ratios = np.nan_to_num(apart / allowed, nan=math.inf)
        if np.max(ratios) > worst:
            worst = float(np.max(ratios))
            k, which = np.unravel_index(np.argmax(ratios), ratios.shape)
            said = (
                f"seed {seed}, {times[k + 1]:.4g} s: true {apart[k, which]:.1e}, stated "
                f"{stated[k, which]:.1e}, the oracle {unsure[k, which]:.1e}"
            )
        if case.mutated and worst > _TOO_SMALL:
            break
    return Outcome(
        worst / _TOO_SMALL,
        f"at most {worst:.2g} times stated; {said}; largest true error {largest:.1e} of the peak",
    )


def _of_oracle(scene: Scene, times: Array) -> tuple[Array, Array, Array]:
    """Angle and speed at times, of which the first is the start, and by how much they may be off:
    the most that they have differed by up to there where steps are divided otherwise, shape (n, 2);
    angle turned and largest speed, shape (2,)."""
    assert scene.start is not None
    found = []
    for parts in _PARTS:
        fine = np.interp(np.arange(parts * (len(times) - 1) + 1) / parts, range(len(times)), times)
        motion = changing_motion(changes_of(scene), scene.start.angle, scene.start.speed, fine)
        found.append(np.stack([motion.theta, motion.omega], axis=1))
    one, other = (rows[::parts][1:] for rows, parts in zip(found, _PARTS, strict=True))
    peaks = np.array([np.ptp(found[1][:, 0]), np.max(np.abs(found[1][:, 1]))])
    return other, np.maximum.accumulate(np.abs(one - other), axis=0), peaks


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
