"""What a slide of a comparison says first, with its number, and what it says below that."""

from __future__ import annotations

import math
from collections.abc import Sequence

from crankmbs.compare import (
    CLOSED_FORM,
    LECTURES,
    OBSERVABLES,
    Deviation,
    Split,
    percent,
    short_name,
)
from crankmbs.digits import digits

__all__ = ["budget_headline", "comparison_headline"]

_FORMULA = "the formula"  # its label would leave no room for the number


def comparison_headline(rows: Sequence[Deviation], *, independent: bool) -> tuple[str, str]:
    """The largest error of a lecture or of a user's formula; how exact the run is, if it computes
    its forces itself.

    rows : the quantities of the slide against every reference
    """
    lectures = [row for row in rows if row.reference != CLOSED_FORM] or rows
    row = max(lectures, key=lambda each: _weight(_share(each)))
    lecture = row.reference in (CLOSED_FORM, *LECTURES)
    name = short_name(row.reference) if lecture else _FORMULA
    if math.isnan(_share(row)):
        size = f"{digits(row.size.largest, most=3)} {OBSERVABLES[row.quantity].units}"
        return f"{row.quantity.capitalize()}: the run has none, {name} up to {size}", ""
    first = f"{row.quantity.capitalize()}: error of {name} up to {_percent(_share(row))}"
    second = _where(row.size.angle) + ("" if lecture else f": {row.reference}")
    shares = [_share(each) for each in rows if each.reference == CLOSED_FORM]
    if independent and not any(map(math.isnan, shares)):
        second += f"; the run is within {digits(max(shares), most=2)} % of the closed form"
    return first, second


def budget_headline(splits: Sequence[Split]) -> tuple[str, str]:
    """The formula's largest error, and the cause that is worth most."""
    split = max(splits, key=lambda each: _weight(each.share(each.total)))
    share, quantity = split.share(split.total), split.quantity.capitalize()
    formula = short_name(split.reference) if split.is_lecture else _FORMULA
    if math.isnan(share):
        return f"{quantity}: the run has none, {formula} has", ""
    if share == 0.0:
        return f"{quantity}: no error of {formula} but for rounding", ""
    cause = max(split.causes, key=split.share)
    worth = f"{split.named(cause)} costs up to {_percent(split.share(cause))}"
    first = f"{quantity}: error of {formula} up to {_percent(share)}"
    return first, f"{_where(split.total.size.angle)}; {worth}"


def _share(row: Deviation) -> float:
    return percent(row.size.largest, row.peak)


def _weight(share: float) -> float:
    """What has no peak to compare with comes first."""
    return math.inf if math.isnan(share) else share


def _percent(share: float) -> str:
    return f"{digits(share, most=3)} %"


def _where(angle: float) -> str:
    return f"of the peak, at {math.degrees(angle):.0f} degrees"
