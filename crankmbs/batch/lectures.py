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
from crankmbs.compare.lectured import LECTURES, gear_of, of_cylinders, turning_crank
from crankmbs.compare.quantities import QUANTITIES, observed_cylinders
from crankmbs.errors import InputError
from crankmbs.mechanics.axes import axes_of
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
_BEARING = ("main bearing force x", "main bearing force y")
_OF_ANGLE = ("piston displacement", "gas torque")  # alone
_MOVING = np.array([1.0, 0.0])[:, np.newaxis, np.newaxis]  # the speed, of what a lecture adds up:
_PRESSED = 1.0 - _MOVING  # inertia at a speed of 1, and gas


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
            found = self._table(np.repeat(missing, s), np.tile(self.rule.nodes, len(missing)))
            table = found.reshape(CURVES, 4, len(missing), s)
            tables[missing], made[missing] = np.moveaxis(table, 2, 0), True
        return np.asarray(tables[cell, curve])

    def _table(self, cells: Index, places: Array) -> Array:
        """At places in cells, shape (quantities, 1 + lectures, 4, n)."""
        turned = (np.cumsum(self.width) - self.width)[cells] + self.width[cells] * places
        theta = self.begin + self.sense * turned
        found = balances(self.train, theta, self.sense)
        own, scene = _observed(self.train.scene, found, theta), self.train.scene
        gas = found.cylinders["gas_force"][:, 0] / (scene.piston.gas_area or 1.0)
        said = _lectured(scene, gas, theta)
        table = np.empty((len(QUANTITIES), EACH, 4, len(theta)))
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
