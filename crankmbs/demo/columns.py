"""The numbers that the page draws: named columns for each of its views.

A column's name says what it is, `unit_of` in what unit.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from crankmbs.compare import CAUSES, LECTURES, Comparison
from crankmbs.demo.outcome import Outcome
from crankmbs.errors import InputError
from crankmbs.figures.outline import Mechanism, in_engine_frame, mechanism
from crankmbs.measures import mean_speed
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import RPM

__all__ = [
    "BEARINGS",
    "BUDGETED",
    "CURVES",
    "FORCES",
    "SCALES",
    "Columns",
    "bearings",
    "budgets",
    "frames",
    "moves",
    "shapes",
    "speeds",
    "thrusts",
    "unit_of",
]

Columns = dict[str, Array]


CURVES = ("simulated", "exact formula", "lecture")
"""The three curves of a quantity: the run; the formulas at constant speed, exact and truncated."""

FORCES = ("main bearing", "crank pin", "piston pin", "cylinder wall", "gas")
"""The forces drawn on the mechanism, in this order."""

BEARINGS = ("main bearing", "crank pin", "piston pin")
BUDGETED = (
    "side thrust",
    "torque",
    "piston acceleration",
    "piston velocity",
    "piston displacement",
    "main bearing force x",
    "main bearing force y",
)
SCALES = {
    "piston displacement": (1e-3, "mm"),
    "piston velocity": (1.0, "m/s"),
    "piston acceleration": (1.0, "m/s²"),
    "torque": (1.0, "N m"),
}
"""Quantity -> divisor and unit in which it is shown; the others are forces."""

_EXACT, *_, _TRUNCATED = LECTURES


def unit_of(column: str, force_unit: str) -> str:
    """Unit of a column of the tabs."""
    quantity = column.split(", ")[0].split(": ")[0]
    named = {"degrees": "deg", "speed": "rpm"}
    return named.get(quantity) or SCALES.get(quantity, (1.0, force_unit))[1]


def frames(outcome: Outcome, force: float) -> Columns:
    """Time, pins of every cylinder, pressures, and the forces on the chosen cylinder's parts.

    Positions [m] and forces in the engine's frame; force [N] : their divisor
    """
    view, scene = outcome.view, outcome.result.scene
    theta = view.values("crank_angle")
    drawn = mechanism(scene, theta)
    time = view.values("time")
    columns = {
        "degrees": view.degrees,
        "time": time - time[0],
        "speed": view.values("crank_speed") / RPM,
        "pressure": view.values("gas_pressure")[:, outcome.cylinder - 1] / 1e5,
    }
    for k in range(len(scene.cylinders)):
        columns[f"crank x{k}"], columns[f"crank y{k}"] = drawn.crank_pin[:, k].T
        columns[f"piston x{k}"], columns[f"piston y{k}"] = drawn.piston_pin[:, k].T
        columns[f"pressure{k}"] = view.values("gas_pressure")[:, k] / 1e5
    for name, (x, y) in zip(FORCES, _forces(outcome), strict=True):
        columns[f"{name} x"], columns[f"{name} y"] = x / force, y / force
    return columns


def _forces(outcome: Outcome) -> list[tuple[Array, Array]]:
    view, scene = outcome.view, outcome.result.scene
    zero = np.zeros_like(view.values("side_force"))
    pairs = [
        (view.values("crank_pin_force_x"), view.values("crank_pin_force_y")),
        (view.values("piston_pin_force_x"), view.values("piston_pin_force_y")),
        (zero, view.values("side_force")),
        (-view.values("gas_force"), zero),
    ]
    chosen = outcome.cylinder - 1
    own = [in_engine_frame(scene, x, y)[:, chosen] for x, y in pairs]
    bearing = (view.values("main_bearing_force_x"), view.values("main_bearing_force_y"))
    return [bearing, *((pair[:, 0], pair[:, 1]) for pair in own)]


def shapes(outcome: Outcome) -> dict[str, list[list[float]]]:
    """Outlines of every cylinder [m]: its liner, and its piston as seen from the piston pin."""
    drawn: Mechanism = mechanism(outcome.result.scene, [0.0])
    piston = drawn.piston[0] - drawn.piston_pin[0][:, None, :]
    return {
        "liner x": drawn.liner[..., 0].tolist(),
        "liner y": drawn.liner[..., 1].tolist(),
        "piston x": piston[..., 0].tolist(),
        "piston y": piston[..., 1].tolist(),
    }


def speeds(outcome: Outcome) -> Columns:
    """Speed of the crank over the cycle, and its mean over time [rpm]."""
    view = outcome.view
    mean = mean_speed(outcome.result, view.window).value / RPM
    speed = view.values("crank_speed") / RPM
    return {
        "degrees": view.degrees,
        "speed, simulated": speed,
        "speed, constant": np.full_like(speed, mean),
    }


def moves(outcome: Outcome) -> Columns:
    """Displacement, velocity and acceleration of the chosen piston, each by `CURVES`."""
    names = ("piston displacement", "piston velocity", "piston acceleration")
    return _compared(outcome, names, 1.0)


def thrusts(outcome: Outcome, force: float) -> Columns:
    """Torque and side thrust of the chosen cylinder, each by `CURVES`."""
    return _compared(outcome, ("torque", "side thrust"), force)


def bearings(outcome: Outcome, force: float) -> Columns:
    """The force in every bearing, simulated and by the truncated lecture."""
    return _compared(outcome, tuple(f"{b} force {part}" for b in BEARINGS for part in "xy"), force)


def budgets(outcome: Outcome, force: float) -> Columns:
    """What each cause adds to the lecture's answer, for every quantity of `BUDGETED`."""
    budget = outcome.budget
    columns = {"degrees": _degrees(outcome, budget.excerpt.samples)}
    for name in BUDGETED:
        scale = SCALES.get(name, (force, ""))[0]
        nothing = np.zeros_like(columns["degrees"])
        curves, total = {}, nothing
        with suppress(InputError):  # zero but for rounding: no split
            split = budget.split(name)
            curves = {cause.name: cause.curve / scale for cause in split.causes}
            total = split.total.curve / scale
        for cause in CAUSES:
            columns[f"{name}: {cause}"] = curves.get(cause, nothing)
        columns[f"{name}: lecture minus run"] = total
    return columns


def _compared(outcome: Outcome, names: tuple[str, ...], force: float) -> Columns:
    comparison = outcome.comparison
    columns = {"degrees": _degrees(outcome, comparison.excerpt.samples)}
    for name in names:
        scale = SCALES.get(name, (force, ""))[0]
        run = comparison.simulated.get(name)
        if run is None:  # zero but for rounding
            run = np.zeros_like(columns["degrees"])
        answers = (run, *(_answer(comparison, name, of, run) for of in (_EXACT, _TRUNCATED)))
        for curve, values in zip(CURVES, answers, strict=True):
            columns[f"{name}, {curve}"] = values / scale
    return columns


def _answer(comparison: Comparison, name: str, reference: str, run: Array) -> Array:
    if name not in comparison.simulated or reference not in comparison.references:
        return np.full_like(run, np.nan)
    return comparison.row(name, reference).values


def _degrees(outcome: Outcome, samples: NDArray[np.intp]) -> Array:
    view = outcome.view
    return np.asarray(view.degrees[samples - view.window.first])
