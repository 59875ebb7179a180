"""What separates the cells of a text, which sign its decimals have, and what stands for nothing."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from typing import NamedTuple

__all__ = ["MISSING", "Dialect", "find_dialect", "is_number", "is_row", "named", "split"]

MISSING = frozenset(
    ["", "-", "--", "---", "nan", "na", "n/a", "#n/a", "null", "none", "-9999", "-9999.0", "-99999"]
)
_NUMBER = {
    ".": re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"),
    ",": re.compile(r"[+-]?(?:[0-9]+,?[0-9]*|,[0-9]+)(?:[eE][+-]?[0-9]+)?"),
}
_SEPARATORS = (";", "\t", ",", "|", " ")
_NAMED = {";": "semicolon", "\t": "tab", ",": "comma", "|": "bar", " ": "blank"}


class Dialect(NamedTuple):
    """separator: one sign, or a blank for any run of blanks; decimal: a point or a comma."""

    separator: str
    decimal: str


def named(separator: str) -> str:
    """A separator's name, as a sentence says it."""
    return _NAMED.get(separator, repr(separator))


def split(line: str, separator: str) -> list[str]:
    """The cells of a line, in quotes or not.

    >>> split('0,5;"1,02"', ";")
    ['0,5', '1,02']
    """
    if separator == " ":
        return line.replace('"', "").split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    rows = csv.reader([line], delimiter=separator, skipinitialspace=True)
    return [cell.strip() for cell in next(rows)]


def is_number(cell: str, decimal: str) -> bool:
    """Whether a cell is a number with this decimal sign.

    >>> is_number("1,5", ","), is_number("1,5", ".")
    (True, False)
    """
    return _NUMBER[decimal].fullmatch(cell) is not None


def is_row(cells: Sequence[str], decimal: str, least: int = 2) -> bool:
    """Whether the cells are numbers, or stand for missing ones; so many at least are numbers."""
    numbers = 0
    for cell in cells:
        if is_number(cell, decimal):
            numbers += 1
        elif cell.lower() not in MISSING:
            return False
    return numbers >= least


def find_dialect(
    lines: Sequence[str],
    separator: str | None = None,
    decimal: str | None = None,
    least: int = 2,
) -> Dialect | None:
    """The dialect in which most lines are rows of numbers, of equals that of more cells.

    separator, decimal : what is known already; least : numbers of a row; None where no line is one

    >>> find_dialect(["angle;p", "0,5;1,02", "1;1,03"])
    Dialect(separator=';', decimal=',')
    """
    best, dialect = (0, 0), None
    for sign in _SEPARATORS if separator is None else (separator,):
        for point in (".", ",") if decimal is None else (decimal,):
            rows = [split(line, sign) for line in lines]
            good = [cells for cells in rows if is_row(cells, point, least)]
            if separator is None and sign == point == ",":  # in quotes alone it is both
                good = [cells for cells in good if any("," in cell for cell in cells)]
            score = (len(good), min(map(len, good), default=0))
            if score > best:
                best, dialect = score, Dialect(sign, point)
    return dialect
