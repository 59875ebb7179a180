"""S1's tables cell by cell: what each should be, and where a wrong one went wrong.

A cell follows from cells printed before it: a -> F_i, p -> P_G, both -> F -> Q, K, F_t, N, and
F_t -> T. A residual beyond rounding is a misprint. Whether the printed value or the formula's was
carried on is read from the cells computed from it: the reading that needs fewer misprints wins.
A pressure has no formula: where the gas force disagrees with it and was carried on, the pressure
is the wrong one, and the gas force, from which it is corrected, has no formula there either.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crankmbs import lecture

__all__ = ["COLUMNS", "KGF", "KGF_PER_CM2", "Cell", "Engine", "judge_angle"]

KGF = 9.80665
KGF_PER_CM2 = 98066.5
_INPUTS = {
    "travel": (),
    "velocity": (),
    "acceleration": (),
    "pressure": (),
    "PG": ("pressure",),
    "Fi": ("acceleration",),
    "F": ("PG", "Fi"),
    "Q": ("F",),
    "K": ("F",),
    "Ft": ("F",),
    "N": ("F",),
    "T": ("Ft",),
}
COLUMNS = tuple(_INPUTS)
_SOUND = 5.0
"""Allowances that still count as rounding: the authors cut digits off and rounded in between.

The cells beyond it miss by 6.4 and more, all others by at most 4.5.
"""


@dataclass(frozen=True)
class Engine:
    """S1's engine: R [m], lambda, k, omega [rad/s], A_p [m2], p_0 [Pa], m_1 [kg]."""

    crank_radius: float
    rod_ratio: float
    relative_offset: float
    omega: float
    area: float
    ambient: float
    mass: float

    def formula(self, name: str, degrees: int, given: Mapping[str, float]) -> float:
        """A cell in the unit of its table, from the cells it is computed from."""
        at = np.radians(degrees)
        central = {
            "crank_radius": self.crank_radius,
            "rod_length": self.crank_radius / self.rod_ratio,
        }
        rod = {**central, "offset": self.relative_offset * self.crank_radius}
        match name:
            case "travel":
                return float(1e3 * lecture.piston_displacement_series(at, **rod))
            case "velocity":
                return float(lecture.piston_velocity_series(at, omega=self.omega, **rod))
            case "acceleration":
                return float(lecture.piston_acceleration_series(at, omega=self.omega, **rod))
            case "PG":
                pressure = given["pressure"] * KGF_PER_CM2
                force = lecture.gas_force(
                    gas_pressure=pressure, ambient_pressure=self.ambient, piston_area=self.area
                )
                return float(force) / KGF
            case "Fi":
                force = lecture.inertia_force(
                    reciprocating_mass=self.mass, piston_acceleration=given["acceleration"]
                )
                return float(force) / KGF
            case "F":
                return float(lecture.net_force(gas_force=given["PG"], inertia_force=given["Fi"]))
            case "Q":
                return float(lecture.side_thrust_series(at, net_force=given["F"], **rod))
            case "K":
                return float(lecture.rod_force_series(at, net_force=given["F"], **central))
            case "Ft":
                return float(lecture.tangential_force_series(at, net_force=given["F"], **rod))
            case "N":
                return float(lecture.radial_force_series(at, net_force=given["F"], **rod))
            case "T":
                arm = self.crank_radius
                return float(lecture.crank_torque(tangential_force=given["Ft"], crank_radius=arm))
        raise KeyError(name)

    def pressure_for(self, gas_force: float) -> float:
        """The pressure [kgf/cm2] that a gas force [kgf] belongs to."""
        return (gas_force * KGF / self.area + self.ambient) / KGF_PER_CM2


@dataclass(frozen=True)
class Cell:
    """printed : as it is; ours : what it should be; misses : residual over what rounding allows.

    verdict : "agrees" (to the printed digit), "rounding", "misprint" or "no formula"; carried : a
    wrong value from which the authors went on
    """

    name: str
    degrees: int
    printed: str
    ours: float
    misses: float
    verdict: str
    carried: bool = False

    @property
    def corrected(self) -> str:
        """What should have been printed, with the digits of the print."""
        return f"{self.ours:.{_decimals(self.printed)}f}"


def judge_angle(engine: Engine, degrees: int, printed: Mapping[str, str]) -> dict[str, Cell]:
    """The cells of one crank angle, in the order in which they follow from one another."""
    row = _Row(engine, degrees, printed)
    for name in COLUMNS:
        if name in printed:
            row.judge(name)
    return row.cells


class _Row:
    """One crank angle: the values that later cells are computed from, and the cells judged."""

    def __init__(self, engine: Engine, degrees: int, printed: Mapping[str, str]) -> None:
        self.engine, self.degrees, self.printed = engine, degrees, printed
        self.used = {name: float(text) for name, text in printed.items()}
        self.cells: dict[str, Cell] = {}

    def judge(self, name: str) -> None:
        if name == "pressure":  # no formula of its own; see PG
            self._add(name, self.used[name], 0.0, "no formula")
            return
        should, misses = self._compare(name, self.used)
        if misses <= _SOUND:
            same = f"{should:.{_decimals(self.printed[name])}f}"
            agrees = float(same) == float(self.printed[name])
            self._add(name, should, misses, "agrees" if agrees else "rounding")
            return
        digits = _decimals(self.printed[name])
        corrected = {**self.used, name: round(should, digits)}
        carried = self._cost(name, self.used) < self._cost(name, corrected)
        if carried and _INPUTS[name] == ("pressure",):
            pressure = self.engine.pressure_for(self.used[name])
            self._add("pressure", pressure, misses, "misprint")
            self._add(name, self.used[name], 0.0, "no formula")
            return
        self._add(name, should, misses, "misprint", carried)
        if not carried:
            self.used = corrected

    def _cost(self, name: str, given: Mapping[str, float]) -> tuple[int, float]:
        """The fewest misprints that this value leaves in the cells computed from it, and how far
        the sound ones of them miss: the reading that needs fewer misprints is the likelier one."""
        misprints, missed = 0, 0.0
        for follower in COLUMNS:
            if name not in _INPUTS[follower] or follower not in self.printed:
                continue
            should, misses = self._compare(follower, given)
            if misses <= _SOUND:
                missed += misses
                continue
            readings = [given, {**given, follower: should}]
            further = min(self._cost(follower, reading) for reading in readings)
            misprints, missed = misprints + 1 + further[0], missed + further[1]
        return misprints, missed

    def _compare(self, name: str, given: Mapping[str, float]) -> tuple[float, float]:
        """The formula's value, and the residual over the half digits of the cell and its inputs."""
        should = self.engine.formula(name, self.degrees, given)
        allowed = _half_digit(self.printed[name])
        for key in _INPUTS[name]:
            moved = {**given, key: given[key] + _half_digit(self.printed[key])}
            allowed += abs(self.engine.formula(name, self.degrees, moved) - should)
        return should, abs(float(self.printed[name]) - should) / allowed

    def _add(
        self, name: str, ours: float, misses: float, verdict: str, carried: bool = False
    ) -> None:
        self.cells[name] = Cell(
            name, self.degrees, self.printed[name], ours, misses, verdict, carried
        )


def _decimals(text: str) -> int:
    return len(text.partition(".")[2])


def _half_digit(text: str) -> float:
    return 0.5 * 10.0 ** -_decimals(text)
