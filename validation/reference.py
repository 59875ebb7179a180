"""Reference tables: CSV files whose first lines, after #, name source, units and what was done."""

import csv
from pathlib import Path

__all__ = ["FOLDER", "MissingReference", "one_row", "rows"]

FOLDER = Path(__file__).parent / "reference"


class MissingReference(Exception):
    """No such file, no such row, or an empty cell where a number is needed."""


def rows(name: str) -> list[dict[str, str]]:
    """The rows of a reference table, every cell as it is printed."""
    path = FOLDER / f"{name}.csv"
    if not path.is_file():
        raise MissingReference(f"reference {path.name} is missing")
    lines = path.read_text(encoding="utf-8").splitlines()
    found = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    if not found or not lines[0].startswith("#"):
        raise MissingReference(f"reference {path.name} has no rows, or no source in its first line")
    return found


def one_row(name: str, **key: str) -> dict[str, str]:
    """The one row whose cells agree with `key`."""
    found = [row for row in rows(name) if all(row[k] == v for k, v in key.items())]
    if len(found) != 1:
        raise MissingReference(f"reference {name}.csv has {len(found)} rows for {key}, not one")
    return found[0]
