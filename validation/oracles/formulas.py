"""The formulas of gas and loads of a machine, and where over angle, speed and time they hold."""

from typing import NamedTuple

from validation.oracles.arithmetic import Arithmetic, Number
from validation.oracles.gas_pieces import gas_forces
from validation.oracles.grid import merge
from validation.oracles.loads import LoadPiece, load_piece, speed_grid, time_grid
from validation.oracles.machine import Machine
from validation.oracles.taylor import GasPiece


class Place(NamedTuple):
    """Numbers of the pieces of crank angle, speed and time."""

    angle: int
    speed: int
    time: int


class Formulas:
    """The knots of a machine and what holds between them."""

    def __init__(self, machine: Machine, arithmetic: Arithmetic) -> None:
        self.machine, self.arithmetic = machine, arithmetic
        self._gas = gas_forces(machine, arithmetic)
        self.angles = self._gas.grid if self._gas else merge([], arithmetic)
        self.speeds = speed_grid(machine.loads, arithmetic)
        self.times = time_grid(machine.loads, arithmetic)

    def gas(self, place: Place) -> GasPiece | None:
        """The gas there; None without gas."""
        return self._gas.piece(place.angle) if self._gas else None

    def load(self, place: Place, time: Number) -> LoadPiece:
        """Its time counted from `time` [s]."""
        return load_piece(
            self.machine.loads,
            time,
            self.times.inside(place.time),
            self.speeds.inside(place.speed),
            self.arithmetic,
        )
