"""The formulas of gas and loads of a machine, and where over angle, speed and time they hold."""

from typing import NamedTuple

from validation.oracles.arithmetic import Arithmetic, Number
from validation.oracles.gas_pieces import angle_pieces
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
        self._over_angle = angle_pieces(machine, arithmetic)
        self.angles = self._over_angle.grid
        self.speeds = speed_grid(machine.loads, arithmetic)
        self.times = time_grid(machine.loads, arithmetic)

    def gas(self, place: Place) -> GasPiece | None:
        """The gas there; None without gas."""
        return self._over_angle.piece(place.angle)

    def load(self, place: Place, time: Number) -> LoadPiece:
        """Its time counted from `time` [s]."""
        return load_piece(
            self.machine.loads,
            time,
            self.times.inside(place.time),
            self.speeds.inside(place.speed),
            self._over_angle.loads(place.angle),
            self.arithmetic,
        )
