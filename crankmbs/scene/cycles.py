"""Pressure files longer than one period: how many cycles they hold, and their mean."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.scene.tables import Table
from crankmbs.scene.units import DEGREE

__all__ = ["SAME_ANGLE", "check_whole", "cycles_in", "mean_cycle"]

SAME_ANGLE = 1e-9  # rad: two angles of a table closer than this are one
_UNEVEN = 2.0  # times the widest gap between rows: more than that is missing of a whole cycle


def cycles_in(table: Table, period: float) -> int:
    """How many periods [rad] the rows span, the last one begun.

    >>> cycles_in(Table([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 1.0, 3.0]), 2.0)
    2
    """
    span = table.x[-1] - table.x[0]
    return max(1, int(np.ceil((span - SAME_ANGLE) / period)))


def check_whole(table: Table, period: float) -> None:
    """Refuse a file of several cycles whose last one is not whole.

    Raises
    ------
    InputError : how much it spans
    """
    span = table.x[-1] - table.x[0]
    missing = cycles_in(table, period) * period - span
    widest = max(b - a for a, b in pairwise(table.x))
    if missing > _UNEVEN * widest + SAME_ANGLE:
        raise InputError(
            f"{table.source}: the rows span {span / DEGREE:g} degrees, and several cycles must be "
            f"whole ones of {period / DEGREE:g}; {missing / DEGREE:g} degrees are missing; leave "
            "out the rows of the last cycle, or add what is missing"
        )


def mean_cycle(table: Table, period: float) -> Table:
    """The mean of all cycles, row by row; a file of one cycle as it is.

    Raises
    ------
    InputError : cycles whose rows do not stand at the same angles

    >>> mean_cycle(Table([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 6.0]), 2.0).y
    (2.0, 4.0)
    """
    count = cycles_in(table, period)
    if count == 1:
        return table
    cycles = _cycles(table, period, count)
    first = cycles[0][0]
    for number, (angle, _) in enumerate(cycles[1:], start=2):
        if len(angle) != len(first) or np.max(np.abs(angle - first)) > SAME_ANGLE:
            raise InputError(
                f'{table.source}: for cycles = "mean" the rows of every cycle must be at the '
                f"angles of the first; those of cycle {number} are not; resample the file, or give "
                'cycles = "sequence"'
            )
    mean = np.mean([value for _, value in cycles], axis=0)
    if first[-1] > first[0] + period - SAME_ANGLE:  # a jump where the period ends
        first, mean = np.append(first, first[0] + period), np.append(mean, mean[0])
    return Table(tuple(first.tolist()), tuple(mean.tolist()), table.source)


def _cycles(table: Table, period: float, count: int) -> list[tuple[Array, Array]]:
    """Angles, less the periods before, and values of each cycle. Of two rows where one cycle ends
    the first belongs to it; a single one begins the next, behind the last the first again."""
    x, y = np.array(table.x), np.array(table.y)
    if x[1] == x[0]:  # before the jump where all begins: the end of the last cycle
        closing = np.count_nonzero(x > x[0] + count * period - SAME_ANGLE)
        inner = slice(1, len(x) - closing)
        end, before = x[0] + count * period, y[len(y) - closing] if closing == 2 else y[0]
        x, y = np.append(x[inner], [end, end]), np.append(y[inner], [before, y[1]])
    cycles = []
    for cycle in range(count):
        begin, end = x[0] + cycle * period, x[0] + (cycle + 1) * period
        at_begin = np.flatnonzero(np.abs(x - begin) < SAME_ANGLE)
        at_end = np.flatnonzero(np.abs(x - end) < SAME_ANGLE)
        low = at_begin[-1] if len(at_begin) else np.searchsorted(x, begin)
        high = at_end[-1] if len(at_end) else np.searchsorted(x, end)
        cycles.append((x[low:high] - cycle * period, y[low:high]))
    return cycles
