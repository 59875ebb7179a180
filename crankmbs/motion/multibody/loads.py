"""Torque from outside as a plain function of numbers: exudyn calls it at every step."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable

from crankmbs.scene.drives import Constant, Quadratic, SpeedTable, TimeTable, Torque, Viscous
from crankmbs.scene.tables import Table

__all__ = ["EVERYWHERE", "Load", "speeds_around", "torque_function"]

Load = Callable[[float, float], float]
Range = tuple[float, float]

EVERYWHERE: Range = (-math.inf, math.inf)


def torque_function(torques: tuple[Torque, ...], times: Range, speeds: Range) -> Load:
    """Torque [N m] over time [s] and crank speed [rad/s], all loads together.

    times [s] : no load over time jumps between; continued linearly before and beyond
    speeds [rad/s] : no load over speed bends or jumps between, and the lines are continued; or
        EVERYWHERE, for the tables as they are
    """
    c0 = c1 = c2 = 0.0
    tables: list[Load] = []
    for load in torques:
        match load:
            case Constant():
                c0 += load.torque
            case Viscous():
                c1 += load.coefficient
            case Quadratic():
                c2 += load.coefficient
            case TimeTable():
                tables.append(_over_time(load.file, *times))
            case SpeedTable() if speeds == EVERYWHERE:
                tables.append(_over_speed(load.file))
            case SpeedTable():
                constant, slope = _line_between(load.file, *speeds)
                c0 += constant
                c1 -= slope

    def torque(time: float, omega: float) -> float:
        value = c0 - (c1 + c2 * abs(omega)) * omega
        for table in tables:
            value += table(time, omega)
        return value

    return torque


def speeds_around(torques: tuple[Torque, ...], omega: float, sense: float) -> Range:
    """The rows of all speed tables next to a speed [rad/s]; beside a row, on the side of sense."""
    rows = sorted({x for load in torques if isinstance(load, SpeedTable) for x in load.file.x})
    k = bisect_right(rows, omega) if sense > 0.0 else bisect_left(rows, omega)
    ends = [-math.inf, *rows, math.inf]
    return ends[k], ends[k + 1]


def _over_time(table: Table, begin: float, end: float) -> Load:
    """The rows around ``begin`` and those up to ``end``; the outer pieces are continued."""
    x, y = table.x, table.y
    low = min(max(bisect_right(x, begin) - 1, 0), len(x) - 2)
    high = max(bisect_left(x, end), low + 1)
    x, y = x[low : high + 1], y[low : high + 1]
    return lambda time, omega: _line(x, y, time)


def _over_speed(table: Table) -> Load:
    """The ends are held."""
    x, y = table.x, table.y
    return lambda time, omega: _line(x, y, min(max(omega, x[0]), x[-1]))


def _line_between(table: Table, low: float, high: float) -> tuple[float, float]:
    """Torque at rest [N m] and slope [N m s] of the table's line from speed low to high."""
    x, y = table.x, table.y
    k = bisect_right(x, low)
    if k == 0 or high > x[-1]:
        return y[0 if k == 0 else -1], 0.0
    slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return y[k] - slope * x[k], slope


def _line(x: tuple[float, ...], y: tuple[float, ...], at: float) -> float:
    k = min(max(bisect_right(x, at), 1), len(x) - 1)
    width = x[k] - x[k - 1]
    if width == 0.0:  # the held end beyond a jump in the outermost rows
        return y[k]
    return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / width
