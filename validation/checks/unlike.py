"""Cylinders unlike one another: random scenes by their seeds."""

from __future__ import annotations

from crankmbs.simulate import simulate
from validation.case import Case, shifted
from validation.checks.pushed import worst_ratio
from validation.judge import Outcome
from validation.random_unlike import random_unlike

__all__ = ["stated_scenes"]

_MOST_LEFT_OUT = 0.1  # of the runs


def stated_scenes(case: Case) -> Outcome:
    """The worst ratio of `pushed.worst_ratio` in scenes whose cylinders are unlike, each run by one
    of the formulations in turn."""
    count, formulations = int(case.parameters["count"]), case.parameters["formulations"]
    worst, said, judged = 0.0, "", 0
    for seed in range(count):
        theirs = random_unlike(seed)
        place = "layout.cylinders.0.radius"
        ours = shifted(theirs, place, lambda radius: radius * case.number("radius"))
        formulation = formulations[seed % len(formulations)]
        try:
            ratio, what = worst_ratio(simulate(ours, formulation=formulation), theirs)
        except ArithmeticError:  # of the oracle
            continue
        judged += 1
        if ratio > worst:
            worst, said = ratio, f"seed {seed}, {formulation}, {what}"
        if case.mutated and worst > case.tolerance:
            break
    if not case.mutated and judged < (1.0 - _MOST_LEFT_OUT) * count:
        raise RuntimeError(f"only {judged} of {count} runs can be judged")
    return Outcome(worst, f"{judged} runs; {said}")
