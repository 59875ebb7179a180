"""What the oracles take: plain records of SI numbers, with nothing derived."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

from validation.oracles.arithmetic import Number

Interpolation = Literal["linear", "step", "pchip", "cubic"]


@dataclass(frozen=True)
class PressureTable:
    """Pressure on a piston less ambient over the cycle angle, periodic, no closing row.

    angles increase [rad] and span less than `period` [rad]; a repeated angle is a jump from the
    first of its pressures to the second. pressures in Pa.
    """

    angles: tuple[Number, ...]
    pressures: tuple[Number, ...]
    period: Number
    interpolation: Interpolation

    def __post_init__(self) -> None:
        if self.interpolation not in get_args(Interpolation):
            raise ValueError(f"interpolation must be one of {get_args(Interpolation)}")
        if len(self.angles) != len(self.pressures) or len(self.angles) < 3:
            raise ValueError("a pressure table needs three or more angles, one pressure each")
        floats = [float(angle) for angle in self.angles]
        if any(b < a for a, b in pairwise(floats)) or any(
            floats.count(angle) > 2 for angle in floats
        ):
            raise ValueError("angles must increase, none given more than twice")
        if floats[-1] - floats[0] >= float(self.period):
            raise ValueError("angles must span less than one period (leave the closing row out)")


@dataclass(frozen=True)
class PressurePieces:
    """Pressure on a piston less ambient as cubics that are given, periodic.

    coefficients[i][j] multiplies (angle - knots[i])**j from knot i to the next; the last piece
    ends one period [rad] behind the first knot.
    """

    knots: tuple[Number, ...]
    coefficients: tuple[tuple[Number, ...], ...]
    period: Number


Pressure = PressureTable | PressurePieces


@dataclass(frozen=True)
class LoadTable:
    """Torque [N m] over time [s] or speed [rad/s]: linear, a repeated abscissa is a jump."""

    abscissae: tuple[Number, ...]
    torques: tuple[Number, ...]

    def __post_init__(self) -> None:
        floats = [float(value) for value in self.abscissae]
        if len(floats) != len(self.torques) or len(set(floats)) < 2:
            raise ValueError("a load table needs two or more abscissae, one torque each")
        if any(b < a for a, b in pairwise(floats)):
            raise ValueError("abscissae must not decrease")


@dataclass(frozen=True)
class Loads:
    """Torques on the crank, positive in the sense of +theta.

    constant - viscous omega - quadratic omega |omega| + time tables + speed tables + angle tables.
    A time table must cover the run; a speed table holds its end values; an angle table has torques
    [N m] over the crank angle for pressures over the cycle angle.
    """

    constant: Number = 0.0
    viscous: Number = 0.0
    quadratic: Number = 0.0
    time_tables: tuple[LoadTable, ...] = ()
    speed_tables: tuple[LoadTable, ...] = ()
    angle_tables: tuple[PressureTable, ...] = ()


@dataclass(frozen=True)
class Machine:
    """Crank, rods and pistons; every cylinder has the same rod, piston and offset, unless each has
    its own, which only the oracle of changing loads knows of.

    crank_center_of_mass lies on the reference line, from the axis; crank_inertia is about the axis.
    rod_center_of_mass is measured from the crank pin, rod_inertia about it. cylinders holds
    (phase, bank) [rad], pressure one for all of them or one for each; levers how far each stands
    beyond the middle of the crank [m], along X turned into Y, empty where that is not known.
    crank_ends are the pressures on the sides towards the crank, of each cylinder or none, which
    press on crank_end_area; only forces and motions by series know of them.
    gravity is (gx, gy) [m/s2] in the engine's frame. The time of the loads' time tables is that of
    the run, which starts at 0.
    """

    crank_radius: Number
    crank_inertia: Number
    rod_length: Number
    crank_mass: Number = 0.0
    crank_center_of_mass: Number = 0.0
    rod_mass: Number = 0.0
    rod_center_of_mass: Number = 0.0
    rod_inertia: Number = 0.0
    piston_mass: Number = 0.0
    piston_area: Number = 0.0
    offset: Number = 0.0
    cylinders: tuple[tuple[Number, Number], ...] = ((0.0, 0.0),)
    levers: tuple[Number, ...] = ()
    pressure: Pressure | tuple[Pressure, ...] | None = None
    gravity: tuple[Number, Number] = (0.0, 0.0)
    loads: Loads = Loads()
    crank_ends: tuple[Pressure, ...] = ()
    crank_end_area: Number = 0.0
    each: tuple[Machine, ...] = ()

    def of(self, cylinder: int) -> Machine:
        """The machine with the throw, rod and piston of a cylinder, from 0."""
        return self.each[cylinder] if self.each else self

    @property
    def pressures(self) -> tuple[Pressure, ...]:
        """The pressure of each cylinder; empty without any."""
        if self.pressure is None:
            return ()
        one = self.pressure
        return one if isinstance(one, tuple) else (one,) * len(self.cylinders)

    @property
    def period(self) -> Number:
        """Crank angle [rad] after which all pressures and angle tables come again; one turn without
        any."""
        all_of = (*self.pressures, *self.crank_ends, *self.loads.angle_tables)
        own = [each.period for each in all_of] or [2.0 * math.pi]
        if all(period == own[0] for period in own):
            return own[0]
        return math.pi * math.lcm(*(round(float(period) / math.pi) for period in own))
