"""Whole periods of an affine motion at once, where none of them is kept.

From one period to the next the energy goes through the same affine map: E becomes E + (growth E +
rise) at the end of the period, and gain E + shift at each of its nodes. So it rises or falls
monotonically, and what holds in the first period and in the last holds in all between: the limits
of speed and of slowness need no other look.
"""

from __future__ import annotations

import math
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.crank_angle.grid import Grid, Strip
from crankmbs.numerics.arrays import Array

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
        block = max(8 * spare, _TOGETHER // len(self.gain))
        done, total = 0, 0.0
        while done < most:
            energies = np.array(
                list(
                    accumulate(
                        range(block),
                        lambda e, _: e + (self.growth * e + self.rise),
                        initial=energy,
                    )
                )
            )
            with np.errstate(invalid="ignore", divide="ignore"):
                roots = np.sqrt(energies[:-1, None] * self.gain + self.shift)
                spent = np.cumsum((1.0 / roots) @ self.weight)
            ended = int(np.searchsorted(~(time + spent <= t_end), True))
            count = int(min(ended - spare, most - done))
            if count <= 0:
                break
            total += float(np.sum(energies[:count]))
            energy, time, done = (
                float(energies[count]),
                time + float(spent[count - 1]),
                done + count,
            )
        return Skipped(done, energy, total / max(done, 1), time)


def period_of(grid: Grid, strip: Strip, branch: Branch, sense: float) -> Period:
    """Compose the maps of the cells of one period, given as a strip."""
    from crankmbs.motion.crank_angle import loops  # numba is loaded only where a run needs it

    rule, (growth, rise) = grid.rule, np.empty((2, len(strip.width)))
    gain, shift, weight = np.empty((3, *strip.inertia.shape))
    push, rate = strip.torque + branch.c0, 2.0 * branch.c2 / strip.inertia
    cells = sense * strip.width, strip.width, push, rate, strip.inertia
    found = gain, shift, weight, growth, rise
    loops.compose(cells, (rule.matrix, rule.weights), found)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = (1.0 + growth[-1]) / (1.0 + growth)  # what the rest of the period makes of it
    # the cells' rises nearly cancel in a steady motion
    whole = float(growth[-1]), math.fsum((rise * left).tolist())
    return Period(*whole, gain.ravel(), shift.ravel(), weight.ravel())
