"""A comparison and a budget as CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from crankmbs.compare.against import Comparison
from crankmbs.compare.causes import Budget, Split
from crankmbs.compare.excerpt import Excerpt
from crankmbs.compare.quantities import QUANTITIES
from crankmbs.compare.size import Size, percent, within
from crankmbs.storage.files import write_in_one_move

__all__ = ["save_budget", "save_budget_peaks", "save_comparison"]

_SIZE = ["peak", "max", "rms", "max_percent", "rms_percent", "angle_deg"]


def save_comparison(comparison: Comparison, folder: Path) -> Path:
    """Write comparison.csv: a line for each reference and quantity, SI units, angle in degrees.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [row.reference, *_whose(comparison.excerpt, row.quantity), *_cells(row.size, row.peak)]
        for row in comparison.rows
    )
    heading = ["reference", "quantity", "unit", "cylinder", *_SIZE]
    return _write(folder / "comparison.csv", heading, lines)


def save_budget(budget: Budget, folder: Path) -> Path:
    """Write budget.csv: every cause over the angle, so that they can be added up.

    A line for each quantity and sample, in SI units and degrees; the causes of a line add up to
    "total", which is "lecture" minus "run". crank_angle_deg is the run's own; angle_deg lies within
    one cycle, of the cylinder, for the main bearing of the crank.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    causes = [cause.name for cause in budget.splits[0].causes] if budget.splits else []
    heading = ["quantity", "unit", "cylinder", "crank_angle_deg", "angle_deg"]
    lines = (line for split in budget.splits for line in _curves(budget.excerpt, split))
    heading += ["run", "lecture", "total", *causes]
    return _write(folder / "budget.csv", heading, lines)


def save_budget_peaks(budget: Budget, folder: Path) -> Path:
    """Write budget_peaks.csv: a line for each quantity and cause, and for the total of the causes.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [*_whose(budget.excerpt, split.quantity), cause.name, *_cells(cause.size, split.peak)]
        for split in budget.splits
        for cause in (*split.causes, split.total)
    )
    heading = ["quantity", "unit", "cylinder", "cause", *_SIZE]
    return _write(folder / "budget_peaks.csv", heading, lines)


def _curves(excerpt: Excerpt, split: Split) -> Iterator[list[str]]:
    """The lines of a quantity, sample by sample."""
    about = _whose(excerpt, split.quantity)
    angle = within(excerpt.angles(split.quantity), excerpt.result.scene.period)
    curves = [np.degrees(excerpt.theta), np.degrees(angle), split.simulated, split.lecture]
    curves += [cause.curve for cause in (split.total, *split.causes)]
    for row in np.transpose(curves).tolist():
        yield [*about, *(f"{value:.15g}" for value in row)]


def _whose(excerpt: Excerpt, quantity: str) -> list[str]:
    about = QUANTITIES[quantity]
    return [quantity, about.units, str(excerpt.cylinder) if about.per_cylinder else "all"]


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
