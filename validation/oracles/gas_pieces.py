"""The gas forces of all cylinders over the crank angle, between the knots of any of them."""

from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import Arithmetic, Number
from validation.oracles.grid import Grid, merge
from validation.oracles.machine import Machine
from validation.oracles.pressure import Pieces, pressure_pieces
from validation.oracles.taylor import GasPiece


@dataclass(frozen=True)
class GasForces:
    """Cubic pieces of every cylinder on the common grid of their knots."""

    machine: Machine
    pieces: tuple[Pieces, ...]
    grid: Grid
    arithmetic: Arithmetic

    def piece(self, index: int) -> GasPiece:
        """The force of each cylinder between knots index and index + 1, a cubic in theta."""
        inside = self.grid.inside(index)
        number = self.arithmetic.number
        rows, origins = [], []
        for pieces, (phase, _) in zip(self.pieces, self.machine.cylinders, strict=True):
            angle = self.arithmetic.array([phase])
            row, beyond = pieces.locate(inside + angle)
            # The knot of this piece in theta, free of the rounding that `inside` carries.
            near = pieces.knots[row] - angle
            turns = np.round(((inside - beyond - near) / pieces.period).astype(float))
            origins.append(near + self.arithmetic.array(turns.tolist()) * pieces.period)
            rows.append(pieces.coefficients[row])
        force = np.concatenate(rows) * number(self.machine.piston_area)
        return GasPiece(force, np.concatenate(origins))


def gas_forces(machine: Machine, arithmetic: Arithmetic) -> GasForces | None:
    """The gas forces of a machine; None without a pressure table."""
    if machine.pressure is None:
        return None
    of_each = tuple(pressure_pieces(pressure, arithmetic) for pressure in machine.pressures)
    knots: list[Number] = []
    period = arithmetic.whole_turns(machine.period)
    for pieces, (phase, _) in zip(of_each, machine.cylinders, strict=True):
        for k in range(round(float(period / pieces.period))):
            knots.extend(pieces.knots + k * pieces.period - arithmetic.number(phase))
    return GasForces(machine, of_each, merge(knots, arithmetic, period), arithmetic)
