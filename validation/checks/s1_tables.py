"""Every cell of S1's Tables 1, 2, 4, 5 and 6: as printed, ours, and the verdict."""

from __future__ import annotations

import math
from functools import lru_cache

from validation import reference
from validation.case import Case
from validation.checks.s1_cells import KGF, KGF_PER_CM2, Cell, Engine, judge_angle
from validation.judge import Outcome
from validation.reference import MissingReference

__all__ = ["engine_of", "judged_cells", "printed_cells", "table", "table_of"]

_TABLES = {
    1: {
        "travel": "piston_travel_mm",
        "velocity": "piston_velocity_m_per_s",
        "acceleration": "piston_acceleration_m_per_s2",
    },
    2: {"pressure": "gas_pressure_abs_kgf_per_cm2"},
    4: {"PG": "gas_force_PG_kgf", "Fi": "inertia_force_Fi_kgf", "F": "net_force_F_kgf"},
    5: {
        "Q": "side_thrust_Q_kgf",
        "K": "rod_force_K_kgf",
        "Ft": "tangential_force_Ft_kgf",
        "N": "normal_force_N_kgf",
    },
    6: {"T": "torque_T_kgf_m"},
}
_WRONG = {"slip", "MISPRINT"}  # by hand; "inconsistent with T2" blames the pressure, as we do
_DIGITS = 1.01e-5  # the hand-made table has five decimals


def table(case: Case) -> Outcome:
    """Cells of one table that the residuals judge otherwise than a reader did by hand.

    A cell counts as different where one calls it wrong and the other does not, or where what it
    should be differs in the five decimals of the hand-made table. A cell without a formula agrees
    with nothing, and is counted apart.
    """
    number = int(case.parameters["table"])
    cells = judged_cells(engine_of(case))
    columns = _TABLES[number]
    counts = dict.fromkeys(("agrees", "rounding", "misprint", "no formula"), 0)
    different: list[str] = []
    for row in reference.rows("s1_verdicts"):
        degrees, name = int(row["crank_angle_deg"]), row["quantity"]
        if name not in columns:
            continue
        cell = cells.get((name, degrees))
        counts["no formula" if cell is None else cell.verdict] += 1
        if not _same(row, cell):
            different.append(f"{name} at {degrees}")
    detail = ", ".join(f"{count} {word}" for word, count in counts.items() if count)
    if different:
        detail += f"; judged otherwise by hand: {', '.join(different)}"
    return Outcome(
        float(len(different)), f"{sum(counts.values())} cells: {detail}", _lines(number, cells)
    )


def engine_of(case: Case) -> Engine:
    """S1's engine from the parameters of a case."""
    return Engine(
        crank_radius=case.number("crank_radius"),
        rod_ratio=case.number("rod_ratio"),
        relative_offset=case.number("relative_offset"),
        omega=case.number("speed_rpm") * math.pi / 30.0,
        area=case.number("piston_area"),
        ambient=KGF_PER_CM2,
        mass=case.number("reciprocating_mass_kgf") * KGF,
    )


@lru_cache(maxsize=1)
def printed_cells() -> dict[int, dict[str, str]]:
    """The cells of all tables by crank angle [deg] and name, as printed."""
    found: dict[int, dict[str, str]] = {}
    for number, columns in _TABLES.items():
        for row in reference.rows(f"s1_table{number}_as_printed"):
            at = found.setdefault(int(row["crank_angle_deg"]), {})
            for name, heading in columns.items():
                if not row[heading]:
                    raise MissingReference(f"Table {number}, {heading}: an empty cell")
                at[name] = row[heading]
    return found


def judged_cells(engine: Engine) -> dict[tuple[str, int], Cell]:
    """The cells to 360 degrees, where Table 2 ends: beyond, T has nothing to be computed from."""
    rows = {degrees: cells for degrees, cells in printed_cells().items() if degrees <= 360}
    return {
        (name, degrees): cell
        for degrees, cells in rows.items()
        for name, cell in judge_angle(engine, degrees, cells).items()
    }


def table_of(name: str) -> int:
    """The number of the table that has a quantity."""
    return next(number for number, columns in _TABLES.items() if name in columns)


def _same(row: dict[str, str], cell: Cell | None) -> bool:
    if row["class"] == "inconsistent with T2":
        return cell is not None and cell.verdict == "no formula"
    if cell is None or cell.verdict == "no formula":
        return row["class"].startswith("no formula")
    if (cell.verdict == "misprint") != (row["class"] in _WRONG):
        return False
    if abs(cell.ours - float(row["formula_from_printed_inputs"])) < _DIGITS:
        return True
    return cell.verdict == "misprint" and float(cell.corrected) == _corrected_by_hand(cell)


def _corrected_by_hand(cell: Cell) -> float:
    number = table_of(cell.name)
    heading = _TABLES[number][cell.name]
    row = reference.one_row(f"s1_table{number}_corrected", crank_angle_deg=str(cell.degrees))
    return float(row[heading])


def _lines(number: int, cells: dict[tuple[str, int], Cell]) -> tuple[str, ...]:
    columns = _TABLES[number]
    header = " | ".join(f"{heading} | ours | verdict" for heading in columns.values())
    lines = [f"| crank angle [deg] | {header} |", "|---" * (1 + 3 * len(columns)) + "|"]
    for degrees, printed in printed_cells().items():
        if not columns.keys() <= printed.keys():
            continue
        row = [str(degrees)]
        for name in columns:
            cell = cells.get((name, degrees))
            row += [printed[name], *(_shown(cell) if cell else ("-", "no formula"))]
        lines.append(f"| {' | '.join(row)} |")
    return tuple(lines)


def _shown(cell: Cell) -> tuple[str, str]:
    if cell.verdict == "no formula":
        return "-", cell.verdict
    ours = f"{cell.ours:.4f}"
    if cell.verdict != "misprint":
        return ours, cell.verdict
    word = "slip, carried on" if cell.carried else "misprint"
    return ours, f"**{word}: corrected to {cell.corrected}**"
