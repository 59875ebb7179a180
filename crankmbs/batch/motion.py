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
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.machine import Pass
from crankmbs.motion.crank_angle.periods import Period
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Maps, Rule, summed
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["Cases", "Courses", "Cuts", "over_periods", "part_of", "settled", "to_times"]

_ROUNDS, _CLOSE = 30, 1e-9  # of Newton's method; a change of the energies whose square is nothing
_LEAST = 0.1  # of the energy where cells begin: no guess is lower
_STEPS = 5  # of Newton's method towards a time, in a cell in which the speed hardly changes


class Cases(NamedTuple):
    """What k motions have of their own, shape (k,): inertia of the crank [kg m2]; c0, c1 and c2 of
    the loads; speed at the start [rad/s]; with how many whole periods a run ends, or its end in
    time [s]; the relative error asked for."""

    mass: Array
    c0: Array
    c1: Array
    c2: Array
    speed: Array
    end: Array
    rtol: Array


class Cuts(NamedTuple):
    """Where periods of k cases begin and end: in which cells, at which places, 0 to 1; shape (k,).
    Over cells, such a period has what lies before the place in that cell's stead, and what lies
    behind it, in the period before, as a cell more."""

    cell: Index
    place: Array


class Courses(NamedTuple):
    """Motions over their last periods.

    energy : at the nodes of cells [J], shape (k, m, s); with cuts (k, m + 1, s), of whole cells
    begin, ends : energies where the period begins, shape (k,), and at the ends of cells, of which
        the last one is its own
    growth : by which a period enlarges a disturbance, less 1, shape (k,)
    least : the least energy at a node on the whole way, shape (k,); no number, or none above 0,
        where there is no motion
    """

    energy: Array
    begin: Array
    ends: Array
    growth: Array
    least: Array


R = TypeVar("R", Cases, Cuts, Courses)


def part_of(record: R, which: Index | NDArray[np.bool_]) -> R:
    """Some of the cases of a record.

    >>> part_of(Cuts(np.array([3, 4]), np.array([0.1, 0.2])), np.array([1])).cell
    array([4])
    """
    parts: list[Any] = [each[which] for each in record]
    return type(record)(*parts)


class _Equation:
    """The equation of motion of k cases in the cells of a pass from one on."""

    def __init__(self, tables: Pass, cases: Cases, sense: float, first: int = 0) -> None:
        mass, c0, c1, c2 = (each[:, None, None] for each in cases[:4])
        self.rule, self.sense = tables.rule, sense
        self.half = 0.5 * (tables.inertia[:, first:] + mass)
        self.width = tables.width[:, first:, None] + 0.0 * mass
        self.push, self.drag = tables.torque[:, first:] + c0, 0.5 * c1
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

    def solve(self, begin: Array, guess: Array, which: Index) -> tuple[Array, Array]:
        """Energies of some cases at nodes and edges, from that at the beginning on, by Newton's
        method."""
        low = _LEAST * begin[:, None, None]
        energy = np.maximum(guess, low) + 0.0 * self.half[which]
        edges, left = np.empty((len(begin), energy.shape[1] + 1)), np.arange(len(begin))
        for _ in range(_ROUNDS):
            maps = self.maps(np.maximum(energy[left], low[left]), which[left])
            new, edges[left] = _passed(maps, begin[left])
            moved = np.abs(new - energy[left]).max(axis=(1, 2))
            energy[left] = new
            left = left[self.viscous[which[left]] & (moved > _CLOSE * begin[left])]
            if len(left) == 0:
                break
        return energy, edges

    def slowness(self, energy: Array, which: Index) -> Array:
        """Time for the unit of length of a cell [s] at its nodes."""
        return np.asarray(self.width[which] * np.sqrt(self.half[which] / energy))

    def periods(self, nudge: float) -> list[Period]:
        """The map of all cells of every case without c1, each raised by the nudge before it."""
        maps, size = self._plain, self.half[0].size
        growth = maps.growth[:, -1] + nudge * (1.0 + maps.growth[:, -1])
        weight = self.width * self.rule.weights * np.sqrt(self.half)
        rows = (each.reshape(-1, size) for each in (maps.gain, maps.shift, weight))
        return [Period(*each) for each in zip(growth, maps.rise[:, -1], *rows, strict=True)]


def _passed(maps: Maps, begin: Array) -> tuple[Array, Array]:
    """Energies at nodes and edges, from those at the beginning on."""
    first = begin[:, None]
    edges = first + (maps.growth * first + maps.rise)
    return maps.gain * first[..., None] + maps.shift, edges


def settled(tables: Pass, cases: Cases, sense: float, nudge: float) -> Courses:
    """The periodic motions, by Newton's method from steady speeds.

    nudge : how far above the fixed point the period is to begin, as a part of its greatest energy
        over its damping
    """
    equation, left = _Equation(tables, cases, sense), np.arange(len(cases.mass))
    energy = equation.half * cases.speed[:, None, None] ** 2
    edges = np.empty((len(left), energy.shape[1] + 1))
    growth, least = np.full((2, len(left)), np.nan)
    for _ in range(_ROUNDS):
        maps = equation.maps(energy[left], left)
        grown, risen = maps.growth[:, -1], maps.rise[:, -1]
        begin = np.divide(-risen, grown, out=np.full_like(grown, np.nan), where=grown < 0.0)
        new, _ = _passed(maps, begin)
        most, low = new.max(axis=(1, 2)), new.min(axis=(1, 2))
        moved = np.abs(new - energy[left]).max(axis=(1, 2))
        growth[left] = grown
        energy[left], edges[left] = _passed(maps, begin - nudge * most / grown)
        good = low > 0.0  # there is one, and it turns on
        done = good & ~(equation.viscous[left] & (moved > _CLOSE * most))
        least[left[done]] = low[done]
        left = left[good & ~done]
        if len(left) == 0:
            break
    return Courses(energy, edges[:, 0], edges[:, 1:], growth, least)


def over_periods(
    tables: Pass, cases: Cases, sense: float, start: tuple[int, Array], nudge: float
) -> Courses:
    """Free runs from the beginning of a cell, with energies there [J], shape (k,), on to where the
    tables begin, and through whole periods.

    nudge : by what part of itself every period raises the energy besides
    """
    (first, energy), k = start, len(cases.mass)
    equation, left, which = _Equation(tables, cases, sense), cases.end.copy(), np.arange(k)
    at, least = energy.copy(), np.full(k, np.inf)
    if first:
        part = _Equation(tables, cases, sense, first)
        nodes, edges = part.solve(at, at[:, None, None], which)
        at, least = edges[:, -1].copy(), nodes.min(axis=(1, 2))
    energies = at[:, None, None] + 0.0 * equation.half
    edges = np.full((k, tables.width.shape[1] + 1), np.nan)
    while len(which := which[(left[which] > 0.0) & (least[which] > 0.0)]):
        begun = at[which] * (1.0 + nudge)
        energies[which], edges[which] = equation.solve(begun, energies[which], which)
        at[which] = edges[which, -1]
        least[which] = np.minimum(least[which], energies[which].min(axis=(1, 2)))
        left[which] -= 1.0
        plain = which[~equation.viscous[which] & (left[which] > 1.0) & (at[which] > 0.0)]
        if len(plain):  # energies where periods begin rise or fall throughout
            maps = equation.maps(energies[plain], plain)
            of_period = maps.growth[:, -1], maps.rise[:, -1]
            at[plain] = _leapt(*of_period, at[plain], left[plain] - 1.0, nudge)
            left[plain] = 1.0
    return Courses(energies, edges[:, 0], edges[:, 1:], np.full(k, np.nan), least)


def _leapt(growth: Array, rise: Array, energy: Array, periods: Array, nudge: float) -> Array:
    """Energies after so many periods of one affine map, each raised by the nudge before it."""
    growth = growth + nudge * (1.0 + growth)
    more = np.expm1(periods * np.log1p(growth))
    times = np.divide(more, growth, out=periods.copy(), where=growth != 0.0)
    return np.asarray(energy + (more * energy + rise * times))


def to_times(
    tables: Pass,
    cases: Cases,
    sense: float,
    energy: Array,
    nudge: float,
    cell: Index | None = None,
) -> tuple[Cuts, Courses]:
    """Free runs from where the tables begin, with energies there [J], shape (k,), to their ends in
    time; cell : where these are known. Of what was less than a period there is no least energy.

    nudge : by what part of itself every period raises the energy besides
    """
    equation, each, m = (
        _Equation(tables, cases, sense),
        np.arange(len(energy)),
        tables.width.shape[1],
    )
    last = _last_periods(equation, cases.end, energy, nudge)
    if cell is None:
        cell = np.minimum((last.ahead[:, 1:] < last.left[:, None]).sum(axis=1), m - 1)
    slow = equation.slowness(last.energy, each)[each, cell]
    place = _place(equation.rule, slow, last.left - last.ahead[each, cell])
    begin, end = (
        _inside(nodes[each, cell], edges[each, cell], edges[each, cell + 1], place)
        for nodes, edges in ((last.before, last.earlier), (last.energy, last.edges))
    )
    again = np.arange(m) < cell[:, None]
    ends = np.where(again, last.edges[:, 1:], last.earlier[:, 1:])
    again[each, cell] = True
    energies = np.where(again[..., None], last.energy, last.before)
    energies = np.append(energies, last.before[each, cell][:, None], axis=1)
    ends = np.append(ends, end[:, None], axis=1)
    return Cuts(cell, place), Courses(energies, begin, ends, np.full_like(end, np.nan), last.least)


def _inside(nodes: Array, begin: Array, end: Array, place: Array) -> Array:
    """Energies at places in cells, by those at nodes and ends."""
    rows = np.column_stack([begin, nodes, end]).T
    return summed(ends_and_nodes(nodes.shape[1]).series(rows)[:, 0], place)


def _place(rule: Rule, slow: Array, left: Array) -> Array:
    """At which places in cells times are over, shape (k,); slow : time for the unit of length at
    the nodes, shape (k, s)."""
    place = left / np.einsum("ks,s->k", slow, rule.weights)
    slope, value = (np.einsum("ds,ks->dk", matrix, slow) for matrix in rule.to_series)
    for _ in range(_STEPS):
        place = place - (summed(value, place) - left) / summed(slope, place)
    return np.asarray(place)


class _Last(NamedTuple):
    """The periods in which times are over, of k cases: energies at nodes and edges, the same in the
    periods before, the least energy on the way, and the time that is left where they begin and
    passes up to every edge."""

    energy: Array
    edges: Array
    before: Array
    earlier: Array
    least: Array
    left: Array
    ahead: Array


def _last_periods(equation: _Equation, end: Array, energy: Array, nudge: float) -> _Last:
    """Those up to times [s] from energies on [J], shape (k,)."""
    k, m, _ = equation.half.shape
    which, at, least, periods = np.arange(k), energy.copy(), np.full(k, np.inf), np.zeros(k)
    last, before = np.array(2 * [at[:, None, None] + 0.0 * equation.half])
    edges, earlier, ahead = np.zeros((3, k, m + 1))
    time, since = np.zeros((2, k), np.longdouble)  # the time of a cell is little of it
    if not equation.viscous.any():
        least = _passed(equation.maps(last, which), energy)[0].min(axis=(1, 2))
        for n, period in enumerate(equation.periods(nudge)):
            periods[n], at[n], _, time[n] = period.run(at[n], 0.0, math.inf, end[n], 1)
    while len(which := which[(time[which] < end[which]) & (least[which] > 0.0)]):
        before[which], earlier[which], since[which] = last[which], edges[which], time[which]
        begun = at[which] * (1.0 + nudge)
        last[which], edges[which] = equation.solve(begun, last[which], which)
        at[which], periods[which] = edges[which, -1], periods[which] + 1.0
        least[which] = np.minimum(least[which], last[which].min(axis=(1, 2)))
        spent = equation.slowness(last[which], which) @ equation.rule.weights
        ahead[which, 1:] = np.cumsum(spent, axis=1)
        time[which] += ahead[which, -1]
    least[periods < 2.0] = np.nan
    return _Last(last, edges, before, earlier, least, (end - since).astype(np.float64), ahead)
