"""Every quantity at one crank angle as tables of words; numbers of a run, and how formulas differ
from it, as pandas tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.compare import OBSERVABLES, AtAngle, Comparison, Reading, percent, short_name
from crankmbs.compare.bodies import bodies_of
from crankmbs.digits import digits, error_digits
from crankmbs.display import displayed, with_unit
from crankmbs.measures import Estimate, Measures
from crankmbs.measures.names import angles_of, names_of, values_of
from crankmbs.report.rows import Table, labelled, meaningless

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "comparison_frame",
    "measures_frame",
    "passed_at",
    "reading_remarks",
    "reading_tables",
    "readings_frame",
]

Row = tuple[str, str, Estimate, Mapping[str, str | float]]
"""A label, SI units, the number with its error, and further columns."""


def reading_tables(state: AtAngle) -> list[Table]:
    """Every quantity at one crank angle: a table of the engine, one with a column a cylinder."""
    rows: dict[tuple[bool, str, str], list[Reading]] = {}
    for reading in state.readings:
        key = reading.cylinder is not None, reading.words, reading.symbol
        rows.setdefault(key, []).append(reading)
    engine = [_line(*key[1:], row) for key, row in rows.items() if not key[0]]
    cylinders = [_line(*key[1:], row) for key, row in rows.items() if key[0]]
    columns = [f"cylinder {k}" for k in range(1, len(cylinders[0]) - 2)]
    within = math.degrees(state.crank_angle) % math.degrees(state.scene.period)
    place = f"at {round(within, 9):.9g} deg of the last cycle"
    return [
        Table([place, "symbol", "value", "num. error"], engine),
        Table([place, "symbol", *columns, "num. error"], cylinders),
    ]


def passed_at(state: AtAngle) -> str:
    """When and where the crank passes the angle, in words."""
    degrees = round(math.degrees(state.crank_angle), 9)
    time = digits(state.time, most=10)
    return f"passed at {time} s, at a crank angle of {degrees:.9g} deg"


def reading_remarks(state: AtAngle) -> list[str]:
    """Which body each force acts on and in which frame, and how the lectures' forces go together.

    >>> len(reading_remarks(simulate(load_scene("yi_diesel")).at("60 deg")))
    3
    """
    mass = ", ".join(f"{mass:.6g}" for mass in np.unique(bodies_of(state.scene).masses.crank_pin))
    return [
        "main bearing and journals: bearing on crank, in the engine's frame X, Y; the main bearing "
        "is the sum of all journals",
        "crank pin: crank on rod; piston pin: rod on piston; side force: wall on piston; in the "
        "cylinder's frame, X along its axis away from the crank",
        f"F_v, F_oj, F_T and F_R leave out the inertia of the rod's mass at the crank pin, m = "
        f"{mass} kg, which M_k has: M_k = F_T r - m r^2 alpha; F_oj is the force along the rod, "
        "equal to F_v / cos(beta) and sqrt(F_T^2 + F_R^2) for a rod of two masses without weight",
    ]


def readings_frame(state: AtAngle) -> pd.DataFrame:
    """Every quantity at one crank angle, in the units that people read."""
    many = len(state.scene.cylinders)
    frame = _frame(
        (
            labelled(reading.words, reading.cylinder, many, reading.units),
            reading.units,
            Estimate(reading.value, reading.error),
            {"symbol": reading.symbol},
        )
        for reading in state.readings
    )
    frame.attrs["remarks"] = reading_remarks(state)
    return frame


def measures_frame(measures: Measures) -> pd.DataFrame:
    """Every measure of a run that means something over its window, in the units that people read;
    of peaks where they are."""
    names, angles, rows = names_of(measures.scene), angles_of(measures), list[Row]()
    period = measures.scene.period
    left_out = meaningless(measures)
    for name, estimates in values_of(measures).items():
        if name in left_out:
            continue
        words, units = names[name].words, names[name].units
        for k, estimate in enumerate(estimates):
            crank, cycle = angles[name][k] if name in angles else (math.nan, None)
            degrees = {
                "crank angle [deg]": math.degrees(crank % period),
                "cycle angle [deg]": math.nan if cycle is None else math.degrees(cycle),
            }
            rows.append((labelled(words, k + 1, len(estimates), units), units, estimate, degrees))
    frame = _frame(rows)
    frame.attrs["window"] = measures.window.kind
    return frame


def comparison_frame(comparison: Comparison) -> pd.DataFrame:
    """Every reference's largest and RMS difference from the run, in the units that people read and
    in percent of the run's peak, and where it is largest; then the single numbers."""
    import pandas as pd

    lines: dict[tuple[str, str], dict[str, float]] = {}
    for row in sorted(
        comparison.rows, key=lambda row: list(comparison.simulated).index(row.quantity)
    ):
        units = OBSERVABLES[row.quantity].units
        scale, size = displayed(units)[0], row.size
        sizes = {"difference": size.largest, "RMS difference": size.rms}
        lines[with_unit(row.quantity, units), short_name(row.reference)] = {
            "run": row.peak / scale,
            **{name: value / scale for name, value in sizes.items()},
            **{f"{name} [%]": percent(value, row.peak) for name, value in sizes.items()},
            "angle [deg]": math.degrees(size.angle),
        }
    for number in comparison.numbers:
        scale = displayed(number.units)[0]
        lines[with_unit(number.quantity, number.units), number.reference] = {
            "run": number.simulated.value / scale,
            "difference": abs(number.error) / scale,
            "difference [%]": abs(number.percent),
        }
    frame = pd.DataFrame.from_dict(lines, orient="index")
    return frame.rename_axis(index=["quantity", "reference"])


def _frame(rows: Iterable[Row]) -> pd.DataFrame:
    import pandas as pd

    lines: dict[str, dict[str, str | float]] = {}
    for label, units, estimate, further in rows:
        scale = displayed(units)[0]
        lines[label] = {part: getattr(estimate, part) / scale for part in ("value", "error")}
        lines[label] |= further
    return pd.DataFrame.from_dict(lines, orient="index")


def _line(name: str, symbol: str, row: list[Reading]) -> list[str]:
    scale, units = displayed(row[0].units)
    values = [digits(reading.value / scale, reading.error / scale, most=9) for reading in row]
    return [f"{name} [{units}]", symbol, *values, error_digits(row[0].error / scale)]
