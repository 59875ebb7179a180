"""A comparison with formulas and an error budget, as tables of words and numbers.

Errors are formula minus run, in percent of the largest value in the run.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from crankmbs.compare import (
    LECTURES,
    OBSERVABLES,
    Budget,
    Comparison,
    LeftOut,
    Split,
    percent,
    short_name,
)
from crankmbs.digits import digits, error_digits
from crankmbs.display import displayed, with_unit
from crankmbs.mechanics.peaks import peak, relative_errors
from crankmbs.mechanics.variables import EVERY
from crankmbs.report.rows import Table
from crankmbs.result import Result

__all__ = [
    "advice",
    "angle_words",
    "budget_table",
    "comparison_table",
    "exact_words",
    "left_out_lines",
    "number_table",
    "worst_variable",
]

_, _S0, _ = LECTURES
_LEAST = 0.005  # %: less is shown as 0.00
_GOOD = 1.0  # %: pressures and masses are seldom known better
_HELPS = 0.9  # of the error; what leaves more does not help
_REMEDIES = {
    "series": "the exact formula in place of the truncated series",
    "datum": "the displacement from the true dead centre",
    "constant speed": "the crank's own speed and acceleration in place of the mean speed",
    "two-mass rod": "the rod's moment of inertia in place of two masses",
    "gravity": "gravity included",
    "friction": "the friction of the pistons included",
    "forces": "the forces on the pistons included",
    "solver": "a smaller rtol",
}


def budget_table(splits: Sequence[Split], comparison: Comparison | None = None) -> Table:
    """The largest error of each formula, where it is, and the causes that make it up there, the
    largest error first.

    Quantities that are right within 0.005 % have no row, causes that add less nowhere no column.

    comparison : of the same run; adds the largest error of Grega's formula as a last column
    """
    shown = [split for split in splits if not _right(split)]
    parts = [split.at_largest() for split in shown]
    named = dict.fromkeys(name for each in parts for name in each)
    causes = [name for name in named if any(abs(each.get(name, 0.0)) >= _LEAST for each in parts)]
    rows = []
    for split, each in zip(shown, parts, strict=True):
        row = [
            *_with_peak(split.quantity, split.peak),
            _signed(sum(each.values())),
            f"{math.degrees(split.total.size.angle):.0f}",
            *(_signed(each.get(name, 0.0)) for name in causes),
        ]
        rows.append([*row, *([] if comparison is None else [_beside(comparison, split.quantity)])])
    headings = ["quantity", "peak", "error [%]", "at [deg]"]
    headings += [splits[0].heading(name) for name in causes]
    return Table([*headings, *([] if comparison is None else [f"{short_name(_S0)} [%]"])], rows)


def angle_words(quantities: Iterable[str]) -> str:
    """What the angles are at which these quantities err most.

    >>> angle_words(["side thrust"])
    'cycle angle of the cylinder'
    """
    engine = any(not OBSERVABLES[name].per_cylinder for name in quantities)
    return "cycle angle of the cylinder" + (
        ", of the main bearing the crank angle" if engine else ""
    )


def exact_words(splits: Sequence[Split]) -> str:
    """The quantities that `budget_table` leaves out, in a sentence; empty where there are none."""
    exact = [split.quantity for split in splits if _right(split)]
    return f"right within {_LEAST} %: {', '.join(exact)}" if exact else ""


def advice(budget: Budget) -> str:
    """What lessens the largest error most, and to what, in a sentence."""
    worst = budget.ranked[0]
    error = worst.share(worst.total)
    whose = f"the {worst.quantity}" + ("" if worst.is_lecture else f" by {worst.reference}")
    if math.isnan(error):
        return f"the run has no {worst.quantity}, the formula has: take the closed form"
    if error < _GOOD:
        return f"the formulas can be used here: none is off by more than {digits(error, most=2)} %"
    cures = [cause for cause in worst.causes if cause.name in _REMEDIES]
    best = min(cures, key=worst.without, default=None)
    if best is None or worst.without(best) > _HELPS * error:
        changes = any(
            cause.name == "constant speed" and abs(worst.share(cause)) >= _LEAST
            for cause in worst.causes
        )
        at_speed = " at the crank's own speed and acceleration" if changes else ""
        return (
            f"no single refinement removes {whose}, which is off by {digits(error, most=3)} %: "
            f"take the closed form{at_speed}"
        )
    left = worst.without(best)
    of_user = best.name == "series" and not worst.is_lecture
    remedy = "the exact formula in its place" if of_user else _REMEDIES[best.name]
    to = f"{digits(left, most=2)} %" if left >= _LEAST else "nothing"
    return f"with {remedy} the error of {whose} falls from {digits(error, most=3)} % to {to}"


def comparison_table(comparison: Comparison) -> Table:
    """The largest difference of each reference from the run; where that of the last one is."""
    references = comparison.references
    rows = []
    for quantity in comparison.simulated:
        compared = {row.reference: row for row in comparison.rows if row.quantity == quantity}
        peak = next(iter(compared.values())).peak
        last = list(compared.values())[-1]
        shares = (
            digits(percent(compared[name].size.largest, peak), most=3) if name in compared else ""
            for name in references
        )
        angle = f"{math.degrees(last.size.angle):.0f}"
        rows.append([*_with_peak(quantity, peak), *shares, angle])
    names = map(short_name, references)
    headings = ["quantity", "peak", *(f"{name} [%]" for name in names), "at [deg]"]
    return Table(headings, rows)


def number_table(comparison: Comparison) -> Table:
    """The formulas that stand for one number of the run, beside it."""
    rows = []
    for row in comparison.numbers:
        scale = displayed(row.units)[0]
        rows.append(
            [
                with_unit(f"{row.quantity} by {row.reference}", row.units),
                digits(row.value / scale),
                digits(row.simulated.value / scale),
                error_digits(row.simulated.error / scale),
                digits(row.percent, most=3),
            ]
        )
    headings = ["single numbers", "formula", "run", "num. error", "formula minus run [%]"]
    return Table(headings, rows)


def worst_variable(result: Result) -> str:
    """The variable of a run whose relative error is the largest, in words."""
    data = result.data
    names = [name for name in EVERY if name in data and "error_estimate" in data[name].attrs]
    peaks = {name: peak(result.sampled(name)) for name in names}
    errors = {name: float(data[name].attrs["error_estimate"]) for name in names}
    angle = result.sampled("crank_angle")
    relative = relative_errors(peaks, errors, peak(angle - angle[0]))
    return max(relative, key=relative.__getitem__).replace("_", " ")


def left_out_lines(entries: Sequence[LeftOut]) -> list[str]:
    """One line for each reason, naming its quantities."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for entry in dict.fromkeys(entries):
        grouped.setdefault((entry.what, entry.reason), []).append(entry.quantity)
    return [
        f"left out{f' of {what!r}' if what else ''}: {', '.join(quantities)}: {reason}"
        for (what, reason), quantities in grouped.items()
    ]


def _right(split: Split) -> bool:
    return split.share(split.total) < _LEAST


def _with_peak(quantity: str, peak: float) -> list[str]:
    """A quantity with its unit, and the peak in it."""
    units = OBSERVABLES[quantity].units
    return [with_unit(quantity, units), digits(peak / displayed(units)[0], most=4)]


def _beside(comparison: Comparison, quantity: str) -> str:
    row = comparison.row(quantity, _S0)
    return f"{percent(row.size.largest, row.peak):.2f}"


def _signed(share: float) -> str:
    """To two decimals, so that causes are seen to add up."""
    if not math.isfinite(share):
        return "-"
    return f"{share:+.2f}" if abs(share) >= _LEAST else "0"
