"""Forces from outside on the pistons, and unlike cylinders: random scenes by their seeds."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter_changes import changes_of
from validation.case import Case, shifted
from validation.judge import Outcome
from validation.oracles.changing import changing_motion
from validation.random_forces import random_forces
from validation.random_unlike import random_unlike

__all__ = ["stated_scenes", "unlike_scenes", "worst_ratio"]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one and the oracle's
_TOO_LARGE = 100.0  # the stated error may be this many times the true one, or what is asked
_ROUNDING = 1e-11  # of the peak, in the oracle: two divisions of its steps err alike by 9e-12
_NOTHING = 1e-9  # of the largest torque in the machine: loads that cancel leave its rounding
_PARTS = (5, 8)  # of the time between samples, in each of which the oracle's integrator begins anew
_MOST_LEFT_OUT = 0.1  # of the runs
_NAMES = {
    "crank_angle": "theta",
    "crank_speed": "omega",
    "crank_acceleration": "alpha",
    "external_torque": "external",
    "gas_force": "gas",
    "friction_force": "friction",
    "applied_force": "applied",
    "fuel": "shares",
}
_OF_EVENTS = ("time", "crank_angle", "crank_speed")
_KINDS = ("fuel", "load off", "load on", "reversal")

Floats = NDArray[np.float64]
Where = NDArray[np.bool_]


def stated_scenes(case: Case) -> Outcome:
    """True error over twice the sum of the stated one and the oracle's own, or stated over 100
    times the true one and over what was asked for, or what the run says that it reached instead:
    the worst variable of all scenes, each run by one of the formulations in turn."""
    return _worst(case, random_forces, "rod.length")


def unlike_scenes(case: Case) -> Outcome:
    """The same of scenes whose cylinders are unlike one another."""
    return _worst(case, random_unlike, "layout.cylinders.0.radius")


def _worst(case: Case, draw: Callable[[int], Scene], length: str) -> Outcome:
    first, count = int(case.parameters["first"]), int(case.parameters["count"])
    formulations = case.parameters["formulations"]
    worst, said, left_out = 0.0, "", []
    for seed in range(first, first + count):
        theirs = draw(seed)
        ours = shifted(theirs, length, lambda length: length * case.number("factor"))
        formulation = formulations[seed % len(formulations)]
        try:
            ratio, what = worst_ratio(simulate(ours, formulation=formulation), theirs)
        except ArithmeticError:
            left_out.append(f"{seed} {formulation}")
            continue
        if ratio > worst:
            worst, said = ratio, f"seed {seed}, {formulation}, {what}"
        if case.mutated and worst > case.tolerance:
            break
    if len(left_out) > _MOST_LEFT_OUT * count:
        raise RuntimeError(f"too many runs cannot be judged: {left_out}")
    also = f"; not judged: {', '.join(left_out)}" if left_out else ""
    return Outcome(worst, f"{count - len(left_out)} runs; {said}{also}")


def worst_ratio(result: Result, scene: Scene) -> tuple[float, str]:
    """The worst of all variables and of the events of a run of a scene, whose samples lie on times,
    above 1 where an error is stated too small or too large; and which.

    Raises
    ------
    ArithmeticError : from the oracle, or no two samples
    """
    holds = scene.friction is not None or any(force.law.switches for force in scene.force)
    held = result.status == 1 and holds
    kept = result.data.sizes["time"] - (result.status != 0 and not held)
    if kept < 2:
        raise ArithmeticError(f"nothing to judge: {result.message}")
    ours = _of_result(result, kept, events=result.status == 0 or held)
    times = result.data["time"].values[:kept]
    (once, clear), (again, also_clear) = (_motion(scene, times, parts) for parts in _PARTS)
    asked = max(result.error.asked, result.error.estimated)
    worst, said = 0.0, ""
    for name, (values, stated, peak) in ours.items():
        if values.shape != again[name].shape:
            return math.inf, f"{name}: {len(values)}, of the oracle {len(again[name])}"
        if len(values) == 0:
            continue
        where = clear & also_clear if len(values) == kept else np.ones(len(values), dtype=bool)
        true, unsure = (
            float(np.max(np.abs(one - again[name])[where], initial=0.0))
            for one in (values, once[name])
        )
        low = true / (_TOO_SMALL * (stated + unsure + _ROUNDING * peak) or 1e-300)
        high = stated / max(_TOO_LARGE * true, max(asked, _ROUNDING) * peak, 1e-300)
        if not max(low, high) <= worst:
            worst = max(low, high)
            said = f"{name}: true {true:.1e}, stated {stated:.1e}, the oracle {unsure:.1e}"
            said += f", peak {peak:.3g}"
    return worst, said


def _of_result(
    result: Result, kept: int, *, events: bool
) -> dict[str, tuple[Floats, float, float]]:
    """Values, stated error and peak of what the oracle knows too, by name."""
    data, found = result.data, {}
    peaks = {
        name: float(np.max(np.abs(data[name].values)))
        for name in (*_NAMES, *_OF_EVENTS, "crank_torque")
        if name in data.variables
    }
    peaks["external_torque"] = max(peaks["external_torque"], _NOTHING * peaks["crank_torque"])
    for name in _NAMES:
        if name in data:
            column = data[name]
            found[name] = column.values[:kept], float(column.attrs["error_estimate"]), peaks[name]
    if not events:
        return found
    rows = result.events
    for kind in _KINDS:
        of_kind = np.flatnonzero((rows["kind"].values == kind) & (rows["time"].values > 0.0))
        at = rows["time"].values[of_kind]
        alone = np.append(True, np.diff(at) > 0.0)[: len(at)]  # cylinders that decide together
        of_kind = of_kind[alone] if kind == "fuel" else of_kind
        for name in _OF_EVENTS:
            stated = float(rows[name].attrs["error_estimate"])
            found[f"{name} of {kind}"] = rows[name].values[of_kind], stated, peaks[name]
    return found


def _motion(scene: Scene, times: Floats, parts: int) -> tuple[dict[str, Floats], Where]:
    """What the oracle finds, by the same names, and which samples are clear."""
    assert scene.start is not None
    fine = np.interp(np.arange(parts * (len(times) - 1) + 1) / parts, range(len(times)), times)
    motion = changing_motion(changes_of(scene), scene.start.angle, scene.start.speed, fine)
    found = {name: getattr(motion, own)[::parts] for name, own in _NAMES.items()}
    for kind in _KINDS:
        rows = [row[:3] for row in motion.events if row[3] == kind and row[0] > 0.0]
        for name, column in zip(_OF_EVENTS, np.array(rows).reshape(-1, 3).T, strict=True):
            found[f"{name} of {kind}"] = column
    return found, motion.clear[::parts]
