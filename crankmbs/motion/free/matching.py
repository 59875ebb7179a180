"""The samples that two passes over the same motion have in common, and their ends."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crankmbs.motion.base import Samples

__all__ = ["Matched", "match", "stays"]

_SAME_REST = 1e-3  # rad: two passes rest at the same place; how far apart is in the stated error


class Matched(NamedTuple):
    """Samples of either pass, of the second None without a common one; whether the passes part."""

    samples: Samples
    better: Samples | None
    parted: bool


def stays(a: Samples, b: Samples) -> bool:
    """Whether from the earlier end on the other pass stays where the first has ended."""
    short, long = sorted((a, b), key=lambda samples: float(samples.time[-1]))
    later = long.theta[long.time.searchsorted(short.time[-1]) :]
    return bool(np.max(np.abs(later - short.theta[-1])) <= _SAME_REST)


def match(a: Samples, b: Samples, *, in_time: bool, reversals: int, at_rest: bool) -> Matched:
    """The samples that both passes have, and their ends.

    A grid angle within the error of a reversal, or of the end, may be missing in one of them.
    Where they part their ends are left out. A crank at rest stays there: when a pass deems it so
    depends on its tolerance, so what comes after is compared with that end, at equal times.

    at_rest : whether they come to rest at the same place, but for their errors
    """
    grid_a, grid_b = (s.time[:-1] if in_time else s.theta[:-1] for s in (a, b))
    n, m = len(grid_a), len(grid_b)
    if not at_rest and np.array_equal(grid_a, grid_b):
        return Matched(a, b, parted=False)
    kept: list[tuple[int, int]] = []
    i = j = 0
    while i < n and j < m:
        late = a.time[i] - b.time[j]
        if grid_a[i] != grid_b[j]:
            i, j = (i + 1, j) if late < 0.0 else (i, j + 1)
        elif i + 1 < n and grid_a[i + 1] == grid_b[j] and abs(a.time[i + 1] - b.time[j]) < -late:
            i += 1  # turning there it is passed twice, or, within the error, not at all
        elif j + 1 < m and grid_b[j + 1] == grid_a[i] and abs(b.time[j + 1] - a.time[i]) < late:
            j += 1
        else:
            kept.append((i, j))
            i, j = i + 1, j + 1
    common = min(a.time[-1], b.time[-1]) if at_rest else math.inf
    passed = np.count_nonzero(a.time[:-1] < common) + np.count_nonzero(b.time[:-1] < common)
    parted = bool(passed - 2 * len(kept) > 2 * (reversals + 1))
    if parted and not kept:
        return Matched(a, None, parted=True)
    if at_rest:
        kept += [(k, m) for k in range(i, n) if a.time[k] >= b.time[-1]]
    if not parted:
        kept.append((n, m))
    rows_a, rows_b = np.array(kept).T
    a, b = a.select(rows_a), b.select(rows_b)
    if at_rest:
        b = replace(b, time=np.where(rows_b == m, a.time, b.time))
    return Matched(a, b, parted)
