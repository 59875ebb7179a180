"""The table of a comparison as a CSV file."""

from __future__ import annotations

import csv
from pathlib import Path

from crankmbs.storage.files import write_in_one_move
from crankmbs.work_precision.benchmark import WorkPrecision

__all__ = ["save_work_precision"]

_HEADING = ("contender", "peer", "knob", "setting", "stated")
_COST = ("time_s", "time_min_s", "time_max_s", "runs", "evaluations")


def save_work_precision(outcome: WorkPrecision, folder: Path) -> Path:
    """Write work_precision.csv: comments with reference, notes and machine, then a line a row.

    Errors are relative; an empty cell is what a contender does not give.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    remarks = (f"reference: {outcome.reference.sentence()}", *outcome.notes, *outcome.machine)
    names = [f"error_{name.replace(' ', '_')}" for name in outcome.quantities]

    def write(file: Path) -> None:
        with file.open("w", encoding="utf-8", newline="") as stream:
            stream.writelines(f"# {line}\n" for line in remarks)
            rows = csv.writer(stream, lineterminator="\n")
            rows.writerow([*_HEADING, *names, *_COST])
            for row in outcome.rows:
                errors = (row.errors.get(name) for name in outcome.quantities)
                times = (row.time, min(row.times), max(row.times))
                rows.writerow(
                    [
                        *(row.contender, int(row.is_peer), row.knob, f"{row.setting:g}"),
                        *(_cell(value) for value in (row.stated, *errors, *times)),
                        *(len(row.times), row.evaluations),
                    ]
                )

    target = folder / "work_precision.csv"
    write_in_one_move(target, write)
    return target


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.3e}"
