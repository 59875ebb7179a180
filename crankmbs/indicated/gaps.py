"""Missing cells: a short gap is bridged between its neighbours, a cycle with a long one, or without
some of its rows, left out; a cell that is a spike refused. What was done is said."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from crankmbs.errors import InputError
from crankmbs.indicated.record import Channel, Record
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import BAR

__all__ = ["bridged", "check_spike"]

_ALONE = 0.2  # of a peak over the lowest pressure: less beside it is no cylinder's pressure
_LONGEST = 3  # rows that a straight line bridges


def bridged(record: Record, channel: Channel) -> tuple[Array, list[str]]:
    """The cycles of a channel, shape (cycles, n), NaN in those with a long gap; what was done.

    Raises
    ------
    InputError : every cycle has a long gap
    """
    missing = np.isnan(channel.values)
    padded = np.pad(missing, [(0, 0), (0, _LONGEST)])
    torn = np.any(np.all(sliding_window_view(padded, _LONGEST + 1, axis=1), axis=-1), axis=1)
    if torn.all():
        at = record.angle[np.argmax(missing[0])]
        raise InputError(
            f"column {channel.name} has more than {_LONGEST} missing cells in a row, at {at:g} "
            "degrees, in every cycle; choose other columns, or export it again"
        )
    values, remarks = channel.values.copy(), []
    for cycle in np.flatnonzero(missing.any(axis=1) & ~torn):
        gap = missing[cycle]
        values[cycle, gap] = np.interp(
            record.angle[gap], record.angle[~gap], values[cycle, ~gap], period=record.period
        )
        remarks.append(
            f"{channel.name}: {np.sum(gap)} missing cells of cycle {cycle + 1}, from "
            f"{record.angle[np.argmax(gap)]:g} degrees, lie now on straight lines between their "
            "neighbours"
        )
    out = np.flatnonzero(torn)
    if len(out):
        listed = ", ".join(str(k + 1) for k in out[:10]) + (" ..." if len(out) > 10 else "")
        remarks.append(
            f"{channel.name}: {len(out)} of {len(values)} cycles are left out for missing rows, or "
            f"more than {_LONGEST} missing cells in a row: {listed}; "
            "the others are numbered without them"
        )
    return values, remarks


def check_spike(record: Record, channel: Channel, values: Array) -> None:
    """Refuse a mean cycle whose peak is a single row of a single cycle.

    values : shape (cycles, n) [Pa]
    """
    mean = np.nanmean(values, axis=0)
    row = int(np.argmax(mean))
    cycle = int(np.nanargmax(values[:, row]))
    low, high = float(np.min(mean)), float(values[cycle, row])
    beside = float(max(values[cycle, row - 1], values[cycle, (row + 1) % len(mean)]))
    if beside - low < _ALONE * (high - low):
        raise InputError(
            f"{channel.name}: its highest pressure, {high / BAR:.4g} bar at {record.angle[row]:g} "
            f"degrees in cycle {cycle + 1}, is a spike: the rows beside it are at most "
            f"{beside / BAR:.4g} bar; correct it, or leave that cycle out"
        )
