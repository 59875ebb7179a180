"""The state of a motion at places in its cells: what acceleration, torques and friction are there.

They are algebra with the polynomials of a cell and what acts in it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from crankmbs.mechanics.friction import friction_forces, friction_torque, held_share
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.torque import over_angle
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.cells import Cells
from crankmbs.numerics.arrays import Array, Index

__all__ = ["States", "inner_states", "states_in"]


class States(NamedTuple):
    """The motion at points, shape (p,) each [s, rad, rad/s, rad/s2, N m].

    external_torque : None where it is what the acceleration takes
    fuel : shares of the combustion, friction : on every piston [N], shape (p, cylinders); or None
    """

    time: Array
    angle: Array
    speed: Array
    acceleration: Array
    external_torque: Array | None
    fuel: Array | None
    friction: Array | None

    @staticmethod
    def joined(parts: Sequence[States], order: Index | slice = slice(None)) -> States:
        """States one after the other, then in an order."""
        rows: list[Any] = [
            None if row[0] is None else np.concatenate(row)[order]
            for row in zip(*parts, strict=True)
        ]
        return States(*rows)

    def variables(self, train: CrankTrain) -> dict[str, Array]:
        """Every variable of a result by name but the energy residual, shape (p,) or
        (p, cylinders)."""
        motion = self.angle, self.speed, self.acceleration
        values = reactions(train, *motion, self.fuel, self.friction)
        values |= {"time": self.time, "crank_angle": self.angle}
        values |= {"crank_speed": self.speed, "crank_acceleration": self.acceleration}
        if self.external_torque is not None:
            values["external_torque"] = self.external_torque
        if self.fuel is not None:
            values["fuel"] = self.fuel
        return values


def states_in(cells: Cells, train: CrankTrain, k: Index, x: Array) -> States:
    """The motion at places x in the cells k, shape (p,) each."""
    basis = cells.basis(x)
    return _states(cells, train, k, lambda row: cells.values(row, k, basis))


def inner_states(cells: Cells, train: CrankTrain) -> States:
    """The motion at the nodes of all cells, and a hair inside their ends, cell after cell."""
    k = np.repeat(np.arange(len(cells.time)), cells.time.shape[1])
    return _states(cells, train, k, cells.inner_reader())


def _states(cells: Cells, train: CrankTrain, k: Index, read: Callable[[Array], Array]) -> States:
    """The motion at points in the cells k, shape (p,), at which rows are read."""
    time, angle = read(cells.time), read(cells.angle)
    shares = cells.shares[k] if cells.shares.shape[1] else None
    reduction, sense = reduce(train, angle, shares), cells.acting.sense
    if cells.energy is None:
        speed = read(cells.speed)
    else:
        energy = np.maximum(read(cells.energy), 0.0)
        speed = sense * np.sqrt(2.0 * energy / reduction.inertia)
    slides = np.full_like(speed, sense)
    outside, rate = None, None
    if cells.outside is not None:
        outside = read(cells.outside)
    elif cells.acting.loads is not None:
        outside = _outside(cells, train, time, angle, speed)
    if outside is not None:
        if cells.acting.holds and train.scene.friction is not None:
            slides = _holding(cells, train, angle, reduction.torque + outside)
        rubbed = friction_torque(train, angle, speed, slides, shares)
        rest = reduction.rest(speed) + rubbed
        outside = -rest if cells.acting.holds else outside
        rate = (rest + outside) / reduction.inertia
    if cells.acceleration is not None:
        rate = read(cells.acceleration)
    assert rate is not None
    friction = None
    if train.scene.friction is not None:
        friction = friction_forces(train, angle, speed, shares, slides)
    return States(time, angle, speed, rate, outside, shares, friction)


def _holding(cells: Cells, train: CrankTrain, angle: Array, torque: Array) -> Array:
    """The share of its friction that a crank at rest needs to be held, with its sign."""
    shares = tuple(cells.shares[0].tolist())
    return np.clip(held_share(train, float(angle[0]), torque, shares), -1.0, 1.0)


def _outside(cells: Cells, train: CrankTrain, time: Array, angle: Array, speed: Array) -> Array:
    """Torque of all loads that act [N m]."""
    loads, of_angle = cells.acting.loads, over_angle(train.scene, cells.acting.phases)
    assert loads is not None
    outside = loads(time, speed) + (0.0 if of_angle is None else of_angle(angle))
    for function in loads.functions:
        outside = outside + function(time, angle, speed)
    return np.asarray(outside)
