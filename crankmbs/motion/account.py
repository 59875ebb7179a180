"""What a run came by on its way, in rows: kept beside the samples, and the same however those are
spaced."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.peaks import peak
from crankmbs.numerics.arrays import Array

__all__ = ["Account", "Keep", "Kind", "Rows", "beside"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # of the largest value of a column


class Kind(IntEnum):
    """What happens: a cylinder decides its share of the combustion; a load sets in, or ends; the
    crank comes to rest, moves off from it, or turns back."""

    FUEL = 1
    LOAD_ON = 2
    LOAD_OFF = 3
    REST = 4
    START = 5
    REVERSAL = 6


@dataclass(frozen=True)
class Rows:
    """Rows of a table.

    columns : by name, shape (n,) or (n, m) each; errors : of each column, absolute
    left_out : how many rows were left out, of what is stated where they are made
    """

    columns: Mapping[str, Array]
    errors: Mapping[str, float]
    left_out: int = 0

    @property
    def count(self) -> int:
        """How many rows there are."""
        return len(next(iter(self.columns.values())))


class Account(NamedTuple):
    """The events of a run, and its whole cycles."""

    events: Rows
    cycles: Rows


Keep = Callable[[], Account]
"""Makes the account of a run; following it once more where it was not kept."""


def beside(rows: Sequence[Rows], share: float) -> Rows:
    """The first of several answers of the same rows, with its error: a share of what the others
    differ from it by at most, its rounding, and what it states itself; unknown, infinite, where
    there is no other.

    >>> one, other = (Rows({"x": np.array([x])}, {}) for x in (1.0, 1.5))
    >>> round(beside([one, other], 2.0).errors["x"], 9)
    1.0
    """
    answer, *others = rows
    errors = {}
    for name, values in answer.columns.items():
        known = np.isfinite(values)
        apart = [peak(np.where(known, each.columns[name] - values, 0.0)) for each in others]
        rounding = _ROUNDING * peak(np.where(known, values, 0.0))
        errors[name] = (
            share * max(apart, default=math.inf) + rounding + answer.errors.get(name, 0.0)
        )
    return Rows(answer.columns, errors, answer.left_out)
