"""Motions of one machine over whole periods: settled ones, and free runs up to their ends.

The energy obeys dE/dtheta = T + c0 + c1 omega + c2 omega^2, made linear in E about the last iterate
where there is c1, dE/dtheta = push + rate E, so that

    E = e^q (E_0 + integral of push e^-q),    q = integral of rate

and a period is an affine map of the energy at its beginning. Integrals are those of the polynomials
through the nodes of cells. Cases are the first axis; what one has does not depend on the others.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.lectures import Cuts, basis_at
from crankmbs.batch.machine import Pass
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule

__all__ = ["Cases", "Courses", "over_periods", "settled", "to_times"]

_ROUNDS, _CLOSE = 30, 1e-9  # of Newton's method; a change of the energies whose square is nothing
_LEAST = 0.1  # of the energy where cells begin: no guess is lower
_LANDINGS, _THERE = 20, 1e-13  # of Newton's method towards a time; of a cell


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

    def part(self, which: Index | NDArray[np.bool_] | slice) -> Cases:
        """Some of them."""
        return Cases(*(each[which] for each in self))


class Courses(NamedTuple):
    """Motions over their last periods.

    energy : at the nodes of cells [J], shape (k, m, s); edges : at the ends of cells, shape (k, m +
        1)
    growth : by which a period enlarges a disturbance, less 1, shape (k,)
    least : the least energy at a node on the whole way, shape (k,); no number, or none above 0,
        where there is no motion
    """

    energy: Array
    edges: Array
    growth: Array
    least: Array

    def part(self, which: NDArray[np.bool_]) -> Courses:
        """Some of them."""
        return Courses(*(each[which] for each in self))


class _Line(NamedTuple):
    """Energies are linear in that at the beginning, E = factor (E_0 + rise): at nodes, shape (k, m,
    s), and at the ends of cells, shape (k, m + 1); there factor less 1."""

    factor: Array
    rise: Array
    growths: Array
    rises: Array

    def part(self, which: Index) -> _Line:
        return _Line(*(each[which] for each in self))

    def nodes(self, begin: Array) -> Array:
        return np.asarray(self.factor * (begin[:, None, None] + self.rise))

    def edges(self, begin: Array) -> Array:
        from_begin = begin[:, None] + self.rises
        return np.asarray(from_begin + self.growths * from_begin)

    def period_map(self) -> tuple[Array, Array]:
        """Growth and rise of all cells: E becomes E + (growth E + rise)."""
        growth, rise = self.growths[:, -1], self.rises[:, -1]
        return growth, rise + growth * rise


class _Strip:
    """The equation of motion of k cases in consecutive cells.

    turned : their widths with the sense of rotation, shape (1 or k, m, 1)
    """

    def __init__(
        self, rule: Rule, turned: Array, inertia: Array, torque: Array, cases: Cases
    ) -> None:
        mass, c0, c1, c2 = (each[:, None, None] for each in cases[:4])
        self.rule, self.sense = rule, np.sign(cases.speed)[:, None, None]
        self.turned = np.broadcast_to(turned, (len(mass), *turned.shape[1:]))
        self.half, self.push, self.drag = 0.5 * (inertia + mass), torque + c0, c1
        self.rate = c2 / self.half
        self.viscous = cases.c1 != 0.0

    def line(self, energy: Array, which: Index) -> _Line:
        """That of some cases, with c1 about energies at the nodes."""
        if not self.viscous.any():
            return self._plain.part(which)
        half, drag = self.half[which], 0.5 * self.drag[which]
        omega = self.sense[which] * np.sqrt(energy / half)
        rate = self.rate[which] + drag / (half * omega)
        return self._integrated(self.turned[which], self.push[which] + drag * omega, rate)

    @cached_property
    def _plain(self) -> _Line:
        """Those without c1, the same in every period."""
        return self._integrated(self.turned, self.push, self.rate)

    def _integrated(self, turned: Array, push: Array, rate: Array) -> _Line:
        rate = turned * rate
        logs = _running_sums(rate @ self.rule.weights)
        factor = np.exp(logs[:, :-1, None] + rate @ self.rule.matrix.T)
        gain = turned * push / factor
        rises = _running_sums(gain @ self.rule.weights)
        rise = rises[:, :-1, None] + gain @ self.rule.matrix.T
        return _Line(factor, rise, np.expm1(logs), rises)

    def solve(self, begin: Array, guess: Array, which: Index) -> tuple[Array, Array]:
        """Energies of some cases at nodes and edges, from that at the beginning on, by Newton's
        method."""
        low = _LEAST * begin[:, None, None]
        energy = np.maximum(guess, low) + 0.0 * self.half[which]
        edges, left = np.empty((len(begin), energy.shape[1] + 1)), np.arange(len(begin))
        for _ in range(_ROUNDS):
            line = self.line(np.maximum(energy[left], low[left]), which[left])
            new, edges[left] = line.nodes(begin[left]), line.edges(begin[left])
            moved = np.abs(new - energy[left]).max(axis=(1, 2))
            energy[left] = new
            left = left[self.viscous[which[left]] & (moved > _CLOSE * begin[left])]
            if len(left) == 0:
                break
        return energy, edges

    def spent(self, energy: Array, which: Index) -> Array:
        """Time in each cell [s], shape (k, m)."""
        inverse = np.sqrt(self.half[which] / energy)
        width = self.sense[which, :, 0] * self.turned[which, :, 0]
        return np.asarray(width * (inverse @ self.rule.weights))


def _running_sums(steps: Array) -> Array:
    """Sums of the first 0, 1, ... of steps, shape (k, m) -> (k, m + 1), each to its own rounding:
    what the first sum missed is summed behind."""
    sums = np.zeros((len(steps), steps.shape[1] + 1))
    np.cumsum(steps, axis=1, out=sums[:, 1:])
    missed = steps - (sums[:, 1:] - sums[:, :-1])
    sums[:, 1:] += np.cumsum(missed, axis=1)
    return sums


def _strip(tables: Pass, cases: Cases, sense: float, first: int = 0) -> _Strip:
    """That of a pass from a cell on."""
    turned = sense * tables.width[None, first:, None]
    return _Strip(tables.rule, turned, tables.inertia[first:], tables.torque[first:], cases)


def settled(tables: Pass, cases: Cases, sense: float, nudge: float) -> Courses:
    """The periodic motions, by Newton's method from steady speeds.

    nudge : how far above the fixed point the period is to begin, as a part of its greatest energy
        over its damping
    """
    strip, left = _strip(tables, cases, sense), np.arange(len(cases.mass))
    energy = strip.half * cases.speed[:, None, None] ** 2
    edges = np.empty((len(left), energy.shape[1] + 1))
    growth, least = np.full((2, len(left)), np.nan)
    for _ in range(_ROUNDS):
        line = strip.line(energy[left], left)
        grown, risen = line.period_map()
        begin = np.divide(-risen, grown, out=np.full_like(grown, np.nan), where=grown < 0.0)
        new = line.nodes(begin)
        most, low = new.max(axis=(1, 2)), new.min(axis=(1, 2))
        moved = np.abs(new - energy[left]).max(axis=(1, 2))
        further = -nudge * most / grown
        energy[left] = new + line.factor * further[:, None, None]
        edges[left], growth[left] = line.edges(begin + further), grown
        good = low > 0.0  # there is one, and it turns on
        done = good & ~(strip.viscous[left] & (moved > _CLOSE * most))
        least[left[done]] = low[done]
        left = left[good & ~done]
        if len(left) == 0:
            break
    return Courses(energy, edges, growth, least)


def over_periods(
    tables: Pass, cases: Cases, sense: float, start: tuple[int, Array], nudge: float
) -> Courses:
    """Free runs from the beginning of a cell, with energies there [J], shape (k,), on to where the
    tables begin, and through whole periods.

    nudge : by what part of itself every period raises the energy besides
    """
    (first, energy), k = start, len(cases.mass)
    strip, left, which = _strip(tables, cases, sense), cases.end.copy(), np.arange(k)
    at, least = energy.copy(), np.full(k, np.inf)
    if first:
        part = _strip(tables, cases, sense, first)
        nodes, edges = part.solve(at, at[:, None, None], which)
        at, least = edges[:, -1].copy(), nodes.min(axis=(1, 2))
    energies = at[:, None, None] + 0.0 * strip.half
    edges = np.full((k, len(tables.width) + 1), np.nan)
    while len(which := which[(left[which] > 0.0) & (least[which] > 0.0)]):
        begun = at[which] * (1.0 + nudge)
        energies[which], edges[which] = strip.solve(begun, energies[which], which)
        at[which] = edges[which, -1]
        least[which] = np.minimum(least[which], energies[which].min(axis=(1, 2)))
        left[which] -= 1.0
        plain = which[~strip.viscous[which] & (left[which] > 1.0) & (at[which] > 0.0)]
        if len(plain):  # energies where periods begin rise or fall throughout
            growth, rise = strip.line(energies[plain], plain).period_map()
            at[plain] = _leapt(growth, rise, at[plain], left[plain] - 1.0, nudge)
            left[plain] = 1.0
    return Courses(energies, edges, np.full(k, np.nan), least)


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
    k, m = len(energy), len(tables.width)
    last = _last_periods(_strip(tables, cases, sense), cases.end, energy, nudge)
    if cell is None:
        cell = np.minimum((last.ahead[:, 1:] < last.left[:, None]).sum(axis=1), m - 1)
    some = np.flatnonzero(last.least > 0.0)
    own, of = cases.part(some), cell[some]
    entered, left = last.edges[some, of], last.left[some] - last.ahead[some, of]
    place = _place_of_end(tables, own, sense, of, entered, left)
    inside = _part(tables, own, sense, of, 0.0 * place, place)
    after = _part(tables, own, sense, of, place, 1.0 + 0.0 * place)
    energies, edges = np.full((k, m + 1, last.energy.shape[2]), np.nan), np.full((k, m + 2), np.nan)
    again = np.arange(m) < of[:, None]
    energies[some, :m] = np.where(again[..., None], last.energy[some], last.before[some])
    edges[some, 1:-1] = np.where(again, last.edges[some, 1:], last.earlier[some, 1:])
    energies[some, of], edges[some, -1] = _across(inside, entered)
    _, edges[some, 0] = _across(inside, last.earlier[some, of])
    energies[some, m], _ = _across(after, edges[some, 0])
    cuts = Cuts(cell, np.full(k, np.nan))
    cuts.place[some] = place
    return cuts, Courses(energies, edges, np.full(k, np.nan), last.least)


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


def _last_periods(strip: _Strip, end: Array, energy: Array, nudge: float) -> _Last:
    """Those up to times [s] from energies on [J], shape (k,)."""
    k, m, _ = strip.half.shape
    which, at, least, periods = np.arange(k), energy.copy(), np.full(k, np.inf), np.zeros(k)
    last, before = np.array(2 * [at[:, None, None] + 0.0 * strip.half])
    edges, earlier, ahead = np.zeros((3, k, m + 1))
    time, since = np.zeros((2, k), np.longdouble)  # the time of a cell is little of it
    while len(which := which[(time[which] < end[which]) & (least[which] > 0.0)]):
        before[which], earlier[which], since[which] = last[which], edges[which], time[which]
        begun = at[which] * (1.0 + nudge)
        last[which], edges[which] = strip.solve(begun, last[which], which)
        at[which], periods[which] = edges[which, -1], periods[which] + 1.0
        least[which] = np.minimum(least[which], last[which].min(axis=(1, 2)))
        ahead[which, 1:] = np.cumsum(strip.spent(last[which], which), axis=1)
        time[which] += ahead[which, -1]
    least[periods < 2.0] = np.nan
    return _Last(last, edges, before, earlier, least, (end - since).astype(np.float64), ahead)


def _place_of_end(
    tables: Pass, cases: Cases, sense: float, cell: Index, entered: Array, left: Array
) -> Array:
    """Where in cells, entered with energies, times are over: as the ends of cells of their own, for
    inside one the solution is of lower order; shape (k,)."""
    place, going = np.ones(len(cell)), np.arange(len(cell))
    for _ in range(_LANDINGS):
        begin, width = 0.0 * place[going], tables.width[cell[going]]
        part = _part(tables, cases.part(going), sense, cell[going], begin, place[going])
        which = np.arange(len(going))
        nodes, _ = part.solve(entered[going], entered[going, None, None], which)
        slow = np.sqrt(part.half[:, 0, -1] / nodes[:, 0, -1])
        move = (left[going] - part.spent(nodes, which)[:, 0]) / (width * slow)
        place[going] += move
        going = going[np.abs(move) > _THERE]
        if len(going) == 0:
            break
    return place


def _part(tables: Pass, cases: Cases, sense: float, cell: Index, low: Array, high: Array) -> _Strip:
    """The equation of motion in parts of cells, from one place to another, shape (k,)."""
    wide = (high - low)[:, None]
    basis = basis_at(tables.rule, low[:, None] + wide * tables.rule.nodes)
    inertia, torque = (
        np.matmul(basis, each[cell][..., None])[:, None, :, 0]
        for each in (tables.inertia, tables.torque)
    )
    turned = sense * wide[..., None] * tables.width[cell, None, None]
    return _Strip(tables.rule, turned, inertia, torque, cases)


def _across(part: _Strip, begin: Array) -> tuple[Array, Array]:
    """Energies at the nodes and at the end of a single cell."""
    nodes, edges = part.solve(begin, begin[:, None, None], np.arange(len(begin)))
    return nodes[:, 0], edges[:, -1]
