"""The table for a scene: the mean cycle, or some cycles one after the other, over the cycle angle.

Cycle angle 360 degrees (0 of a two-stroke cycle) puts the throw on the cylinder axis; the file's
dead centre is the true one, which with an offset lies beside it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from crankmbs.errors import InputError
from crankmbs.indicated.findings import CylinderPressure
from crankmbs.indicated.record import Record
from crankmbs.indicated.referencing import Cycles
from crankmbs.indicated.shape import Shape
from crankmbs.numerics.arrays import Array
from crankmbs.scene.tables import CylinderTable, Table

__all__ = ["table_of"]


def table_of(
    record: Record,
    cylinders: Sequence[CylinderPressure],
    cut: Sequence[Cycles],
    shape: Shape | None,
    cycles: tuple[int, int | None] | None,
) -> tuple[Table | CylinderTable, str]:
    """The table [rad, Pa] over the cycle angle of the first cylinder, and what it holds.

    cut : the cycles of each cylinder as they were cut from the record

    Raises
    ------
    InputError : cycles that are not there, or that do not follow one another
    """
    period = record.period
    top = 0.0 if shape is None else math.degrees(shape.top)
    zero = 360.0 if record.stroke == 4 else 0.0
    angle = cylinders[0].angle + zero + top
    words = f"cycle angle {zero:g} degrees is the firing dead centre"
    if top:
        words = (
            f"the true firing dead centre is at a cycle angle of {zero + top:.5g} degrees, as "
            "the offset asks for"
        )
    firsts = [each.first for each in cut]
    if cycles is None:
        return _mean(cylinders, firsts, angle, period), f"the table holds the mean cycle; {words}"
    _check_follow(cut)
    sequence = _sequence(cylinders, firsts)
    whole = sequence.shape[1]
    first, last = cycles[0], cycles[1] or whole
    if last > whole:
        raise InputError(f"cycles must be among the {whole} whole ones; {last} came")
    chosen = sequence[:, first - 1 : last]
    count = chosen.shape[1]
    long = np.concatenate([angle + k * period for k in range(count)])
    which = f"cycle {first}" if first == last else f"cycles {first} to {last}"
    gap = "" if all(each.follow for each in cut) or count == 1 else ", which do not all follow"
    return (
        _tabulated(long, chosen.reshape(len(cylinders), -1)),
        f"the table holds {which} of {whole}{gap}; {words}",
    )


def _mean(
    cylinders: Sequence[CylinderPressure], firsts: Sequence[int], angle: Array, period: float
) -> Table | CylinderTable:
    """Mean cycles, in the first one's order of rows."""
    rows = [
        np.roll(each.mean, first - firsts[0]) for each, first in zip(cylinders, firsts, strict=True)
    ]
    within = np.mod(angle + 1e-9, period) - 1e-9
    order = np.argsort(within)
    return _tabulated(within[order], np.array(rows)[:, order])


def _check_follow(cut: Sequence[Cycles]) -> None:
    """Refuse cycles of several cylinders that do not follow one another."""
    apart = [each.channel.cylinder for each in cut if not each.follow]
    if apart and len(cut) > 1:
        raise InputError(
            f"the cycles of cylinder {apart[0]} do not follow one another, so they cannot "
            'stand beside those of others; give cycles="mean", or one column'
        )


def _sequence(cylinders: Sequence[CylinderPressure], firsts: Sequence[int]) -> Array:
    """Whole cycles that all cylinders have, as the first one counts them; shape (cylinders,
    cycles, n)."""
    n = len(cylinders[0].angle)
    flat = [each.pressure.reshape(-1) for each in cylinders]
    begin = firsts[0] + n * max(0, math.ceil((max(firsts) - firsts[0]) / n))
    whole = (min(first + len(each) for first, each in zip(firsts, flat, strict=True)) - begin) // n
    if whole < 1:
        raise InputError('no cycle is whole in every cylinder; give cycles="mean", or one column')
    parts = [
        each[begin - first : begin - first + whole * n]
        for each, first in zip(flat, firsts, strict=True)
    ]
    return np.array(parts).reshape(len(cylinders), whole, n)


def _tabulated(angle: Array, rows: Array) -> Table | CylinderTable:
    x = tuple(np.radians(angle).tolist())
    y = tuple(tuple(row) for row in rows.tolist())
    return Table(x, y[0], "measured") if len(y) == 1 else CylinderTable(x, y, "measured")
