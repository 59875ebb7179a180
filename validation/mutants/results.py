"""What became of every mutant, when and at which commit: `results.csv`, one row a mutant."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from validation.mutants.plan import FOLDER, Mutant

__all__ = ["NO_END", "PAGE", "RESULTS", "Row", "read_rows", "score", "untried", "write_rows"]

RESULTS = FOLDER / "results.csv"
NO_END = "no end"
PAGE = FOLDER.parent / "MUTANTS.md"


@dataclass(frozen=True)
class Row:
    """One mutant tried.

    verdict : "killed", "no end" (its guards did not come to their end) or "survived"
    by : the guard that turned red first; seconds : what that took
    mutant : digest of the mutant that was tried
    """

    name: str
    verdict: str
    by: str
    seconds: int
    date: str
    commit: str
    mutant: str

    @property
    def dead(self) -> bool:
        """Whether something turned red."""
        return self.verdict != "survived"


def read_rows(path: Path = RESULTS) -> dict[str, Row]:
    """The rows by the names of the mutants; none where there is no file yet."""
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8") as file:
        rows = [_row(raw) for raw in csv.DictReader(file)]
    return {row.name: row for row in rows}


def _row(cells: dict[str, str]) -> Row:
    seconds = int(cells.pop("seconds"))
    return Row(seconds=seconds, **cells)


def write_rows(rows: Iterable[Row], path: Path = RESULTS) -> None:
    """Write the rows in a file's place at once."""
    part = path.with_suffix(".part")
    with part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Row)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(row) for row in rows)
    part.replace(path)


def untried(mutants: Iterable[Mutant], rows: Mapping[str, Row]) -> list[str]:
    """The mutants without a row, and those whose row is of another text."""
    return [m.name for m in mutants if m.name not in rows or rows[m.name].mutant != m.digest]


def score(mutants: list[Mutant], rows: dict[str, Row]) -> tuple[int, int]:
    """How many are dead, and of how many: those that no number can show are not counted."""
    counted = [rows[mutant.name] for mutant in mutants if not mutant.equivalent]
    return sum(row.dead for row in counted), len(counted)
