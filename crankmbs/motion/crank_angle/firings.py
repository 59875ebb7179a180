"""Cells of the crank angle across the decisions on the fuel, which fall on edges of cells.

Between two decisions the shares of the combustion are fixed, and with them the torque over the
angle. Shares that are known beforehand, all but a governor's, cut nothing: the cells are solved
with them at once, and only where a decision turns out otherwise, as a window of the
fuel opens or closes, do they end there.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.firing import Firing, FuelLaw
from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.grid import Grid, Terms
from crankmbs.motion.crank_angle.solvers import Begin, Cells, solve
from crankmbs.motion.mode import Mode, decided
from crankmbs.numerics.arrays import Array, Index

__all__ = ["Fired", "solve_fired"]

_HAIR = 1e-9  # rad: an edge so near is where the decision falls


class Fired(NamedTuple):
    """Solved cells, their terms with the torque of the combustion, and from which cell on each mode
    holds."""

    cells: Cells
    terms: Terms
    modes: tuple[tuple[int, Mode], ...]


class _Ahead(NamedTuple):
    """Decisions on the way: the cell before which each falls, the last one behind all cells; crank
    angle [rad] and J [kg m2] there; what misfires and scatter leave of each share, shape
    (n, cylinders), NaN where a cylinder does not decide."""

    cell: Index
    angle: Array
    inertia: Array
    parts: Array

    def expected(self, n: int, last: int, mode: Mode) -> Array:
        """The shares before decision n and after it and each up to the last one, which is left out,
        shape (last - n + 1, cylinders), where what lets fuel in or keeps it out stays as it is."""
        assert mode.firing is not None
        factor = float(mode.firing.set_in is not None and not mode.firing.over)
        shares = np.vstack([mode.shares, factor * self.parts[n:last]])
        for before, after in pairwise(shares):
            np.copyto(after, before, where=np.isnan(after))
        return shares


def solve_fired(
    grid: Grid, terms: Terms, loads: Branch | Course, begin: Begin, state: State
) -> Fired:
    """Solve consecutive cells from a state on, as far at once as the shares are foreseen."""
    law, mode = grid.train.law, state.mode
    assert law is not None
    assert mode.firing is not None
    foreseen = _foreseen(law, mode.firing)
    ahead, count = _ahead(grid, terms, begin.sense, state), len(terms.cell)
    torque, modes, parts = terms.torque.copy(), [(0, mode)], list[Cells]()
    k, n, now = 0, 0, begin
    while k < count and now.energy > 0.0 and now.time < begin.t_end:
        last = len(ahead.cell) - 1 if foreseen else n
        stop, expected = int(ahead.cell[last]), ahead.expected(n, last, mode)
        shares = expected[0]
        if last > n:
            shares = expected.repeat(np.diff([k, *ahead.cell[n : last + 1]]), axis=0)
        part = terms.part(k, stop).fired(shares)
        solved = solve(grid, part, loads, now)
        m = whole = len(solved.torque)
        for shares_after in [*expected[1:].tolist(), None]:
            at = int(ahead.cell[n])
            energy, time = (float(q[min(at - k, whole)]) for q in solved[:2])
            if at == count or at - k > whole or not energy > 0.0:
                break
            omega = begin.sense * math.sqrt(2.0 * energy / ahead.inertia[n])
            mode, n = decided(grid.train, mode, time, float(ahead.angle[n]), omega), n + 1
            modes.append((at, mode))
            if shares_after is None or mode.shares != tuple(shares_after):
                m = at - k
                break
        torque[k : k + m] = part.torque[:m]
        parts.append(solved.first(m))
        k, goes_on = k + m, m < whole or whole == stop - k
        if not goes_on:
            break
        # the angle counts from where the terms begin
        now = now._replace(energy=float(solved.edges[m]), time=float(solved.time[m]))
    return Fired(_joined(parts), replace(terms, torque=torque).first(k), tuple(modes))


def _foreseen(law: FuelLaw, firing: Firing) -> bool:
    """Whether shares are known before the motion is, while the fuel's window stays as it is."""
    return law.fuel.governor is None and firing.imposed is None


def _ahead(grid: Grid, terms: Terms, sense: float, state: State) -> _Ahead:
    """The decisions in consecutive cells from a state on; backwards all is decided, as far as it
    went before."""
    law, mode, count = grid.train.law, state.mode, len(terms.cell)
    assert law is not None
    first = mode.high if sense > 0.0 else mode.low
    reach = max(0.0, float(terms.turned[-1]) - sense * (first - state.theta))
    angles, slots, parts = law.ahead(first, sense, reach)
    cell = terms.turned[:count].searchsorted(sense * (angles - state.theta) - _HAIR)
    cell[-1] = count
    return _Ahead(cell, angles, grid.at_decisions[slots], parts)


def _joined(parts: list[Cells]) -> Cells:
    """Cells one after the other; an edge between two is that of the later ones."""
    edges = [[*(part[i][:-1] for part in parts[:-1]), parts[-1][i]] for i in (0, 1)]
    nodes = [[part[i] for part in parts] for i in (2, 3)]
    return Cells(*map(np.concatenate, edges + nodes))
