"""The lectures' answers of `crankmbs.compare`, with the rod of two masses: exact at any speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crankmbs.compare import QUANTITIES
from crankmbs.compare.excerpt import Answer, excerpt_of
from crankmbs.compare.lectured import UNTRUNCATED
from crankmbs.lecture import datum_shift
from validation.case import Case
from validation.checks.curves import lecture_geometry
from validation.judge import Outcome
from validation.runs import run

__all__ = ["at_constant_speed", "untruncated"]


def untruncated(case: Case) -> Outcome:
    """Every quantity of every cylinder against the run's own, over the peak of its unit; the
    displacement counted from the run's dead centre."""
    ours, result = run(case.ours()), run(case.theirs())
    shift = float(datum_shift(**lecture_geometry(result)))
    apart: dict[str, float] = {}
    for cylinder in range(1, len(result.scene.cylinders) + 1):
        answer = excerpt_of(result, cylinder).lecture(UNTRUNCATED, constant_speed=False)
        answer["piston displacement"] = answer["piston displacement"] - shift
        simulated = excerpt_of(ours, cylinder).simulated()
        own = _apart(answer, simulated)
        apart |= {f"{name} of cylinder {cylinder}": error for name, error in own.items()}
    worst = max(apart, key=lambda name: apart[name])
    return Outcome(apart[worst], f"{len(apart)} curves; the worst is {worst}")


def at_constant_speed(case: Case) -> Outcome:
    """The lectures' answers for a free run take the time mean of its speed and no acceleration:
    against Newton-Euler of just that at the run's angles, over the peak of the quantity's unit."""
    result, theirs = run(case.ours()), excerpt_of(run(case.theirs()), 1)
    answer = excerpt_of(result, 1).lecture(UNTRUNCATED, constant_speed=True)
    answer["piston displacement"] -= float(datum_shift(**lecture_geometry(result)))
    time, angle = (theirs.result.data[name].values for name in ("time", "crank_angle"))
    before = np.argmin(np.abs(angle - (angle[-1] - theirs.result.scene.period)))
    mean = (angle[-1] - angle[before]) / (time[-1] - time[before])
    still = np.zeros_like(theirs.alpha)
    motion = {"crank_speed": still + mean, "crank_acceleration": still}
    steady = replace(theirs, variables={**theirs.variables, **motion})
    closed = steady.newton_euler(theirs.result.scene)
    apart = _apart(answer, closed)
    worst = max(apart, key=lambda name: apart[name])
    return Outcome(apart[worst], f"{len(apart)} curves at {mean:.6f} rad/s; the worst is {worst}")


def _apart(answer: Answer, closed: Answer) -> dict[str, float]:
    """Largest difference of every curve over the highest peak of its unit."""
    peaks: dict[str, float] = {}
    for name, curve in closed.items():
        unit = QUANTITIES[name].units
        peaks[unit] = max(peaks.get(unit, 0.0), float(np.max(np.abs(curve))))
    return {
        name: float(np.max(np.abs(answer[name] - curve))) / peaks[QUANTITIES[name].units]
        for name, curve in closed.items()
    }
