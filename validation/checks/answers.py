"""The lectures' answers of `crankmbs.compare`, with the rod of two masses: exact at any speed."""

from __future__ import annotations

import numpy as np

from crankmbs.compare import QUANTITIES
from crankmbs.compare.lectured import UNTRUNCATED
from crankmbs.compare.stretch import stretch_of
from crankmbs.lecture import datum_shift
from validation.case import Case
from validation.checks.curves import lecture_geometry
from validation.judge import Outcome
from validation.runs import run

__all__ = ["untruncated"]


def untruncated(case: Case) -> Outcome:
    """Every quantity of every cylinder against the run's own, over the peak of its unit; the
    displacement counted from the run's dead centre."""
    ours, result = run(case.ours()), run(case.theirs())
    shift = float(datum_shift(**lecture_geometry(result)))
    apart: dict[str, float] = {}
    for cylinder in range(1, len(result.scene.cylinders) + 1):
        answer = stretch_of(result, cylinder).lecture(UNTRUNCATED, constant_speed=False)
        answer["piston displacement"] = answer["piston displacement"] - shift
        simulated = stretch_of(ours, cylinder).simulated()
        peaks: dict[str, float] = {}
        for name, curve in simulated.items():
            unit = QUANTITIES[name].units
            peaks[unit] = max(peaks.get(unit, 0.0), float(np.max(np.abs(curve))))
        for name, curve in simulated.items():
            error = float(np.max(np.abs(answer[name] - curve)))
            apart[f"{name} of cylinder {cylinder}"] = error / peaks[QUANTITIES[name].units]
    worst = max(apart, key=lambda name: apart[name])
    return Outcome(apart[worst], f"{len(apart)} curves; the worst is {worst}")
