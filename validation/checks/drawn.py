"""Random scenes by their seeds: the true error of every variable beside the stated one."""

from __future__ import annotations

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.case import Case, shifted
from validation.checks.honest import scales, true_errors
from validation.judge import Outcome
from validation.random_speeds import random_speeds
from validation.runs import run

__all__ = ["stated_ratio", "stated_scene", "stated_scenes"]

_DRAWS = {"speeds": random_speeds}
_ROUNDED = 1e-12  # of the peak of what has the same unit: there no statement is asked for
_TOO_LARGE = 100.0  # the stated error may be this many times the true one


def stated_scenes(case: Case) -> Outcome:
    """True error over the stated one, or stated over 100 times the true one and over what was
    asked for: the worst variable of all scenes."""
    draw, first = _DRAWS[case.word("draw")], int(case.parameters["first"])
    worst, said, largest = 0.0, "", 0.0
    for seed in range(first, first + int(case.parameters["count"])):
        theirs = draw(seed)
        ours = shifted(theirs, "rod.length", lambda length: length * case.number("rod"))
        ratio, what, relative = stated_ratio(simulate(ours), theirs)
        largest = max(largest, relative)
        if ratio > worst:
            worst, said = ratio, f"seed {seed}, {what}"
        if case.mutated and worst > case.tolerance:
            break
    return Outcome(worst, f"{said}; largest true error {largest:.1e} of a peak")


def stated_scene(case: Case) -> Outcome:
    """The same of the case's own scene, by a formulation."""
    result = run(case.ours(), case.word("formulation"))
    worst, said, largest = stated_ratio(result, case.theirs())
    return Outcome(worst, f"{said}; largest true error {largest:.1e} of a peak")


def stated_ratio(result: Result, scene: Scene) -> tuple[float, str, float]:
    """The worst ratio of a run against the oracles of a scene, where, and the largest true error
    over the peak of its unit."""
    true, peaks = true_errors(result, scene)
    scale = scales(peaks)
    worst, said, largest = 0.0, "every error is zero", 0.0
    for name, error in true.items():
        stated, size = float(result.data[name].attrs["error_estimate"]), scale[name]
        if size == 0.0:
            continue
        low = error / max(stated, _ROUNDED * size)
        asked = max(result.error.asked, _ROUNDED) * size
        high = stated / max(_TOO_LARGE * error, asked)
        largest = max(largest, error / size)
        if max(low, high) > worst:
            worst, said = max(low, high), f"{name}: true {error:.2e}, stated {stated:.2e}"
    return worst, said, largest
