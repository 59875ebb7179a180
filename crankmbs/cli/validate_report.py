"""What ``validate`` prints."""

from __future__ import annotations

import math
from collections.abc import Sequence

from crankmbs.cli.text import table
from crankmbs.compare import (
    CLOSED_FORM,
    OBSERVABLES,
    Budget,
    Comparison,
    Excerpt,
    LeftOut,
    percent,
)
from crankmbs.digits import digits, error_digits
from crankmbs.scene.units import RPM

__all__ = ["validation_report"]

_ADDED = (
    "The peaks of the causes lie at different angles and do not add; at each angle the causes do:\n"
    "budget.csv has them all, budget_peaks.csv this table."
)


def validation_report(comparison: Comparison, split: Budget) -> str:
    """A comparison and its budget, what matters most first."""
    parts = [
        _first(comparison, split),
        str(comparison.excerpt.result),
        _about(comparison.excerpt),
        *([_numbers(comparison)] if comparison.numbers else []),
        _causes(split),
        _ADDED,
        "\n".join(row.sentence() for row in split.ranked),
        *(_against(comparison, reference) for reference in comparison.references),
        "\n".join(_left_out((*comparison.left_out, *split.left_out))),
    ]
    return "\n\n".join(part for part in parts if part)


def _about(excerpt: Excerpt) -> str:
    count = len(excerpt.result.scene.cylinders)
    rpm = excerpt.mean_speed / RPM
    inside = excerpt.result.data.sizes["time"] - excerpt.window.inside
    folded = len(excerpt.samples) < inside
    return (
        f"over the {excerpt.window.kind}"
        f"{' but for where the rod folds onto the crank' if folded else ''}, "
        f"cylinder {excerpt.cylinder} of {count}, mean speed {digits(rpm)} rpm\n"
        "angles: cycle angle of the cylinder, for the main bearing the crank angle\n"
        "peak: the largest magnitude in the run\n"
        "lectures: S0 is Grega's, S1 that of Yi, Win and Htay; the budget splits the error of S1"
    )


def _first(comparison: Comparison, split: Budget) -> str:
    """What matters most: the lecture's largest error, and how far to believe the run."""
    lines = []
    lectures = [row for row in split.ranked if row.is_lecture]
    lines += [row.sentence() for row in split.ranked if not row.is_lecture]
    if lectures:
        lines.append(f"the lecture is most wrong about the {lectures[0].sentence()}")
    shares = [
        (percent(row.size.largest, row.peak), row.quantity)
        for row in comparison.rows
        if row.reference == CLOSED_FORM and row.peak > 0.0
    ]
    if comparison.excerpt.result.formulation != "multibody":
        lines.append("the run takes its forces from the closed form; multibody has its own")
    elif shares:
        share, quantity = max(shares)
        lines.append(f"the run itself is within {_share(share)} % of the closed form ({quantity})")
    return "\n".join(lines)


def _against(comparison: Comparison, reference: str) -> str:
    headings = [f"against: {reference}", "peak", "max", "% of peak", "at [deg]", "rms", "% of peak"]
    rows = [
        [
            f"{row.quantity} [{OBSERVABLES[row.quantity].units}]",
            digits(row.peak),
            digits(row.size.largest, most=4),
            _share(percent(row.size.largest, row.peak)),
            f"{math.degrees(row.size.angle):.1f}",
            digits(row.size.rms, most=4),
            _share(percent(row.size.rms, row.peak)),
        ]
        for row in comparison.rows
        if row.reference == reference
    ]
    return table(headings, rows)


def _numbers(comparison: Comparison) -> str:
    """The formulas that stand for one number of the run, beside it."""
    headings = ["single numbers", "formula", "run", "error of the run", "off by [%]"]
    rows = [
        [
            f"{row.quantity} by {row.reference} [{row.units}]",
            digits(row.value),
            digits(row.simulated.value),
            error_digits(row.simulated.error),
            _share(row.percent),
        ]
        for row in comparison.numbers
    ]
    return table(headings, rows)


def _causes(split: Budget) -> str:
    """Every cause's peak in percent of the quantity's in the run."""
    named = [*split.chain, "total"]
    headings = ["error budget, peaks in %", *named]
    rows = []
    for row in split.splits:
        shares = {cause.name: row.share(cause) for cause in (*row.causes, row.total)}
        about = row.quantity if row.is_lecture else f"{row.quantity} by {row.reference}"
        rows.append([about, *(_share(shares.get(name, math.nan)) for name in named)])
    return table(headings, rows)


def _left_out(entries: Sequence[LeftOut]) -> list[str]:
    """One line for each reason, naming its quantities."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for entry in dict.fromkeys(entries):
        grouped.setdefault((entry.what, entry.reason), []).append(entry.quantity)
    return [
        f"left out{f' of {what!r}' if what else ''}: {', '.join(quantities)}: {reason}"
        for (what, reason), quantities in grouped.items()
    ]


def _share(percentage: float) -> str:
    return digits(percentage, most=3)
