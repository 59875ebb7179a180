"""Time and speed at the end of long runs that keep their energy."""

from __future__ import annotations

import math

from validation.adapter import machine_of
from validation.case import Case
from validation.judge import Outcome
from validation.oracles.arithmetic import LONG
from validation.oracles.period_time import period_time
from validation.runs import run

__all__ = ["conserved"]


def conserved(case: Case) -> Outcome:
    """At the end of whole turns without gas and loads: the true error of time and speed over the
    stated one, and the stated one over what it may be, the worst of all.

    The speed there is that of the start, the time that of one turn as often. Parameters of the
    case: `coarsest`, the largest error that may be stated, of the value; `formulation`.
    """
    result, scene = run(case.ours(), case.word("formulation")), case.theirs()
    until, in_time = scene.end
    turns = round(until / (2.0 * math.pi))
    assert not in_time
    assert scene.start is not None
    assert math.isclose(until, 2.0 * math.pi * turns, rel_tol=1e-14)
    begin, speed = scene.start.angle, scene.start.speed
    last = result.data.isel(time=-1)
    time = turns * period_time(machine_of(scene), begin, speed)
    beyond = LONG.number(float(last["crank_angle"])) - begin - 2 * LONG.pi * turns  # rounding
    true = {"time": float(time) + float(beyond) / speed, "crank_speed": speed}
    worst, what = 0.0, ""
    for name, value in true.items():
        stated = float(result.data[name].attrs["error_estimate"])
        error = abs(float(last[name]) - value)
        share = max(error / stated, stated / (case.number("coarsest") * value))
        if not share <= worst:
            worst = share if math.isfinite(share) else math.inf
            what = f"{name}: true error {error:.1e}, stated {stated:.1e}"
    return Outcome(worst, f"{what}, after {turns} turns")
