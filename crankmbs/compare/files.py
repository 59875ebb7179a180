"""A comparison and a budget as CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from crankmbs.compare.against import Comparison, Deviation
from crankmbs.compare.excerpt import Excerpt
from crankmbs.compare.quantities import OBSERVABLES
from crankmbs.compare.size import Size, percent, within
from crankmbs.compare.split import Budget, Split
from crankmbs.storage.files import write_in_one_move

__all__ = ["save_budget", "save_budget_peaks", "save_comparison", "save_numbers"]

_WHAT = ["reference", "quantity", "unit", "cylinder"]
_SIZE = ["peak", "max", "rms", "max_percent", "rms_percent", "angle_deg"]


def save_comparison(comparison: Comparison, folder: Path) -> Path:
    """Write comparison.csv: a line for each reference and quantity, SI units, angle in degrees.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [*_what(comparison.excerpt, row), *_values(row.size, row.peak)] for row in comparison.rows
    )
    return _write(folder / "comparison.csv", [*_WHAT, *_SIZE], lines)


def save_budget(budget: Budget, folder: Path) -> Path:
    """Write budget.csv: every cause over the angle, so that they can be added up.

    A line for each formula, quantity and sample, in SI units and degrees; the causes in a line add
    up to "total", which is "formula" minus "run". crank_angle_deg is unwrapped; angle_deg is the
    cycle angle of the cylinder, for the main bearing the crank angle within one period.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    curves = ["crank_angle_deg", "angle_deg", "run", "formula", "total", *budget.chain]
    lines = (line for split in budget.splits for line in _budget_lines(budget, split))
    return _write(folder / "budget.csv", [*_WHAT, *curves], lines)


def save_budget_peaks(budget: Budget, folder: Path) -> Path:
    """Write budget_peaks.csv: a line for each formula, quantity and cause, and for the total.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [*_what(budget.excerpt, split), cause.name, *_values(cause.size, split.peak)]
        for split in budget.splits
        for cause in (*split.causes, split.total)
    )
    return _write(folder / "budget_peaks.csv", [*_WHAT, "cause", *_SIZE], lines)


def save_numbers(comparison: Comparison, folder: Path) -> Path:
    """Write numbers.csv: a line for each formula that stands for one number of the run.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    lines = (
        [
            row.reference,
            row.quantity,
            row.units,
            *(f"{value:.12g}" for value in (row.value, *row.simulated, row.error, row.percent)),
        ]
        for row in comparison.numbers
    )
    heading = ["reference", "quantity", "unit", "formula", "run", "run_error", "error", "percent"]
    return _write(folder / "numbers.csv", heading, lines)


def _budget_lines(budget: Budget, split: Split) -> Iterator[list[str]]:
    """The lines of a quantity, sample by sample; causes that it lacks are 0."""
    excerpt = budget.excerpt
    angle = within(excerpt.angles(split.quantity), excerpt.result.scene.period)
    causes = {cause.name: cause.curve for cause in split.causes}
    curves = [np.degrees(excerpt.theta), np.degrees(angle), split.simulated, split.values]
    curves += [split.total.curve, *(causes.get(name, 0.0 * angle) for name in budget.chain)]
    for sample in np.transpose(curves).tolist():
        yield [*_what(excerpt, split), *(f"{value:.15g}" for value in sample)]


def _what(excerpt: Excerpt, row: Deviation | Split) -> list[str]:
    about = OBSERVABLES[row.quantity]
    cylinder = str(excerpt.cylinder) if about.per_cylinder else "all"
    return [row.reference, row.quantity, about.units, cylinder]


def _values(size: Size, peak: float) -> list[str]:
    shares = (percent(size.largest, peak), percent(size.rms, peak))
    values = (peak, size.largest, size.rms, *shares, math.degrees(size.angle))
    return [f"{value:.12g}" for value in values]


def _write(target: Path, heading: list[str], lines: Iterable[list[str]]) -> Path:
    def fill(part: Path) -> None:
        with part.open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream, lineterminator="\n").writerows([heading, *lines])

    write_in_one_move(target, fill)
    return target
