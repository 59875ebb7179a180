"""What ``validate`` prints."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

from crankmbs.cli.text import table
from crankmbs.compare import CLOSED_FORM, LECTURES, Budget, Comparison, Split, percent
from crankmbs.digits import digits, error_digits
from crankmbs.report.compared import (
    advice,
    angle_words,
    budget_table,
    comparison_table,
    exact_words,
    left_out_lines,
    number_table,
    worst_variable,
)
from crankmbs.scene.units import RPM

__all__ = ["validation_report"]

_WIDTH = 100
_, _S0, _ = LECTURES


def validation_report(comparison: Comparison, split: Budget, *, verbose: bool) -> str:
    """The largest error of each formula with its causes, and how far to believe the run; verbose:
    every reference and every cause, too."""
    parts = [
        _about(comparison),
        _user_formulas(comparison, split),
        table(*number_table(comparison)) if comparison.numbers else "",
        _lectures(comparison, split),
        textwrap.fill(f"advice: {advice(split)}", _WIDTH) if split.splits else "",
        "\n".join(
            textwrap.fill(line, _WIDTH)
            for line in left_out_lines((*comparison.left_out, *split.left_out))
        ),
        _full(comparison, split) if verbose else "",
    ]
    return "\n\n".join(part for part in parts if part)


def _full(comparison: Comparison, split: Budget) -> str:
    """Every reference, and every formula's causes wherever they are largest."""
    return "\n\n".join(
        [
            "each reference: largest difference from the run, in % of its peak; at [deg]: "
            "where that of the last reference is\n" + table(*comparison_table(comparison)),
            "each cause at its largest; these lie at different angles and do not add:",
            *(textwrap.fill(row.sentence(), _WIDTH) for row in split.ranked),
        ]
    )


def _about(comparison: Comparison) -> str:
    excerpt = comparison.excerpt
    result, count = excerpt.result, len(excerpt.result.scene.cylinders)
    inside = result.data.sizes["time"] - excerpt.window.inside
    folded = len(excerpt.samples) < inside
    lines = {
        "run": f"{result.formulation}, {result.message}",
        "compared": f"{excerpt.window.kind}"
        f"{' but for where the rod folds onto the crank' if folded else ''}, "
        f"cylinder {excerpt.cylinder} of {count}, "
        f"mean speed {digits(excerpt.mean_speed / RPM)} rpm",
        "num. error": _numerical(comparison),
        "closed form": _believed(comparison),
    }
    head = [result.scene.title, ""] if result.scene.title else []
    indent = " " * 13
    rows = [
        textwrap.fill(text, _WIDTH, initial_indent=f"{name:<13}", subsequent_indent=indent)
        for name, text in lines.items()
    ]
    return "\n".join([*head, *rows])


def _numerical(comparison: Comparison) -> str:
    result = comparison.excerpt.result
    size = error_digits(100.0 * result.error.estimated)
    return f"{size} % of the peak at most ({worst_variable(result)} of {result.formulation})"


def _believed(comparison: Comparison) -> str:
    """Where the closed form is evaluated, and how near multibody's joint forces are to it."""
    at = "at the run's own angle, speed and acceleration"
    if comparison.excerpt.result.formulation != "multibody":
        return f"Newton-Euler {at}; gives this run its joint forces, multibody has its own"
    shares = [
        (percent(row.size.largest, row.peak), row.quantity)
        for row in comparison.rows
        if row.reference == CLOSED_FORM and row.peak > 0.0
    ]
    share, quantity = max(shares)
    return f"Newton-Euler {at}: the run is within {error_digits(share)} % of it ({quantity})"


def _user_formulas(comparison: Comparison, split: Budget) -> str:
    """Each formula of the user, with its causes where it has a budget."""
    formulas = [row for row in split.ranked if not row.is_lecture]
    by = dict.fromkeys(row.reference for row in formulas)
    parts = []
    for label in by:
        rows = [row for row in formulas if row.reference == label]
        parts += [
            f"{label} minus run, in % of the run's peak, at its largest",
            *_rows(rows),
            "",
        ]
    for row in comparison.rows:
        if row.reference not in {CLOSED_FORM, *LECTURES, *by}:
            share = digits(percent(row.size.largest, row.peak), most=3)
            place = f"of the peak, at {math.degrees(row.size.angle):.0f} degrees"
            parts.append(f"{row.quantity} by {row.reference}: off by up to {share} % {place}")
    return "\n".join(parts).rstrip()


def _lectures(comparison: Comparison, split: Budget) -> str:
    rows = [row for row in split.ranked if row.is_lecture]
    if not rows:
        return ""
    beside = comparison if _S0 in comparison.references else None
    lines = [
        "error: formula minus run, in % of the run's peak, at its largest; the causes add up to it",
        "formulas: those of Yi, Win and Htay (S1)"
        + ("; last column: the largest error of Grega's (S0)" if beside else ""),
        f"angles: {angle_words(row.quantity for row in rows)}",
    ]
    return "\n".join([*lines, "", *_rows(rows, beside)])


def _rows(splits: Sequence[Split], beside: Comparison | None = None) -> list[str]:
    """The table of these formulas, and what it leaves out."""
    budget = budget_table(splits, beside)
    lines = [table(*budget)] if budget.rows else []
    return [*lines, *([textwrap.fill(exact, _WIDTH)] if (exact := exact_words(splits)) else [])]
