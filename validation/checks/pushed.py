"""Forces from outside on the pistons: random scenes by their seeds."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter_changes import changes_of
from validation.case import Case, shifted
from validation.checks.changing import Found, compared
from validation.judge import Outcome
from validation.oracles.changing import changing_motion
from validation.random_forces import random_forces

__all__ = ["compared_forces", "stated_scenes"]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_MOST_LEFT_OUT = 0.1  # of the runs


def compared_forces(result: Result, scene: Scene) -> dict[str, Found]:
    """The errors of all that `compared` knows of a run, and of the forces from outside.

    Raises
    ------
    ArithmeticError : from the oracle, or no two samples
    """
    errors = compared(result, scene)
    assert scene.start is not None
    data = result.data.isel(time=slice(result.data.sizes["time"] - (result.status != 0)))
    begin = scene.start.angle, scene.start.speed
    found = changing_motion(changes_of(scene), *begin, data["time"].values)
    ours = data["applied_force"].values
    apart = float(np.max(np.abs(ours - found.applied)[found.clear], initial=0.0))
    stated = float(data["applied_force"].attrs["error_estimate"])
    return errors | {"applied_force": Found(apart, stated, float(np.max(np.abs(ours))))}


def stated_scenes(case: Case) -> Outcome:
    """True error over twice the stated one, or stated over 100 times the true one and over what was
    asked for, or what the run says that it reached instead: the worst variable of all scenes, each
    run by one of the formulations in turn."""
    first, count = int(case.parameters["first"]), int(case.parameters["count"])
    formulations = case.parameters["formulations"]
    worst, said, largest, judged = 0.0, "", 0.0, 0
    left_out: list[str] = []
    for seed in range(first, first + count):
        theirs = random_forces(seed)
        ours = shifted(theirs, "rod.length", lambda length: length * case.number("rod"))
        formulation = formulations[seed % len(formulations)]
        result = simulate(ours, formulation=formulation)
        try:
            found = compared_forces(result, theirs)
        except ArithmeticError:
            left_out.append(f"{seed} {formulation}")
            continue
        judged += 1
        reached = max(result.error.asked, result.error.estimated)
        for name, one in found.items():
            low, high = one.low(), one.high(reached) * _TOO_SMALL
            largest = max(largest, low)
            if not max(low, high) <= worst:
                worst = max(low, high) if math.isfinite(one.true) else math.inf
                said = (
                    f"seed {seed}, {formulation}, {name}: true {one.true:.1e}, "
                    f"stated {one.stated:.1e}"
                )
        if case.mutated and worst > _TOO_SMALL:
            break
    if len(left_out) > _MOST_LEFT_OUT * count:
        raise RuntimeError(f"too many runs cannot be judged: {left_out}")
    also = f"; not judged: {', '.join(left_out)}" if left_out else ""
    return Outcome(
        worst / _TOO_SMALL, f"{judged} runs, at most {largest:.2g} times stated; {said}{also}"
    )
