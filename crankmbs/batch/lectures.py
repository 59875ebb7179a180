"""By how much the lectures are off, over the angle: curves A (u - p) + B alpha + C + D p, where u
is omega^2 and p the square of the mean speed, or the speed and its mean.

Tables are made at nodes some degrees apart, and at all nodes of those cells in which a curve may
be largest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from crankmbs.compare.bodies import Bodies, bodies_of
from crankmbs.compare.lectured import LECTURES, quantities_by
from crankmbs.compare.quantities import QUANTITIES, cycle_angles, observed
from crankmbs.errors import InputError
from crankmbs.mechanics.newton_euler import UNITS
from crankmbs.numerics.arrays import Array, Index
from crankmbs.scene.scene import Scene

__all__ = ["CURVES", "EACH", "LINEAR", "OF_RUN", "Deviations"]

EACH = 1 + len(LECTURES)
"""Curves of every quantity: itself, and what it is more than each lecture says."""
CURVES = len(QUANTITIES) * EACH
_VELOCITY = list(QUANTITIES).index("piston velocity")
LINEAR = slice(_VELOCITY * EACH, (_VELOCITY + 1) * EACH)
"""Curves that go with the speed, and not with its square."""
_OF_ANGLE = ("piston displacement", "gas torque")  # alone
_MOVING = np.array([[1.0], [0.0]])  # the speed, of what a lecture adds up: inertia, and gas


OF_RUN = (
    *("piston_displacement", "piston_velocity", "piston_acceleration", "rod_angle", "side_force"),
    *(
        f"{joint}_force_{axis}"
        for joint in ("piston_pin", "crank_pin", "main_bearing")
        for axis in "xy"
    ),
    *("crank_torque", "gas_force", "net_pressure"),
)
"""The variables that they are made of."""


@dataclass(frozen=True)
class Deviations:
    """A, B, C and D of every curve in the cells of a period, of several machines.

    theta : crank angles [rad] at the s nodes of the m cells of a share of the period, shape
        (machines, m, s)
    variables : those of `OF_RUN` at all these, one machine after the other, as
        `crankmbs.batch.balances` has them
    turns : the cylinder that is in the first share where the first one is in each
    sparse : numbers of nodes of a share, shape (n,)
    """

    scenes: Sequence[Scene]
    theta: Array
    variables: dict[str, Array]
    turns: Index
    sparse: Index

    @cached_property
    def at_sparse(self) -> Array:
        """At the sparse nodes of all shares, shape (n, machines, 4, curves)."""
        count, m, s = self.theta.shape
        run, lectures = self._parts(np.add.outer(m * s * np.arange(count), self.sparse).ravel())
        table = np.empty((len(QUANTITIES), EACH, 4, *run.shape[2:]))
        table[:, :, :3], table[:, :, 3] = run[:, None], run[:, None, 0]
        table[:, :, 2:] -= lectures[:, :, ::-1]
        table = table.reshape(CURVES, 4, -1, count, len(self.sparse)).transpose(2, 4, 3, 1, 0)
        return table.reshape(-1, count, 4, CURVES)

    @cached_property
    def _known(self) -> list[Any]:
        """Which cells were looked at, and the parts there."""
        return [np.zeros(self.theta[..., 0].size, bool), None]

    def at(self, case: Index, cell: Index, curve: Index) -> Array:
        """Of some curves of cases at the nodes of some cells, shape (4, c, s)."""
        (count, m, s), (share, cell) = self.theta.shape, np.divmod(cell, self.theta.shape[1])
        cell += m * np.minimum(case, count - 1)
        marked = np.bincount(cell, minlength=count * m) > 0
        if (marked > self._known[0]).any():
            marked |= self._known[0]
            nodes = np.add.outer(s * np.flatnonzero(marked), np.arange(s)).ravel()
            self._known[:] = marked, self._parts(nodes)
        marked, parts = self._known
        row = (np.cumsum(marked) - 1)[cell]
        run, lectures = (part.reshape(*part.shape[:-1], -1, s) for part in parts)
        quantity, by = np.divmod(curve, EACH)
        a, b, c = np.moveaxis(run[quantity, :, share, row], 1, 0)
        square, one = np.moveaxis(lectures[quantity, by, :, share, row], 1, 0)
        return np.stack([a, b, c - one, a - square])

    def _parts(self, nodes: Index) -> tuple[Array, Array]:
        """What the run and the lectures have at some nodes: parts that belong to omega^2, alpha and
        1, shape (quantities, 3, shares, n), of what goes with the speed the first to omega; and,
        at a constant speed, to its square and to 1, shape (quantities, 1 + lectures, 2, shares, n),
        no numbers where one says nothing."""
        of, theta, scene = nodes // self.theta[0].size, self.theta.ravel()[nodes], self.scenes[0]
        bodies = Bodies(*np.array([bodies_of(one) for one in self.scenes]).T[..., of, np.newaxis])
        variables = {name: each.take(nodes, axis=1) for name, each in self.variables.items()}
        phi = cycle_angles(scene, theta)
        answer = observed(bodies, variables, phi, UNITS.square, UNITS.alpha)
        run = np.zeros((len(QUANTITIES), 3, len(self.turns), len(theta)))
        for part, (name, values) in zip(run, self._first(answer), strict=True):
            if name in _OF_ANGLE:
                part[2] = values[0]
            elif name == "piston velocity":
                part[0] = values[0]
            else:
                part[:] = values
        lectures = np.empty((len(QUANTITIES), EACH, 2, *run.shape[2:]))
        lectures[:, 0] = 0.0
        gas, made = variables["net_pressure"], dict[object, Any]()
        difference, motion = np.concatenate([0.0 * gas, gas]), (_MOVING, 0.0 * _MOVING)
        for by, formulas in enumerate(LECTURES.values(), start=1):
            try:
                made |= {one: one(phi, bodies) for one in formulas if one not in made}
            except InputError:
                lectures[:, by] = np.nan
                continue
            factors = made[formulas.motion], made[formulas.forces]
            answer = quantities_by(scene, bodies, factors, theta, difference, motion)
            for part, (_, values) in zip(lectures[:, by], self._first(answer), strict=True):
                part[:] = values
            lectures[0, by, 0] = 0.0  # of the displacement, which depends on the angle alone
        return run, lectures

    def _first(self, answer: dict[str, Array]) -> Iterator[tuple[str, Array]]:
        """The quantities of cylinder 1 in all shares, shape (..., shares, n), and of the engine."""
        for name, (_, _, per_cylinder) in QUANTITIES.items():
            values = answer[name]
            yield (
                name,
                values.swapaxes(-1, -2)[..., self.turns, :]
                if per_cylinder
                else values[..., None, :],
            )
