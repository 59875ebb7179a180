"""Samples so near a jump over the angle that their stated angle leaves its side open."""

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
    """The errors, of gas, joint forces and loads no less than a jump within reach changes.

    Two runs on the same wrong side of a jump agree. Within reach is twice the stated error of the
    crank angle. Samples in angle are exact but for the last of a run that ends at a time.
    """
    errors, plan = dict(errors), problem.plan
    reach = 2.0 * errors["crank_angle"]
    if not (plan.in_time or plan.until_time) or not np.isfinite(reach):
        return errors
    theta = answer["crank_angle"][slice(None) if plan.in_time else slice(-1, None)]
    for side in (-reach, reach):
        for name, change in (
            _of_gas(problem, theta, side) | _of_loads(problem, theta, side)
        ).items():
            errors[name] = max(errors[name], float(np.max(np.abs(change))))
    return errors


def _of_gas(problem: Problem, theta: Array, side: float) -> dict[str, Array]:
    """By how much gas and joint forces change to one side, where the gas jumps."""
    if not problem.gas.jumps:
        return {}
    fired = [problem.gas.law.most] * len(problem.gas.phases) if problem.gas.law else []
    change = problem.gas.force(theta + side, fired) - problem.gas.force(theta, fired)
    pressure = change / (problem.scene.piston.gas_area or 1.0)
    own = {"gas_force": change, "gas_pressure": pressure}
    return held_by(problem.scene, change, theta) | own


def _of_loads(problem: Problem, theta: Array, side: float) -> dict[str, Array]:
    """By how much the loads over the angle that jump change to one side."""
    parts = (load.parts.over_angle for load in problem.scene.torque)
    jumping = [part for part in parts if part is not None and part.order == 1]
    changes = [part(theta + side) - part(theta) for part in jumping]
    return {"external_torque": np.sum(np.abs(changes), axis=0)} if changes else {}
