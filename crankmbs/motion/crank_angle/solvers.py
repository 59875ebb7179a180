"""The energy over the crank angle, cell by cell: affine maps, or Newton's method.

Each has two ways, arrays for all cells at once and the compiled loop of
`crankmbs.motion.crank_angle.loops`, which give the same to rounding.
"""

from __future__ import annotations

from itertools import accumulate
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.crank_angle import loops
from crankmbs.motion.crank_angle.grid import Grid, Strip
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import Maps

__all__ = ["Begin", "Cells", "solve_affine", "solve_newton"]

_NEWTON = 20


class Begin(NamedTuple):
    """Sense of rotation, kinetic energy [J] and time [s] where the cells begin; the compiled loops
    end after the cell that passes ``t_end``."""

    sense: float
    energy: float
    time: float
    t_end: float


class Cells(NamedTuple):
    """Solved cells: energy and time at their edges, torque and slowness at their nodes."""

    edges: Array
    time: Array
    torque: Array
    slowness: Array

    @staticmethod
    def empty(strip: Strip) -> Cells:
        """Room for the answer of a compiled loop."""
        edges, time = np.empty((2, len(strip.width) + 1))
        torque, slowness = np.empty((2, *strip.inertia.shape))
        return Cells(edges, time, torque, slowness)

    def first(self, m: int) -> Cells:
        """The first m cells."""
        return Cells(self.edges[: m + 1], self.time[: m + 1], self.torque[:m], self.slowness[:m])


def solve_affine(
    grid: Grid, strip: Strip, branch: Branch, begin: Begin, *, compiled: bool
) -> Cells:
    """dE/du = sense (T + c0) + 2 sense c2 E / J: an affine map per cell, the same every period."""
    m, n = len(strip.width), len(grid.edges) - 1
    once = min(m - 1, n + 1)  # the first cell may be a part; then one period, then the last cell
    which = np.append(np.arange(once), m - 1)
    again = np.append(np.arange(m - 1), once)
    again[once:-1] = 1 + (again[once:-1] - 1) % n
    inertia, push = strip.inertia[which], strip.torque[which] + branch.c0
    rate, signed = 2.0 * branch.c2 / inertia, begin.sense * strip.width[which]
    if compiled:
        cells, rule = Cells.empty(strip), (grid.rule.matrix, grid.rule.weights)
        loads, ends = (signed, push, rate, inertia), begin[1:]
        maps = (*np.empty((2, *push.shape)), *np.empty((2, len(push))))
        room = np.empty((push.shape[1], push.shape[1] + 2))
        return cells.first(loops.affine(again, loads, maps, room, rule, ends, strip.width, *cells))
    maps = grid.rule.maps(signed, push, rate)
    edges, energy = _chain(Maps(*(part[again] for part in maps)), begin.energy)
    slowness = np.sqrt(0.5 * strip.inertia / energy)
    time = _clock(begin.time, strip.width * (slowness @ grid.rule.weights))
    return Cells(edges, time, push[again] + rate[again] * energy, slowness)


def solve_newton(
    grid: Grid, strip: Strip, loads: Branch | Course, begin: Begin, *, compiled: bool
) -> Cells:
    """Newton's method: compiled, cell after cell; with arrays, on all cells at once, where time,
    by quadrature, follows behind."""
    sense, start, t0, t_end = begin
    rule = grid.rule
    if compiled:
        cells = Cells.empty(strip)
        bounds = (t_end, loads.omega_low, loads.omega_high)
        tables = (strip.width, strip.inertia, strip.torque)
        at, gauss = (start, t0, sense), (rule.matrix, rule.weights)
        return cells.first(loops.newton(loads.tables, bounds, at, gauss, tables, *cells))
    energy = np.full(strip.inertia.shape, start)
    t = np.full(strip.inertia.shape, t0)
    slowness = np.sqrt(0.5 * strip.inertia / energy)
    for _ in range(_NEWTON):
        omega = sense / slowness
        torque = strip.torque + loads(t, omega)
        rate = loads.slope(omega) / (strip.inertia * omega)
        maps = rule.maps(sense * strip.width, torque - rate * energy, rate)
        edges, new = _chain(maps, start)
        change = np.abs(new / energy - 1.0).max(axis=1)
        energy = new
        slowness = np.sqrt(0.5 * strip.inertia / energy)
        time = _clock(t0, strip.width * (slowness @ rule.weights))
        t = time[:-1, None] + strip.width[:, None] * (slowness @ rule.matrix.T)
        if (change < 1e-14).all():
            break
    slowness[~np.logical_and.accumulate(change < 1e-11)] = np.nan
    return Cells(edges, time, strip.torque + loads(t, sense / slowness), slowness)


def _clock(t0: float, spent: Array) -> Array:
    """Time at the edges from the times spent in the cells; summed in more bits where there are:
    passes over the same cells would round alike, and not see it in their difference."""
    return np.asarray(t0 + np.append(0.0, np.cumsum(spent, dtype=np.longdouble)), dtype=np.float64)


def _chain(maps: Maps, start: float) -> tuple[Array, Array]:
    """Energy at edges and nodes, cell after cell; what a sum loses by rounding goes to the next."""

    def step(before: tuple[float, float], maps: tuple[float, float]) -> tuple[float, float]:
        (energy, lost), (growth, rise) = before, maps
        gained = growth * energy + rise - lost
        after = energy + gained
        return after, (after - energy) - gained

    steps = zip(maps.growth.tolist(), maps.rise.tolist(), strict=True)
    edges = np.array([energy for energy, _ in accumulate(steps, step, initial=(start, 0.0))])
    return edges, maps.gain * edges[:-1, None] + maps.shift
