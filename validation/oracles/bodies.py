"""Crank, rods and pistons as free bodies in absolute coordinates: one linear system for them all.

Unknown are the accelerations of every body and the force in every joint. The rows are Newton's and
Euler's equations of each body about its own centre of mass and the second time derivatives of the
joints' closures. One more row states either the crank's acceleration (inverse dynamics) or the
torque on it (forward dynamics), so both directions share one system.

Every entry is constant or linear in the cosines and sines of the bodies' angles
(theta; the throws theta + phase; the rods' directions, from each cylinder's own X), so the same
entries serve samples (values) and Taylor series (coefficients).
"""

from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import Arithmetic, Array, Number
from validation.oracles.machine import Machine

ALPHA, TORQUE, BEARING_X, BEARING_Y, CRANK_X, CRANK_Y = range(6)
ROD_X, ROD_Y, ROD_SPIN, PISTON_X, CRANK_PIN_X, CRANK_PIN_Y, PISTON_PIN_X, PISTON_PIN_Y, SIDE = (
    range(6, 15)
)
PER_CYLINDER = 9

Link = tuple[Number, int, int]
"""Length, index of its angle, unknown that is this angle's second derivative."""


@dataclass(frozen=True)
class System:
    """matrix z = right side; see `matrix` and `right_side` for what the fields hold.

    entry_*: matrix[row, column] += cosine cos(angle) + sine sin(angle).
    turn_*: right[row] += (cosine cos(angle) + sine sin(angle)) rate**2.
    """

    constant: Array
    entry_row: Array
    entry_column: Array
    entry_angle: Array
    entry_cosine: Array
    entry_sine: Array
    right: Array
    turn_row: Array
    turn_angle: Array
    turn_cosine: Array
    turn_sine: Array
    gas_row: Array
    given_row: int

    def entries(self, cosine: Array, sine: Array) -> Array:
        """The trigonometric entries for cosines and sines shape (..., angles)."""
        pick = self.entry_angle
        values: Array = self.entry_cosine * cosine[..., pick] + self.entry_sine * sine[..., pick]
        return values

    def matrix(self, cosine: Array, sine: Array) -> Array:
        """The matrix shape (samples, size, size)."""
        result = np.repeat(self.constant[None], len(cosine), axis=0)
        entries = self.entries(cosine, sine)
        for k, (row, column) in enumerate(zip(self.entry_row, self.entry_column, strict=True)):
            result[:, row, column] += entries[:, k]
        return result

    def turning(self, cosine_rate2: Array, sine_rate2: Array) -> Array:
        """Right-hand terms of the squared rates, by entry, from cos rate**2 and sin rate**2."""
        pick = self.turn_angle
        values: Array = (
            self.turn_cosine * cosine_rate2[..., pick] + self.turn_sine * sine_rate2[..., pick]
        )
        return values


class _Builder:
    """Collects the equations one by one."""

    def __init__(self, arithmetic: Arithmetic, cylinders: int) -> None:
        size = 6 + PER_CYLINDER * cylinders
        self.arithmetic = arithmetic
        self.constant = arithmetic.zeros(size, size)
        self.right = arithmetic.zeros(size)
        self.entries: list[tuple[int, int, int, Number, Number]] = []
        self.turns: list[tuple[int, int, Number, Number]] = []

    def link(self, row: int, axis: str, coordinate: int | None, links: list[Link]) -> None:
        """coordinate'' = sum of length (cos angle)'' for axis x, (sin angle)'' for axis y."""
        if coordinate is not None:
            self.constant[row, coordinate] += 1
        for length, angle, spin in links:
            if axis == "x":
                self.entries.append((row, spin, angle, 0, length))
                self.turns.append((row, angle, -length, 0))
            else:
                self.entries.append((row, spin, angle, -length, 0))
                self.turns.append((row, angle, 0, -length))

    def moment(self, row: int, lever: Number, angle: int, force_x: int, force_y: int) -> None:
        """Add lever (cos, sin)(angle) x force to the row."""
        self.entries.append((row, force_y, angle, lever, 0))
        self.entries.append((row, force_x, angle, 0, -lever))

    def finish(self, gas_row: list[int], given_row: int) -> System:
        def floats(values: tuple[Number, ...]) -> Array:
            return self.arithmetic.array(values)

        row, column, angle, cosine, sine = zip(*self.entries, strict=True)
        turn_row, turn_angle, turn_cosine, turn_sine = zip(*self.turns, strict=True)
        return System(
            self.constant,
            np.array(row),
            np.array(column),
            np.array(angle),
            floats(cosine),
            floats(sine),
            self.right,
            np.array(turn_row),
            np.array(turn_angle),
            floats(turn_cosine),
            floats(turn_sine),
            np.array(gas_row),
            given_row,
        )


def build(machine: Machine, given: int, arithmetic: Arithmetic) -> System:
    """The system of a machine with ALPHA or TORQUE given (its row's right side is left at 0)."""
    number = arithmetic.number
    cylinders = len(machine.cylinders)
    out = _Builder(arithmetic, cylinders)
    radius, length = number(machine.crank_radius), number(machine.rod_length)
    crank_mass, to_center = number(machine.crank_mass), number(machine.crank_center_of_mass)
    rod_mass, to_rod = number(machine.rod_mass), number(machine.rod_center_of_mass)
    piston_mass = number(machine.piston_mass)
    gx, gy = (number(component) for component in machine.gravity)

    out.link(0, "x", CRANK_X, [(to_center, 0, ALPHA)])
    out.link(1, "y", CRANK_Y, [(to_center, 0, ALPHA)])
    for row, mass_column, bearing, pull in (
        (2, CRANK_X, BEARING_X, gx),
        (3, CRANK_Y, BEARING_Y, gy),
    ):
        out.constant[row, mass_column] += crank_mass
        out.constant[row, bearing] -= 1
        out.right[row] += crank_mass * pull
    out.constant[4, ALPHA] += number(machine.crank_inertia) - crank_mass * to_center * to_center
    out.constant[4, TORQUE] -= 1
    out.moment(4, to_center, 0, BEARING_X, BEARING_Y)
    out.constant[5, given] += 1

    gas_row = []
    for k, (_, bank) in enumerate(machine.cylinders):
        shift = PER_CYLINDER * k
        throw, rod = 1 + k, 1 + cylinders + k
        spin, piston = ROD_SPIN + shift, PISTON_X + shift
        sx, sy = CRANK_PIN_X + shift, CRANK_PIN_Y + shift
        fx, fy = PISTON_PIN_X + shift, PISTON_PIN_Y + shift
        cos_bank, sin_bank = arithmetic.cos(number(bank)), arithmetic.sin(number(bank))
        pull_x, pull_y = cos_bank * gx + sin_bank * gy, cos_bank * gy - sin_bank * gx

        for row, x_share, y_share in ((2, cos_bank, -sin_bank), (3, sin_bank, cos_bank)):
            out.constant[row, sx] += x_share
            out.constant[row, sy] += y_share
        out.moment(4, radius, throw, sx, sy)
        out.entries.append((4, sy, 0, -to_center * cos_bank, -to_center * sin_bank))
        out.entries.append((4, sx, 0, -to_center * sin_bank, to_center * cos_bank))

        row = 6 + shift
        throw_link: Link = (radius, throw, ALPHA)
        out.link(row, "x", ROD_X + shift, [throw_link, (to_rod, rod, spin)])
        out.link(row + 1, "y", ROD_Y + shift, [throw_link, (to_rod, rod, spin)])
        out.link(row + 2, "x", piston, [throw_link, (length, rod, spin)])
        out.link(row + 3, "y", None, [throw_link, (length, rod, spin)])
        for line, mass_column, near, far, pull in (
            (row + 4, ROD_X + shift, sx, fx, pull_x),
            (row + 5, ROD_Y + shift, sy, fy, pull_y),
        ):
            out.constant[line, mass_column] += rod_mass
            out.constant[line, near] -= 1
            out.constant[line, far] += 1
            out.right[line] += rod_mass * pull
        out.constant[row + 6, spin] += number(machine.rod_inertia)
        out.moment(row + 6, to_rod, rod, sx, sy)
        out.moment(row + 6, length - to_rod, rod, fx, fy)
        out.constant[row + 7, piston] += piston_mass
        out.constant[row + 7, fx] -= 1
        out.right[row + 7] += piston_mass * pull_x
        out.constant[row + 8, fy] -= 1
        out.constant[row + 8, SIDE + shift] -= 1
        out.right[row + 8] += piston_mass * pull_y
        gas_row.append(row + 7)
    return out.finish(gas_row, 5)


def pose(
    machine: Machine, theta: Array, omega: Array, arithmetic: Arithmetic
) -> tuple[Array, Array]:
    """Angles and rates of all bodies, shape (samples, 1 + 2 cylinders), from the loop closure.

    sin(rod) = (offset - radius sin(throw)) / length, and its first time derivative.
    """
    number = arithmetic.number
    radius, length = number(machine.crank_radius), number(machine.rod_length)
    phases = arithmetic.array([phase for phase, _ in machine.cylinders])
    throws = theta[:, None] + phases
    rods = arithmetic.arcsin((number(machine.offset) - radius * arithmetic.sin(throws)) / length)
    spin = omega[:, None] + phases * 0
    rod_rates = -radius * arithmetic.cos(throws) * spin / (length * arithmetic.cos(rods))
    return (
        np.concatenate([theta[:, None], throws, rods], axis=1),
        np.concatenate([omega[:, None], spin, rod_rates], axis=1),
    )
