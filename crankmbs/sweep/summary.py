"""What a sweep amounts to: how its cases ended, and between which bounds each measure lies."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crankmbs.sweep.store import columns_in

__all__ = ["Bounds", "Summary", "summary"]


class Bounds(NamedTuple):
    """A measure over all cases that have it, in its units; error : the largest of its errors."""

    name: str
    long_name: str
    units: str
    least: float
    largest: float
    error: float


@dataclass(frozen=True)
class Summary:
    """How a sweep ended.

    ended : status -> how many cases, and the sentence of the first of them
    bounds : of every measure that is one number
    """

    ended: dict[int, tuple[int, str]]
    bounds: tuple[Bounds, ...]


def summary(path: Path) -> Summary:
    """Sum up a store, one column in memory after the other.

    Raises
    ------
    OutputError : no sweep
    """
    columns = columns_in(path)
    status, message = columns["status"][:], columns["message"]
    ended = {}
    for one in np.unique(status).tolist():
        cases = np.flatnonzero(status == one)
        ended[one] = (len(cases), str(message[int(cases[0])]))
    bounds = []
    for name in columns:
        if f"{name}_error" not in columns or columns[name].ndim != 1:
            continue  # no measure, or not one number
        values, errors = columns[name][:], columns[f"{name}_error"][:]
        if np.all(np.isnan(values)):
            continue
        words, units = (str(columns[name].attrs[which]) for which in ("long_name", "units"))
        size = float(np.nanmin(values)), float(np.nanmax(values)), float(np.nanmax(errors))
        bounds.append(Bounds(name, words, units, *size))
    return Summary(ended, tuple(bounds))
