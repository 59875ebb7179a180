"""Cells of the crank angle over one period, and what depends on the angle alone, tabulated.

No knot of the pressure lies inside a cell, so everything in it is smooth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.friction import rubbing
from crankmbs.mechanics.inertia import fired_torque, reduce
from crankmbs.mechanics.torque import over_angle
from crankmbs.mechanics.train import CrankTrain, edges_over_angle
from crankmbs.mechanics.windows import Phases
from crankmbs.numerics.arrays import Array, largest_of_row
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.scene.units import DEGREE

__all__ = ["FINEST_CELL", "Grid", "Terms", "edges_apart", "grid_of"]


FINEST_CELL = 3e-14
"""What rounding leaves of a cell's relative error."""

_EPS = float(np.finfo(float).eps)
_WIDEST = 6.0 * DEGREE  # rad: of a cell
_MOST_CELLS = 20_000
_SLIVER = 1e-12  # rad: a start this close to an edge is on it


@dataclass(frozen=True)
class Terms:
    """Terms of the equation of motion in consecutive cells, in the sense of rotation.

    cell : shape (m,), their numbers in the grid; width : shape (m,) [rad]
    turned : shape (m + 1,) [rad], angle from the beginning to every edge
    against : the share of the gas's torque that its rings oppose, with the sense of rotation
    inertia, torque : shape (m, s), J [kg m2] and the torque over the angle [N m], of gas, gravity,
        loads and friction, at the nodes
    combustion : shape (m, s, cylinders) [N m], what firings of share 1 add to the torque; no
        cylinders without fuel
    rubbed : shape (m, s, cylinders) [N m], with fuel, of the gas without combustion the torque
        that presses rings; no cylinders where none are pressed
    drag : shape (m, s) [N m s/rad], of viscous friction; (m, 0) without
    ends : shape (m, 2) [kg m2], J where each begins and ends
    """

    cell: NDArray[np.intp]
    width: Array
    turned: Array
    against: float
    inertia: Array
    torque: Array
    combustion: Array
    rubbed: Array
    drag: Array
    ends: Array

    @property
    def drags(self) -> bool:
        """Whether friction depends on angle and speed together."""
        return bool(self.drag.shape[-1])

    @property
    def pace(self) -> Array:
        """Angle turned per position in the cell, which is 0 to 1: (m, 1) as it is the same at all
        nodes [rad]."""
        return self.width[:, None]

    def fired(self, shares: Array) -> Terms:
        """With what the combustion adds to the torque, and the rings that it presses; shares of
        each cylinder, shape (cylinders,), or (m, cylinders)."""
        torque = self.torque + (self.combustion @ shares[..., None])[..., 0]
        if self.rubbed.shape[-1]:
            pressing = np.abs(self.rubbed + self.combustion * shares[..., None, :])
            torque -= self.against * pressing.sum(axis=-1)
        return replace(self, torque=torque)

    def angles(self, theta: float, sense: float, rule: Rule) -> Array:
        """Crank angles [rad] of the nodes of a rule, shape (m, s), where it begins at one."""
        ahead = self.turned[:-1, None] + self.width[:, None] * rule.nodes
        return np.asarray(theta + sense * ahead)

    def first(self, m: int) -> Terms:
        """The first m cells."""
        return self if m == len(self.cell) else self.part(0, m)

    @property
    def _tables(self) -> tuple[Array, ...]:
        return self.inertia, self.torque, self.combustion, self.rubbed, self.drag, self.ends

    def part(self, low: int, high: int) -> Terms:
        """The cells from one number to another; edges are still counted from the beginning."""
        of_cells = (table[low:high] for table in self._tables)
        turned = self.turned[low : high + 1]
        return Terms(self.cell[low:high], self.width[low:high], turned, self.against, *of_cells)

    def joined(self, after: Terms) -> Terms:
        """These cells and those after them, whose angles are counted from where these end."""
        cell = np.concatenate([self.cell, after.cell])
        width = np.concatenate([self.width, after.width])
        turned = np.concatenate([self.turned[:-1], self.turned[-1] + after.turned])
        pairs = zip(self._tables, after._tables, strict=True)
        return Terms(cell, width, turned, self.against, *map(np.concatenate, pairs))


class _Tables(NamedTuple):
    """At the nodes of every cell: J, torque over the angle without friction, what the combustion of
    each cylinder adds; friction against either sense of rotation; rubbed and drag of `Terms`; J at
    both ends."""

    inertia: Array
    torque: Array
    combustion: Array
    friction: Array
    rubbed: Array
    drag: Array
    ends: Array


@dataclass(frozen=True)
class Grid:
    """edges : shape (n + 1,) [rad], from 0 to one period; tables for one collocation rule.

    checks : whether it is there to check another grid, and nothing checks it
    phases : of the loads' windows; known : the same grid in other phases
    """

    train: CrankTrain
    edges: Array
    rule: Rule
    checks: bool = False
    phases: Phases = ()
    known: dict[Phases, Grid] = field(default_factory=dict, compare=False, repr=False)

    def at(self, phases: Phases) -> Grid:
        """The grid in these phases of the loads."""
        if phases == self.phases or not self.train.loads_over_angle:
            return self
        if phases not in self.known:
            self.known[phases] = replace(self, phases=phases)
        return self.known[phases]

    @property
    def drags(self) -> bool:
        """Whether friction depends on angle and speed together."""
        return self.train.drags

    @cached_property
    def at_decisions(self) -> Array:
        """J [kg m2] at the crank angles of one period at which the fuel is decided."""
        law = self.train.law
        return reduce(self.train, np.array(law.angles if law else ())).inertia

    @cached_property
    def tables(self) -> _Tables:
        """J and torques over the angle at the nodes of every cell, shape (n, s) each, or
        (n, s, cylinders)."""
        return self._tabulate(self.edges[:-1], self._widths)

    @cached_property
    def _widths(self) -> Array:
        """Of the cells, shape (n,) [rad]."""
        return np.diff(self.edges)

    @cached_property
    def scale(self) -> Array:
        """Largest torque over the angle in and around each cell, shape (n,) [N m]."""
        tables, train, scene = self.tables, self.train, self.train.scene
        share = train.law.most if train.law else 0.0
        pressing = scene.friction.ring_pressure if scene.friction else 0.0
        torque = np.abs(tables.torque)
        torque = torque + (1.0 + pressing) * share * np.abs(tables.combustion).sum(axis=-1)
        if train.rubs:
            torque += np.abs(tables.friction) + pressing * np.abs(tables.rubbed).sum(axis=-1)
        most = np.append(largest_of_row(torque), 0.0)
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        around = np.add.outer(middle, [-_WIDEST, _WIDEST])
        from_to = np.searchsorted(middle, around.ravel())
        return np.asarray(np.maximum.reduceat(most, from_to)[::2])

    @property
    def weights_alone(self) -> bool:
        """Whether nothing but weights acts over the angle."""
        train = self.train
        gas_or_friction = train.pressure is not None or train.rubs
        return not gas_or_friction and over_angle(train, self.phases) is None

    @cached_property
    def rounding(self) -> float:
        """Mean torque [N m] that rounding may leave of the works in a period: it is alike in every
        period and every pass, so a grid that checks another errs by it on purpose, and the
        difference knows what the motion makes of it. 0 on the others."""
        works = self.scale * self._widths
        return float(self.checks * _EPS * np.linalg.norm(works) / self.edges[-1])

    @cached_property
    def least(self) -> Array:
        """Smallest J in each cell, shape (n,) [kg m2]."""
        return -largest_of_row(-self.tables.inertia)

    @cached_property
    def finer(self) -> Grid:
        """The same cells for a rule of two more stages, which checks this one, under a pressure
        that is off by as much as this one may be."""
        rule = gauss(len(self.rule.nodes) + 2)
        return Grid(self.train.perturbed, self.edges, rule, checks=True, phases=self.phases)

    @cached_property
    def of_finer_rule(self) -> Grid:
        """The same cells for that rule, under this pressure: it shows what the cells err, which
        smaller ones make less of; what the pressure may be off by stays."""
        finer = self.finer
        if finer.train is self.train:
            return finer
        return Grid(self.train, self.edges, finer.rule, phases=self.phases)

    def split(self, parts: NDArray[np.intp]) -> Grid:
        """Every cell cut into equal parts, as many as ``parts``, shape (n,), says."""
        cell = np.repeat(np.arange(len(parts)), parts)
        part = np.arange(len(cell)) - (np.cumsum(parts) - parts)[cell]
        edges = self.edges[cell] + part * (np.diff(self.edges) / parts)[cell]
        return Grid(self.train, np.append(edges, self.edges[-1]), self.rule)

    def refined(self, cell: NDArray[np.intp], at_end: Array, inside: Array, local: float) -> Grid:
        """Cells so fine that each errs by ``local`` per radian at its end, and by ``local`` inside,
        where the order is lower; itself where they are, or where there are too many.

        cell, at_end, inside : shape (m,) each, cells that were passed and their relative errors
        """
        stages = len(self.rule.nodes)
        at_end = at_end / np.maximum(local * self._widths[cell], FINEST_CELL)
        inside = inside / max(local, FINEST_CELL)
        enough = at_end.max() <= 1.0 and inside.max() <= 1.0
        if enough or len(self.edges) >= _MOST_CELLS:
            return self
        parts = np.ceil(np.maximum(at_end ** (0.5 / stages), inside ** (1.0 / (stages + 1))))
        most = np.ones(len(self._widths), dtype=np.intp)
        np.maximum.at(most, cell, np.clip(np.nan_to_num(parts, nan=2.0), 1, 4).astype(np.intp))
        return self.split(most)

    def cell_at(self, theta: float, sense: float) -> int:
        """Number of the cell that the motion is about to pass at a crank angle [rad]."""
        local = theta % float(self.edges[-1])
        k = int(np.searchsorted(self.edges, local + sense * _SLIVER, side="right")) - 1
        return k % (len(self.edges) - 1)

    def terms(self, theta: float, sense: float, count: int, bound: float) -> Terms:
        """At most ``count`` cells from a crank angle on, in the sense of rotation, cut at the
        angle ``bound``; the first and the last may be parts of cells."""
        n, period, reach = len(self.edges) - 1, float(self.edges[-1]), abs(bound - theta)
        step = 1 if sense > 0.0 else -1
        at = self.cell_at(theta, sense) + step * np.arange(count + 1)
        cell = at[:-1] % n
        # not the sum of so many widths, which every pass over the same cells would round alike
        turns, after = np.divmod(at[1:], n)
        ahead = self.edges[after if step > 0 else after + 1]
        turned = np.append(0.0, sense * (turns * period + ahead - self._local(theta, sense)))
        width = self._widths[cell]
        width[0] = turned[1]
        m = int(np.searchsorted(turned[1:], reach - _SLIVER)) + 1
        if m <= count:
            cell, width, turned = cell[:m], width[:m], turned[: m + 1]
            if turned[m] > reach:
                turned[m], width[m - 1] = reach, reach - turned[m - 1]
        return self._filled(theta, sense, cell, width, turned)

    def _local(self, theta: float, sense: float) -> float:
        """An angle [rad] in the period in which the motion goes on."""
        period = float(self.edges[-1])
        return theta - math.floor((theta + sense * _SLIVER) / period) * period

    def same(self, terms: Terms, theta: float, sense: float) -> Terms:
        """The terms of another grid's cells from a crank angle on, where edges are the same."""
        return self._filled(theta, sense, terms.cell, terms.width, terms.turned)

    def cut(self, terms: Terms, theta: float, sense: float, marks: Array) -> Terms:
        """The terms from a crank angle on with edges more, at angles turned [rad]."""
        marks = np.unique(marks)
        marks = marks[np.append(True, np.diff(marks) > _SLIVER)]
        k = np.searchsorted(terms.turned, marks) - 1
        apart = np.minimum(marks - terms.turned[k], terms.turned[k + 1] - marks) > _SLIVER
        marks, k = marks[apart], k[apart]
        of = np.insert(np.arange(len(terms.cell)), k, k)
        turned = np.insert(terms.turned, k + 1, marks)
        width = np.where(np.isin(of, k), np.diff(turned), terms.width[of])
        return self._filled(theta, sense, terms.cell[of], width, turned)

    def _filled(
        self, theta: float, sense: float, cell: NDArray[np.intp], width: Array, turned: Array
    ) -> Terms:
        """The terms of these cells; what is a part of a cell is tabulated anew."""
        parts = (width != self._widths.take(cell)).nonzero()[0]
        anew: tuple[Array, ...] = ()
        if len(parts):
            start = self._local(theta, sense) + sense * turned[parts]
            anew = self._tabulate(start, sense * width[parts])
        if len(parts) == len(cell):
            tables = [*anew]
        else:
            tables = [table.take(cell, axis=0) for table in self.tables]
            if sense < 0.0:
                tables = [table[:, ::-1].copy() for table in tables]
            for table, part in zip(tables, anew, strict=False):
                table[parts] = part
        inertia, torque, combustion, friction, *others = tables
        against = 0.0
        if self.train.rubs:
            rings = self.train.scene.friction
            against = sense * rings.ring_pressure if rings else 0.0
            torque -= sense * friction
        return Terms(cell, width, turned, against, inertia, torque, combustion, *others)

    def _tabulate(self, start: Array, width: Array) -> _Tables:
        places = ends_and_nodes(len(self.rule.nodes)).places
        every = start[:, None] + width[:, None] * places
        theta, reduction = every[:, 1:-1], reduce(self.train, every)
        inertia, ends = reduction.inertia[:, 1:-1], reduction.inertia[:, [0, -1]]
        torque, of_angle = reduction.torque[:, 1:-1], over_angle(self.train, self.phases)
        torque = torque.copy() if of_angle is None else torque + of_angle(theta)
        combustion, rubbed = fired_torque(self.train, theta), self._rub(theta)
        return _Tables(inertia, torque, combustion, *rubbed, ends)

    def _rub(self, theta: Array) -> tuple[Array, Array, Array]:
        """What of `_Tables` comes from friction, at angles of shape (m, s)."""
        friction, empty = self.train.scene.friction, np.empty((*theta.shape, 0))
        nothing = np.empty((len(theta), 0))
        if not self.train.rubs:
            return nothing, empty, nothing
        rubs = rubbing(self.train, theta, self.phases)
        drag = rubs.drag if self.drags else nothing
        pressed = friction is not None and friction.ring_pressure > 0.0
        if pressed and self.train.combustion is not None:
            return rubs.rings, rubs.gas, drag
        return rubs.coulomb(), empty, drag


def grid_of(train: CrankTrain, rule: Rule, widest: float = _WIDEST) -> Grid:
    """The coarsest grid of a crank train: with the edges that it must have, no cell wider than
    ``widest`` [rad]."""
    marks = edges_apart(np.array([0.0, train.period]), _edges_of(train))
    grid = Grid(train, marks, rule)
    return grid.split(np.maximum(np.ceil(np.diff(marks) / widest - 1e-9), 1).astype(np.intp))


def _edges_of(train: CrankTrain) -> Array:
    """Crank angles [rad] in one period, in any order: `edges_over_angle`, and the decisions on the
    fuel."""
    return np.concatenate([edges_over_angle(train), _decisions(train)])


def _decisions(train: CrankTrain) -> Array:
    """Crank angles [rad] in one period at which the fuel is decided."""
    if train.law is None:
        return np.empty(0)
    cycle = train.scene.period
    turns = cycle * np.arange(round(train.period / cycle))
    return np.asarray(np.add.outer(turns, train.law.angles).ravel())


def edges_apart(*marks: Array) -> Array:
    """All marks [rad] in order, one where rounding alone sets them apart; the last stays."""
    edges = np.unique(np.concatenate([part.ravel() for part in marks]))
    last = edges[-1]
    edges = edges[np.append(True, np.diff(edges) > _SLIVER)]
    edges[-1] = last
    return np.asarray(edges)
