"""Loads over the crank angle of any period: random scenes by their seeds."""

from __future__ import annotations

from crankmbs.simulate import simulate
from validation.adapter import machine_of
from validation.case import Case, shifted
from validation.checks.drawn import stated_ratio
from validation.judge import Outcome
from validation.oracles.free_motion import series_path
from validation.random_periods import random_periods

__all__ = ["stated_scenes"]


def stated_scenes(case: Case) -> Outcome:
    """True error over twice the stated one, or stated over 100 times the true one and over what was
    asked for: the worst variable of all scenes that reach their end."""
    first, count = int(case.parameters["first"]), int(case.parameters["count"])
    worst, said, largest, swings = 0.0, "", 0.0, 0
    for seed in range(first, first + count):
        theirs = random_periods(seed)
        ours = shifted(theirs, "rod.length", lambda length: length * case.number("rod"))
        result = simulate(ours, formulation="crank_angle")
        if result.status != 0:
            swings += 1
            continue
        assert theirs.start is not None
        path = series_path(machine_of(theirs), theirs.start.angle, theirs.start.speed)
        ratio, what, relative = stated_ratio(result, theirs, path)
        largest = max(largest, relative)
        if ratio > worst:
            worst, said = ratio, f"seed {seed}, {what}"
        if case.mutated and worst > case.tolerance:
            break
    left_out = f"; {swings} swing and do not reach their end" if swings else ""
    return Outcome(worst, f"{said}; largest true error {largest:.1e} of a peak{left_out}")
