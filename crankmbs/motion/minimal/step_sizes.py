"""The steps over time that a pass took, which a later pass halves."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections.abc import Iterable

__all__ = ["StepSizes"]

_DIED_OUT = 1e-12  # of the time: steps as short led to where a load has no value, and need no half


class StepSizes:
    """When the steps of a pass begin and how long they are [s]: without bound where the crank angle
    carries it.

    >>> steps = StepSizes()
    >>> steps.add([0.0, 1.0, 1.5], [1.0, 0.5, math.inf])
    >>> steps.halved(0.0, 1.0), steps.halved(1.0, 0.8), steps.halved(1.5, 1.0)
    (0.5, 0.25, 1.0)
    """

    def __init__(self) -> None:
        self._begins, self._sizes = array("d"), array("d")

    def add(self, begins: Iterable[float], sizes: Iterable[float]) -> None:
        """Add steps that follow those so far."""
        self._begins.extend(begins)
        self._sizes.extend(sizes)

    def at(self, time: float) -> float:
        """How long the step is [s] that is under way at a time [s]; without bound before any."""
        k = bisect_right(self._begins, time)
        return self._sizes[k - 1] if k else math.inf

    def halved(self, time: float, size: float) -> float:
        """A step [s] from a time [s] on, no longer than half the one under way at its middle."""
        least = _DIED_OUT * abs(time)
        while size > (half := 0.5 * self.at(time + 0.5 * size)) > least:
            size = half
        return size
