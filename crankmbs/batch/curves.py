"""Motions over a period at the nodes of its cells, and curves whose largest sizes are sought."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crankmbs.batch.lectures import CURVES, EACH, LINEAR
from crankmbs.batch.machine import Machine, Pass
from crankmbs.batch.motion import Cases, Energies
from crankmbs.batch.peaks import Curves, Which
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import at_nodes

__all__ = ["Motions"]


@dataclass(frozen=True)
class Motions:
    """Those of a pass over k cases. With cuts, cells are whole, with one more, until `cut`."""

    machine: Machine
    tables: Pass
    energies: Energies
    cases: Cases

    @cached_property
    def places(self) -> tuple[Array, Array]:
        """Angles turned [rad] to where cells begin, and their widths, shape (1 or k, cells)."""
        width, cuts = self.tables.width, self.energies.cuts
        return (np.cumsum(width, axis=1) - width, width) if cuts is None else cuts.places(width)

    @cached_property
    def square(self) -> Array:
        """omega^2 [rad2/s2], shape (k, cells, s)."""
        return np.asarray(2.0 * self.energies.energy / self._total)

    @cached_property
    def omega(self) -> Array:
        """Speed [rad/s], shape (k, cells, s)."""
        return np.asarray(self.machine.sense * np.sqrt(self.square))

    @cached_property
    def load(self) -> Array:
        """Torque of the loads [N m], shape (k, cells, s)."""
        c0, c1, c2 = (each[:, None, None] for each in self.cases[1:4])
        return np.asarray(c0 + c1 * self.omega + c2 * self.square)

    @cached_property
    def alpha(self) -> Array:
        """Acceleration [rad/s2], shape (k, cells, s)."""
        torque, half = (self._whole(each) for each in (self.tables.torque, self.tables.rods[:, 0]))
        return (torque + self.load + half * self.square) / self._total

    @cached_property
    def rods(self) -> Array:
        """Torque of all rods [N m], shape (k, cells, s)."""
        return self._combined(self.tables.rods)

    @cached_property
    def vectors(self) -> Array:
        """The forces of the joints, then along a line what is largest where the torque of the rods
        is largest, and least, and where the speed is, shape (k, r, 2, cells, s)."""
        lines = [
            sign * values + level[:, None, None]
            for values, level in zip((self.rods, self.omega), self.levels, strict=True)
            for sign in (1.0, -1.0)
        ]
        extremes = np.stack(lines, axis=1)[:, :, None]
        extremes = np.concatenate([extremes, np.zeros_like(extremes)], axis=2)
        forces = self._combined(self.tables.forces)
        return self.cut(np.concatenate([forces, extremes], axis=1))

    @cached_property
    def levels(self) -> tuple[Array, Array]:
        """What torque [N m] and speed [rad/s] are measured from there, shape (k,)."""
        torque, speed = (2.0 * np.abs(each).max(axis=(1, 2)) for each in (self.rods, self.omega))
        return torque, speed

    @cached_property
    def sizes(self) -> Array:
        """Of the vectors, shape (k, r, cells, s)."""
        return np.asarray(np.sqrt(np.einsum("krcms,krcms->krms", self.vectors, self.vectors)))

    @property
    def curves(self) -> Curves:
        """Those of the vectors."""
        (k, r, m, s), sizes, vectors = self.sizes.shape, self.sizes, self.vectors
        uncut = self.energies.cuts is None
        nodes = self.tables.lectures.sparse if uncut else np.arange(m * s)

        def some_sizes(some: slice) -> Array:
            seen: Array = sizes[some].reshape(-1, r, m * s)[..., nodes]
            return np.moveaxis(seen, 2, 0).copy()

        def rows(which: Which) -> Array:
            return np.asarray(vectors[which.case, which.curve, :, which.cell].T.copy())

        return Curves((k, r), 1, some_sizes, nodes // s, rows)

    def of_lectures(self, mean: Array) -> Curves:
        """Of the lectures over the whole period: A (u - p) + B alpha + C + D p; mean : speed, shape
        (k,)."""
        (k, m, s), lectures, mean = self.omega.shape, self.tables.lectures, mean[:, None, None]
        powers = np.empty((k, m, 2, 4, s))  # of what goes with the square of the speed, or with it
        for line, (u, p) in enumerate(((self.square, mean**2), (self.omega, mean))):
            each = np.broadcast_arrays(u - p, self.alpha, np.ones(1), p)
            powers[:, :, line] = np.stack(each, axis=2)
        cuts, of_share = self.energies.cuts, self.tables.width.shape[1]
        cells, nodes = np.divmod(lectures.sparse, s)
        cells = np.add.outer(of_share * np.arange(self.machine.shares), cells).ravel()
        nodes = np.tile(nodes, self.machine.shares)

        def sizes(some: slice) -> Array:
            seen, table = powers[some, cells % m, :, :, nodes], lectures.at_sparse
            if table.shape[1] > 1:
                table = table[:, some]
            shape = len(cells), table.shape[1], -1
            square, linear = (seen[:, :, line].reshape(*shape, 4) for line in range(2))
            values = square @ table
            values[..., LINEAR] = linear @ table[..., LINEAR]
            values = values.reshape(len(cells), -1, CURVES)
            if cuts is not None:  # of other nodes
                values[cells[:, None] == cuts.cell[some]] = 0.0
            return np.asarray(np.abs(values, out=values))

        def rows(which: Which) -> Array:
            case, curve, cell = which
            line = ((curve >= LINEAR.start) & (curve < LINEAR.stop)).astype(np.intp)
            whole = cell if cuts is None else np.where(cell == of_share, cuts.cell[case], cell)
            table, power = lectures.at(case, whole, curve), powers[case, cell % m, line]
            values = np.einsum("pcs,cps->cs", table, power).T[:, None].copy()
            if cuts is not None:
                low, high = cuts.ends(case, cell, of_share)
                part = high - low < 1.0
                values[..., part] = at_nodes(s).part(values[..., part], low[part], high[part])
            return np.asarray(values)

        always = None
        if cuts is not None:
            always = np.stack([cuts.cell, np.full_like(cuts.cell, of_share)], axis=1)
        return Curves((k, CURVES), EACH, sizes, cells, rows, always)

    def cut(self, values: Array) -> Array:
        """Values in the cells, of parts of cells at the nodes of these."""
        cuts = self.energies.cuts
        return values if cuts is None else cuts.cut(values)

    @cached_property
    def _total(self) -> Array:
        """J [kg m2]."""
        return self._whole(self.tables.inertia) + self.cases.mass[:, None, None]

    def _whole(self, table: Array) -> Array:
        """A table in the cells."""
        return table if self.energies.cuts is None else self.energies.cuts.more(table)

    def _combined(self, table: Array) -> Array:
        """What a table, shape (machines, ..., 3, m, s), makes of omega^2, alpha and 1, shape (k,
        ..., cells, s)."""
        m, cuts, lead = table.shape[-2], self.energies.cuts, np.ones(table.ndim - 4, np.intp)

        def fill(out: Array, parts: Array, at: slice) -> None:
            square, alpha = (
                each[:, at].reshape(len(each), *lead, *out.shape[-2:])
                for each in (self.square, self.alpha)
            )
            np.multiply(parts[0], square, out=out)
            out += parts[1] * alpha
            out += parts[2]

        (k, cells, s) = self.square.shape
        values = np.empty((k, *table.shape[1:-3], cells, s))
        fill(values[..., :m, :], np.moveaxis(table, -3, 0), slice(m))
        if cuts is not None:
            again = np.moveaxis(cuts.of(table), -2, 0)[..., None, :]
            fill(values[..., m:, :], again, slice(m, None))
        return values
