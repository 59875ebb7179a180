"""By how much the lectures are off, over the angle: curves A (u - p) + B alpha + C + D p, where u
is omega^2 and p the square of the mean speed, or the speed and its mean.

Tables are made at nodes some degrees apart, and at all nodes of those cells in which a curve may
be largest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.balances import Balances, balances
from crankmbs.compare.bodies import bodies_of
from crankmbs.compare.lectured import LECTURES, quantities_by
from crankmbs.compare.quantities import QUANTITIES, cycle_angles, observed
from crankmbs.errors import InputError
from crankmbs.mechanics.newton_euler import UNITS
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import Rule
from crankmbs.scene.scene import Scene

__all__ = ["CURVES", "EACH", "LINEAR", "Deviations"]

EACH = 1 + len(LECTURES)
"""Curves of every quantity: itself, and what it is more than each lecture says."""
CURVES = len(QUANTITIES) * EACH
_VELOCITY = list(QUANTITIES).index("piston velocity")
LINEAR = slice(_VELOCITY * EACH, (_VELOCITY + 1) * EACH)
"""Curves that go with the speed, and not with its square."""
_OF_ANGLE = ("piston displacement", "gas torque")  # alone
_MOVING = np.array([[1.0], [0.0]])  # the speed, of what a lecture adds up: inertia, and gas


@dataclass(frozen=True)
class Deviations:
    """A, B, C and D of every curve in the m cells of a period.

    begin, sense : crank angle at its beginning [rad], and sense of rotation; width : of the cells
        [rad], shape (m,); sparse : numbers of nodes, shape (n,)
    """

    train: CrankTrain
    begin: float
    sense: float
    rule: Rule
    width: Array
    sparse: Index

    @cached_property
    def at_sparse(self) -> Array:
        """At the sparse nodes, shape (n, 4, curves)."""
        cells, places = np.divmod(self.sparse, len(self.rule.nodes))
        table = self._table(cells, self.rule.nodes[places])
        return np.ascontiguousarray(table.reshape(CURVES, 4, -1).T)

    @cached_property
    def _tables(self) -> tuple[Array, NDArray[np.bool_]]:
        """Tables at all nodes, shape (m, curves, 4, s), of those cells that are marked."""
        shape = len(self.width), CURVES, 4, len(self.rule.nodes)
        return np.empty(shape), np.zeros(len(self.width), bool)

    def at(self, cell: Index, curve: Index) -> Array:
        """Of some curves at the nodes of some cells, shape (c, 4, s)."""
        (tables, made), s = self._tables, len(self.rule.nodes)
        missing = np.unique(cell[~made[cell]])
        if len(missing):
            cells, places = np.repeat(missing, s), np.tile(self.rule.nodes, len(missing))
            table = self._table(cells, places).reshape(CURVES, 4, len(missing), s)
            tables[missing], made[missing] = np.moveaxis(table, 2, 0), True
        return np.asarray(tables[cell, curve])

    def _table(self, cells: Index, places: Array) -> Array:
        """At places in cells, shape (quantities, 1 + lectures, 4, n)."""
        turned = (np.cumsum(self.width) - self.width)[cells] + self.width[cells] * places
        theta = self.begin + self.sense * turned
        parts = balances(self.train, theta, self.sense)
        run, scene = _observed(self.train.scene, parts, theta), self.train.scene
        gas = parts.cylinders["gas_force"][:, 0].T / (scene.piston.gas_area or 1.0)
        lectures = _lectured(scene, gas, theta)
        table = np.empty((len(QUANTITIES), EACH, 4, len(theta)))
        table[:, :, :2] = run[:, None, :2]
        table[:, 0, 2], table[:, 0, 3] = run[:, 2], run[:, 0]
        table[:, 1:, 2] = run[:, None, 2] - lectures[:, :, 1]
        table[:, 1:, 3] = run[:, None, 0] - lectures[:, :, 0]
        return table


def _first(name: str, values: Array) -> Array:
    """Of a quantity that every cylinder has, shape (..., n, cylinders), that of cylinder 1."""
    return values[..., 0] if QUANTITIES[name].per_cylinder else values


def _observed(scene: Scene, balances: Balances, theta: Array) -> Array:
    """The quantities of cylinder 1: parts that belong to omega^2, alpha and 1, shape (quantities,
    3, n); of what goes with the speed the first belongs to omega."""
    cylinders = {name: np.moveaxis(values, 0, -1) for name, values in balances.cylinders.items()}
    answer = observed(scene, balances.crank | cylinders, theta, UNITS.square, UNITS.alpha)
    parts = np.zeros((len(QUANTITIES), 3, len(theta)))
    for part, name in zip(parts, QUANTITIES, strict=True):
        values = _first(name, answer[name])
        if name in _OF_ANGLE:
            part[2] = values[0]
        elif name == "piston velocity":
            part[0] = values[0]
        else:
            part[:] = values
    return parts


def _lectured(scene: Scene, pressure: Array, theta: Array) -> Array:
    """What the lectures say of them at a constant speed: parts that belong to its square and to 1,
    shape (quantities, lectures, 2, n); no numbers where one says nothing.

    pressure : shape (n, cylinders) [Pa]
    """
    phi, bodies = cycle_angles(scene, theta), bodies_of(scene)
    difference, motion = np.stack([0.0 * pressure, pressure]), (_MOVING, 0.0 * _MOVING)
    parts = np.full((len(QUANTITIES), len(LECTURES), 2, len(theta)), np.nan)
    made: dict[object, Any] = {}
    for k, formulas in enumerate(LECTURES.values()):
        try:
            factors = [
                made[one] if one in made else made.setdefault(one, one(phi, bodies))
                for one in formulas
            ]
        except InputError:
            continue
        answer = quantities_by(scene, (factors[0], factors[1]), theta, difference, motion)
        for part, name in zip(parts[:, k], QUANTITIES, strict=True):
            part[:] = _first(name, answer[name])
        parts[0, k, 0] = 0.0  # of the displacement, which depends on the angle alone
    return parts
