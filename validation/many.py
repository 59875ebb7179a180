"""Random scenes by the thousand: no true error over twice the stated one, whatever is drawn."""

from __future__ import annotations

import sys
import time
from dataclasses import replace

from crankmbs.result import Result
from crankmbs.scene import Scene
from crankmbs.simulate import simulate
from validation.checks.honest import scales, true_errors
from validation.random_scenes import random_scene

__all__ = ["run_many"]

_FORMULATIONS = ("crank_angle", "minimal")
_ALLOWED = 2.0  # true over stated error
_FLOOR = 2e-11  # of the peak of what has the same unit: there no statement is asked for


def run_many(count: int) -> bool:
    """Judge the first ``count`` random scenes; print the worst and all that fail.

    Returns
    -------
    whether no variable's true error exceeded twice the stated one, in every formulation
    """
    begin, worst, red = time.perf_counter(), 0.0, 0
    for seed in range(count):
        for formulation in _FORMULATIONS:
            ratio, said = _judge(random_scene(seed), formulation)
            worst = max(worst, ratio)
            if not ratio <= _ALLOWED:
                red += 1
                print(f"seed {seed}, {formulation}: {said}", flush=True)
        if sys.stderr.isatty():
            print(f"\r{seed + 1} of {count}", end="", file=sys.stderr, flush=True)
    seconds = time.perf_counter() - begin
    print(
        f"{count} random scenes, {len(_FORMULATIONS)} formulations: {red} red, "
        f"worst true over stated error {worst:.3g}, {seconds:.0f} s"
    )
    return red == 0


def _judge(scene: Scene, formulation: str) -> tuple[float, str]:
    """The worst true over stated error of a run, and its numbers."""
    result = simulate(scene, formulation=formulation)
    kept = result.data.sizes["time"] - (result.status != 0)  # the oracles do not see why it ends
    if kept < 2:
        return 0.0, result.message
    result = _first(result, kept)
    true, peaks = true_errors(result, scene)
    scale = scales(peaks)
    stated = {name: float(result.data[name].attrs["error_estimate"]) for name in true}
    ratios = {
        name: error / max(stated[name], _FLOOR * scale[name])
        for name, error in true.items()
        if error > 0.0
    }
    name = max(ratios, key=lambda name: ratios[name], default="time")
    numbers = f"{name} errs by {true[name]:.2e}, {stated[name]:.2e} stated"
    return ratios.get(name, 0.0), f"{numbers}; {result.message}"


def _first(result: Result, kept: int) -> Result:
    return replace(result, data=result.data.isel(time=slice(kept)))
