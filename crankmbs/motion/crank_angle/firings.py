"""Cells of the crank angle across the decisions on the fuel, which fall on edges of cells.

Between two decisions the shares of the combustion are fixed, and with them the torque over the
angle: a stretch of cells is solved as any other.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.firing import Firing
from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle import loops
from crankmbs.motion.crank_angle.functions import solve_functions
from crankmbs.motion.crank_angle.grid import Grid, Strip
from crankmbs.motion.crank_angle.solvers import Begin, Cells, solve_affine, solve_newton
from crankmbs.motion.mode import Mode, decided
from crankmbs.numerics.arrays import Array

__all__ = ["Fired", "fired_by_stretch", "solve", "solve_fired"]

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
    """Solve the cells of a strip from a state on, from decision to decision: compiled where loads
    are tables, else stretch by stretch."""
    if loads.functions:
        return fired_by_stretch(grid, strip, loads, begin, state)
    law, mode = grid.train.law, state.mode
    assert law is not None
    assert mode.firing is not None
    sense, count = begin.sense, len(strip.width)
    first = mode.high if sense > 0.0 else mode.low
    reach = float(strip.turned[-1]) - sense * (first - state.theta)
    angles, slots, parts = law.ahead(first, sense, reach)
    at = strip.turned[:count].searchsorted(sense * (angles - state.theta) - _HAIR)
    at[-1] = count  # beyond the strip
    kept, shares = np.empty((len(at), 5)), np.empty((len(at), parts.shape[1]))
    kept[0], shares[0] = _numbers(mode.firing), mode.firing.shares
    cells, torque = Cells.empty(strip), strip.torque.copy()
    start, gauss = (begin.energy, begin.time, sense), (grid.rule.matrix, grid.rule.weights)
    solved, decided_ = loops.fired(
        isinstance(loads, Branch) and loads.is_affine_in_energy and not strip.drags,
        loads.tables,
        (begin.t_end, loads.omega_low, loads.omega_high),
        start,
        gauss,
        (strip.width, strip.inertia, torque, strip.drag),
        strip.of_gas,
        (at, angles, grid.at_decisions[slots], parts),
        law.numbers,
        (kept, shares),
        (cells.edges, cells.time, cells.torque, cells.slowness),
    )
    modes = _modes(mode, sense, angles, kept[: decided_ + 1], shares)
    of_cells = tuple(zip([0, *at[:decided_].tolist()], modes, strict=True))
    return Fired(cells.first(solved), replace(strip, torque=torque).first(solved), of_cells)


def fired_by_stretch(
    grid: Grid, strip: Strip, loads: Branch | Course, begin: Begin, state: State
) -> Fired:
    """The same with decisions as `crankmbs.motion.mode.decided` makes them."""
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
        part = fired(strip.part(k, stop), np.array(mode.shares))
        there = begin._replace(energy=float(cells.edges[k]), time=float(cells.time[k]))
        found = solve(grid, part, loads, there)
        torque[k:stop], solved = part.torque, len(found.torque)
        cells.edges[k : k + solved + 1], cells.time[k : k + solved + 1] = found.edges, found.time
        cells.torque[k : k + solved], cells.slowness[k : k + solved] = found.torque, found.slowness
        k += solved
        if k < stop or not cells.edges[k] > 0.0 or cells.time[k] >= begin.t_end:
            break
    return Fired(cells.first(k), replace(strip, torque=torque).first(k), tuple(modes))


def fired(strip: Strip, shares: Array) -> Strip:
    """A strip with the torque of these shares of the combustion, shape (cylinders,)."""
    torque = strip.torque.copy()
    loops.fire(torque, *strip.of_gas, shares)
    return replace(strip, torque=torque)


def _speed(grid: Grid, theta: float, sense: float, energy: float) -> float:
    """The speed [rad/s] at an angle at which a decision falls."""
    law = grid.train.law
    assert law is not None
    inertia = float(grid.at_decisions[law.ahead(theta, sense, 0.0).slots[0]])
    return sense * math.sqrt(2.0 * energy / inertia)


def _numbers(firing: Firing) -> tuple[float, float, float, float, float]:
    """What has been decided, as `crankmbs.motion.crank_angle.loops.fired` takes it."""
    set_in = math.nan if firing.set_in is None else firing.set_in
    return firing.time, firing.theta, firing.integral, set_in, float(firing.over)


def _modes(mode: Mode, sense: float, angles: Array, kept: Array, shares: Array) -> list[Mode]:
    """The mode, and those after each decision at one of these angles."""
    modes, last = [mode], mode.firing
    assert last is not None
    low, high = last.low, last.high
    rows = zip(kept[1:].tolist(), shares[1:].tolist(), angles[1:].tolist(), strict=False)
    for (time, theta, integral, set_in, over), each, beyond in rows:
        low, high = min(theta, low), max(theta, high)
        begun = None if math.isnan(set_in) else set_in
        firing = Firing(tuple(each), time, theta, integral, begun, over > 0.0, low, high)
        before, after = (mode.low, beyond) if sense > 0.0 else (beyond, mode.high)
        modes.append(Mode(mode.loads, before, after, firing))
    return modes
