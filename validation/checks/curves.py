"""The lectures' motion curves redrawn, with the curve of the multibody run on top.

The lectures' side takes dimensions and speed from the case, the other is the run's own, both in
m, m/s and m/s2: a run at a wrong speed shows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from crankmbs import lecture
from crankmbs.result import Result
from crankmbs.scene.scene import Scene
from validation import reference
from validation.case import Case
from validation.checks.s1_tables import printed_cells
from validation.judge import Outcome
from validation.plots import Array, Dots, Panel, overlay
from validation.runs import run

__all__ = ["constant_speed", "lecture_geometry", "maximum_speed", "truncation"]


@dataclass(frozen=True)
class _Curve:
    """A quantity: its row in truncation_errors.csv in R w^power, unit, and how it is printed."""

    row: str
    power: int
    series: Callable[..., float | Array]
    unit: str
    printed: str


_CURVES = {
    "piston_displacement": _Curve(
        "S0 x~ / S1 Eq3 / S2 S_x  [s/R]",
        0,
        lecture.piston_displacement_series,
        "m",
        "travel",
    ),
    "piston_velocity": _Curve(
        "S0 c~ / S1 Eq4 / S2 W  [v/(R w)]",
        1,
        lecture.piston_velocity_series,
        "m/s",
        "velocity",
    ),
    "piston_acceleration": _Curve(
        "S0 a~ / S1 Eq5 / S2 j  [a/(R w^2)]",
        2,
        lecture.piston_acceleration_series,
        "m/s²",
        "acceleration",
    ),
}


def lecture_geometry(result: Result) -> dict[str, float]:
    """The keyword arguments of the lecture's formulas that say what the mechanism is."""
    return _geometry(result.scene)


def constant_speed(scene: Scene) -> float:
    """The prescribed speed of a scene [rad/s]."""
    assert scene.motion is not None
    assert isinstance(scene.motion.speed, float)
    return scene.motion.speed


def truncation(case: Case) -> Outcome:
    """The largest error of the lecture's series against the run, beside the tabulated one."""
    data, theirs = run(case.ours(), "multibody").data, case.theirs()
    geometry, omega = _geometry(theirs), constant_speed(theirs)
    angle = data["crank_angle"].values
    worst, details, panels = 0.0, [], []
    for name in case.parameters["curves"]:
        curve = _CURVES[name]
        extra = {"omega": omega} if curve.power else {}
        series = np.asarray(curve.series(angle, **geometry, **extra))
        simulated = data[name].values[:, 0]
        if curve.power == 0:  # the lecture counts from l + r, the run from the dead centre
            simulated = simulated + lecture.datum_shift(**geometry)
        largest = float(np.max(np.abs(series - simulated)))
        row = reference.one_row(
            "truncation_errors",
            approximation=curve.row,
            k_offset_over_R=case.word("relative_offset"),
        )
        unit = geometry["crank_radius"] * omega**curve.power
        tabulated = unit * abs(float(row[f"lam{case.word('rod_ratio')}_signed_err_at_max"]))
        worst = max(worst, abs(largest / tabulated - 1.0))
        what = name.removeprefix("piston_")
        details.append(
            f"{what} {largest:.4g} {curve.unit} of {np.max(np.abs(simulated)):.5g} {curve.unit} "
            f"(tabulated {tabulated:.4g})"
        )
        dots = (_printed(curve),) if case.parameters.get("dots") else ()
        panels.append(Panel(f"{what} [{curve.unit}]", simulated, series, dots))
    title = f"{case.word('title')}: rod ratio {case.word('rod_ratio')}"
    figure = overlay(np.degrees(angle), panels, title, ("truncated series", "multibody run"))
    return Outcome(
        worst,
        "largest error of the series against the multibody run: " + ", ".join(details),
        figures={case.name: figure},
    )


def maximum_speed(case: Case) -> Outcome:
    """How far S0's greatest piston speed r w sqrt(1 + lambda^2) lies below the simulated one."""
    data, theirs = run(case.ours(), "multibody").data, case.theirs()
    geometry, omega = _geometry(theirs), constant_speed(theirs)
    velocity = data["piston_velocity"].values[:, 0]
    lectures = float(
        lecture.maximum_piston_speed_sqrt(
            crank_radius=geometry["crank_radius"], rod_length=geometry["rod_length"], omega=omega
        )
    )
    simulated = float(np.max(velocity))
    row = reference.one_row("s0_maximum_speed", rod_ratio=case.word("rod_ratio"))
    unit = geometry["crank_radius"] * omega
    tabulated = unit * float(row["formula_minus_exact_over_R_omega"])
    at = np.degrees(data["crank_angle"].values[int(np.argmax(velocity))]) % 360.0
    return Outcome(
        abs((lectures - simulated) / tabulated - 1.0),
        f"sqrt form {lectures:.6f} m/s, multibody run {simulated:.6f} m/s: difference "
        f"{lectures - simulated:.3e} m/s (tabulated {tabulated:.3e}); maximum of the run at "
        f"{at:.2f} deg (tabulated {row['angle_of_exact_deg']})",
    )


def _geometry(scene: Scene) -> dict[str, float]:
    return {
        "crank_radius": scene.crank.radius,
        "rod_length": scene.rod.length,
        "offset": scene.piston.offset,
    }


def _printed(curve: _Curve) -> Dots:
    """The cells of S1's Table 1, in SI units."""
    rows = {d: cells for d, cells in printed_cells().items() if curve.printed in cells}
    scale = 1e-3 if curve.printed == "travel" else 1.0
    values = [scale * float(cells[curve.printed]) for cells in rows.values()]
    return Dots("Table 1 as printed", np.array(list(rows), dtype=np.float64), np.array(values))
