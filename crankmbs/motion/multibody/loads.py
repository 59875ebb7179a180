"""Torque from outside as a plain function of numbers: exudyn calls it at every step."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable

import numpy as np

from crankmbs.numerics.piecewise import Piecewise
from crankmbs.scene.torque import Torque

__all__ = ["EVERYWHERE", "Load", "speeds_around", "torque_function"]

Load = Callable[[float, float, float], float]
Range = tuple[float, float]

EVERYWHERE: Range = (-math.inf, math.inf)


def torque_function(torques: tuple[Torque, ...], times: Range, speeds: Range) -> Load:
    """Torque [N m] over time [s], crank angle [rad] and speed [rad/s], all loads together.

    times [s] : no load over time jumps between; continued smoothly before and beyond
    speeds [rad/s] : no load over speed bends or jumps between, and they are continued; or
        EVERYWHERE, for the loads as they are
    """
    parts = [load.parts for load in torques]
    in_time = [part.over_time for part in parts if part.over_time is not None]
    in_speed = [part.over_speed for part in parts if part.over_speed is not None]
    over_time = [_between(part, *times) for part in in_time]
    over_speed = [_between(part, *speeds) for part in in_speed if part.knots]
    over_angle = [part.over_angle.by_number() for part in parts if part.over_angle is not None]
    functions = [part.function for part in parts if part.function is not None]
    smooth = np.sum([part.pieces[0] for part in in_speed if not part.knots] or [(0.0,) * 3], axis=0)
    c0, c1, c2 = map(float, smooth)

    def torque(time: float, theta: float, omega: float) -> float:
        value = c0 + (c1 + c2 * omega) * omega
        for function in over_time:
            value += function(time)
        for function in over_speed:
            value += function(omega)
        for function in over_angle:
            value += function(theta)
        for given in functions:
            value += given.number(time, theta, omega)
        return value

    return torque


def speeds_around(
    torques: tuple[Torque, ...], omega: float, sense: float, stops: tuple[float, ...] = ()
) -> Range:
    """The speeds next to one [rad/s] where a load bends or jumps, and other stops; beside such a
    speed, on the side of sense."""
    parts = [load.parts for load in torques]
    bends = {x for part in parts if part.over_speed is not None for x in part.over_speed.bends}
    kinks = {x for part in parts if part.function is not None for x in part.function.speeds}
    rows = sorted(bends | kinks | set(stops))
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
