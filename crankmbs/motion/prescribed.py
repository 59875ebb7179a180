"""The stretches of a prescribed motion on which the crank turns one way."""

from __future__ import annotations

import math

from crankmbs.errors import InputError
from crankmbs.mechanics.speed import SpeedLaw
from crankmbs.motion.plan import Plan
from crankmbs.scene.units import DEGREE

__all__ = ["monotone_stretches"]


def monotone_stretches(plan: Plan, law: SpeedLaw) -> tuple[list[tuple[float, float]], bool]:
    """Stretches (begin, end) [s] up to the end of the run; and whether that comes.

    Raises
    ------
    InputError : a speed table that ends before the run does
    """
    stretches: list[tuple[float, float]] = []
    begin = 0.0
    for turn in law.turning_times:
        end = min(turn, plan.time_bound)
        sense = float(law.at_time(begin + 1.0 if math.isinf(end) else 0.5 * (begin + end))[1])
        bound = plan.angle_bounds[1 if sense > 0.0 else 0]
        if sense != 0.0 and math.isfinite(bound):
            passed = math.inf if math.isinf(end) else (float(law.at_time(end)[0]) - bound) * sense
            if passed >= -1e-13 * abs(bound):
                stretches.append((begin, float(law.time_at(bound, begin, end)[0])))
                return stretches, True
        if sense == 0.0 and math.isinf(end):
            return stretches, False
        stretches.append((begin, end))
        if end == plan.time_bound:
            return stretches, True
        begin = end
    degrees = float(law.at_time(begin)[0]) / DEGREE
    raise InputError(
        f"motion.speed: the speed table ends at {begin:g} s, before the run does, at "
        f"{degrees:g} degrees; lengthen the table or shorten the run"
    )
