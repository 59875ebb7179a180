"""What became of every claim: `results.csv`, one row a claim, and what needs more than a line,
`details.json`."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from validation.case import Case
from validation.inputs import digest
from validation.judge import SEEN, Verdict

__all__ = ["DETAILS", "RESULTS", "Row", "read_rows", "row_of", "stale", "write_rows"]

_HERE = Path(__file__).parent
RESULTS, DETAILS = _HERE / "results.csv", _HERE / "details.json"
_LONG = ("detail", "table", "figures")  # what stands in details.json


@dataclass(frozen=True, kw_only=True)
class Row:
    """One claim judged.

    name, claim : of the case
    verdict : that of `validation.judge`; measured, tolerance : in the norm of the case
    mutant : whether the shifted parameter of the case was seen, as `validation.judge.seen` says it
    seconds : what that took; date, commit, environment : when, of which checkout and with what
    inputs : digest of what it was judged from
    detail : one line with the numbers behind it; table : lines of Markdown; figures : names in
        `figures`
    """

    name: str
    claim: str
    verdict: str
    measured: float
    tolerance: float
    mutant: str
    seconds: int
    date: str
    commit: str
    environment: str
    inputs: str
    detail: str
    table: Sequence[str]
    figures: Sequence[str]

    @property
    def green(self) -> bool:
        """Whether the claim held, and would not have with its shifted parameter."""
        return self.verdict == "holds" and self.mutant == SEEN

    @property
    def share(self) -> float:
        """What was measured, in tolerances; 0 where nothing may be missed and nothing is."""
        return self.measured / self.tolerance if self.measured else 0.0


def row_of(
    verdict: Verdict,
    *,
    seconds: int,
    date: str,
    commit: str,
    environment: str,
    folder: Path = _HERE,
) -> Row:
    """The row of a claim judged now; its figures are written into the folder's."""
    case, outcome = verdict.case, verdict.outcome
    (folder / "figures").mkdir(exist_ok=True)
    for name, figure in outcome.figures.items():
        figure.savefig(folder / "figures" / f"{name}.png", dpi=90, metadata={"Software": None})
    return Row(
        name=case.name,
        claim=case.claim,
        verdict=verdict.word,
        measured=float(outcome.error),
        tolerance=case.tolerance,
        mutant=verdict.mutant,
        seconds=seconds,
        date=date,
        commit=commit,
        environment=environment,
        inputs=digest(case),
        detail=outcome.detail,
        table=outcome.table,
        figures=tuple(outcome.figures),
    )


def read_rows(folder: Path = _HERE) -> dict[str, Row]:
    """The rows by the names of the claims; none where there are no files yet."""
    table = folder / RESULTS.name
    if not table.is_file():
        return {}
    details = json.loads((folder / DETAILS.name).read_text(encoding="utf-8"))
    with table.open(newline="", encoding="utf-8") as file:
        rows = [_row(cells, details[cells["name"]]) for cells in csv.DictReader(file)]
    return {row.name: row for row in rows}


def _row(cells: dict[str, Any], details: Mapping[str, Any]) -> Row:
    for name, number in (("measured", float), ("tolerance", float), ("seconds", int)):
        cells[name] = number(cells[name])
    return Row(**cells, **details)


def write_rows(rows: Mapping[str, Row], folder: Path = _HERE) -> None:
    """Write the rows in the order of their names, each file in its place at once."""
    ordered = [asdict(rows[name]) for name in sorted(rows)]
    details = {row["name"]: {part: row.pop(part) for part in _LONG} for row in ordered}
    names = [field.name for field in fields(Row) if field.name not in _LONG]
    part = folder / "results.part"
    part.write_text(json.dumps(details, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(folder / DETAILS.name)
    with part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(ordered)
    part.replace(folder / RESULTS.name)


def stale(cases: Sequence[Case], rows: Mapping[str, Row]) -> list[str]:
    """The claims without a row, and those whose row was measured from other inputs."""
    return [c.name for c in cases if c.name not in rows or rows[c.name].inputs != digest(c)]
