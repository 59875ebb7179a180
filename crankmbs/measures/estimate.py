"""Numbers read from a motion, each with an error: one rule for all of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs.motion.motion import Motion, Passes
from crankmbs.numerics.arrays import Array

__all__ = ["ROUNDING", "Estimate", "Number", "Numbers", "estimates"]

ROUNDING = 64 * float(np.finfo(float).eps)  # of what a number is summed from


class Estimate(NamedTuple):
    """A value and an estimate of its absolute error, in one unit."""

    value: float
    error: float


class Number(NamedTuple):
    """What is read from one motion, shape (n,), and how large that is which was summed up to it."""

    value: Array
    size: Array

    def over(self, divisor: float | Array) -> Number:
        """Divided by a number, or by many."""
        return Number(self.value / divisor, self.size / np.abs(divisor))

    @property
    def summed(self) -> Number:
        """The sum."""
        return Number(self.value.sum(keepdims=True), self.size.sum(keepdims=True))


Numbers = dict[str, Number]


def estimates(passes: Passes, read: Callable[[Motion], Numbers]) -> dict[str, tuple[Estimate, ...]]:
    """Numbers of a motion with their errors: the share of the largest difference from the same
    numbers of the motions that check it, and 64 units of rounding of what they are summed from;
    infinite where nothing checks it.
    """
    answer = read(passes.answer)
    checks = [read(motion) for motion in passes.checks]
    measured = {}
    for name, number in answer.items():
        value, size = np.atleast_1d(number.value), np.atleast_1d(number.size)
        error = np.full(len(value), math.inf)
        if checks:
            apart = [np.abs(np.atleast_1d(check[name].value) - value) for check in checks]
            error = passes.share * np.max(apart, axis=0) + ROUNDING * size
        pairs = zip(value.tolist(), error.tolist(), strict=True)
        measured[name] = tuple(Estimate(*pair) for pair in pairs)
    return measured
