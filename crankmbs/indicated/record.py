"""The axis: rows and columns of a sheet to cycles of each cylinder over one period.

Cycles stand in columns, in rows under a heading of angles, or one after the other; the resolution
may change within the cycle, but alike in every one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from crankmbs.delimited import Sheet
from crankmbs.delimited.dialect import is_number
from crankmbs.errors import InputError, UndecidedError
from crankmbs.indicated.channels import Column, angle_column, columns_of
from crankmbs.indicated.options import Options
from crankmbs.indicated.rotation import Rotation
from crankmbs.numerics.arrays import Array
from crankmbs.scene.headings import PRESSURE_UNITS, Heading, angle_factor, headings_of
from crankmbs.scene.units import BAR

__all__ = ["Channel", "Record", "record_of"]

_FEWEST = 90  # columns from which a row of rising numbers may be the crank angle
_NEAR = 1e-6  # degrees: two angles of the axis closer than this are one
_ASIDE = 3  # steps on either side of one
_WIDEST = 4.5  # times as wide as those: more than the three rows that a gap of cells may have
_STROKES = "stroke=4 with the whole cycle of 720 degrees", "stroke=2"


class Channel(NamedTuple):
    """One pressure: values of shape (cycles, n) [Pa], as they came but for the unit."""

    name: str
    kind: str
    cylinder: int
    values: Array
    reference: str


@dataclass(frozen=True, eq=False)
class Record:
    """What a file holds over one period.

    angle : shape (n,) [deg], the file's, rising, less than a period from first to last
    consecutive : whether a cycle begins where the one before ends
    said : what was made of the rows, in sentences
    rotation : the crank's turning, of a record over time
    """

    angle: Array
    stroke: int
    channels: tuple[Channel, ...]
    consecutive: bool
    said: list[str] = field(default_factory=list)
    rotation: Rotation | None = None

    @property
    def period(self) -> float:
        """Degrees."""
        return 180.0 * self.stroke


def record_of(sheet: Sheet, options: Options, stroke: int | None) -> Record:
    """Find the crank angle and the pressures in a sheet.

    stroke : 2 or 4 where it is known

    Raises
    ------
    InputError : no angle, no pressures, angles that do not follow one another, half a cycle
    UndecidedError : what may be read in two ways
    """
    across = _angles_across(sheet)
    if across is not None:
        return _across(sheet, options, stroke, across)
    width = sheet.values.shape[1]
    where = f"file {sheet.name}"
    headings = headings_of(sheet.above, width)
    nameless = not any(heading.name or heading.unit for heading in headings)
    if nameless and _is_axis(sheet.values[:, 0]):
        headings = tuple(Heading(f"PCYL{k}" if k else "CA", "") for k in range(width))
    at = angle_column(headings, where)
    columns = columns_of(headings, options, where, at)
    angle = np.degrees(sheet.values[:, at] * angle_factor(headings[at]))
    missing = np.flatnonzero(np.isnan(angle))
    if len(missing):
        raise InputError(
            f"file {sheet.name}, line {sheet.first + missing[0]}: the crank angle is missing; "
            "complete the row, or cut it off"
        )
    record = _Axis(sheet, angle, columns, options.stroke or stroke).record()
    if nameless:
        others = f", the others as PCYL1 to PCYL{width - 1}" if width > 2 else ""
        record.said.insert(0, f"no column has a name: the first is read as the crank angle{others}")
    return record


class _Axis:
    """Rows over the crank angle, one cycle or one after the other."""

    def __init__(
        self, sheet: Sheet, angle: Array, columns: Sequence[Column], stroke: int | None
    ) -> None:
        self._sheet, self._angle, self._columns, self._stroke = sheet, angle, columns, stroke
        self._said: list[str] = []

    def record(self) -> Record:
        begins, length, period = self._cut()
        grid = self._angle[begins[0] : begins[0] + length]
        closing = len(grid) > 2 and abs(grid[-1] - grid[0] - period) < _NEAR
        count = length - closing
        self._check_steps(grid[:count], begins[0], period)
        grouped: dict[tuple[str, int], list[Column]] = {}
        for column in self._columns:
            grouped.setdefault((column.kind, column.cylinder), []).append(column)
        channels, apart = [], 0.0
        for (kind, cylinder), columns in grouped.items():
            values = np.concatenate([self._cycles(each, begins, count) for each in columns])
            if closing:
                ends = [self._cycles(each, begins, length) for each in columns]
                gaps = [np.nanmax(np.abs(each[:, -1] - each[:, 0])) for each in ends]
                apart = max([apart, *gaps])
            name = columns[0].name
            if len(columns) > 1:
                name = f"{name} to {columns[-1].name}"
            channels.append(Channel(name, kind, cylinder, values, columns[0].reference))
        if closing:
            self._said.append(
                f"the closing rows, {period:g} degrees after the first, are dropped; they lie up "
                f"to {apart / BAR:.3g} bar from it"
            )
        apart_in_columns = any(len(columns) > 1 for columns in grouped.values())
        consecutive = len(begins) > 1 or apart_in_columns
        stroke = round(period / 180.0)
        return Record(grid[:count].copy(), stroke, tuple(channels), consecutive, self._said)

    def _cycles(self, column: Column, begins: Sequence[int], length: int) -> Array:
        values = self._sheet.values[:, column.place]
        return np.array([values[k : k + length] for k in begins]) * column.factor

    def _cut(self) -> tuple[list[int], int, float]:
        """First rows of the cycles, their rows, and the period [deg]."""
        angle = self._angle
        steps = np.diff(angle)
        if len(angle) > 2 and np.all(steps < 0.0):
            raise InputError(
                f"{self._at(0)}: the crank angle falls from row to row, and it must rise; turn "
                "the rows round, or the sign of the angle"
            )
        drops = np.flatnonzero(steps < 0.0) + 1
        equal = np.flatnonzero(steps == 0.0)
        if len(equal):
            raise InputError(
                f"{self._at(equal[0] + 1)}: the crank angle {angle[equal[0]]:g} comes twice, and "
                "it must rise; drop one of the rows"
            )
        if len(drops):
            return self._by_drops(drops)
        return self._by_period()

    def _check_steps(self, grid: Array, first: int, period: float) -> None:
        """Refuse a cycle without some of its rows: a step much wider than those on either side. The
        resolution may change, to steps that go on.

        first : row at which the cycle begins
        """
        steps = np.diff(np.append(grid, grid[0] + period))
        if len(steps) <= 2 * _ASIDE:
            return
        aside = np.array([np.roll(steps, k) for k in range(-_ASIDE, _ASIDE + 1) if k])
        usual = np.maximum(aside[:_ASIDE].min(axis=0), aside[_ASIDE:].min(axis=0))
        wide = np.flatnonzero(steps > _WIDEST * usual)
        if len(wide):
            k = wide[0]
            raise InputError(
                f"{self._at(first + int(k))}: from {grid[k]:g} degrees the next row is "
                f"{steps[k]:g} degrees on, where others are {usual[k]:g} degrees apart: rows are "
                "missing; export the cycle with all of them"
            )

    def _by_drops(self, drops: np.ndarray) -> tuple[list[int], int, float]:
        """The angle begins again with every cycle."""
        angle = self._angle
        edges = [0, *drops.tolist(), len(angle)]
        lengths = np.diff(edges)
        low, high = float(np.min(angle)), float(np.max(angle))
        short = [d for d in drops if angle[d - 1] - angle[d] < 0.4 * (high - low)]
        if short:
            d = short[0]
            raise InputError(
                f"{self._at(d)}: the crank angle goes from {angle[d - 1]:g} back to {angle[d]:g} "
                "degrees, and it must rise to the end of the cycle; export the rows in order"
            )
        length = int(np.bincount(lengths).argmax())
        whole = [k for k, each in enumerate(lengths) if each == length]
        partial = [k for k in (0, len(lengths) - 1) if lengths[k] < length]
        odd = [k for k in range(len(lengths)) if k not in whole and k not in partial]
        if odd:
            raise InputError(
                f"{self._at(edges[odd[0]])}: the cycle that begins here has {lengths[odd[0]]} rows,"
                f" the others {length}; leave it out, or export every cycle at the same angles"
            )
        begins = [edges[k] for k in whole]
        self._check_grids(begins, length, 0.0)
        for k in partial:
            place = "begins" if k == 0 else "ends"
            self._said.append(
                f"the file {place} within a cycle: {lengths[k]} rows of it are left out"
            )
        grid = angle[begins[0] : begins[0] + length]
        return begins, length, self._period_of(grid)

    def _by_period(self) -> tuple[list[int], int, float]:
        """The angle rises from the first row to the last, over one cycle or several."""
        angle = self._angle
        span = float(angle[-1] - angle[0]) if len(angle) > 1 else 0.0
        period = 180.0 * self._stroke if self._stroke else 720.0
        step = float(np.max(np.diff(angle))) if len(angle) > 1 else 0.0
        if span <= period + 1.5 * step:
            if self._stroke and abs(span + step - period) < 1.5 * step:
                return [0], len(angle), period
            return [0], len(angle), self._period_of(angle)
        if self._stroke is None:
            self._said.append(f"{span:.6g} degrees in one piece are read as cycles of 720 degrees")
        length = int(np.searchsorted(angle, angle[0] + period - _NEAR))
        begins = list(range(0, len(angle) - length + 1, length))
        self._check_grids(begins, length, period)
        left = len(angle) - begins[-1] - length
        if left > 1 or (left and abs(angle[-1] - angle[0] - len(begins) * period) > _NEAR):
            self._said.append(f"the file ends within a cycle: {left} rows of it are left out")
        return begins, length, period

    def _check_grids(self, begins: Sequence[int], length: int, period: float) -> None:
        first = self._angle[begins[0] : begins[0] + length]
        for number, k in enumerate(begins):
            off = np.abs(self._angle[k : k + length] - first - number * period)
            if np.max(off) > 1e-3:
                row = k + int(np.argmax(off > 1e-3))
                raise InputError(
                    f"{self._at(row)}: cycle {number + 1} is not at the angles of the "
                    f"first, {self._angle[row]:g} degrees came; resample the cycles to the same "
                    "angles, or check stroke"
                )

    def _period_of(self, grid: Array) -> float:
        """The period that one pass of angles is: of two strokes or of four."""
        step = np.diff(grid)
        span = float(grid[-1] - grid[0])
        for stroke in (4, 2):
            missing = 180.0 * stroke - span
            whole = -_NEAR < missing <= 2.0 * float(np.max(step)) + _NEAR
            if not whole or (self._stroke not in (None, stroke)):
                continue
            if stroke == 2 and self._stroke is None:
                raise UndecidedError(
                    f"file {self._sheet.name}: a cycle spans {span:g} degrees, which is the whole "
                    "cycle of a two-stroke engine or half of a four-stroke one's",
                    _STROKES,
                )
            return 180.0 * stroke
        rule = f"{180 * self._stroke:g}" if self._stroke else "360 or 720"
        raise InputError(
            f"file {self._sheet.name}: the rows span {span:g} degrees from {grid[0]:g} to "
            f"{grid[-1]:g}, and a cycle has {rule}; export the whole cycle, gas exchange included"
        )

    def _at(self, row: int) -> str:
        return f"file {self._sheet.name}, line {self._sheet.first + int(row)}"


def _angles_across(sheet: Sheet) -> tuple[Array, int, int] | None:
    """Crank angles in a heading or in the first row, the first column below them, and the first
    row of values; None where cycles do not stand in rows."""
    width = sheet.values.shape[1]
    if width < _FEWEST:
        return None
    decimal = sheet.dialect.decimal
    for cells in reversed(sheet.above[-3:]):
        words = sum(not is_number(cell, decimal) for cell in cells[:3])
        numbers = [cell for cell in cells[words:width] if is_number(cell, decimal)]
        if words and len(numbers) == width - words:
            angle = np.array([float(cell.replace(",", ".")) for cell in numbers])
            if _is_axis(angle):
                return angle, words, 0
    if np.isnan(sheet.values[0, 0]) and _is_axis(sheet.values[0, 1:]):
        return sheet.values[0, 1:], 1, 1
    return None


def _is_axis(angle: Array) -> bool:
    return bool(np.all(np.diff(angle) > 0.0)) and float(np.ptp(angle)) > 300.0


def _across(
    sheet: Sheet, options: Options, stroke: int | None, axis: tuple[Array, int, int]
) -> Record:
    """Cycles in rows, one after the other."""
    angle, first, row = axis
    words = [cell.strip("[]() ").lower() for cells in sheet.above for cell in cells]
    units = [word for word in words if word in PRESSURE_UNITS]
    unit = units[-1] if units else options.unit
    if unit is None:
        raise UndecidedError(
            f"file {sheet.name}: the pressures, one cycle a row, have no unit",
            ('unit="bar"', "another of kPa, Pa, MPa, psi"),
        )
    column = Column(0, "pressure", PRESSURE_UNITS[unit], "cycle", 1)
    values = sheet.values[row:, first:]
    upright = sheet._replace(values=values.reshape(-1, 1))
    tiled = np.tile(angle, len(values))
    record = _Axis(upright, tiled, [column], options.stroke or stroke).record()
    record.said.insert(0, f"{len(values)} cycles in rows, {len(angle)} angles in columns")
    return record
