"""A record over time: the wheel gives the crank angle, the sensor the pressures, cycle by cycle."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from crankmbs.delimited import Sheet
from crankmbs.errors import InputError, UndecidedError, shown
from crankmbs.indicated.channels import is_pressure, refuse_unit, several_words
from crankmbs.indicated.options import Options
from crankmbs.indicated.record import Channel, Record
from crankmbs.indicated.rotation import Rotation, rotation_of
from crankmbs.indicated.unlikely import cut_off_words
from crankmbs.indicated.wheel import Wheel, edges, first_edges, marked_edges, tick_of
from crankmbs.numerics.arrays import Array
from crankmbs.scene.headings import PRESSURE_UNITS, TIME_UNITS, Heading, by_name, is_time, pick
from crankmbs.scene.units import BAR

__all__ = ["clock", "most_edges", "record_over_time", "time_column", "turned"]

_JUMP = 1.5  # times the usual step: a clock that jumps
_STEPS = (0.05, 0.1, 0.2, 0.25, 0.5, 1.0, 2.0)  # degrees
_FLAT = 1.0 * BAR  # a range below which nothing was compressed
_WEAK = 0.2  # of the usual range of a cycle
_SPEED = re.compile(r"\b(rpm|rad/s|deg/s)\b|([1u]/min|min\^?-1)")  # no signal of a wheel
_VOLTS = {"v": 1.0, "mv": 1e-3}


class _Columns(NamedTuple):
    pressures: list[int]
    wheel: int
    mark: int | None


def time_column(headings: Sequence[Heading], sheet: Sheet, options: Options) -> int | None:
    """The place of the time; None where the record does not stand over one.

    Without names it is the first column where a wheel is given, or where it rises evenly, and by
    too little to be an angle over a cycle.
    """
    of_unit = [k for k, heading in enumerate(headings) if is_time(heading)]
    named = by_name(headings, time=True) or of_unit
    if named or any(heading.name or heading.unit for heading in headings):
        return named[0] if named else None
    steps = np.diff(sheet.values[:, 0])
    rises = len(steps) > 1 and bool(np.all(steps > 0.0)) and steps.max() < _JUMP * steps.min()
    short = rises and np.ptp(sheet.values[:, 0]) < 300.0 and sheet.values.shape[1] > 2
    return 0 if options.wheel is not None or short else None


def record_over_time(
    sheet: Sheet,
    headings: Sequence[Heading],
    at: int,
    options: Options,
    stroke: int | None,
    *,
    geometry: bool,
) -> Record:
    """The cycles of a record over time, at even angles from the first edge after a gap.

    at : place of the time; stroke : 2 or 4 where it is known; geometry : whether the compression
        ratio is known, with which the pressure shows its dead centre and reference

    Raises
    ------
    UndecidedError : what the record needs and does not say, all of it in one sentence
    InputError : a clock that jumps, a wheel without a gap, teeth missing or doubled, less than two
        cycles, a pressure that never compresses
    """
    headings = [h._replace(name=h.name or f"column {k}") for k, h in enumerate(headings, start=1)]
    columns = _columns(sheet, headings, at, options)
    _ask(headings, columns, options, geometry=geometry)
    refuse_unit([headings[k] for k in columns.pressures], options.unit)
    assert options.wheel is not None
    time = clock(sheet, headings[at], at)
    for k in (*columns.pressures, columns.wheel):
        missing = np.flatnonzero(np.isnan(sheet.values[:, k]))
        if len(missing):
            raise InputError(
                f"{sheet.line(missing[0])}: column {shown(headings[k].name)} has no number; "
                "complete the row, or cut the record there"
            )
    marks = None if columns.mark is None else sheet.values[:, columns.mark]
    strokes = options.stroke or stroke or 4
    rotation = turned(time, sheet.values[:, columns.wheel], marks, options.wheel, strokes)
    delay = options.delay or 0.0
    begin, count, grid = _grid(rotation, time, delay)
    instants = rotation.time_at(begin + np.arange(count * len(grid)) * (grid[1] - grid[0])) + delay
    channels, cut = [], []
    for number, k in enumerate(columns.pressures, start=1):
        name, _, reference = headings[k]
        pascals = _pressure(sheet.values[:, k], headings[k], options)
        cut += cut_off_words(name, -pascals if options.invert else pascals)
        values = CubicSpline(time, pascals)(instants).reshape(count, len(grid))
        _check_compression(values, name, instants)
        channels.append(Channel(name, "cycle", number, values, reference))
    remarks = [
        f"the record is over time: {shown(headings[columns.wheel].name)} is the wheel, angles "
        f"count from its first {rotation.wheel.edge} edge "
        + ("after the gap" if columns.mark is None else "at the index"),
        *several_words(headings, at, time=True),
        *rotation.words(),
        *cut,
    ]
    if stroke is None and options.stroke is None:
        remarks.append(
            f"read as cycles of {rotation.period:g} degrees; stroke=2 is for a two-stroke engine"
        )
    if delay:
        remarks.append(f"the sensor's delay, {1e3 * delay:g} ms, is taken off its times")
    return Record(grid, strokes, tuple(channels), True, remarks, rotation)


def turned(time: Array, signal: Array, marks: Array | None, wheel: Wheel, stroke: int) -> Rotation:
    """The rotation that a wheel's signal shows; marks : the signal of an encoder's index."""
    at = edges(time, signal, falling=wheel.falling)
    if marks is None:
        first = first_edges(at, wheel)
    else:
        first = marked_edges(at, edges(time, marks, falling=wheel.falling), wheel)
    return rotation_of(at, first, wheel, stroke, tick_of(time, signal))


def clock(sheet: Sheet, heading: Heading, at: int) -> Array:
    """The times [s] of the rows.

    Raises
    ------
    InputError : one is missing, does not rise, or jumps; by its line
    """
    time = sheet.values[:, at] * TIME_UNITS.get(heading.unit, 1.0)
    steps = np.diff(time)
    usual = float(np.median(steps))
    bad = np.flatnonzero(~((steps > 0.0) & (steps < _JUMP * usual)))
    if len(bad):
        k = int(bad[0])
        raise InputError(
            f"{sheet.line(k + 1)}: the clock goes from {time[k]:.9g} to "
            f"{time[k + 1]:.9g} s, and its steps are {usual:.4g} s; export the time with more "
            "digits, or cut the record there"
        )
    return time


def most_edges(sheet: Sheet, columns: Sequence[int]) -> int:
    """Which of some columns has the most rising edges, missing cells left out."""

    def count(column: int) -> int:
        signal = sheet.values[:, column]
        present = signal[~np.isnan(signal)]
        return len(edges(np.arange(1.0 * len(present)), present)) if len(present) else 0

    return max(columns, key=count)


def _columns(sheet: Sheet, headings: Sequence[Heading], at: int, options: Options) -> _Columns:
    """Which columns are pressures, the wheel and the index: by their names, the wheel by its many
    edges."""
    index = None if options.index is None else pick(headings, options.index, "index")[0]
    rest = [k for k in range(len(headings)) if k not in (at, index)]
    if options.columns is not None:
        named = [k for k in pick(headings, options.columns, "columns") if k in rest]
    else:
        named = [k for k in rest if is_pressure(headings[k], ("", *_VOLTS))]
    others = [
        k for k in rest if k not in named and not _SPEED.search(" ".join(headings[k][:2]).lower())
    ]
    if not others:
        listed = ", ".join(shown(heading.name) for heading in headings)
        raise InputError(
            f"the record is over time, and no column is left for the signal of a "
            f"wheel; the columns are {listed}; record the wheel beside the pressure, or export the "
            "pressures over the crank angle"
        )
    wheel = most_edges(sheet, others)
    pressures = named or [k for k in others if k != wheel]
    if not pressures or (not named and len(pressures) > 1):
        ways = [f'columns="{headings[k].name}"' for k in others if k != wheel]
        raise UndecidedError(
            f"column {shown(headings[wheel].name)} has the edges of a wheel, and which "
            "of the others are pressures is not said",
            tuple(ways[:3]) or ("a record with a pressure",),
        )
    return _Columns(pressures, wheel, index)


def _ask(
    headings: Sequence[Heading],
    columns: _Columns,
    options: Options,
    *,
    geometry: bool,
) -> None:
    """Ask at once for all that a record over time needs and does not say."""
    bare = [headings[k] for k in columns.pressures if headings[k].pressure is None]
    volts = any(each.unit in _VOLTS for each in bare)
    known = options.sensor is not None or (options.unit is not None and not volts)
    needs = []
    if options.wheel is None:
        needs.append(
            f'wheel="60-2", the teeth of column {shown(headings[columns.wheel].name)} less the '
            'missing ones ("60-2 falling" where its falling edges count)'
        )
    if bare and not known:
        needs.append(
            f"for the volts of column {shown(bare[0].name)} a formula such as "
            'sensor="(V/5 - 0.115)/0.00385 bar", or two points such as '
            'sensor="0.5 V = 0 bar, 4.5 V = 100 bar"'
        )
    if not needs:
        return
    unsaid = any(not headings[k].reference for k in columns.pressures)
    if options.reference is None and unsaid and not geometry:
        needs.append('reference="absolute" ("gauge 1 bar", "inlet 1 bar")')
    if options.firing_tdc is None and not geometry:
        needs.append(
            'firing_tdc="25 deg", by which a dead centre follows the first edge after the gap, or '
            "a scene and compression_ratio, with which the pressure shows it"
        )
    *most, last = needs
    raise UndecidedError(
        "the record is over time, and some of what it needs is not said",
        ("; ".join([*most, f"and {last}"]) if most else last,),
    )


def _grid(rotation: Rotation, time: Array, delay: float) -> tuple[float, int, Array]:
    """Where the first cycle begins [deg], how many are recorded, and the even angles of a cycle:
    about as many as there are samples."""
    within = (time >= rotation.begin) & (time <= rotation.end)
    rough = rotation.cycles * rotation.period / np.count_nonzero(within)
    step = next((each for each in _STEPS if each >= 0.99 * rough), _STEPS[-1])
    grid = np.arange(0.0, round(rotation.period / step)) * step
    begin, count = 0.0, rotation.cycles
    if rotation.begin + delay < time[0]:
        begin, count = rotation.period, count - 1
    if rotation.end + delay > time[-1]:
        count -= 1
    return begin, count, grid


def _pressure(signal: Array, heading: Heading, options: Options) -> Array:
    """In Pa."""
    if heading.pressure is not None:
        return signal * heading.pressure
    if options.sensor is not None:
        return options.sensor(signal * _VOLTS.get(heading.unit, 1.0))
    assert options.unit is not None
    return signal * PRESSURE_UNITS[options.unit]


def _check_compression(values: Array, name: str, instants: Array) -> None:
    reach = np.ptp(values, axis=1)
    usual = float(np.median(reach))
    if usual < _FLAT:
        raise InputError(
            f"the pressure of column {shown(name)} goes from {np.min(values) / BAR:.3g} "
            f"to {np.max(values) / BAR:.3g} bar and never compresses; check sensor and unit, or "
            "name another column by columns"
        )
    weak = np.flatnonzero(reach < _WEAK * usual)
    if len(weak):
        begin = instants.reshape(values.shape)[weak[0], 0]
        raise InputError(
            f"in the cycle from {begin:.6g} s on the pressure of column {shown(name)} "
            f"never compresses: it rises by {reach[weak[0]] / BAR:.3g} bar, in the others by "
            f"{usual / BAR:.3g}; cut the record before or after that"
        )
