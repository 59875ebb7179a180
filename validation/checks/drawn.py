"""Random scenes by their seeds: the true error of every variable beside the stated one."""

from __future__ import annotations

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import machine_of, reference_motion
from validation.case import Case, shifted
from validation.checks.honest import scales, true_errors
from validation.judge import Outcome
from validation.oracles.free_motion import series_path
from validation.oracles.path import Path
from validation.random_speeds import random_speeds
from validation.random_turning import random_turning
from validation.runs import run

__all__ = ["stated_ratio", "stated_scene", "stated_scenes"]

_DRAWS = {"speeds": random_speeds, "turning": random_turning}
_ROUNDED = 1e-12  # of the peak of what has the same unit: there no statement is asked for
_MOST_LEFT_OUT = 0.2  # runs that do not reach their end, of the scenes
_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_TOO_LARGE = 100.0  # the stated error may be this many times the true one


def stated_scenes(case: Case) -> Outcome:
    """True error over twice the stated one, or stated over 100 times the true one and over what
    was asked for: the worst variable of all scenes."""
    draw, first = _DRAWS[case.word("draw")], int(case.parameters["first"])
    worst, said, largest = 0.0, "", 0.0
    left_out: list[int] = []
    for seed in range(first, first + int(case.parameters["count"])):
        theirs = draw(seed)
        ours = shifted(theirs, "rod.length", lambda length: length * case.number("rod"))
        path = _path(theirs)
        for formulation in case.parameters["formulations"]:
            result = simulate(ours, formulation=formulation)
            if result.status != 0:  # it swings without end
                left_out.append(seed)
                continue
            ratio, what, relative = stated_ratio(result, theirs, path)
            largest = max(largest, relative)
            if ratio > worst:
                worst, said = ratio, f"seed {seed}, {formulation}, {what}"
        if case.mutated and worst > case.tolerance:
            break
    if len(left_out) > _MOST_LEFT_OUT * int(case.parameters["count"]):
        raise RuntimeError(f"too many scenes do not reach their end: {left_out}")
    not_judged = f"; not judged, as they do not reach their end: {left_out}" if left_out else ""
    return Outcome(worst, f"{said}; largest true error {largest:.1e} of a peak{not_judged}")


def stated_scene(case: Case) -> Outcome:
    """The same of the case's own scene, by a formulation."""
    result = run(case.ours(), case.word("formulation"))
    worst, said, largest = stated_ratio(result, case.theirs())
    return Outcome(worst, f"{said}; largest true error {largest:.1e} of a peak")


def _path(scene: Scene) -> Path | None:
    """The oracle's path of a free crank."""
    if scene.start is None:
        return None
    return series_path(machine_of(scene), scene.start.angle, scene.start.speed)


def stated_ratio(
    result: Result, scene: Scene, path: Path | None = None
) -> tuple[float, str, float]:
    """The worst ratio of a run against the oracles of a scene, where, and the largest true error
    over the peak of its unit.

    path : the oracle's, of a free crank, where it is known already
    """
    true, peaks = true_errors(result, scene, reference_motion(result, scene, path=path))
    scale = scales(peaks)
    worst, said, largest = 0.0, "every error is zero", 0.0
    for name, error in true.items():
        stated, size = float(result.data[name].attrs["error_estimate"]), scale[name]
        if size == 0.0:
            continue
        low = error / max(_TOO_SMALL * stated, _ROUNDED * size)
        asked = max(result.error.asked, _ROUNDED) * size
        high = stated / max(_TOO_LARGE * error, asked)
        largest = max(largest, error / size)
        if max(low, high) > worst:
            worst, said = max(low, high), f"{name}: true {error:.2e}, stated {stated:.2e}"
    return worst, said, largest
