"""Curves over time, with points between samples that lie far apart on paper."""

from __future__ import annotations

import numpy as np

from crankmbs.measures import interp
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["over_time"]

_WIDTH = 500  # of a panel, in the longest lines that are drawn straight


def over_time(result: Result, first: int = 0) -> dict[str, Array]:
    """Time [s], crank angle [rad] and the variables of a result from a sample on, by name, for a
    panel of all of it.

    Samples at equal angles lie far apart in time where the crank turns back. Between them the
    motion is read as it was solved; without it, as of some loaded results, there are samples alone.
    """
    values = {
        name: values[first:] for name, (of, values, _) in result.variables.items() if "time" in of
    }
    time = values["time"]
    pieces = np.ceil(np.diff(time) * _WIDTH / max(float(np.ptp(time)), np.finfo(float).tiny))
    if result.motion is None:
        return values
    begin = result.passes.answer.begin  # of a long run with few samples the end is kept
    wide = np.flatnonzero((pieces > 1.0) & (time[:-1] >= begin))
    if not wide.size:
        return values
    added = [np.linspace(time[k], time[k + 1], int(pieces[k]) + 1)[1:-1] for k in wide]
    between = interp(result, time=np.concatenate(added))
    places = np.repeat(wide + 1, [len(times) for times in added])
    return {
        name: np.insert(v, places, between[name].values, axis=0)
        for name, v in values.items()
        if name in between
    }
