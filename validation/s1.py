"""What S1 does not print: parameters identified from its cells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation import reference
from validation.checks.s1_tables import printed_cells

__all__ = ["Identified", "identified", "section"]

Array = NDArray[np.float64]

_OMEGA = 3200.0 * math.pi / 30.0  # rad/s, printed
_SOUND_INERTIA = (0, 90, 120, 150, 180)  # rows of Table 4 whose F_i is no slip
_INTRODUCTION = """\

## What S1 does not print

[S1] prints speed, compression ratio and polytropic exponents, but neither radius, rod ratio, bore
nor reciprocating mass; the offset only as 0.015 of the bore, piston and rod only as ranges per
area. What is below was identified from its own cells by least squares; "rest" is the root mean
square of what the fit leaves. Masses of piston, rod and crank, the rod's inertia, the flywheel and
the firing order are guessed. The misprints found, with their corrections, and what the paper says
against itself are in [ERRATA.md](ERRATA.md).

| parameter | identified | used | from | rest |
|---|---|---|---|---|"""


@dataclass(frozen=True)
class Identified:
    """A parameter by least squares: value, standard error and what the cases use, in `unit`.

    cells : which; count : how many of them; rest : the root mean square left, in `rest_unit`
    """

    name: str
    value: float
    error: float
    used: float
    unit: str
    cells: str
    count: int
    rest: float
    rest_unit: str


def identified() -> list[Identified]:
    """Every parameter that the claims about S1 take from its cells."""
    return [*_geometry(), *_gas(), _mass()]


def section() -> list[str]:
    """Lines of Markdown: the identified parameters."""
    lines = _INTRODUCTION.splitlines()
    lines += [_row(parameter) for parameter in identified()]
    implied = len([row for row in reference.rows("s1_table6_pressure") if _implied(row)])
    return [
        *lines,
        f"| pressures of 390 to 690 degrees | {implied} values, reference/s1_table6_pressure.csv | "
        f"as identified | Table 6, torque, {implied} cells | 0: one value a cell |",
    ]


def _row(p: Identified) -> str:
    value, used = f"{p.value:.9g} ± {p.error:.1g} {p.unit}", f"{p.used:g} {p.unit}"
    fit = f"{p.cells}, {p.count} rows | {p.rest:.1g} {p.rest_unit}"
    return f"| {p.name} | {value.strip()} | {used.strip()} | {fit} |"


def _geometry() -> list[Identified]:
    """A / omega^2 = R cos phi + R lambda cos 2 phi + R k lambda sin phi; 210 degrees is a slip."""
    degrees = [at for at in range(0, 361, 30) if at != 210]
    angle = np.radians(degrees)
    columns = np.stack([np.cos(angle), np.cos(2.0 * angle), np.sin(angle)], axis=1)
    fit, spread, rest = _least_squares(columns, _cells("acceleration", degrees) / _OMEGA**2)
    radius, ratio, offset = fit[0], fit[1] / fit[0], fit[2] / fit[1]
    cells, count, left = "Table 1, acceleration", len(degrees), (rest * _OMEGA**2, "m/s^2")
    error = spread / np.abs(fit)
    ratios = [math.hypot(error[0], error[1]), math.hypot(error[1], error[2])]
    return [
        Identified("radius R", 1e3 * radius, 1e3 * spread[0], 46.0, "mm", cells, count, *left),
        Identified("rod ratio lambda", ratio, ratio * ratios[0], 0.3, "", cells, count, *left),
        Identified("offset over R, k", offset, offset * ratios[1], 0.0282, "", cells, count, *left),
    ]


def _gas() -> list[Identified]:
    """P_G = A_p p - A_p p_0, but for the misprint at 30 degrees."""
    degrees = [at for at in range(0, 361, 30) if at != 30]
    pressure = _cells("pressure", degrees)
    columns = np.stack([pressure, -np.ones_like(pressure)], axis=1)
    fit, spread, rest = _least_squares(columns, _cells("PG", degrees))
    ambient = fit[1] / fit[0]
    error = ambient * math.hypot(spread[0] / fit[0], spread[1] / fit[1])
    cells, count, left = "Table 2 and Table 4, P_G", len(degrees), (rest, "kgf")
    return [
        Identified("piston area A_p", fit[0], spread[0], 57.079, "cm^2", cells, count, *left),
        Identified("ambient pressure p_0", ambient, error, 1.0, "kgf/cm^2", cells, count, *left),
    ]


def _mass() -> Identified:
    """F_i = -m_1 A with the printed A, at rows without a slip."""
    rows = list(_SOUND_INERTIA)
    columns = -_cells("acceleration", rows)[:, None]
    fit, spread, rest = _least_squares(columns, _cells("Fi", rows))
    cells = "Table 1, acceleration, and Table 4, F_i"
    return Identified(
        "reciprocating mass m_1",
        fit[0],
        spread[0],
        0.15727,
        "kgf s^2/m",
        cells,
        len(rows),
        rest,
        "kgf",
    )


def _least_squares(columns: Array, right: Array) -> tuple[Array, Array, float]:
    """The fit, its standard errors, and the root mean square that is left."""
    fit = np.asarray(np.linalg.lstsq(columns, right, rcond=None)[0], dtype=np.float64)
    left = right - columns @ fit
    variance = left @ left / (len(right) - len(fit))
    spread: Array = np.sqrt(variance * np.diag(np.linalg.inv(columns.T @ columns)))
    return fit, spread, float(np.sqrt(np.mean(left**2)))


def _cells(name: str, degrees: Sequence[int]) -> Array:
    return np.array([float(printed_cells()[at][name]) for at in degrees])


def _implied(row: dict[str, str]) -> bool:
    return 360 < int(row["crank_angle_deg"]) < 720
