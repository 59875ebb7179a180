"""Runs against the same machines as bodies of MuJoCo, whose numbers are stored."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.case import Case, shifted
from validation.judge import Outcome
from validation.mujoco.stored import Stored, read_stored
from validation.random_double import random_double
from validation.random_forces import random_forces
from validation.random_unlike import random_unlike

__all__ = ["drawn", "machine", "scenes_of"]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one and MuJoCo's
_ROUNDING = 1e-11  # of the peak, in MuJoCo's numbers: two divisions of the steps err alike
_NOTHING = 1e-9  # of the largest torque in the machine: loads that cancel leave its rounding
_MOST_LEFT_OUT = 0.1  # of the scenes
_DRAWS: dict[str, Callable[[int], Scene]] = {
    "forces": random_forces,
    "unlike": random_unlike,
    "double": random_double,
}


def machine(case: Case) -> Outcome:
    """The scene of the case by each formulation: the worst true error over twice the sum of the
    stated one and MuJoCo's own."""
    stored, found = read_stored()[case.scene], []
    for formulation in case.parameters["formulations"]:
        ratio, said = _worst(simulate(case.ours(), formulation=formulation), stored)
        found.append((ratio, f"{formulation}, {said}"))
    worst, said = max(found)
    return Outcome(worst, f"{len(stored.samples)} states; {said}")


def drawn(case: Case) -> Outcome:
    """The same of random scenes, each by one of the formulations in turn: the worst of all."""
    formulations, shift = case.parameters["formulations"], case.word("shift")
    stored, worst, said, left_out, states = read_stored(), 0.0, "", [], 0
    for seed, (name, scene) in enumerate(scenes_of(case)):
        if name not in stored:
            left_out.append(name)
            continue
        ours = shifted(scene, shift, lambda value: value * case.number("factor"))
        formulation = formulations[seed % len(formulations)]
        ratio, what = _worst(simulate(ours, formulation=formulation), stored[name])
        states += len(stored[name].samples)
        if ratio > worst:
            worst, said = ratio, f"{name}, {formulation}, {what}"
        if case.mutated and worst > case.tolerance:
            break
    if len(left_out) > _MOST_LEFT_OUT * int(case.parameters["count"]):
        raise RuntimeError(f"too many scenes have no stored numbers: {left_out}")
    also = f"; not by MuJoCo: {', '.join(left_out)}" if left_out else ""
    return Outcome(worst, f"{states} states; {said}{also}")


def scenes_of(case: Case) -> Iterator[tuple[str, Scene]]:
    """The scenes of a case, with the names that they are stored under."""
    if case.scene:
        yield case.scene, case.theirs()
        return
    kind = case.word("kind")
    for seed in range(int(case.parameters["count"])):
        yield f"{kind} {seed}", _DRAWS[kind](seed)


def _worst(result: Result, stored: Stored) -> tuple[float, str]:
    """The worst of all variables, above 1 where an error is stated too small; and which."""
    data, worst, said = result.data, 0.0, ""
    if data.sizes["time"] <= max(stored.samples):
        return math.inf, f"{data.sizes['time']} samples: {result.message}"
    for name, exact in stored.numbers.items():
        if name not in data:
            continue
        ours, stated = data[name].values, float(data[name].attrs["error_estimate"])
        peak = float(np.max(np.abs(ours)))
        if name == "external_torque":
            peak = max(peak, _NOTHING * float(np.max(np.abs(data["crank_torque"].values))))
        true = float(np.max(np.abs(ours[list(stored.samples)] - exact)))
        allowed = stated + stored.errors[name] + _ROUNDING * peak
        ratio = true / (_TOO_SMALL * allowed or 1e-300)
        if not ratio <= worst:
            worst = ratio if math.isfinite(ratio) else math.inf
            said = f"{name}: true {true:.1e}, stated {stated:.1e}, MuJoCo's "
            said += f"{stored.errors[name]:.1e}, peak {peak:.3g}"
    return worst, said
