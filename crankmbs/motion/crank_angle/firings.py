"""Cells of the crank angle across the decisions on the fuel, which fall on edges of cells.

Between two decisions the shares of the combustion are fixed, and with them the torque over the
angle: a stretch of cells is solved as any other.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.functions import solve_functions
from crankmbs.motion.crank_angle.grid import Grid, Strip
from crankmbs.motion.crank_angle.solvers import Begin, Cells, solve_affine, solve_newton
from crankmbs.motion.mode import Mode, decided

__all__ = ["Fired", "solve", "solve_fired"]

_HAIR = 1e-9  # rad: an edge so near is where the decision falls


class Fired(NamedTuple):
    """Solved cells, their strip with the torque of the combustion, and from which cell on each mode
    holds."""

    cells: Cells
    strip: Strip
    modes: tuple[tuple[int, Mode], ...]


def solve(grid: Grid, strip: Strip, loads: Branch | Course, begin: Begin) -> Cells:
    """The cells of a strip, by the method that the loads allow."""
    if isinstance(loads, Branch) and loads.is_affine_in_energy and not strip.drags:
        return solve_affine(grid, strip, loads, begin)
    if loads.functions:
        return solve_functions(grid, strip, loads, begin)
    return solve_newton(grid, strip, loads, begin)


def solve_fired(
    grid: Grid, strip: Strip, loads: Branch | Course, begin: Begin, state: State
) -> Fired:
    """Solve the cells of a strip from a state on, stretch by stretch from decision to decision."""
    cells, torque = Cells.empty(strip), strip.torque.copy()
    sense, count = begin.sense, len(strip.width)
    cells.edges[0], cells.time[0] = begin.energy, begin.time
    mode, k = state.mode, 0
    modes = [(0, mode)]
    while k < count:
        angle = mode.high if sense > 0.0 else mode.low
        ahead = sense * (angle - state.theta)
        if ahead <= strip.turned[k] + _HAIR:
            energy, time = float(cells.edges[k]), float(cells.time[k])
            mode = decided(grid.train, mode, time, angle, _speed(grid, angle, sense, energy))
            modes.append((k, mode))
            continue
        stop = min(int(strip.turned.searchsorted(ahead - _HAIR)), count)
        part = strip.part(k, stop).fired(np.array(mode.shares))
        there = begin._replace(energy=float(cells.edges[k]), time=float(cells.time[k]))
        found = solve(grid, part, loads, there)
        torque[k:stop], solved = part.torque, len(found.torque)
        cells.edges[k : k + solved + 1], cells.time[k : k + solved + 1] = found.edges, found.time
        cells.torque[k : k + solved], cells.slowness[k : k + solved] = found.torque, found.slowness
        k += solved
        if k < stop or not cells.edges[k] > 0.0 or cells.time[k] >= begin.t_end:
            break
    return Fired(cells.first(k), replace(strip, torque=torque).first(k), tuple(modes))


def _speed(grid: Grid, theta: float, sense: float, energy: float) -> float:
    """The speed [rad/s] at an angle, where a decision asks for it; else NaN."""
    law = grid.train.law
    if law is None or not law.asks_speed:
        return math.nan
    return sense * math.sqrt(2.0 * energy / float(inertia_alone(grid.train.scene, theta)))
