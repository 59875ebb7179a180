"""A turning-moment diagram against the areas between it and its mean."""

from __future__ import annotations

import numpy as np

from crankmbs.design.flywheel import flywheel
from validation.case import Case
from validation.judge import Outcome
from validation.runs import run

__all__ = ["greatest_excess"]


def greatest_excess(case: Case) -> Outcome:
    """J (max omega^2 - min omega^2) / 2 of the run, and the flywheel's W, over the area, less 1."""
    scene, area = case.ours(), case.number("area")
    speed = run(scene).data["crank_speed"].values
    swing = 0.5 * scene.crank.moment_of_inertia * float(np.ptp(speed**2))
    wanted = float(np.ptp(speed) / np.mean(speed))
    found = flywheel(case.theirs(), wanted)
    if found.status != 0:
        raise RuntimeError(found.message)
    errors = {"run": abs(swing / area - 1.0), "W": abs(found.work.value / area - 1.0)}
    return Outcome(
        max(errors.values()),
        ", ".join(f"{name} off by {error:.1e}" for name, error in errors.items())
        + f"; {swing:.6g} J, speed fluctuates by {100.0 * wanted:.4g} %",
    )
