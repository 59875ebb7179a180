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
    pieces: Pieces
    grid: Grid
    arithmetic: Arithmetic

    def piece(self, index: int) -> GasPiece:
        """The force of each cylinder between knots index and index + 1, a cubic in theta."""
        inside = self.grid.inside(index)
        number = self.arithmetic.number
        phases = self.arithmetic.array([phase for phase, _ in self.machine.cylinders])
        row, beyond = self.pieces.locate(inside + phases)
        # The knot of this piece in theta, free of the rounding that `inside` carries.
        near = self.pieces.knots[row] - phases
        turns = np.round(((inside - beyond - near) / self.pieces.period).astype(float))
        origin = near + self.arithmetic.array(turns.tolist()) * self.pieces.period
        return GasPiece(self.pieces.coefficients[row] * number(self.machine.piston_area), origin)


def gas_forces(machine: Machine, arithmetic: Arithmetic) -> GasForces | None:
    """The gas forces of a machine; None without a pressure table."""
    if machine.pressure is None:
        return None
    pieces = pressure_pieces(machine.pressure, arithmetic)
    knots: list[Number] = []
    for phase, _ in machine.cylinders:
        knots.extend(pieces.knots - arithmetic.number(phase))
    return GasForces(machine, pieces, merge(knots, arithmetic, pieces.period), arithmetic)
