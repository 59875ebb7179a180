"""S1's figures: the indicator diagram, and the torque accumulated along its four-cylinder crank."""

from __future__ import annotations

import numpy as np

from crankmbs import lecture
from crankmbs.lecture.accumulated_torque import AccumulatedTorque, accumulated_torque
from validation import reference
from validation.case import Case
from validation.checks.s1_cells import KGF, KGF_PER_CM2
from validation.checks.s1_tables import printed_cells
from validation.judge import Outcome
from validation.plots import Array, Dots, Panel, overlay
from validation.runs import run

__all__ = ["accumulated_cells", "compression", "indicator", "journals", "pins"]

_LAGS = (0, 1, 3, 2)  # of cylinders 1 to 4, in quarters of the cycle: firing order 1-3-4-2
_QUARTER = 180  # degrees
_GRID = tuple(range(0, 720, 30))


def indicator(case: Case) -> Outcome:
    """Figure 2: the run's pressure at the angles of Table 2, its misprint corrected, and beyond at
    those of Table 6. The figure has Table 2 as printed, and apart what Table 6 implies."""
    result = run(case.ours())
    gas = case.theirs().gas
    assert gas is not None
    degrees = np.degrees(result.data["crank_angle"].values)
    ambient = (gas.ambient or 0.0) / KGF_PER_CM2
    pressure = result.data["gas_pressure"].values[:, 0] / KGF_PER_CM2 + ambient
    rows = reference.rows("s1_table6_pressure")
    angles = np.array([float(row["crank_angle_deg"]) for row in rows])
    table = np.array([float(row["p_best_kgf_cm2"]) for row in rows])
    simulated = np.interp(angles, degrees, pressure)
    error = np.abs(simulated / table - 1.0)
    travel = 1e3 * result.data["piston_displacement"].values[:, 0]
    at_table = np.interp(angles, degrees, travel)
    printed = np.array([float(printed_cells()[k]["pressure"]) for k in range(0, 361, 30)])
    to_360, beyond = angles <= 360.0, (angles > 360.0) & (angles < 720.0)
    off = np.round(printed - simulated[to_360], 6)
    read = Dots("Table 2 as printed", at_table[to_360], printed, off)
    off = np.round(table - simulated, 6)[beyond]
    implied = Dots("implied by Table 6", at_table[beyond], table[beyond], off, computed=True)
    panel = Panel("pressure [kgf/cm²]", pressure, dots=(read, implied))
    figure = overlay(travel, [panel], "S1, Figure 2", axis="piston travel [mm]")
    worst = int(np.argmax(error))
    return Outcome(
        float(error[worst]),
        f"worst at {angles[worst]:.0f} deg: {simulated[worst]:.5f} against {table[worst]:.5f}",
        figures={case.name: figure},
    )


def compression(case: Case) -> Outcome:
    """Table 2 from the indicator diagram as far as that goes: the compression stroke."""
    ratio, exponent = case.number("compression_ratio"), case.number("n_compression")
    radius = case.number("crank_radius")
    rod = {
        "crank_radius": radius,
        "rod_length": radius / case.number("rod_ratio"),
        "offset": case.number("relative_offset") * radius,
    }
    area = case.number("piston_area")
    swept = 2.0 * radius * area
    clearance = lecture.clearance_volume(swept_volume=swept, compression_ratio=ratio)
    worst, missed, lines = 0.0, {}, []
    for row in reference.rows("s1_table6_pressure"):
        degrees = int(row["crank_angle_deg"])
        if not 180 <= degrees <= 330:
            continue
        volume = lecture.cylinder_volume_series(
            np.radians(degrees), piston_area=area, clearance_volume=clearance, **rod
        )
        ours = float(
            lecture.polytropic_pressure(
                volume,
                reference_volume=swept + clearance,
                reference_pressure=float(printed_cells()[180]["pressure"]),
                exponent=exponent,
            )
        )
        tabulated = float(row["p_polytropic_kgf_cm2"])
        worst = max(worst, abs(ours / tabulated - 1.0))
        printed = printed_cells()[degrees]["pressure"]
        missed[degrees] = 100.0 * (float(printed) / ours - 1.0)
        lines.append(f"| {degrees} | {printed} | {ours:.5f} | {missed[degrees]:+.1f} % |")
    low, high = min(missed, key=lambda at: missed[at]), max(missed, key=lambda at: missed[at])
    return Outcome(
        worst,
        f"Table 2 lies {-missed[low]:.1f} % below its own polytrope at {low} degrees and "
        f"{missed[high]:.1f} % above at {high}, as a curve read from a drawing does",
        table=(
            "| crank angle [deg] | printed | polytrope | printed over polytrope |",
            "|---|---|---|---|",
            *lines,
        ),
    )


def accumulated_cells(case: Case) -> Outcome:
    """Table 6 as printed, added up along the crank by `crankmbs.lecture.accumulated_torque`."""
    ours = _accumulated_table(round(case.number("lag_deg")))
    worst, count = 0.0, 0
    for k, row in enumerate(reference.rows("s1_accumulated_torque")):
        for name, values in (("main_journal", ours.journals), ("crank_pin", ours.pins)):
            for number, value in enumerate(values[k], start=1):
                worst = max(worst, abs(value - float(row[f"{name}_{number}_kgf_m"])))
                count += 1
    return Outcome(worst, f"{count} cells, firing order 1-3-4-2")


def journals(case: Case) -> Outcome:
    """Figure 4: Table 6 added up to each main journal, and the run's."""
    return _figure(case, "Figure 4", "journals", "main journal", 1)


def pins(case: Case) -> Outcome:
    """Figure 5: Table 6 added up to each crank pin, and the run's."""
    return _figure(case, "Figure 5", "pins", "crank pin", 0)


def _accumulated_table(quarter: int = _QUARTER) -> AccumulatedTorque:
    """Table 6 on the 30-degree grid for the four cylinders [kgf m]."""
    table = {degrees: float(cells["T"]) for degrees, cells in printed_cells().items()}
    torque = [[table[(degrees + lag * quarter) % 720] for lag in _LAGS] for degrees in _GRID]
    return accumulated_torque(torque)


def _figure(case: Case, number: str, kind: str, title: str, first: int) -> Outcome:
    """Largest difference of the run from the table on the 30-degree grid, over its peak."""
    result = run(case.ours())
    degrees = np.degrees(result.data["crank_angle"].values)
    simulated: Array = getattr(accumulated_torque(result.data["crank_torque"].values), kind)
    added: Array = KGF * getattr(_accumulated_table(), kind)
    at_grid = np.array([simulated[np.argmin(np.abs(degrees - at))] for at in _GRID])
    difference = np.abs(at_grid - added)
    panels = [
        Panel(
            f"{title} {k + 1} [N m]",
            simulated[:, k],
            dots=(
                Dots(
                    "Table 6 added up",
                    np.array(_GRID, dtype=np.float64),
                    added[:, k],
                    added[:, k] - at_grid[:, k],
                    computed=True,
                ),
            ),
        )
        for k in range(first, added.shape[1])
    ]
    row, column = np.unravel_index(int(np.argmax(difference)), difference.shape)
    figure = overlay(
        degrees,
        panels,
        f"S1, {number}: torque up to the {title}s; Figures 4 and 5 share Table 6's torque,\n"
        "added up in the assumed firing order 1-3-4-2; the paper prints no number of its curve",
    )
    return Outcome(
        float(difference.max() / np.abs(added).max()),
        f"largest difference {difference.max():.1f} N m at {title} {column + 1}, {_GRID[row]} deg",
        figures={case.name: figure},
    )
