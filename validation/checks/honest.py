"""Whether the true error of every variable is at most twice the stated one, and not far smaller."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.indicator import INDICATOR_RTOL
from crankmbs.mechanics.variables import VARIABLES
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from validation.adapter import at_jumps, load_torque, reference_motion, reference_variables
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import LONG, Arithmetic, Array
from validation.oracles.free_motion import Motion
from validation.runs import run

__all__ = ["scales", "stated_errors", "true_errors"]

_TOO_SMALL = 2.0  # the true error may be this many times the stated one
_TOO_LARGE = 100.0  # the stated error may be this many times the true one
_FLOOR = 1e-12  # of the peak of what has the same unit: rounding, allowed on either side
_NEWTON = 1e-10  # instead from above where Newton's iteration leaves so much of every equation


def stated_errors(case: Case) -> Outcome:
    """True error over twice the stated one, and stated over a hundred times the true one.

    The worst of both over all variables; the floor is added to what each is measured by. The
    oracle of an indicator diagram has the same pieces, so it does not see what they miss of the
    polytropes, which is stated: by as much the stated error may be larger.
    """
    result, scene = run(case.ours(), case.word("formulation")), case.theirs()
    true, peaks = true_errors(result, scene)
    scale = scales(peaks)
    above = _NEWTON if case.word("formulation") == "multibody" else _FLOOR
    shared = INDICATOR_RTOL if scene.gas and scene.gas.indicator else 0.0
    worst, what = 0.0, "every error is zero"
    for name, error in true.items():
        stated = float(result.data[name].attrs["error_estimate"])
        low = error / (_TOO_SMALL * stated + _FLOOR * scale[name]) if error > 0.0 else 0.0
        known = _TOO_LARGE * (error + shared * scale[name])
        high = stated / (known + above * scale[name]) if stated else 0.0
        if max(low, high) > worst:
            worst = max(low, high)
            what = f"{name}: true {error:.2e}, stated {stated:.2e} {VARIABLES[name].units}"
    relative = max(error / scale[name] for name, error in true.items() if scale[name] > 0.0)
    return Outcome(worst, f"{what}; largest true error {relative:.1e} of a peak")


def true_errors(
    result: Result, scene: Scene, motion: Motion | None = None, arithmetic: Arithmetic = LONG
) -> tuple[dict[str, float], dict[str, float]]:
    """The largest error of every variable against the oracles for a scene, and its peak.

    motion : the oracle's at the result's samples; None lets it run
    """
    data = result.data
    motion = motion or reference_motion(result, scene, arithmetic)
    oracle = reference_variables(scene, motion.theta, motion.omega, motion.alpha, arithmetic)
    oracle |= {"crank_speed": motion.omega, "crank_acceleration": motion.alpha}
    if scene.start is not None:
        oracle["external_torque"] = load_torque(scene, motion, arithmetic)
    clear = ~at_jumps(scene, motion.theta)
    true = {name: _largest((v - data[name].values)[clear]) for name, v in oracle.items()}
    true["time"], true["crank_angle"] = _of_motion(result, motion)
    return true, {name: _largest(data[name].values) for name in true}


def scales(peaks: dict[str, float]) -> dict[str, float]:
    """For every variable the highest of the peaks of those with its unit; angular accelerations
    that are all zero have the square of the angular speed, of which they are differences."""
    largest: dict[str, float] = {}
    for name, peak in peaks.items():
        unit = VARIABLES[name].units
        largest[unit] = max(peak, largest.get(unit, 0.0))
    if largest.get("rad/s^2") == 0.0:
        largest["rad/s^2"] = largest["rad/s"] ** 2
    return {name: largest[VARIABLES[name].units] for name in peaks}


def _of_motion(result: Result, motion: Motion) -> tuple[float, float]:
    """Errors of time and crank angle; the angle's is taken at equal times."""
    late = motion.time - result.data["time"].values
    ahead = motion.theta - result.data["crank_angle"].values
    return _largest(late), _largest(ahead - result.data["crank_speed"].values * late)


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values)))
