"""Torque from outside as a plain function of numbers: exudyn calls it at every step."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable

from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.loads import Torque

__all__ = ["EVERYWHERE", "Load", "speeds_around", "torque_function"]

Load = Callable[[float, float], float]
Range = tuple[float, float]

EVERYWHERE: Range = (-math.inf, math.inf)


def torque_function(torques: tuple[Torque, ...], times: Range, speeds: Range) -> Load:
    """Torque [N m] over time [s] and crank speed [rad/s], all loads together.

    times [s] : no load over time jumps between; continued smoothly before and beyond
    speeds [rad/s] : no load over speed bends or jumps between, and they are continued; or
        EVERYWHERE, for the loads as they are
    """
    c0 = c1 = c2 = 0.0
    over_time: list[Callable[[float], float]] = []
    over_speed: list[Callable[[float], float]] = []
    for load in torques:
        in_time, in_speed = load.parts
        if in_time is not None and in_time.is_constant and not in_time.knots:
            c0 += in_time.pieces[0][0]
        elif in_time is not None:
            over_time.append(_between(in_time, *times))
        if in_speed is not None and in_speed.knots:
            over_speed.append(_between(in_speed, *speeds))
        elif in_speed is not None:
            a, b, c = in_speed.pieces[0]
            c0, c1, c2 = c0 + a, c1 + b, c2 + c

    def torque(time: float, omega: float) -> float:
        value = c0 + (c1 + c2 * omega) * omega
        for function in over_time:
            value += function(time)
        for function in over_speed:
            value += function(omega)
        return value

    return torque


def speeds_around(
    torques: tuple[Torque, ...], omega: float, sense: float, stops: tuple[float, ...] = ()
) -> Range:
    """The speeds next to one [rad/s] where a load bends or jumps, and other stops; beside such a
    speed, on the side of sense."""
    parts = (load.parts.over_speed for load in torques)
    rows = sorted({x for part in parts if part is not None for x in part.bends}.union(stops))
    k = bisect_right(rows, omega) if sense > 0.0 else bisect_left(rows, omega)
    ends = [-math.inf, *rows, math.inf]
    return ends[k], ends[k + 1]


def _between(part: Piecewise, begin: float, end: float) -> Callable[[float], float]:
    """Its pieces from ``begin`` to ``end``; the outer ones are continued."""
    knots, pieces = part.knots, part.pieces
    low = bisect_right(knots, begin)
    high = max(bisect_left(knots, end), low)
    knots, pieces = knots[low:high], pieces[low : high + 1]

    def value(x: float) -> float:
        a, b, c = pieces[bisect_right(knots, x)]
        return a + (b + c * x) * x

    return value
