"""Missing cells: a short gap is bridged between its neighbours, a cycle with a long one left out.
What was done is said."""

from __future__ import annotations

import numpy as np

from crankmbs.errors import InputError
from crankmbs.indicated.record import Channel, Record
from crankmbs.numerics.arrays import Array

__all__ = ["without_gaps"]

_LONGEST = 3  # rows that a straight line bridges


def without_gaps(record: Record, channel: Channel, where: str) -> tuple[Array, bool, list[str]]:
    """The cycles of a channel without missing cells; whether some were left out; what was done.

    Raises
    ------
    InputError : nothing is left
    """
    values, remarks = channel.values, []
    missing = np.isnan(values)
    if not missing.any():
        return values, False, []
    values = values.copy()
    bad = np.flatnonzero(missing.any(axis=1))
    whole = np.ones(len(values), dtype=bool)
    for cycle in bad:
        if _longest(missing[cycle]) > _LONGEST:
            whole[cycle] = False
            continue
        gap = missing[cycle]
        values[cycle, gap] = np.interp(
            record.angle[gap], record.angle[~gap], values[cycle, ~gap], period=record.period
        )
        at = record.angle[np.flatnonzero(gap)[0]]
        remarks.append(
            f"{channel.name}: {int(gap.sum())} missing cells of cycle {cycle + 1}, from {at:g} "
            "degrees, lie now on straight lines between their neighbours"
        )
    out = np.flatnonzero(~whole)
    if len(out) == len(values):
        at = record.angle[np.flatnonzero(missing[0])[0]]
        raise InputError(
            f"{where}: column {channel.name} has more than {_LONGEST} missing cells in a row, at "
            f"{at:g} degrees, in every cycle; choose other columns, or export it again"
        )
    if len(out):
        listed = ", ".join(str(k + 1) for k in out[:10]) + (" ..." if len(out) > 10 else "")
        remarks.append(
            f"{channel.name}: {len(out)} of {len(values)} cycles have more than {_LONGEST} missing "
            f"cells in a row and are left out: {listed}"
        )
    return values[whole], bool(len(out)), remarks


def _longest(missing: np.ndarray) -> int:
    """The longest run of missing cells."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], missing.astype(int), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))
