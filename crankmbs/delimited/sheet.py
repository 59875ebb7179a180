"""Text to rows: where the table begins, what stands above it, and its numbers, missing ones as NaN.

Millions of rows are read by NumPy's reader; only where that cannot read a cell, cell by cell.
"""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crankmbs.delimited.dialect import (
    MISSING,
    Dialect,
    find_dialect,
    is_number,
    is_row,
    named,
    split,
)
from crankmbs.delimited.encoding import Text
from crankmbs.errors import InputError, shown
from crankmbs.numerics.arrays import Array

__all__ = ["Dialect", "Sheet", "read_sheet"]

_PROBE = 400  # lines from which the dialect is told
_LONGEST_HEAD = 2000  # lines
_ALIKE = 3  # rows of equally many cells: a table has begun
_OFF = (-9999.0, -99999.0)


class Sheet(NamedTuple):
    """What a file holds: rows of numbers, and the lines above them.

    above : the cells of every line above the numbers, line by line
    values : shape (rows, columns), NaN where a cell is missing
    first : number of the line of the first row, from 1
    """

    name: str
    above: tuple[tuple[str, ...], ...]
    values: Array
    first: int
    dialect: Dialect
    encoding: str

    def line(self, row: int) -> str:
        """The place of a row of values, counted from 0, for a sentence."""
        return f"line {self.first + row}"

    @contextmanager
    def errors(self) -> Iterator[None]:
        """Put the file before the sentence of every InputError from inside."""
        try:
            yield
        except InputError as error:
            sentence = str(error)
            mark = "," if sentence.startswith("line ") else ":"
            error.args = (f"file {self.name}{mark} {sentence}",)
            raise


def read_sheet(
    name: str,
    source: Text,
    *,
    separator: str | None = None,
    decimal: str | None = None,
    skip: int = 0,
    least: int = 2,
) -> Sheet:
    r"""Find the table in a text and read its numbers.

    Parameters
    ----------
    separator : ";", ",", "|", a tab or a blank; None: detected
    decimal : "." or ","; None: detected
    skip : lines at the beginning that are left out; least : numbers of a row

    Raises
    ------
    InputError : no rows of numbers, rows of other lengths, a cell that is no number; file, line,
        rule, what came, way out

    >>> read_sheet("a.csv", Text("CA;p\n0;1,5\n1;1,6\n", "UTF-8")).values.tolist()
    [[0.0, 1.5], [1.0, 1.6]]
    """
    head, offset = _lines(source.text, _LONGEST_HEAD + _PROBE)
    dialect = find_dialect(_probe(head[skip:]), separator, decimal, least)
    begin = None if dialect is None else _begin(head, skip, dialect, least)
    if dialect is None or begin is None:
        raise InputError(_no_rows(name, head, skip, separator, decimal))
    if least == 1 and separator is decimal is None and dialect == (",", "."):
        dialect = _single_column(name, head[skip:begin], _probe(head[begin:])) or dialect
    width = len(split(head[begin], dialect.separator))
    above = [_headings(line, dialect.separator, width) for line in head[skip:begin]]
    body = source.text[offset[begin] :]
    trailing = width > 2 and _ends_empty(head[begin], dialect) and _ends_empty_above(above, width)
    values = _numbers(name, body, dialect, begin, width - trailing)
    for missing in _OFF:
        values[values == missing] = np.nan
    return Sheet(name, tuple(above), values, begin + 1, dialect, source.encoding)


def _single_column(name: str, above: list[str], rows: list[str]) -> Dialect | None:
    """One column with decimal commas, where two of whole numbers are read: as the headings have it,
    or where the first of two does not rise as the numbers do.

    Raises
    ------
    InputError : both readings are possible
    """
    cells = [split(row, ",") for row in rows]
    if not all(len(row) == 2 and all(cell.isdigit() for cell in row) for row in cells):
        return None
    single = Dialect(";", ",")
    widths = {len(split(line, ",")) for line in _probe(above)}
    whole = [float(first) for first, _ in cells]
    values = [float(f"{first}.{second}") for first, second in cells]
    rises, both = (all(a < b for a, b in pairwise(each)) for each in (values, whole))
    if rises and both and not widths:
        raise InputError(
            f"file {name}: {shown(rows[0])} may be two columns of whole numbers or one with "
            'decimal commas; give separator="," or decimal=","'
        )
    return single if widths == {1} or (rises and not both) else None


def _headings(line: str, separator: str, width: int) -> tuple[str, ...]:
    """The cells of a line above the numbers; between blanks a name may hold single ones."""
    apart = re.split(r"\t|\s{2,}", line.strip()) if separator == " " else []
    return tuple(apart if len(apart) == width else split(line, separator))


def _lines(text: str, most: int) -> tuple[list[str], list[int]]:
    """The first lines, and where each begins."""
    lines: list[str] = []
    offsets: list[int] = []
    at = 0
    while at < len(text) and len(lines) < most:
        end = text.find("\n", at)
        end = len(text) if end < 0 else end
        lines.append(text[at:end])
        offsets.append(at)
        at = end + 1
    return lines, offsets


def _probe(lines: list[str]) -> list[str]:
    """The last lines of the head are rows, if any are."""
    written = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    return written[-_PROBE:]


def _begin(lines: list[str], skip: int, dialect: Dialect, least: int) -> int | None:
    """The index of the first of several rows of equally many cells."""
    widths = []
    for line in lines[skip:]:
        cells = split(line, dialect.separator)
        widths.append(len(cells) if is_row(cells, dialect.decimal, least) else 0)
    counted = Counter(width for width in widths if width)
    usual = max(counted, key=lambda width: (counted[width], width), default=0)
    for k, width in enumerate(widths):
        after = widths[k : k + _ALIKE]
        if width == usual > 0 and all(each == width for each in after):
            return skip + k
    return None


def _ends_empty(line: str, dialect: Dialect) -> bool:
    return split(line, dialect.separator)[-1] == ""


def _ends_empty_above(above: list[tuple[str, ...]], width: int) -> bool:
    """Whether the headings end in a separator too, so that no column is behind it."""
    return all(cells[-1] == "" for cells in above if len(cells) == width)


def _numbers(name: str, body: str, dialect: Dialect, begin: int, width: int) -> Array:
    sign, decimal = dialect
    if '"' not in body and not (sign == decimal == ","):
        text = body.replace(",", ".") if decimal == "," else body
        if sign != " ":
            text = _filled(text, sign)
        stream = io.TextIOWrapper(io.BytesIO(text.encode("utf-8")), encoding="utf-8")
        del text
        try:
            columns = range(width)
            return np.loadtxt(
                stream, delimiter=None if sign == " " else sign, comments=None, ndmin=2
            )[:, columns]
        except (ValueError, IndexError):
            pass  # cell by cell, to say where
    return np.array(list(_rows(name, body, dialect, begin, width)))


def _filled(text: str, sign: str) -> str:
    """Empty cells as nan, where there are any."""
    signs = (sign + sign, f"{sign}\n", f"\n{sign}", f"{sign} ")  # quicker than the expressions
    if not any(each in text for each in signs) and sign not in (text[:1], text[-1:]):
        return text
    sign = re.escape(sign)
    text = re.sub(rf"(?<={sign})[ ]*(?={sign}|$)", "nan", text, flags=re.MULTILINE)
    return re.sub(rf"^[ ]*(?={sign})", "nan", text, flags=re.MULTILINE)


def _rows(name: str, body: str, dialect: Dialect, begin: int, width: int) -> Iterator[list[float]]:
    sign, decimal = dialect
    for number, line in enumerate(body.split("\n"), start=begin + 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = split(line, sign)
        if len(cells) == width + 1 and cells[-1] == "":
            cells = cells[:-1]
        if len(cells) != width:
            raise InputError(
                f"file {name}, line {number}: every row must have {width} cells, as the first one "
                f"has; {len(cells)} came, {shown(line)}; export one table a file, or cut off what "
                "is no row"
            )
        yield [_value(name, number, k, cell, decimal) for k, cell in enumerate(cells)]


def _value(name: str, line: int, column: int, cell: str, decimal: str) -> float:
    if is_number(cell, decimal):
        return float(cell.replace(",", "."))
    if cell.lower() in MISSING:
        return np.nan
    raise InputError(
        f"file {name}, line {line}: cell {column + 1} must be a number with the decimal sign "
        f'"{decimal}", or empty; {shown(cell)} came; correct it, or give separator and decimal'
    )


def _no_rows(
    name: str, lines: list[str], skip: int, separator: str | None, decimal: str | None
) -> str:
    if not any(line.strip() for line in lines):
        return f"file {name} is empty: it needs headings and rows of crank angle and pressure"
    written = [line for line in lines[skip:] if line.strip()]
    last = shown(written[-1]) if written else "nothing"
    stated = f", separated by {named(separator)}s" if separator else ""
    stated += f', with the decimal sign "{decimal}"' if decimal else ""
    return (
        f"file {name}: no rows of at least two numbers{stated} were found in its first "
        f"{len(lines)} lines"
        f"{f' after the {skip} skipped' if skip else ''}; the last of them is {last}; give "
        "separator, decimal and skip, or export the table alone"
    )
