"""By how much the lectures are off, over the angle: curves A (u - p) + B alpha + C + D p, where u
is omega^2 and p the square of the mean speed, or the speed and its mean.

Tables are made at nodes some degrees apart, and at all nodes of those cells in which a curve may
be largest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.balances import Balances, balances
from crankmbs.batch.peaks import Curves, Which, polynomials_of, sparse_nodes
from crankmbs.compare.lectured import LECTURES, gear_of, of_cylinders, turning_crank
from crankmbs.compare.quantities import QUANTITIES, observed_cylinders
from crankmbs.errors import InputError
from crankmbs.mechanics.inertia import axes_of
from crankmbs.mechanics.newton_euler import UNITS
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule
from crankmbs.scene.scene import Scene

__all__ = ["Cuts", "Deviations", "basis_at"]

_LINEAR = list(QUANTITIES).index("piston velocity")  # goes with the speed
_BEARING = ("main bearing force x", "main bearing force y")
_OF_ANGLE = ("piston displacement", "gas torque")  # alone
_MOVING = np.array([1.0, 0.0])[:, np.newaxis, np.newaxis]  # the speed, of what a lecture adds up:
_PRESSED = 1.0 - _MOVING  # inertia at a speed of 1, and gas
_SHAPE = len(QUANTITIES), 1 + len(LECTURES)


class Cuts(NamedTuple):
    """Where periods of k cases begin and end: in which cells, at which places, 0 to 1; shape (k,).
    In arrays over cells what lies before it stands for the cell, and what lies behind it comes
    last."""

    cell: Index
    place: Array

    def part(self, which: NDArray[np.bool_]) -> Cuts:
        """Some of them."""
        return Cuts(self.cell[which], self.place[which])


def basis_at(rule: Rule, places: Array) -> Array:
    """What the values at the nodes of a cell add at places in it: shape (k, n) -> (k, n, s)."""
    s = len(rule.nodes)
    several = np.append(places, 0.0)  # a product with one row alone would round otherwise
    return polynomials_of(s).basis(several)[:-1].reshape(*places.shape, s)


@dataclass(frozen=True)
class Deviations:
    """Curves of every quantity, and of what it is more than each lecture says, in the m cells of a
    period.

    begin, sense : crank angle at its beginning [rad], and sense of rotation; width : of the cells
        [rad], shape (m,)
    """

    train: CrankTrain
    begin: float
    sense: float
    rule: Rule
    width: Array

    def curves(
        self, square: Array, alpha: Array, omega: Array, mean: Array, cuts: Cuts | None
    ) -> Curves:
        """Those of motions whose omega^2, alpha and omega at the nodes have the shape (k, m, s), or
        (k, m + 1, s) where they are cut; mean : speed, shape (k,)."""
        cells = self._nodes // len(self.rule.nodes)

        def sizes(some: slice) -> Array:
            a, b, c, d = self._sparse
            u, rate, speed = (
                each[some].reshape(-1, 1, each[0].size)[..., self._nodes]
                for each in (square, alpha, omega)
            )
            p = mean[some, None, None]
            moving, level = a[:, 0] * (u - p * p) + b[:, 0] * rate, np.repeat(p * p, len(a), axis=1)
            moving[:, _LINEAR] = (a[_LINEAR, 0] * (speed - p))[:, 0]
            level[:, _LINEAR] = p[:, 0]
            values = d * level[..., None]
            values += c
            values += moving[:, :, None]
            np.abs(values, out=values)
            if cuts is not None:  # of other nodes
                values[
                    np.broadcast_to((cells == cuts.cell[some, None])[:, None, None], values.shape)
                ] = 0.0
            return np.asarray(values)

        def rows(which: Which) -> Array:
            a, b, c, d = np.moveaxis(self._full(which, cuts), 1, 0)
            line = (which.curve // _SHAPE[1] == _LINEAR)[:, None]
            u = np.where(line, *(each[which.case, which.cell] for each in (omega, square)))
            p = np.where(line, mean[which.case, None], mean[which.case, None] ** 2)
            rate = alpha[which.case, which.cell]
            return np.asarray((a * (u - p) + b * rate + (c + d * p))[:, None])

        always = None
        if cuts is not None:
            always = np.stack([cuts.cell, np.full_like(cuts.cell, len(self.width))], axis=1)
        count = len(mean), math.prod(_SHAPE)
        return Curves(count, _SHAPE[1], sizes, cells, rows, always)

    @cached_property
    def _nodes(self) -> Index:
        return sparse_nodes(self.width, len(self.rule.nodes))

    @cached_property
    def _sparse(self) -> Array:
        """A, B, C and D there, shape (4, quantities, 1 + lectures, n)."""
        cells, places = np.divmod(self._nodes, len(self.rule.nodes))
        return np.moveaxis(self._table(cells, self.rule.nodes[places]), 2, 0).copy()

    @cached_property
    def _tables(self) -> tuple[Array, NDArray[np.bool_]]:
        """Tables at all nodes, shape (m, curves, 4, s), of those cells that are marked."""
        shape = len(self.width), math.prod(_SHAPE), 4, len(self.rule.nodes)
        return np.empty(shape), np.zeros(len(self.width), bool)

    def _full(self, which: Which, cuts: Cuts | None) -> Array:
        """Those of some curves in some cells, or parts of cells, shape (c, 4, s)."""
        (tables, made), cell, s = self._tables, which.cell, len(self.rule.nodes)
        if cuts is not None:
            cut, place = cuts.cell[which.case], cuts.place[which.case]
            ahead, behind = (np.flatnonzero(cell == one) for one in (cut, len(self.width)))
            cell = np.where(cell == len(self.width), cut, cell)
        missing = np.unique(cell[~made[cell]])
        if len(missing):
            found = self._table(np.repeat(missing, s), np.tile(self.rule.nodes, len(missing)))
            table = found.reshape(tables.shape[1], 4, len(missing), s)
            tables[missing], made[missing] = np.moveaxis(table, 2, 0), True
        rows = tables[cell, which.curve]
        if cuts is not None:
            nodes = self.rule.nodes
            for of, places in (
                (ahead, place[ahead, None] * nodes),
                (behind, place[behind, None] + (1.0 - place[behind, None]) * nodes),
            ):
                rows[of] = np.matmul(rows[of], basis_at(self.rule, places).swapaxes(1, 2))
        return np.asarray(rows)

    def _table(self, cells: Index, places: Array) -> Array:
        """At places in cells, shape (quantities, 1 + lectures, 4, n)."""
        turned = (np.cumsum(self.width) - self.width)[cells] + self.width[cells] * places
        theta = self.begin + self.sense * turned
        found = balances(self.train, theta, self.sense)
        own, scene = _observed(self.train.scene, found, theta), self.train.scene
        said = _lectured(scene, found.cylinders["gas_pressure"][:, 0], theta)
        table = np.empty((*_SHAPE, 4, len(theta)))
        table[:, :, :2] = own[:, None, :2]
        table[:, 0, 2], table[:, 0, 3] = own[:, 2], own[:, 0]
        table[:, 1:, 2] = own[:, None, 2] - said[:, :, 1]
        table[:, 1:, 3] = own[:, None, 0] - said[:, :, 0]
        return table


def _observed(scene: Scene, found: Balances, theta: Array) -> Array:
    """The quantities of cylinder 1: parts that belong to omega^2, alpha and 1, shape (quantities,
    3, n); of what goes with the speed the first belongs to omega."""
    first = {name: values[0] for name, values in found.cylinders.items()}
    phi = theta + scene.cylinders[0].phase
    answer = observed_cylinders(scene, first, phi, UNITS.square, UNITS.alpha)
    answer |= {name: found.crank[name.replace(" ", "_")] for name in _BEARING}
    parts = np.zeros((len(QUANTITIES), 3, len(theta)))
    for part, name in zip(parts, QUANTITIES, strict=True):
        if name in _OF_ANGLE:
            part[2] = answer[name][0]
        elif name == "piston velocity":
            part[0] = answer[name][0]
        else:
            part[:] = answer[name]
    return parts


def _lectured(scene: Scene, pressure: Array, theta: Array) -> Array:
    """What the lectures say of them at a constant speed: parts that belong to its square and to 1,
    shape (quantities, lectures, 2, n); no numbers where one says nothing.

    pressure : shape (cylinders, n) [Pa]
    """
    phi = theta + np.array([cylinder.phase for cylinder in scene.cylinders])[:, None]
    gear, axes = gear_of(scene), axes_of(scene)
    own = turning_crank(scene, theta, _MOVING[:, 0], 0.0)
    parts = np.full((len(QUANTITIES), len(LECTURES), 2, len(theta)), np.nan)
    made: dict[object, Any] = {}
    for k, formulas in enumerate(LECTURES.values()):
        try:
            at = [
                made[one] if one in made else made.setdefault(one, one(phi, gear))
                for one in formulas
            ]
        except InputError:
            continue
        said = of_cylinders(scene, (at[0], at[1]), phi, _PRESSED * pressure, (_MOVING, 0.0))
        x, y = (said[f"crank pin force {axis}"] for axis in "xy")
        bearing = axes.cos @ x - axes.sin @ y, axes.sin @ x + axes.cos @ y
        for part, name in zip(parts[:, k], QUANTITIES, strict=True):
            if name in _BEARING:
                axis = _BEARING.index(name)
                part[:] = bearing[axis] + own[axis]
            elif name == "piston displacement":
                part[0], part[1] = 0.0, said[name][0]
            else:
                part[:] = said[name][:, 0]
    return parts
