"""Torque from outside as a plain function of numbers: exudyn calls it at every step."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable

from crankmbs.drives import Constant, Quadratic, SpeedTable, TimeTable, Torque, Viscous
from crankmbs.tables import Table

__all__ = ["Load", "torque_function"]

Load = Callable[[float, float], float]


def torque_function(torques: tuple[Torque, ...], begin: float, end: float) -> Load:
    """Torque [N m] over time [s] and crank speed [rad/s], all loads together.

    Valid from time ``begin`` to time ``end``, where no load jumps between, and continued linearly
    before and beyond.
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
                tables.append(_over_time(load.file, begin, end))
            case SpeedTable():
                tables.append(_over_speed(load.file))

    def torque(time: float, omega: float) -> float:
        value = c0 - (c1 + c2 * abs(omega)) * omega
        for table in tables:
            value += table(time, omega)
        return value

    return torque


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


def _line(x: tuple[float, ...], y: tuple[float, ...], at: float) -> float:
    k = min(max(bisect_right(x, at), 1), len(x) - 1)
    width = x[k] - x[k - 1]
    if width == 0.0:  # the held end beyond a jump in the outermost rows
        return y[k]
    return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / width
