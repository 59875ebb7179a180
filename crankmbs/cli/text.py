"""Tables as plain ASCII text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from crankmbs.digits import digits, error_digits

if TYPE_CHECKING:
    from crankmbs.measures import Estimate

__all__ = ["cells", "table", "with_unit"]


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns two blanks apart; the first flush left, the others flush right."""
    lines = [headings, *rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(headings))]
    rule = ["-" * width for width in widths]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in (headings, rule, *rows)
    )


def cells(one: Estimate) -> list[str]:
    """A value to the digits that its error leaves, and the error."""
    return [digits(*one), error_digits(one.error)]


def with_unit(name: str, units: str) -> str:
    """A name as a heading, its unit in brackets where it has one."""
    return f"{name} [{units}]" if units else name
