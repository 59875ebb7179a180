"""What depends on the crank angle, the gas forces of all cylinders and the loads, between knots."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import Arithmetic, Array, Number
from validation.oracles.grid import Grid, merge
from validation.oracles.machine import Machine
from validation.oracles.pressure import Pieces, pressure_pieces
from validation.oracles.taylor import GasPiece


@dataclass(frozen=True)
class AnglePieces:
    """Cubic pieces of every cylinder and of the angle tables, on the common grid of their knots."""

    machine: Machine
    pieces: tuple[Pieces, ...]
    crank_ends: tuple[Pieces, ...]
    tables: tuple[Pieces, ...]
    grid: Grid
    arithmetic: Arithmetic

    def piece(self, index: int) -> GasPiece | None:
        """The force of each cylinder between knots index and index + 1, a cubic in theta; None
        without gas."""
        if not self.pieces:
            return None
        phases = [phase for phase, _ in self.machine.cylinders]
        force, origin = self._cubics(index, self.pieces, phases)
        force = force * self.arithmetic.number(self.machine.piston_area)
        if self.crank_ends:
            below, behind = self._cubics(index, self.crank_ends, phases)
            area = self.arithmetic.number(self.machine.crank_end_area)
            force = force - area * _from(below, origin - behind)
        return GasPiece(force, origin)

    def loads(self, index: int) -> tuple[Array, Array]:
        """What each angle table gives there, alike, and the origins of its angle."""
        return self._cubics(index, self.tables, [0] * len(self.tables))

    def _cubics(
        self, index: int, of_each: tuple[Pieces, ...], phases: Sequence[Number]
    ) -> tuple[Array, Array]:
        inside = self.grid.inside(index)
        rows, origins = [self.arithmetic.zeros(0, 4)], [self.arithmetic.zeros(0)]
        for pieces, phase in zip(of_each, phases, strict=True):
            angle = self.arithmetic.array([phase])
            row, beyond = pieces.locate(inside + angle)
            # The knot of this piece in theta, free of the rounding that `inside` carries.
            near = pieces.knots[row] - angle
            turns = np.round(((inside - beyond - near) / pieces.period).astype(float))
            origins.append(near + self.arithmetic.array(turns.tolist()) * pieces.period)
            rows.append(pieces.coefficients[row])
        return np.concatenate(rows), np.concatenate(origins)


def _from(cubics: Array, x: Array) -> Array:
    """Cubics, shape (n, 4) by ascending power, about points farther on by x, shape (n,)."""
    a, b, c, d = cubics.T
    return np.stack(
        [a + x * (b + x * (c + x * d)), b + x * (2 * c + 3 * d * x), c + 3 * d * x, d], axis=1
    )


def angle_pieces(machine: Machine, arithmetic: Arithmetic) -> AnglePieces:
    """The pieces of a machine's pressures and angle tables."""
    of_each = tuple(pressure_pieces(pressure, arithmetic) for pressure in machine.pressures)
    ends = tuple(pressure_pieces(pressure, arithmetic) for pressure in machine.crank_ends)
    knots: list[Number] = []
    period = arithmetic.whole_turns(machine.period)
    tables = tuple(pressure_pieces(table, arithmetic) for table in machine.loads.angle_tables)
    phases = [phase for of in (of_each, ends) for phase, _ in machine.cylinders[: len(of)]]
    phases += [0] * len(tables)
    for pieces, phase in zip((*of_each, *ends, *tables), phases, strict=True):
        for k in range(round(float(period / pieces.period))):
            knots.extend(pieces.knots + k * pieces.period - arithmetic.number(phase))
    grid = merge(knots, arithmetic, period if knots else None)
    return AnglePieces(machine, of_each, ends, tables, grid, arithmetic)
