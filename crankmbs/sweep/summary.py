"""The summary of a sweep: how its cases ended, and between which bounds each measure lies."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product, repeat
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crankmbs.sweep.store import read_store

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
    """Sum up a store, a block in memory after the other.

    Raises
    ------
    OutputError : no sweep
    """
    data = read_store(path)
    status, measures = data["status"].values, data["measures"]
    sizes = measures.encoding["chunks"]
    least, largest = np.full((2, measures.shape[-1]), np.nan)
    for first in product(*map(range, repeat(0), measures.shape, sizes)):
        block = measures[tuple(map(slice, first, np.add(first, sizes)))]
        of_cases = block.values.reshape(-1, measures.shape[-1])
        least = np.fmin(least, np.fmin.reduce(of_cases))
        largest = np.fmax(largest, np.fmax.reduce(of_cases))
    places = {name: k for k, name in enumerate(data["measure"].values.tolist())}
    words, units = (measures.attrs[label] for label in ("long_name", "units"))
    bounds = [
        Bounds(name, words[k], units[k], *map(float, (least[k], largest[k], largest[error])))
        for name, k in sorted(places.items())
        if (error := places.get(f"{name}_error")) is not None and not np.isnan(least[k])
    ]
    groups = (
        column.tolist() for column in np.unique(status, return_index=True, return_counts=True)
    )
    ended = {
        kind: (count, data["message"][np.unravel_index(first, status.shape)].item())
        for kind, first, count in zip(*groups, strict=True)
    }
    return Summary(ended, tuple(bounds))
