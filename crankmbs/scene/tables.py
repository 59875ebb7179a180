"""Tables of two columns, or of one for each cylinder: frozen records, and their CSV reader."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from crankmbs.errors import InputError, shown
from crankmbs.scene.content import content_of

__all__ = [
    "CylinderTable",
    "Header",
    "Table",
    "check_abscissae",
    "headings",
    "read_table",
    "tables_of",
]

_LARGEST = 1e15  # a number in a table: beyond it nothing is a unit any more


class Header(NamedTuple):
    """The columns of a table in a file, and what they hold.

    x, y : heading -> factor to SI, the one that is written first; of x the first that a file has is
        read, of y it has exactly one
    holds : the columns in words, "times [s], torques [N m]"
    ways : headings of two ordinates that may stand in place of one
    way_out : what else may be done about other headings, in words
    """

    x: dict[str, float]
    y: dict[str, float]
    holds: str = ""
    ways: tuple[str, ...] = ()
    way_out: str = ""

    @property
    def abscissae(self) -> str:
        """What the first column holds, in words."""
        return self.holds.partition(" [")[0]


@dataclass(frozen=True)
class Table:
    """Rows (x, y) in SI units; ``source`` names where they came from.

    x, y : equally long sequences of floats, kept as tuples; what they mean is said by the field
        that holds the table

    >>> Table([0.0, 1.0], [5.0, 5.0]).x
    (0.0, 1.0)
    """

    x: tuple[float, ...]
    y: tuple[float, ...]
    source: str = "table"

    def __post_init__(self) -> None:
        for name in ("x", "y"):
            try:
                column = tuple(map(float, getattr(self, name)))
            except (TypeError, ValueError):
                raise InputError(
                    f"{self.source}: {name} must be a sequence of numbers; "
                    f"{shown(getattr(self, name))} came"
                ) from None
            object.__setattr__(self, name, column)
        if len(self.x) != len(self.y):
            raise InputError(
                f"{self.source}: {len(self.x)} abscissae but {len(self.y)} ordinates; "
                "a table needs as many of one as of the other"
            )
        if not all(map(math.isfinite, self.x + self.y)):
            raise InputError(f"{self.source}: every value must be finite; a NaN or infinity came")
        largest = max(map(abs, self.x + self.y), default=0.0)
        if largest > _LARGEST:
            raise InputError(
                f"{self.source}: every value must be at most {_LARGEST:g} in size, in SI units, or "
                f"calculating with it overflows; {largest:g} came"
            )

    def scaled(self, y: float, x: float = 1.0) -> Table:
        """The table times a factor, and its abscissae times another.

        >>> Table([1.0], [5.0]).scaled(2.0).y
        (10.0,)
        """
        return Table(tuple(x * v for v in self.x), tuple(y * v for v in self.y), self.source)


def check_abscissae(table: Table | CylinderTable, abscissae: str, *, jumps: bool) -> None:
    """Refuse a table of fewer than two rows, or whose rows do not follow one another.

    what : name of its abscissae; jumps : whether two of them may be equal

    Raises
    ------
    InputError : the file, the rule, what came
    """
    x = table.x
    if len(x) < 2:
        raise InputError(f"{table.source}: the table needs at least two rows; {len(x)} came")
    for k, (a, b) in enumerate(pairwise(x)):
        third = k > 0 and x[k - 1] == a == b
        if b < a or third or (b == a and not jumps):
            rule = "not decrease (two equal ones are a jump)" if jumps else "strictly increase"
            raise InputError(f"{table.source}: {abscissae} must {rule}; row {k + 2} breaks this")


@dataclass(frozen=True)
class CylinderTable:
    """Rows with several values, as one for each cylinder; ``source`` names where they came from.

    x : shape (n,), y : shape (cylinders, n), in SI units, kept as tuples

    >>> CylinderTable([0.0, 1.0], [[5.0, 6.0], [7.0, 8.0]]).tables[1].y
    (7.0, 8.0)
    """

    x: tuple[float, ...]
    y: tuple[tuple[float, ...], ...]
    source: str = "table"

    def __post_init__(self) -> None:
        try:
            columns = tuple(self.y)
        except TypeError:
            columns = ()
        if not columns:
            raise InputError(
                f"{self.source}: y must hold a sequence of numbers for each cylinder; "
                f"{shown(self.y)} came"
            )
        object.__setattr__(self, "y", columns)
        tables = self.tables
        object.__setattr__(self, "x", tables[0].x)
        object.__setattr__(self, "y", tuple(table.y for table in tables))

    @property
    def tables(self) -> tuple[Table, ...]:
        """One table for each cylinder."""
        return tuple(
            Table(self.x, y, f"{self.source}, cylinder {number}")
            for number, y in enumerate(self.y, start=1)
        )


def tables_of(source: object) -> tuple[Table, ...]:
    """The tables of a pressure or a force: of each cylinder or way, or one of all; none where no
    rows came."""
    if isinstance(source, CylinderTable):
        return source.tables
    if isinstance(source, Table):
        return (source,)
    return source if isinstance(source, tuple) else ()


def read_table(path: Path, header: Header, *, numbered: bool = False) -> Table | CylinderTable:
    """Read columns of a CSV file into SI units: two, or of several ordinates all.

    Parameters
    ----------
    path : the file; lines that start with ``#`` are comments, other columns are ignored
    numbered : whether there may be a column for each cylinder, with _1, _2, ... behind its heading

    Raises
    ------
    InputError : file missing or unreadable, header wrong, a cell empty or no finite number;
        numbers that do not go from 1 up
    """
    rows = _rows(path)
    names = rows[0][1]
    first = next(({name: header.x[name]} for name in header.x if name in names), header.x)
    columns = [_column(path, names, first, "", header.way_out)]
    instead = f", or {' and '.join(header.ways)}" if header.ways else ""
    several = [] if set(header.y) & set(names) else _several(path, names, header, numbered)
    columns += several or [_column(path, names, header.y, instead, header.way_out)]
    x, *y = _values(path, rows, columns)
    return CylinderTable(x, tuple(y), str(path)) if several else Table(x, y[0], str(path))


def headings(path: Path) -> list[str]:
    """The names of the columns of a CSV file.

    Raises
    ------
    InputError : file missing or unreadable
    """
    return _rows(path)[0][1]


def _several(
    path: Path, names: list[str], header: Header, numbered: bool
) -> list[tuple[int, float]]:
    """Place and factor of several columns of ordinates; none where they are not there."""
    if header.ways and set(header.ways) <= set(names):
        return [(names.index(way), factor) for way in header.ways for factor in header.y.values()]
    found = sorted(
        (int(match[2]), names.index(name), header.y[match[1]])
        for name in names
        if numbered and (match := _NUMBERED.fullmatch(name)) and match[1] in header.y
    )
    numbers = [number for number, _, _ in found]
    if numbers != list(range(1, len(numbers) + 1)):
        raise InputError(
            f"file {path}: the columns of the cylinders must be numbered from 1 up, each once; "
            f"{', '.join(map(str, numbers))} came"
        )
    return [(place, factor) for _, place, factor in found]


_NUMBERED = re.compile(r"(.+)_([1-9][0-9]?)")


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Line number and cells of the header and of every row."""
    rows = [
        (number, cells)
        for number, line in enumerate(_text(path).splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
        for cells in [_cells(path, number, line)]
    ]
    if not rows:
        raise InputError(f"file {path} is empty: it needs a header and rows")
    return rows


def _values(
    path: Path, rows: list[tuple[int, list[str]]], columns: list[tuple[int, float]]
) -> list[tuple[float, ...]]:
    """The values of some columns, given by their place and factor to SI."""
    header = rows[0][1]
    values: list[list[float]] = [[] for _ in columns]
    for number, cells in rows[1:]:
        if len(cells) > len(header):
            raise InputError(
                f"file {path}, line {number}: {len(cells)} cells under a header of {len(header)}; "
                "commas separate the columns, the decimal sign is a point"
            )
        for numbers, (i, factor) in zip(values, columns, strict=True):
            numbers.append(factor * _number(path, number, header[i], cells[i : i + 1]))
    return [tuple(column) for column in values]


def _text(path: Path) -> str:
    try:
        return content_of(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(
            f"file {path} is no UTF-8 text; save the table as CSV in UTF-8; crankmbs pressure "
            "reads what an indicating system writes"
        ) from None


def _cells(path: Path, line: int, text: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([text], skipinitialspace=True))]
    except csv.Error as error:
        raise InputError(f"file {path}, line {line}: cannot be read as CSV: {error}") from None


def _column(
    path: Path, header: list[str], units: dict[str, float], instead: str, way_out: str
) -> tuple[int, float]:
    names = [name for name in header if name in units]
    if len(names) != 1:
        if not way_out and any(";" in name for name in header):
            way_out = "; write it with commas between the columns and decimal points"
        raise InputError(
            f"file {path}: the header must name exactly one column {' | '.join(units)}{instead}, "
            f"with commas between the columns; {shown(','.join(header))} came{way_out}"
        )
    return header.index(names[0]), units[names[0]]


def _number(path: Path, line: int, name: str, cells: list[str]) -> float:
    text = "".join(cells)
    try:
        value = math.nan if "_" in text else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        came = shown(text) if text else "an empty cell"
        raise InputError(f"file {path}, line {line}: {name} must be a finite number; {came} came")
    return value
