"""S2's values at special crank angles, its mean piston speed and its Brix correction.

S2's side takes dimensions and speed from the case: a run at a wrong speed shows. What is exact is
held against the closed form (kinetostatic), the Brix correction against the multibody run.
"""

from __future__ import annotations

import math

import numpy as np

from crankmbs import lecture
from crankmbs.result import Result
from validation import reference
from validation.case import Case
from validation.checks.curves import constant_speed
from validation.judge import Outcome
from validation.runs import run

__all__ = ["brix_correction", "mean_speed", "special_angles"]


def special_angles(case: Case) -> Outcome:
    """S2's displacement, velocity and acceleration where its series are exact, over R w^n."""
    result, (radius, ratio) = run(case.ours(), "kinetostatic"), _sizes(case)
    omega = constant_speed(case.theirs())
    worst, count = 0.0, 0
    for row in reference.rows("s2_special_values"):
        if row["truncated"] == "yes":
            continue
        power = {"R": 0, "R w": 1, "R w2": 2}[row["unit"]]
        simulated = _at(result, f"piston_{row['quantity']}", float(row["crank_angle_deg"]))
        printed = float(row["constant"]) + float(row["per_rod_ratio"]) * ratio
        worst = max(worst, abs(simulated / (radius * omega**power) - printed))
        count += 1
    return Outcome(worst, f"{count} values")


def mean_speed(case: Case) -> Outcome:
    """S2's S n / 30 against the distance that the piston covers in the time of a revolution."""
    result, (radius, _) = run(case.ours(), "kinetostatic"), _sizes(case)
    path = 2.0 * (
        _at(result, "piston_displacement", 180.0) - _at(result, "piston_displacement", 0.0)
    )
    time = _at(result, "time", 360.0) - _at(result, "time", 0.0)
    speed_rpm = constant_speed(case.theirs()) * 30.0 / math.pi
    printed = 2.0 * radius * speed_rpm / 30.0
    return Outcome(
        abs(printed * time / path - 1.0),
        f"{printed:.6f} m/s at {speed_rpm:.0f} rpm, of the run {path / time:.6f} m/s",
    )


def brix_correction(case: Case) -> Outcome:
    """How far S2's R lambda / 2 misses the simulated displacement at 90 degrees beyond R."""
    result, (radius, ratio) = run(case.ours(), "multibody"), _sizes(case)
    simulated = _at(result, "piston_displacement", 90.0) - radius
    printed = lecture.brix_correction_series(crank_radius=radius, rod_length=radius / ratio)
    row = reference.one_row("s2_brix", rod_ratio=case.word("rod_ratio"))
    tabulated = float(row["formula_over_exact_minus_1_percent"])
    percent = 100.0 * (float(printed) / simulated - 1.0)
    return Outcome(
        abs(percent - tabulated),
        f"R lambda / 2 is {printed * 1e3:.4f} mm, simulated {simulated * 1e3:.4f} mm: "
        f"{percent:.3f} % (tabulated {tabulated} %)",
    )


def _sizes(case: Case) -> tuple[float, float]:
    scene = case.theirs()
    return scene.crank.radius, scene.crank.radius / scene.rod.length


def _at(result: Result, name: str, degrees: float) -> float:
    """The sample at a crank angle."""
    angle = result.data["crank_angle"].values
    k = int(np.argmin(np.abs(angle - np.radians(degrees))))
    if abs(angle[k] - np.radians(degrees)) > 1e-12:
        raise ValueError(f"no sample at {degrees} degrees")
    return float(result.data[name].values.reshape(len(angle), -1)[k, 0])
