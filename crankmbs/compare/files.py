"""A comparison and a budget as CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable
from pathlib import Path

from crankmbs.compare.against import Comparison
from crankmbs.compare.causes import Budget
from crankmbs.compare.quantities import QUANTITIES
from crankmbs.compare.size import Size, percent
from crankmbs.compare.stretch import Stretch
from crankmbs.files import write_in_one_move

__all__ = ["save_budget", "save_comparison"]

_SIZE = ["peak", "max", "rms", "max_percent", "rms_percent", "angle_deg"]


def save_comparison(comparison: Comparison, folder: Path) -> Path:
    """Write comparison.csv: a line for each reference and quantity, SI units, angle in degrees.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [row.reference, *_whose(comparison.stretch, row.quantity), *_cells(row.size, row.peak)]
        for row in comparison.rows
    )
    heading = ["reference", "quantity", "unit", "cylinder", *_SIZE]
    return _write(folder / "comparison.csv", heading, lines)


def save_budget(budget: Budget, folder: Path) -> Path:
    """Write budget.csv: a line for each quantity and cause, and for the total of the causes.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [*_whose(budget.stretch, split.quantity), cause.name, *_cells(cause.size, split.peak)]
        for split in budget.splits
        for cause in (*split.causes, split.total)
    )
    return _write(folder / "budget.csv", ["quantity", "unit", "cylinder", "cause", *_SIZE], lines)


def _whose(stretch: Stretch, quantity: str) -> list[str]:
    about = QUANTITIES[quantity]
    return [quantity, about.units, str(stretch.cylinder) if about.per_cylinder else "all"]


def _cells(size: Size, peak: float) -> list[str]:
    shares = (percent(size.largest, peak), percent(size.rms, peak))
    values = (peak, size.largest, size.rms, *shares, math.degrees(size.angle))
    return [f"{value:.12g}" for value in values]


def _write(target: Path, heading: list[str], lines: Iterable[list[str]]) -> Path:
    def fill(part: Path) -> None:
        with part.open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream, lineterminator="\n").writerows([heading, *lines])

    write_in_one_move(target, fill)
    return target
