"""Tables as plain ASCII text."""

from __future__ import annotations

from collections.abc import Sequence

from crankmbs.digits import digits, error_digits
from crankmbs.display import displayed

__all__ = ["cells", "heading", "table"]


def heading(name: str, title: str) -> str:
    """The first line of a report: the scene's name, and its title if it has one."""
    return f"{name}: {title}" if title else name


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


def cells(estimate: tuple[float, float], units: str = "1", per: str = "1") -> list[str]:
    """A value with its error, to the digits that this leaves, and the error, in the units that
    people read.

    units, per : SI, of the value, or of it and what it is divided by
    """
    scale = displayed(units)[0] / displayed(per)[0]
    value, error = (part / scale for part in estimate)
    return [digits(value, error), error_digits(error)]
