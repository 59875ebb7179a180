"""What a sweep amounts to: how its cases ended, and between which bounds each measure lies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.sweep.store import columns_in

if TYPE_CHECKING:
    import zarr

__all__ = ["Bounds", "Summary", "summary"]

_CHUNKS = 256  # of a column in memory at a time


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
    """Sum up a store, a part of a column in memory after the other.

    Raises
    ------
    OutputError : no sweep
    """
    columns = columns_in(path)
    ended = _ended(columns)
    bounds = []
    for name, column in columns.items():
        if f"{name}_error" not in columns or column.ndim != 1:
            continue  # no measure, or not one number
        least, largest = _range(column)
        if least <= largest:
            words, units = (str(column.attrs[which]) for which in ("long_name", "units"))
            error = _range(columns[f"{name}_error"])[1]
            bounds.append(Bounds(name, words, units, least, largest, error))
    return Summary(ended, tuple(bounds))


def _ended(columns: dict[str, zarr.Array[Any]]) -> dict[int, tuple[int, str]]:
    found: dict[int, tuple[int, str]] = {}
    for begin, part in _parts(columns["status"]):
        for status, at, count in zip(
            *(one.tolist() for one in np.unique(part, return_index=True, return_counts=True)),
            strict=True,
        ):
            before, said = found.get(status) or (0, str(columns["message"][begin + at]))
            found[status] = before + count, said
    return dict(sorted(found.items()))


def _range(column: zarr.Array[Any]) -> tuple[float, float]:
    """The least and the largest; inf and -inf where no case has one."""
    least, largest = np.inf, -np.inf
    for _, part in _parts(column):
        least = min(least, float(np.fmin.reduce(part, initial=np.inf)))
        largest = max(largest, float(np.fmax.reduce(part, initial=-np.inf)))
    return least, largest


def _parts(column: zarr.Array[Any]) -> Iterator[tuple[int, Array]]:
    """A column part by part, with the case at which each begins."""
    step = _CHUNKS * column.chunks[0]
    for begin in range(0, column.shape[0], step):
        yield begin, np.asarray(column[begin : begin + step])
