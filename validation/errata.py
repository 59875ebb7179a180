"""`python -m validation.errata`: ERRATA.md, every misprint found in the three lectures."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from crankmbs import lecture, load_scene
from crankmbs.result import Result
from validation import reference
from validation.bibliography import links
from validation.case import CASES, load_case
from validation.checks.s1_cells import COLUMNS, KGF, Cell
from validation.checks.s1_tables import engine_of, judged_cells, printed_cells, table_of
from validation.runs import run

__all__ = ["ERRATA", "at_odds", "misprints", "text"]

ERRATA = Path(__file__).parent / "ERRATA.md"
_TABLES = (1, 2, 4, 5, 6)
_STROKE, _RPM, _POWER = 0.092, 3200.0, 70.4e3  # m by Table 1, 1/min and W as printed
_INTRODUCTION = """\
# Errata of the three lectures

Written by `python -m validation.errata` from `reference/errata.csv` and from the cells of S1 as
printed, judged anew. The lectures are [S0], [S1] and [S2] of [BIBLIOGRAPHY.md](BIBLIOGRAPHY.md),
read in their text: a slip of type may be the transcription's. Formulas that are truncated, and say
so, are no errata; their errors stand in `crankmbs.lecture`.

## Misprinted cells of S1

A cell is wrong where it misses its formula, taken from the printed cells before it, by more than
five times what rounding of all of them allows (its allowance); the sound ones miss by at most 4.5.
Whether later cells were computed from the printed value or from the right one says where it went
wrong: in the arithmetic, or in the print. A cell counts only for itself: what was carried on
from a wrong one is not wrong again.

| table | at [deg] | quantity | printed | corrected | misses, in allowances | how it was found |
|---|---|---|---|---|---|---|"""
_EQUATIONS = """\

## Equations and sentences

| lecture | where | printed | corrected | how it was found |
|---|---|---|---|---|"""
_AT_ODDS = """\

## What S1 says against itself

| it says | its own numbers say | by how much |
|---|---|---|"""
_SUSPECT = """\

## Suspect, and cannot be decided

Beyond 360 degrees neither pressure nor force is printed. Torques of Table 6 there that imply no
plausible pressure:

| crank angle [deg] | torque printed [kgf m] | why it is suspect |
|---|---|---|"""


def misprints() -> list[Cell]:
    """The wrong cells of S1's tables, table by table."""
    return [cell for number in _TABLES for cell in _wrong_cells(number)]


def at_odds() -> list[tuple[str, str, str]]:
    """What S1 states, what its own tables give, and how far apart they are."""
    return [
        _power(),
        _mean_speed(),
        _offset(),
        (
            "compression along a polytrope of 1.32 (conclusion)",
            "Table 2 from 180 degrees on leaves it",
            _spread(range(210, 331, 30)),
        ),
        (
            "expansion along a polytrope of 1.18 (conclusion)",
            "the pressures that Table 6 implies leave it from 390 degrees on",
            _spread(range(420, 541, 30)),
        ),
    ]


def text() -> str:
    """The whole page."""
    lines = [_INTRODUCTION, *(_cell_row(cell) for cell in misprints()), _EQUATIONS]
    lines += [_row(row[key] for key in _COLUMNS) for row in reference.rows("errata")]
    lines += [_AT_ODDS, *(_row(said) for said in at_odds()), _SUSPECT]
    lines += [_row(found) for found in _suspect()]
    return "\n".join([*lines, "", *links(("S0", "S1", "S2"))]) + "\n"


_COLUMNS = ("lecture", "where", "printed", "corrected", "found")


def _wrong_cells(number: int) -> Iterator[Cell]:
    judged = judged_cells(engine_of(load_case(CASES / f"s1_table_{number}.toml")))
    for (name, _), cell in sorted(
        judged.items(), key=lambda item: (COLUMNS.index(item[0][0]), item[0][1])
    ):
        if table_of(name) == number and cell.verdict == "misprint":
            yield cell


def _cell_row(cell: Cell) -> str:
    by_hand = reference.one_row(
        "s1_verdicts", crank_angle_deg=str(cell.degrees), quantity=cell.name
    )
    went_on = "later cells have the printed value" if cell.carried else "no later cell has it"
    found = f"{went_on}; {by_hand['note']}" if by_hand["note"] else went_on
    return _row(
        (
            f"{table_of(cell.name)}",
            f"{cell.degrees}",
            f"{cell.name} [{by_hand['unit']}]",
            cell.printed,
            f"{cell.corrected}",
            f"{cell.misses:.3g}",
            found,
        )
    )


def _power() -> tuple[str, str, str]:
    cells, omega = printed_cells(), _omega()
    mean = float(np.mean([float(cells[at]["T"]) for at in range(0, 720, 30)]))
    torque = 4.0 * KGF * mean
    fine = 4.0 * _mean_torque(run(load_scene("yi_diesel"))) * omega
    return (
        "70.4 kW at 3200 rpm (abstract)",
        f"Table 6 has a mean of {mean:.4f} kgf m a cylinder, {torque:.2f} N m for four: "
        f"{torque * omega / 1e3:.1f} kW ({fine / 1e3:.1f} kW in steps of 1 degree through the same "
        f"pressures); 70.4 kW would need {_POWER / omega:.1f} N m",
        f"{_POWER / (torque * omega):.2f} times too much",
    )


def _mean_speed() -> tuple[str, str, str]:
    speed = float(lecture.mean_piston_speed(stroke=_STROKE, omega=_omega()))
    return (
        "a mean piston speed of 7 m/s, in a range of 5 to 9 (conclusion)",
        f"stroke 92 mm (Table 1) at 3200 rpm: {speed:.2f} m/s; 7 m/s would be "
        f"{7.0 * 30.0 / _STROKE:.0f} rpm",
        f"{100.0 * (1.0 - 7.0 / speed):.0f} % too little; {speed:.2f} is outside the range",
    )


def _offset() -> tuple[str, str, str]:
    engine = engine_of(load_case(CASES / "s1_table_1.toml"))
    bore = math.sqrt(4.0 * engine.area / math.pi)
    offset = engine.relative_offset * engine.crank_radius
    return (
        "an offset of 0.015 D (section 2)",
        f"Table 1 has {1e3 * offset:.4f} mm, with the bore of {1e3 * bore:.2f} mm "
        f"{offset / bore:.5f} D",
        f"{100.0 * (offset / bore / 0.015 - 1.0):.1f} %",
    )


def _omega() -> float:
    return float(lecture.angular_speed(rotational_frequency=_RPM / 60.0))


def _mean_torque(result: Result) -> float:
    """Over the crank angle of one cycle [N m]."""
    angle, torque = result.data["crank_angle"].values, result.data["crank_torque"].values[:, 0]
    return float(np.trapezoid(torque, angle) / np.ptp(angle))


def _spread(degrees: range) -> str:
    """How far the print lies from its polytrope at these crank angles."""
    rows = [reference.one_row("s1_table6_pressure", crank_angle_deg=str(at)) for at in degrees]
    off = [
        100.0 * (float(r["p_best_kgf_cm2"]) / float(r["p_polytropic_kgf_cm2"]) - 1.0) for r in rows
    ]
    low, high = int(np.argmin(off)), int(np.argmax(off))
    return f"{off[low]:.0f} % at {degrees[low]} to {off[high]:+.0f} % at {degrees[high]} degrees"


def _suspect() -> Iterator[tuple[str, str, str]]:
    for row in reference.rows("s1_verdicts"):
        _, suspect, why = row["note"].partition("suspect")
        if suspect:
            yield row["crank_angle_deg"], row["as_printed"], why.lstrip(": ")


def _row(cells: Iterator[str] | tuple[str, ...]) -> str:
    return f"| {' | '.join(cells)} |"


def main(arguments: list[str] | None = None) -> int:
    """Write the file."""
    parser = argparse.ArgumentParser(prog="python -m validation.errata", description=__doc__)
    parser.parse_args(arguments)
    ERRATA.write_text(text(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
