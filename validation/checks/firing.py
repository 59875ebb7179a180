"""When the cylinders fire."""

from __future__ import annotations

import math

import numpy as np

from validation.case import Case
from validation.judge import Outcome
from validation.runs import run

__all__ = ["order"]


def order(case: Case) -> Outcome:
    """Crank angle [rad] between the peaks of the gas pressure of cylinders in their firing order,
    against the period over their number; the last one's to the first one's of the next cycle."""
    data, scene = run(case.ours()).data, case.theirs()
    angle = data["crank_angle"].values
    inside = angle < angle[0] + scene.period * (1.0 - 1e-9)  # the last sample is the first again
    angle, pressure = angle[inside], data["gas_pressure"].values[inside]
    fires = {k + 1: float(angle[np.argmax(pressure[:, k])]) for k in range(pressure.shape[1])}
    numbers = [int(number) for number in case.parameters["firing_order"]]
    even = scene.period / len(numbers)
    worst = 0.0
    for number, after in zip(numbers, [*numbers[1:], numbers[0]], strict=True):
        apart = (fires[after] - fires[number]) % scene.period
        worst = max(worst, abs(apart - even))
    degrees = ", ".join(f"{k} at {math.degrees(fires[k]):.0f}" for k in numbers)
    return Outcome(worst, f"the peaks come in cylinder {degrees} deg")
