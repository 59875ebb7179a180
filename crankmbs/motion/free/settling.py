"""A settled motion on the grids of the passes: the fixed point of what a period makes of the
numbers that it hands to the next.

So its error, and what 1 / (1 - factor) makes of it, is in the difference of the passes like any
other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from crankmbs.motion.base import Decay, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.ending import Ending
from crankmbs.numerics.arrays import Array

__all__ = ["FINE", "STEP", "WIDE", "LostError", "Settling", "largest", "newton_step", "slope_of"]

FINE = 1e-13
"""Tolerance of the periods that tell the factor."""

STEP, WIDE = 1e-4, 4e-4
"""Of each number's size: differences."""

_EPS = float(np.finfo(float).eps)
_KEPT = 1e-6  # of an integral that nothing changes: rounding of the differences
_POLISHES = 12  # steps at most; they end where a step is not half the one before


_STILL = (Ending.REST, Ending.STICKS, Ending.SWING, Ending.STUCK, Ending.UNMOVED)


class LostError(Exception):
    """The run does not settle, for a reason: how a period ends in which the crank does not turn
    on, or what becomes of them; factor by which one changes a disturbance."""

    def __init__(self, ending: Ending, factor: float = math.nan) -> None:
        super().__init__(ending)
        self.ending = Ending.STALLS if ending in _STILL else ending
        self.factor = factor


@dataclass
class Settling:
    """Where a settled motion begins, and how fast it is reached. The first of its numbers is the
    energy [J]; the second, where there are more, an integral.

    at, slope : numbers near the fixed point, and the derivative of what a period makes of them
    image : what a period makes of them on a grid, by steps of a tolerance
    state : that begins a period with them; sizes : what each of them is measured by
    swing : greatest energy in the period over the one where it begins
    widths, errs : of the differences that tell the factor, and what an image errs in them; one that
        is affine is as exact over wide ones
    """

    at: Array
    slope: Array
    image: Callable[[Grid, float, Array], Array]
    state: Callable[[Array], State]
    sizes: Callable[[Array], Array]
    swing: float = 1.0
    widths: tuple[float, float] = (STEP, WIDE)
    errs: float = FINE
    seen: list[tuple[Grid, Array]] = field(default_factory=list)

    @property
    def damping(self) -> float:
        """1 less the largest factor."""
        return 1.0 - largest(self.slope)

    def begin(self, grid: Grid, local: float) -> State:
        """Where the settled period begins on a grid, by periods with this tolerance; on one that
        checks another beside it, by what rounding may make of it."""
        at = self._polished(grid, local)
        if grid.checks and self.seen:
            more = 4.0 * _EPS * self.swing / self.damping * at[0]
            at[0] += math.copysign(more, at[0] - self.seen[-1][1][0])
        self.seen.append((grid, at))
        return self.state(at)

    def _polished(self, grid: Grid, local: float) -> Array:
        """The fixed point on a grid, from the one before."""
        at, left = (self.seen[-1][1] if self.seen else self.at).copy(), math.inf
        for _ in range(_POLISHES):
            step = newton_step(at, self.image(grid, local, at), self.slope)
            size = float(np.max(np.abs(step) / self.sizes(at)))
            if size > 0.5 * left:
                break  # nothing but what the periods err
            at, left = at + step, size
            if left <= _EPS:
                break
        return at

    def decay(self) -> Decay:
        """The largest factor by which a disturbance changes in a period, and its error: what it
        differs by between two differences, and between the grids of both passes."""
        (one, at), (other, there) = self.seen[-2:]
        step, wide = self.widths
        factors = [
            largest(slope_of(partial(self.image, grid, FINE), here, self.sizes(here), width))
            for grid, here, width in ((other, there, step), (other, there, wide), (one, at, step))
        ]
        apart = sum(abs(factor - factors[0]) for factor in factors[1:])
        return Decay(factors[0], apart + self.errs / step)


def slope_of(image: Callable[[Array], Array], at: Array, sizes: Array, width: float) -> Array:
    """The derivative of what a period makes of the numbers, by differences of so much of their
    sizes."""
    slope = np.empty((len(at), len(at)))
    for k, size in enumerate(sizes):
        ahead, behind = at.copy(), at.copy()
        ahead[k] += width * size
        behind[k] -= width * size
        slope[:, k] = (image(ahead) - image(behind)) / (ahead[k] - behind[k])
    return slope


def newton_step(at: Array, image: Array, slope: Array) -> Array:
    """Newton's step to a fixed point; an integral that a period leaves as it is stays."""
    moves = _moves(slope)
    step = np.zeros_like(at)
    system = np.eye(len(at))[np.ix_(moves, moves)] - slope[np.ix_(moves, moves)]
    step[moves] = np.linalg.lstsq(system, (image - at)[moves], rcond=None)[0]
    return step


def _moves(slope: Array) -> Array:
    """Which of the numbers a period changes: all but an integral that it leaves as it is."""
    kept = np.abs(slope - np.eye(len(slope))) < _KEPT
    return np.array([not (k == 1 and row.all()) for k, row in enumerate(kept)])


def largest(slope: Array) -> float:
    """The largest absolute factor of a disturbance of what a period changes."""
    moves = _moves(slope)
    return float(np.max(np.abs(np.linalg.eigvals(slope[np.ix_(moves, moves)]))))
