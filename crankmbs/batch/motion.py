"""Motions over whole periods: settled ones, and free runs up to their ends.

The energy obeys dE/dtheta = T + c0 + c1 omega + c2 omega^2, made linear in E about the last iterate
where there is c1: a cell is an affine map of the energy at its begin, as in a run alone
(`crankmbs.numerics.collocation`), and a period is one of the energy at its beginning. Cases are the
first axis, of tables too unless these are of one machine; what a case has does not depend on the
others.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.cuts import Cuts, inside, place_of
from crankmbs.batch.machine import Pass
from crankmbs.motion.crank_angle.periods import Period
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Maps

__all__ = ["Cases", "Energies", "Setup", "run", "settled"]

_ROUNDS, _CLOSE = 30, 1e-9  # of Newton's method; a change of the energies whose square is nothing
_LEAST = 0.1  # of the energy where cells begin: no guess is lower


class Cases(NamedTuple):
    """What k motions have of their own, shape (k,): inertia of the crank [kg m2]; c0, c1 and c2 of
    the loads; speed at the start [rad/s]; with how many periods a run ends, or its end in time [s];
    the relative error asked for."""

    mass: Array
    c0: Array
    c1: Array
    c2: Array
    speed: Array
    end: Array
    rtol: Array


class Setup(NamedTuple):
    """What runs of one machine share: sense of rotation; whether they end at a time; by what part
    of itself every period raises the energy besides."""

    sense: float
    in_time: bool = False
    nudge: float = 0.0


class Energies(NamedTuple):
    """Motions over their last periods.

    energy : at the nodes of cells [J], shape (k, m, s); with cuts (k, m + 1, s), of whole cells
    begin, ends : energies where the period begins, shape (k,), and at the ends of cells, of which
        the last one is its own
    growth : by which a period enlarges a disturbance, less 1, shape (k,)
    least : the least energy at a node on the whole way, shape (k,); no number, or none above 0,
        where there is no motion
    cuts : of periods that begin and end inside of a cell
    """

    energy: Array
    begin: Array
    ends: Array
    growth: Array
    least: Array
    cuts: Cuts | None = None


class _Equation:
    """The equation of motion of k cases in the cells of a pass."""

    def __init__(self, tables: Pass, cases: Cases, sense: float) -> None:
        mass, c0, c1, c2 = (each[:, None, None] for each in cases[:4])
        self.rule, self.sense = tables.rule, sense
        self.half = 0.5 * (tables.inertia + mass)
        self.width = tables.width[..., None] + 0.0 * mass
        self.push, self.drag = tables.torque + c0, 0.5 * c1
        self.rate = c2 / self.half
        self.viscous = cases.c1 != 0.0

    def maps(self, energy: Array, which: Index) -> Maps:
        """Those of some cases from the beginning on, with c1 about energies at the nodes."""
        if self.viscous.any():
            half, drag = self.half[which], self.drag[which]
            omega = self.sense * np.sqrt(energy / half)
            rate = self.rate[which] + drag / (half * omega)
            return self._composed(which, self.push[which] + drag * omega, rate)
        if len(which) == len(self.viscous):
            return self._plain
        return Maps(*(each[which] for each in self._plain))

    @cached_property
    def _plain(self) -> Maps:
        """Those without c1, the same in every period."""
        return self._composed(slice(None), self.push, self.rate)

    def _composed(self, which: Index | slice, push: Array, rate: Array) -> Maps:
        return self.rule.maps(self.sense * self.width[which], push, rate).composed()

    def solve(
        self, guess: Array, which: Index, begin: Array | None = None, nudge: float = 0.0
    ) -> tuple[Array, Array, Array]:
        """Periods of some cases by Newton's method: energies at nodes and edges, and by which they
        enlarge a disturbance, less 1; no numbers where it does not converge.

        begin : energies at the beginning; None of periods that come again
        nudge : how far above it such a period is to begin, as a part of its greatest energy over
            its damping
        """
        energy, left = guess + 0.0 * self.half[which], np.arange(len(which))
        edges = np.empty((len(which), energy.shape[1] + 1))
        growth, low = np.zeros((2, len(which)))
        for _ in range(_ROUNDS):
            maps = self.maps(np.maximum(energy[left], low[left, None, None]), which[left])
            growth[left] = grown = maps.growth[:, -1]
            first = _fixed(grown, maps.rise[:, -1]) if begin is None else begin[left]
            new, edges[left] = _passed(maps, first)
            most, moved = (each.max(axis=(1, 2)) for each in (new, np.abs(new - energy[left])))
            if begin is None:
                new, edges[left] = _passed(maps, first - nudge * most / grown)
            energy[left], low[left] = new, _LEAST * first
            left = left[self.viscous[which[left]] & (moved > _CLOSE * most)]
            if len(left) == 0:
                break
        energy[left] = np.nan
        return energy, edges, growth

    def spent(self, energy: Array, which: Index) -> Array:
        """Time for the unit of length of a cell [s] at its nodes."""
        return np.asarray(self.width[which] * np.sqrt(self.half[which] / energy))

    def turned(self, energy: Array, which: Index) -> Array:
        """The same in angles, as a part of a period."""
        return np.asarray(self.width[which] / self.width[which].sum(axis=1)[:, None] + 0.0 * energy)

    def leap(
        self, energy: Array, left: NDArray[np.longdouble], setup: Setup
    ) -> tuple[Array, Array]:
        """Energies without c1 where the last two periods begin, from those on with which so much is
        left; and how many periods before. What is left is made less by these."""
        maps, size = self._plain, self.half[0].size
        growth, rise = maps.growth[:, -1], maps.rise[:, -1]
        growth = growth + setup.nudge * (1.0 + growth)
        if not setup.in_time:
            periods = np.maximum(np.ceil(left) - 2.0, 0.0).astype(np.float64)
            left -= periods
            return _leapt(growth, rise, energy, periods), periods
        weight = self.width * self.rule.weights * np.sqrt(self.half)
        rows = (each.reshape(-1, size) for each in (maps.gain, maps.shift, weight))
        found = [
            Period(*period).run(start, 0.0, math.inf, end, 1)
            for start, end, *period in zip(energy, left, growth, rise, *rows, strict=True)
        ]
        periods, energy, _, time = np.array(found).T
        left -= time
        return energy, periods


def _fixed(growth: Array, rise: Array) -> Array:
    """The energies that come again after maps; no number of what grows."""
    return np.divide(-rise, growth, out=np.full_like(growth, np.nan), where=growth < 0.0)


def _passed(maps: Maps, begin: Array) -> tuple[Array, Array]:
    """Energies at nodes and edges, from those at the beginning on."""
    first = begin[:, None]
    edges = first + (maps.growth * first + maps.rise)
    return maps.gain * first[..., None] + maps.shift, edges


def _leapt(growth: Array, rise: Array, energy: Array, periods: Array) -> Array:
    """Energies after so many periods of one affine map."""
    more = np.expm1(periods * np.log1p(growth))
    times = np.divide(more, growth, out=periods.copy(), where=growth != 0.0)
    return np.asarray(energy + (more * energy + rise * times))


def settled(tables: Pass, cases: Cases, setup: Setup) -> Energies:
    """The periodic motions, by Newton's method from steady speeds."""
    equation = _Equation(tables, cases, setup.sense)
    guess = equation.half * cases.speed[:, None, None] ** 2
    energy, edges, growth = equation.solve(guess, np.arange(len(guess)), nudge=setup.nudge)
    return Energies(energy, edges[:, 0], edges[:, 1:], growth, energy.min(axis=(1, 2)))


def run(
    tables: Pass, cases: Cases, setup: Setup, energy: Array, cell: Index | None = None
) -> Energies:
    """Free runs from where the tables begin, with energies there [J], shape (k,), to their ends;
    cell : where these are known. Of what ends within its first period there is no least energy."""
    equation, which = _Equation(tables, cases, setup.sense), np.arange(len(energy))
    k, m, _ = equation.half.shape
    at, least, periods = energy.copy(), np.full(k, np.inf), np.zeros(k)
    left = cases.end.astype(np.longdouble)  # the time of a cell is little of it
    if not equation.viscous.any():  # energies where periods begin rise or fall throughout
        least = _passed(equation.maps(energy, which), energy)[0].min(axis=(1, 2))
        at, periods = equation.leap(energy, left, setup)
    last = _Last(*np.array(2 * [at[:, None, None] + 0.0 * equation.half]), *np.zeros((3, k, m + 1)))
    pace, rest = equation.spent if setup.in_time else equation.turned, left.copy()
    while len(which := which[(left[which] > 0.0) & (least[which] > 0.0)]):
        last.before[which], last.earlier[which] = last.energy[which], last.edges[which]
        begun, rest[which] = at[which] * (1.0 + setup.nudge), left[which]
        solved, edges, _ = equation.solve(last.energy[which], which, begun)
        last.energy[which], last.edges[which] = solved, edges
        at[which], periods[which] = edges[:, -1], periods[which] + 1.0
        least[which] = np.minimum(least[which], solved.min(axis=(1, 2)))
        last.ahead[which, 1:] = np.cumsum(pace(solved, which) @ equation.rule.weights, axis=1)
        left[which] -= last.ahead[which, -1] if setup.in_time else 1.0
    if not (setup.in_time or (cases.end % 1.0).any()):
        edges = last.edges
        return Energies(last.energy, edges[:, 0], edges[:, 1:], np.full(k, np.nan), least)
    least[periods < 2.0] = np.nan
    if cell is None:
        cell = np.minimum((last.ahead[:, 1:] < rest[:, None]).sum(axis=1), m - 1)
    each = np.arange(k)
    left = (rest - last.ahead[each, cell]).astype(np.float64)
    cuts = Cuts(cell, place_of(equation.rule, pace(last.energy, each)[each, cell], left))
    return _ended(last, cuts, least)


class _Last(NamedTuple):
    """The periods in which k runs end: energies at nodes and edges, the same in the periods before,
    and what passes up to every edge of what is left where they begin."""

    energy: Array
    before: Array
    edges: Array
    earlier: Array
    ahead: Array


def _ended(last: _Last, cuts: Cuts, least: Array) -> Energies:
    """The last periods up to places in cells."""
    (cell, place), each = cuts, np.arange(len(least))
    begin, end = (
        inside(nodes[each, cell], edges[each, cell], edges[each, cell + 1], place)
        for nodes, edges in ((last.before, last.earlier), (last.energy, last.edges))
    )
    again = np.arange(last.energy.shape[1]) < cell[:, None]
    ends = np.where(again, last.edges[:, 1:], last.earlier[:, 1:])
    again[each, cell] = True
    energies = np.where(again[..., None], last.energy, last.before)
    energies = np.append(energies, last.before[each, cell][:, None], axis=1)
    ends = np.append(ends, end[:, None], axis=1)
    return Energies(energies, begin, ends, np.full_like(end, np.nan), least, cuts)
