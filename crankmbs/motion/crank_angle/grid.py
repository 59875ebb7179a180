"""Cells of the crank angle over one period, and what depends on the angle alone, tabulated.

No knot of the pressure lies inside a cell, so everything in it is smooth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.inertia import fired_torque, inertia_alone, reduce
from crankmbs.mechanics.torque import knots_over_angle, over_angle
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots
from crankmbs.mechanics.windows import Phases
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import Rule, gauss
from crankmbs.numerics.cycle import Cycle
from crankmbs.scene.units import DEGREE

__all__ = ["Grid", "Strip", "grid_of", "largest_of_row"]


_WIDEST = 6.0 * DEGREE
_SLIVER = 1e-12  # rad: a start this close to an edge is on it


@dataclass(frozen=True)
class Strip:
    """Consecutive cells in the sense of rotation.

    cell : shape (m,), their numbers in the grid; width : shape (m,) [rad]
    turned : shape (m + 1,) [rad], angle from the beginning to every edge
    inertia, torque : shape (m, s), J [kg m2] and the torque over the angle [N m], of gas, gravity
        and loads, at the nodes
    combustion : shape (m, s, cylinders) [N m], what firings of share 1 add to the torque; no
        cylinders without fuel
    """

    cell: NDArray[np.intp]
    width: Array
    turned: Array
    inertia: Array
    torque: Array
    combustion: Array

    def angles(self, theta: float, sense: float, rule: Rule) -> Array:
        """Crank angles [rad] of the nodes of a rule, shape (m, s), where it begins at one."""
        ahead = self.turned[:-1, None] + self.width[:, None] * rule.nodes
        return np.asarray(theta + sense * ahead)

    def first(self, m: int) -> Strip:
        """The first m cells."""
        return self.part(0, m)

    def part(self, low: int, high: int) -> Strip:
        """The cells from one number to another; edges are still counted from the beginning."""
        of_cells = (self.inertia[low:high], self.torque[low:high], self.combustion[low:high])
        turned = self.turned[low : high + 1]
        return Strip(self.cell[low:high], self.width[low:high], turned, *of_cells)


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
        if phases == self.phases or not self._has_loads:
            return self
        if phases not in self.known:
            self.known[phases] = replace(self, phases=phases)
        return self.known[phases]

    @cached_property
    def _has_loads(self) -> bool:
        """Whether loads depend on the angle."""
        return any(load.parts.over_angle is not None for load in self.train.scene.torque)

    @cached_property
    def over_angle(self) -> Cycle | None:
        """What loads that act give over the angle."""
        return over_angle(self.train.scene, self.phases)

    @cached_property
    def at_decisions(self) -> Array:
        """J [kg m2] at the crank angles of one period at which the fuel is decided."""
        law = self.train.law
        return inertia_alone(self.train.scene, np.array(law.angles if law else ()))

    def outside(self, theta: Array) -> Array | float:
        """Torque of loads over the angle [N m], at angles [rad]."""
        return 0.0 if self.over_angle is None else self.over_angle(theta)

    @cached_property
    def tables(self) -> tuple[Array, Array, Array]:
        """J and torque over the angle at the nodes of every cell, shape (n, s) each; what the
        combustion of each cylinder adds, shape (n, s, cylinders)."""
        return self._tabulate(self.edges[:-1], np.diff(self.edges))

    @cached_property
    def scale(self) -> Array:
        """Largest torque over the angle in and around each cell, shape (n,) [N m]."""
        _, torque, combustion = self.tables
        share = self.train.law.most if self.train.law else 0.0
        torque = np.abs(torque) + share * np.abs(combustion).sum(axis=-1)
        most = np.append(largest_of_row(torque), 0.0)
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        around = np.add.outer(middle, [-_WIDEST, _WIDEST])
        from_to = np.searchsorted(middle, around.ravel())
        return np.asarray(np.maximum.reduceat(most, from_to)[::2])

    @cached_property
    def least(self) -> Array:
        """Smallest J in each cell, shape (n,) [kg m2]."""
        return -largest_of_row(-self.tables[0])

    @cached_property
    def finer(self) -> Grid:
        """The same cells for a rule of two more stages, which checks this one, under a pressure
        that is off by as much as this one may be."""
        rule = gauss(len(self.rule.nodes) + 2)
        return Grid(self.train.off, self.edges, rule, checks=True, phases=self.phases)

    def split(self, parts: NDArray[np.intp]) -> Grid:
        """Every cell cut into equal parts, as many as ``parts``, shape (n,), says."""
        cell = np.repeat(np.arange(len(parts)), parts)
        part = np.arange(len(cell)) - (np.cumsum(parts) - parts)[cell]
        edges = self.edges[cell] + part * (np.diff(self.edges) / parts)[cell]
        return Grid(self.train, np.append(edges, self.edges[-1]), self.rule)

    def cell_at(self, theta: float, sense: float) -> int:
        """Number of the cell that the motion is about to pass at a crank angle [rad]."""
        local = theta % float(self.edges[-1])
        k = int(np.searchsorted(self.edges, local + sense * _SLIVER, side="right")) - 1
        return k % (len(self.edges) - 1)

    def strip(self, theta: float, sense: float, count: int, bound: float) -> Strip:
        """At most ``count`` cells from a crank angle on, in the sense of rotation, cut at the
        angle ``bound``; the first and the last may be parts of cells."""
        n, period = len(self.edges) - 1, float(self.edges[-1])
        first = self.cell_at(theta, sense)
        base = math.floor((theta + sense * _SLIVER) / period) * period
        local = theta - base
        # not the sum of so many widths, which every pass over the same cells would round alike
        turns, cell = np.divmod(first + int(sense) * np.arange(count + 1), n)
        turned = sense * (turns * period + self.edges[cell + (sense < 0.0)] - local)
        turned[0] = 0.0
        cell, reach = cell[:count], abs(bound - theta)
        whole = np.diff(self.edges)
        width = whole[cell]
        width[0] = turned[1]
        last = int(np.searchsorted(turned[1:], reach - _SLIVER)) + 1
        cell, width, turned = cell[:last], width[:last].copy(), turned[: last + 1]
        if turned[-1] > reach:
            turned[-1] = reach
            width[-1] = reach - turned[-2]
        return self._filled(theta, sense, cell, width, turned)

    def same(self, strip: Strip, theta: float, sense: float) -> Strip:
        """The cells of another grid's strip from a crank angle on, where edges are the same."""
        return self._filled(theta, sense, strip.cell, strip.width, strip.turned)

    def cut(self, strip: Strip, theta: float, sense: float, marks: Array) -> Strip:
        """A strip from a crank angle on with edges more, at angles turned [rad]."""
        marks = np.unique(marks)
        marks = marks[np.append(True, np.diff(marks) > _SLIVER)]
        k = np.searchsorted(strip.turned, marks) - 1
        apart = np.minimum(marks - strip.turned[k], strip.turned[k + 1] - marks) > _SLIVER
        marks, k = marks[apart], k[apart]
        of = np.insert(np.arange(len(strip.cell)), k, k)
        turned = np.insert(strip.turned, k + 1, marks)
        width = np.where(np.isin(of, k), np.diff(turned), strip.width[of])
        return self._filled(theta, sense, strip.cell[of], width, turned)

    def _filled(
        self, theta: float, sense: float, cell: NDArray[np.intp], width: Array, turned: Array
    ) -> Strip:
        """The strip of these cells; what is a part of a cell is tabulated anew."""
        inertia, torque, combustion = (table.take(cell, axis=0) for table in self.tables)
        if sense < 0.0:
            inertia, torque = inertia[:, ::-1].copy(), torque[:, ::-1].copy()
            combustion = combustion[:, ::-1].copy()
        parts = np.flatnonzero(width != np.diff(self.edges)[cell])
        if len(parts):
            period = float(self.edges[-1])
            local = theta - math.floor((theta + sense * _SLIVER) / period) * period
            start = local + sense * turned[parts]
            anew = self._tabulate(start, sense * width[parts])
            inertia[parts], torque[parts], combustion[parts] = anew
        return Strip(cell, width, turned, inertia, torque, combustion)

    def _tabulate(self, start: Array, width: Array) -> tuple[Array, Array, Array]:
        theta = start[:, None] + width[:, None] * self.rule.nodes
        found = reduce(self.train, theta)
        torque = np.asarray(found.torque + self.outside(theta))
        return found.inertia, torque, fired_torque(self.train, theta)


def grid_of(train: CrankTrain, rule: Rule, widest: float = _WIDEST) -> Grid:
    """The coarsest grid of a crank train: edges at the knots of the pressure and of the loads, at
    the decisions on the fuel, and around folds that a rod just escapes, no cell wider than
    ``widest`` [rad]."""
    knots = [crank_angle_knots(train), knots_over_angle(train), _near_folds(train)]
    marks = np.unique(np.concatenate([[0.0], *knots, _decisions(train), [train.period]]))
    marks = marks[np.append(True, np.diff(marks) > _SLIVER)]
    marks[-1] = train.period
    grid = Grid(train, marks, rule)
    return grid.split(np.maximum(np.ceil(np.diff(marks) / widest - 1e-9), 1).astype(np.intp))


def _decisions(train: CrankTrain) -> Array:
    """Crank angles [rad] in one period at which the fuel is decided."""
    if train.law is None:
        return np.empty(0)
    own = train.scene.period
    turns = own * np.arange(round(train.period / own))
    return np.asarray(np.add.outer(turns, train.law.angles).ravel())


def _near_folds(train: CrankTrain) -> Array:
    """Crank angles [rad] around those where a rod is hardly longer than it must be, ever farther.

    The rod swings over within ``width`` of there, where its formulas have their singularity beside
    the real angles: in wider cells two rules err alike, if they see it at all.
    """
    scene, period = train.scene, train.period
    radius, spare = scene.crank.radius, scene.rod.length - scene.crank.radius
    marks = [np.empty(0)]
    for fold, gap in ((0.5, spare + scene.piston.offset), (-0.5, spare - scene.piston.offset)):
        width = math.sqrt(2.0 * max(gap, 0.0) / radius)
        if 0.0 < width < _WIDEST:
            beside = width * 2.0 ** np.arange(math.ceil(math.log2(_WIDEST / width)))
            around = fold * math.pi + np.concatenate([-beside, [0.0], beside])
            turns = 2.0 * math.pi * np.arange(round(period / (2.0 * math.pi)))
            marks += [np.add.outer(turns - c.phase, around).ravel() for c in scene.cylinders]
    return np.asarray(np.mod(np.concatenate(marks), period))


def largest_of_row(table: Array) -> Array:
    """Largest of each row, NaN where one is: ten times faster than along an axis of few columns.

    >>> largest_of_row(np.array([[1.0, 2.0], [4.0, 3.0]]))
    array([2., 4.])
    """
    return np.asarray(table.T.copy().max(axis=0))
