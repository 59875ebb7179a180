"""Whole periods of an affine motion at once, where none of them is kept.

From one period to the next the energy goes through the same affine map: E becomes E + (growth E +
rise) at the end of the period, and gain E + shift at each of its nodes. So it rises or falls
monotonically, and what holds in the first period and in the last holds in all between: the limits
of speed and of slowness need no other look.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.crank_angle.grid import Grid, Terms
from crankmbs.motion.crank_angle.solvers import surplus
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import carried

__all__ = ["Period", "Skipped", "period_of"]

_TOGETHER = 60_000  # nodes: they stay in the processor's cache


class Skipped(NamedTuple):
    """Periods passed, the energy [J] after them, its mean at their beginnings, and the time [s]."""

    periods: int
    energy: float
    mean: float
    time: float


class Period(NamedTuple):
    """The map over one period, and what gives its duration.

    gain, shift : shape (nodes,); weight [s J^(1/2)], so that the period takes
    sum(weight / sqrt(gain E + shift))
    """

    growth: float
    rise: float
    gain: Array
    shift: Array
    weight: Array

    def run(self, energy: float, time: float, most: float, t_end: float, spare: int) -> Skipped:
        """As many periods as end ``spare`` periods before ``t_end``, ``most`` at most."""
        block = max(8, _TOGETHER // len(self.gain))
        done, total, clock = 0, 0.0, np.longdouble(time)  # alike in every pass, rounding is unseen
        while done < most:
            growth, rise = np.full((2, block), [[self.growth], [self.rise]])
            with np.errstate(all="ignore"):
                energies = carried(growth, rise, energy)
                roots = np.sqrt(energies[:-1, None] * self.gain + self.shift)
                spent = clock + np.cumsum((1.0 / roots) @ self.weight, dtype=np.longdouble)
            ended = int(np.searchsorted(~(spent <= t_end), True))
            if ended == block <= spare:
                block *= 2  # too few to know which are spare
                continue
            count = int(min(ended - spare, most - done))
            if count <= 0:
                break
            total += float(np.sum(energies[:count]))
            energy, clock, done = float(energies[count]), spent[count - 1], done + count
            if ended < block:
                break
        return Skipped(done, energy, total / max(done, 1), float(clock))


def period_of(grid: Grid, terms: Terms, branch: Branch, sense: float) -> Period:
    """Compose the maps of the cells of one period."""
    rule, inertia = grid.rule, terms.inertia
    push, rate = terms.torque + branch.c0, 2.0 * branch.c2 / inertia
    maps = rule.maps(sense * terms.pace, push, rate)
    gain, shift, grown, _ = maps.composed()
    weight = np.sqrt(0.5 * inertia) * terms.pace * rule.weights
    with np.errstate(divide="ignore", invalid="ignore"):
        left = (1.0 + grown[-1]) / (1.0 + grown[1:])  # what the rest of the period makes of it
    # the cells' rises nearly cancel in a steady motion
    rise = math.fsum((maps.rise * left).tolist())
    rise -= surplus(grid, branch, sense, maps.rise) * float(grid.edges[-1])
    return Period(float(grown[-1]), rise, gain.ravel(), shift.ravel(), weight.ravel())
