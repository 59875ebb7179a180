"""Samples so near a jump of the gas force that their stated angle leaves its side open."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from crankmbs.motion.multibody.held import held_by
from crankmbs.motion.multibody.problem import Problem
from crankmbs.numerics.arrays import Array

__all__ = ["errors_beside_jumps"]


def errors_beside_jumps(
    problem: Problem, answer: Mapping[str, Array], errors: Mapping[str, float]
) -> dict[str, float]:
    """The errors, of the gas and of the joint forces no less than a jump within reach changes.

    Two runs on the same wrong side of a jump agree. Within reach is twice the stated error of the
    crank angle. Samples in angle are exact but for the last of a run that ends at a time.
    """
    errors, plan = dict(errors), problem.plan
    if not problem.gas.jumps or not (plan.in_time or plan.until_time):
        return errors
    theta = answer["crank_angle"][slice(None) if plan.in_time else slice(-1, None)]
    reach = 2.0 * errors["crank_angle"]
    if not np.isfinite(reach):
        return errors
    fired = [problem.gas.law.most] * len(problem.gas.phases) if problem.gas.law else []
    for side in (-reach, reach):
        change = problem.gas.force(theta + side, fired) - problem.gas.force(theta, fired)
        changes = held_by(problem.scene, change, theta)
        changes["gas_force"] = change
        changes["gas_pressure"] = change / (problem.scene.piston.gas_area or 1.0)
        for name, values in changes.items():
            errors[name] = max(errors[name], float(np.max(np.abs(values))))
    return errors
