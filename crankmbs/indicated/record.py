"""The axis: rows and columns of a sheet to cycles of each cylinder over one period.

Cycles stand in columns, in rows under a heading of angles, or one after the other; the resolution
may change within the cycle, but alike in every one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crankmbs.delimited import Sheet
from crankmbs.delimited.dialect import is_number
from crankmbs.errors import InputError, UndecidedError
from crankmbs.indicated.channels import (
    Column,
    angle_column,
    columns_of,
    refuse_unit,
    several_words,
)
from crankmbs.indicated.options import Options
from crankmbs.indicated.rotation import Rotation
from crankmbs.numerics.arrays import Array, Index
from crankmbs.scene.headings import PRESSURE_UNITS, Heading, angle_factor
from crankmbs.scene.units import BAR

__all__ = ["Channel", "Record", "record_of"]

_FEWEST = 90  # columns from which a row of rising numbers may be the crank angle
_NEAR = 1e-6  # degrees: two angles of the axis closer than this are one
_ALIKE = 1e-3  # degrees: a row this near an angle of the other cycles is at it
_ASIDE = 3  # steps on either side of one
_WIDEST = 4.5  # times as wide as those: more than the three rows that a gap of cells may have
_STROKES = "stroke=4 with the whole cycle of 720 degrees", "stroke=2"


class Channel(NamedTuple):
    """One pressure: values of shape (cycles, n) [Pa], as they came but for the unit; NaN where a
    cell is missing, and in all of a cycle without some of its rows."""

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
    remarks : what was made of the rows, in sentences
    rotation : the crank's turning, of a record over time
    """

    angle: Array
    stroke: int
    channels: tuple[Channel, ...]
    consecutive: bool
    remarks: list[str]
    rotation: Rotation | None = None

    @property
    def period(self) -> float:
        """Degrees."""
        return 180.0 * self.stroke


def record_of(
    sheet: Sheet, headings: Sequence[Heading], options: Options, stroke: int | None
) -> Record:
    """Find the crank angle and the pressures in a sheet.

    stroke : 2 or 4 where it is known

    Raises
    ------
    InputError : no angle, no pressures, angles that do not follow one another, half a cycle
    UndecidedError : what may be read in two ways
    """
    stroke = options.stroke or stroke
    across = _angles_across(sheet)
    if across is not None:
        return _across(sheet, options, stroke, across)
    width = len(headings)
    nameless = not any(heading.name or heading.unit for heading in headings)
    if nameless and _is_axis(sheet.values[:, 0]):
        headings = tuple(Heading(f"PCYL{k}" if k else "CA", "") for k in range(width))
    at = angle_column(headings, options.angle)
    columns = columns_of(headings, options, at)
    angle = np.degrees(sheet.values[:, at] * angle_factor(headings[at]))
    missing = np.flatnonzero(np.isnan(angle))
    if len(missing):
        raise InputError(
            f"{sheet.line(missing[0])}: the crank angle is missing; complete the row, or cut it off"
        )
    record = _over_angle(sheet, angle, columns, stroke)
    if nameless:
        others = f", the others as PCYL1 to PCYL{width - 1}" if width > 2 else ""
        first = f"no column has a name: the first is read as the crank angle{others}"
        record.remarks.insert(0, first)
    if options.angle is None:
        record.remarks.extend(several_words(headings, at, time=False))
    return record


def _over_angle(
    sheet: Sheet, angle: Array, columns: Sequence[Column], stroke: int | None
) -> Record:
    """Rows over the crank angle, one cycle or one after the other."""
    begins, grid, period, remarks = _cycles_of(sheet, angle, stroke)
    whole = begins >= 0
    closing = len(grid) > 2 and abs(grid[-1] - grid[0] - period) < _NEAR
    count = len(grid) - closing
    _check_steps(sheet, grid[:count], begins[whole][0], period)
    grouped: dict[tuple[str, int], list[Column]] = {}
    for column in columns:
        grouped.setdefault((column.kind, column.cylinder), []).append(column)
    rows = np.add.outer(begins, np.arange(len(grid)))
    channels, apart = [], 0.0
    for (kind, cylinder), alike in grouped.items():
        values = np.concatenate(
            [
                np.where(whole[:, None], sheet.values[rows, each.place] * each.factor, np.nan)
                for each in alike
            ]
        )
        if closing:
            apart = max(apart, np.nanmax(np.abs(values[:, -1] - values[:, 0])))
        first, *_, last = [each.name or f"column {each.place + 1}" for each in (alike[0], *alike)]
        name = first if len(alike) == 1 else f"{first} to {last}"
        channels.append(Channel(name, kind, cylinder, values[:, :count], alike[0].reference))
    if closing:
        remarks.append(
            f"the closing rows, {period:g} degrees after the first, are dropped; they lie up "
            f"to {apart / BAR:.3g} bar from it"
        )
    consecutive = len(begins) > 1 or len(grouped) < len(columns)
    return Record(grid[:count], round(period / 180.0), tuple(channels), consecutive, remarks)


def _cycles_of(
    sheet: Sheet, angle: Array, stroke: int | None
) -> tuple[Index, Array, float, list[str]]:
    """First rows of the cycles, -1 of one without some of its rows; the angles of a whole one and
    the period [deg]; and what is left out."""
    steps = np.diff(angle)
    if len(angle) > 2 and np.all(steps < 0.0):
        raise InputError(
            f"{sheet.line(0)}: the crank angle falls from row to row, and it must rise; turn the "
            "rows round, or the sign of the angle"
        )
    equal = np.flatnonzero(steps == 0.0)
    if len(equal):
        raise InputError(
            f"{sheet.line(equal[0] + 1)}: the crank angle {angle[equal[0]]:g} comes twice, and "
            "it must rise; drop one of the rows"
        )
    if np.any(steps < 0.0):  # the angle begins again with every cycle
        _check_drops(sheet, angle, np.flatnonzero(steps < 0.0) + 1)
        begins, grid, remarks = _in_cycles(sheet, angle, np.cumsum(np.append(0, steps < 0.0)))
        return begins, grid, _period_of(grid, stroke), remarks
    period = 180.0 * stroke if stroke else 720.0
    span = float(angle[-1] - angle[0])
    if span <= period + 1.5 * float(np.median(steps)):
        return np.array([0]), angle, _period_of(angle, stroke), []
    number = ((angle - angle[0] + _ALIKE) // period).astype(np.intp)
    begins, grid, remarks = _in_cycles(sheet, angle - period * number, number)
    if stroke is None:
        remarks.insert(0, f"{span:.6g} degrees in one piece are read as cycles of 720 degrees")
    return begins, grid, period, remarks


def _in_cycles(sheet: Sheet, angle: Array, number: Index) -> tuple[Index, Array, list[str]]:
    """First rows of the cycles, -1 of one without some of its rows; the angles [deg] of a whole
    one, which is as long as most rows have it; and what is left out.

    angle : shape (n,) [deg], alike in every cycle; number : shape (n,), of the cycle, from 0

    Raises
    ------
    InputError : a row at an angle that a whole cycle does not have
    """
    starts = np.searchsorted(number, np.arange(number[-1] + 1))
    lengths = np.diff(starts, append=len(angle))
    having = np.bincount(lengths) * np.arange(max(lengths) + 1)
    length = int(np.flatnonzero(having == max(having))[-1])
    grid = angle[starts[np.argmax(lengths == length)] :][:length]
    begins: list[int] = []
    remarks, lacking, last = [], [], len(starts) - 1
    for k, (at, rows) in enumerate(zip(starts.tolist(), lengths.tolist(), strict=True)):
        cycle, count = angle[at : at + rows], len(begins) + 1
        place = np.minimum(np.searchsorted(grid, cycle - _ALIKE), length - 1)
        wrong = np.abs(cycle - grid[place]) > _ALIKE
        if np.any(wrong):
            row = int(np.argmax(wrong))
            raise InputError(
                f"{sheet.line(at + row)}: cycle {count} is not at the angles of the others, "
                f"{cycle[row]:g} degrees came; resample the cycles to the same angles, or check "
                "stroke"
            )
        if k == 0 and place[0] == length - rows > 0:
            remarks.append(f"the file begins within a cycle: {rows} rows of it are left out")
        elif k == last and place[-1] == rows - 1 < length - 1:
            if rows > 1:  # a single one closes the cycle before
                remarks.append(f"the file ends within a cycle: {rows} rows of it are left out")
        else:
            begins.append(at if rows == length else -1)
            if rows < length:
                first = int(np.argmax(np.append(place, length) != np.arange(rows + 1)))
                lacking.append(
                    f"{length - rows} of the {length} of cycle {count}, from {grid[first]:g} "
                    f"degrees ({sheet.line(at + first)})"
                )
    if lacking:
        listed = "; ".join(lacking[:10]) + ("; ..." if len(lacking) > 10 else "")
        remarks.append(f"rows are missing in {len(lacking)} of {len(begins)} cycles: {listed}")
    return np.array(begins), grid, remarks


def _check_steps(sheet: Sheet, grid: Array, first: int, period: float) -> None:
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
            f"{sheet.line(first + k)}: from {grid[k]:g} degrees the next row is "
            f"{steps[k]:g} degrees on, where others are {usual[k]:g} degrees apart: rows are "
            "missing; export the cycle with all of them"
        )


def _check_drops(sheet: Sheet, angle: Array, drops: Index) -> None:
    """Refuse an angle that goes back by less than a cycle."""
    low, high = float(np.min(angle)), float(np.max(angle))
    short = [d for d in drops if angle[d - 1] - angle[d] < 0.4 * (high - low)]
    if short:
        d = short[0]
        raise InputError(
            f"{sheet.line(d)}: the crank angle goes from {angle[d - 1]:g} back to {angle[d]:g} "
            "degrees, and it must rise to the end of the cycle; export the rows in order"
        )


def _period_of(grid: Array, known: int | None) -> float:
    """The period that one pass of angles is: of two strokes or of four, where that is known."""
    span = float(grid[-1] - grid[0])
    for stroke in (4, 2):
        missing = 180.0 * stroke - span
        whole = -_NEAR < missing <= 2.0 * np.max(np.diff(grid), initial=0.0) + _NEAR
        if not whole or known not in (None, stroke):
            continue
        if stroke == 2 and known is None:
            raise UndecidedError(
                f"a cycle spans {span:g} degrees, which is the whole cycle of a two-stroke engine "
                "or half of a four-stroke one's",
                _STROKES,
            )
        return 180.0 * stroke
    way_out = "export the whole cycle, gas exchange included"
    if known == 4 and 0.0 <= 360.0 - span <= 2.0 * np.max(np.diff(grid), initial=0.0) + _NEAR:
        if grid[0] >= 0.0:
            way_out = "an angle must not begin again after a revolution, but go on to 720"
        way_out += "; stroke=2 is for a two-stroke engine"
    rule = f"{180 * known:g}" if known else "360 or 720"
    raise InputError(
        f"the rows span {span:g} degrees from {grid[0]:g} to {grid[-1]:g}, and a cycle has {rule}; "
        f"{way_out}"
    )


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
    refuse_unit([Heading("pressure", each) for each in units[-1:]], options.unit)
    unit = units[-1] if units else options.unit
    if unit is None:
        raise UndecidedError(
            "the pressures, one cycle a row, have no unit",
            ('unit="bar"', "another of kPa, Pa, MPa, psi"),
        )
    column = Column(0, "pressure", PRESSURE_UNITS[unit], "cycle", 1)
    values = sheet.values[row:, first:]
    upright = sheet._replace(values=values.reshape(-1, 1))
    tiled = np.tile(angle, len(values))
    record = _over_angle(upright, tiled, [column], stroke)
    record.remarks.insert(0, f"{len(values)} cycles in rows, {len(angle)} angles in columns")
    return record
