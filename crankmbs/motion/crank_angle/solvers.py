"""The energy over the crank angle, cell by cell: affine maps, or Newton's method, in the compiled
loops of `crankmbs.motion.crank_angle.loops`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.crank_angle import loops
from crankmbs.motion.crank_angle.grid import Grid, Strip
from crankmbs.numerics.arrays import Array

__all__ = ["Begin", "Cells", "solve_affine", "solve_newton"]


class Begin(NamedTuple):
    """Sense of rotation, kinetic energy [J], time [s] and crank angle [rad] where the cells begin;
    they end after the cell that passes ``t_end``."""

    sense: float
    energy: float
    time: float
    t_end: float
    angle: float


class Cells(NamedTuple):
    """Solved cells: energy and time at their edges, torque and slowness at their nodes."""

    edges: Array
    time: Array
    torque: Array
    slowness: Array

    @property
    def bare(self) -> tuple[Array, Array, Array, Array]:
        """As a loop takes them."""
        return self.edges, self.time, self.torque, self.slowness

    @staticmethod
    def empty(strip: Strip) -> Cells:
        """Room for the answer of a loop."""
        edges, time = np.empty((2, len(strip.width) + 1))
        torque, slowness = np.empty((2, *strip.inertia.shape))
        return Cells(edges, time, torque, slowness)

    def first(self, m: int) -> Cells:
        """The first m cells."""
        if m == len(self.torque):
            return self
        return Cells(self.edges[: m + 1], self.time[: m + 1], self.torque[:m], self.slowness[:m])


def solve_affine(grid: Grid, strip: Strip, branch: Branch, begin: Begin) -> Cells:
    """dE/du = sense (T + c0) + 2 sense c2 E / J: an affine map per cell, the same every period."""
    alike = grid.train.law is None  # whose shares differ from period to period
    period = len(grid.edges) - 1 if alike else len(strip.width)
    cells, rule = Cells.empty(strip), (grid.rule.matrix, grid.rule.weights)
    tables, loads = (strip.width, strip.inertia, strip.torque), (branch.c0, branch.c2, begin.sense)
    return cells.first(loops.affine(period, tables, loads, rule, begin[1:4], cells.bare))


def solve_newton(grid: Grid, strip: Strip, loads: Branch | Course, begin: Begin) -> Cells:
    """Newton's method, cell after cell."""
    sense, start, t0, t_end, _ = begin
    cells = Cells.empty(strip)
    bounds = (t_end, loads.omega_low, loads.omega_high)
    tables = (strip.width, strip.inertia, strip.torque, strip.drag)
    at, gauss = (start, t0, sense), (grid.rule.matrix, grid.rule.weights)
    return cells.first(loops.newton(loads.tables, bounds, at, gauss, tables, cells.bare))
