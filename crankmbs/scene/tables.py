"""Tables of two columns, or of one for each cylinder: frozen records, and their CSV reader."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from crankmbs.errors import InputError, shown
from crankmbs.scene.content import content_of

__all__ = [
    "CylinderTable",
    "Header",
    "Table",
    "check_abscissae",
    "headings",
    "read_columns",
    "read_table",
    "undumped",
]

_LARGEST = 1e15  # a number in a table: beyond it nothing is a unit any more


class Header(NamedTuple):
    """Headings of a table's two columns, and the factors that bring them to SI.

    y_names : of several columns of ordinates; left out, numbered
    """

    x_name: str
    x_factor: float
    y_name: str
    y_factor: float
    y_names: tuple[str, ...] = ()

    @property
    def units(self) -> tuple[dict[str, float], dict[str, float]]:
        """Heading -> factor, of either column."""
        return {self.x_name: self.x_factor}, {self.y_name: self.y_factor}


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


def check_abscissae(table: Table, abscissae: str, *, jumps: bool) -> None:
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


def undumped(value: dict[str, Any]) -> Table | CylinderTable:
    """The table that a saved scene holds by its fields.

    >>> undumped({"x": [0.0], "y": [[5.0], [7.0]]}).y
    ((5.0,), (7.0,))
    """
    several = any(isinstance(each, list | tuple) for each in value.get("y", ()))
    return CylinderTable(**value) if several else Table(**value)


def read_table(path: Path, x_units: dict[str, float], y_units: dict[str, float]) -> Table:
    """Read two columns of a CSV file into SI units.

    Parameters
    ----------
    path : the file; lines that start with ``#`` are comments, other columns are ignored
    x_units, y_units : accepted column name -> factor to SI; exactly one of each must be there, but
        where x_units names two quantities, as time_s and crank_angle_deg, the first is read

    Raises
    ------
    InputError : file missing or unreadable, header wrong, a cell empty or no finite number
    """
    rows = _rows(path)
    header = rows[0][1]
    names = [name for name in x_units if name in header]
    quantities = {name.rpartition("_")[0] for name in names}
    several = len(quantities) == len(names) > 1
    given = {names[0]: x_units[names[0]]} if several else x_units
    x, y = _values(path, rows, [_column(path, header, given), _column(path, header, y_units)])
    return Table(x, y, source=str(path))


def headings(path: Path) -> list[str]:
    """The names of the columns of a CSV file.

    Raises
    ------
    InputError : file missing or unreadable
    """
    return _rows(path)[0][1]


def read_columns(
    path: Path, x_units: dict[str, float], y_units: dict[str, float]
) -> Table | CylinderTable:
    """Read a CSV file as `read_table` does, or one with a numbered column for each cylinder.

    y_units : accepted column name -> factor to SI; numbered, _1, _2, ... is put behind the name

    Raises
    ------
    InputError : as `read_table` does, or numbers that do not go from 1 up
    """
    rows = _rows(path)
    header = rows[0][1]
    numbered = [
        (int(match[2]), header.index(name), y_units[match[1]])
        for name in header
        if (match := _NUMBERED.fullmatch(name)) and match[1] in y_units
    ]
    if not numbered or any(name in y_units for name in header):
        return read_table(path, x_units, y_units)
    numbered.sort()
    numbers = [number for number, _, _ in numbered]
    if numbers != list(range(1, len(numbers) + 1)):
        raise InputError(
            f"file {path}: the columns of the cylinders must be numbered from 1 up, each once; "
            f"{', '.join(map(str, numbers))} came"
        )
    y = [(column, factor) for _, column, factor in numbered]
    x, *columns = _values(path, rows, [_column(path, header, x_units), *y])
    return CylinderTable(x, tuple(columns), source=str(path))


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


def _column(path: Path, header: list[str], units: dict[str, float]) -> tuple[int, float]:
    names = [name for name in header if name in units]
    if len(names) != 1:
        raise InputError(
            f"file {path}: the header must name exactly one column {' | '.join(units)}, with "
            f"commas between the columns; {shown(','.join(header))} came"
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
