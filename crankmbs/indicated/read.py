"""A measured file in, its cylinders and the table for a scene out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crankmbs.delimited import Sheet
from crankmbs.delimited.dialect import named
from crankmbs.errors import InputError, UndecidedError
from crankmbs.indicated.cylinders import cylinder_of
from crankmbs.indicated.dead_centre import DeadCentre, fired_dead_centre
from crankmbs.indicated.findings import CylinderPressure, Indicated, Level
from crankmbs.indicated.firing import (
    cut_cycles,
    firing_angle,
    half_cycles,
    lags,
    peak_or_given,
    places,
)
from crankmbs.indicated.gaps import bridged, check_spike
from crankmbs.indicated.options import Options
from crankmbs.indicated.over_time import record_over_time, time_column
from crankmbs.indicated.record import Channel, Record, record_of
from crankmbs.indicated.referencing import Cycles, decide, refer
from crankmbs.indicated.report import sentences_of
from crankmbs.indicated.shape import Shape, differences, of_header, shape_of
from crankmbs.indicated.speed import MeasuredSpeed, speed_of
from crankmbs.indicated.tabulate import table_of
from crankmbs.indicated.unlikely import cut_off_words, levels
from crankmbs.numerics.arrays import Array
from crankmbs.scene.headings import headings_of, is_angle
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import BAR

__all__ = ["read_pressure"]

_ROUNDS = 20  # towards the dead centre
_SETTLED = 0.01  # degrees
_PEAKS = (-10.0, 60.0)  # degrees from the dead centre where a peak may lie
_ALIKE = 0.03  # of the mean peak: what those of motored cycles scatter by
_SYMMETRIC = 1.0  # degree between the peak and the middle of its chord


def read_pressure(file: str | Path, scene: Scene | None = None, **options: Any) -> Indicated:
    r"""Read cylinder pressures as an indicating system writes them, and check them.

    What the file does not say, and nothing shows, is asked for; all that was done is said.

    Parameters
    ----------
    file : a text file of pressures over the crank angle, or over time with the signal of a wheel
    scene : its geometry gives volumes, hence imep, the dead centre and references by polytrope;
        its layout the cylinders' firing; else a header's stroke and rod length are used
    columns : names of the pressures, "PCYL1..4"; angle : name of the crank angle's column, where it
        is not told by its name or unit; separator, decimal, skip : as in `Gas`
    unit : of pressures without one, "bar"; each : "cycle" or "cylinder", what numbers count
    stroke : 2 or 4; invert : True turns the signal over
    reference : "absolute"; "gauge", with the ambient "gauge 1 bar" made absolute; "inlet 1 bar", or
        "inlet" with an intake's column; "polytrope 1.32"
    firing_tdc : the file's angle of the (first cylinder's) firing dead centre, "0.35 deg"; over
        time, modulo 360 degrees, from the wheel's first edge after the gap
    wheel : of a record over time, "60-2", teeth less the missing ones, or "60-2 falling"; of an
        encoder "360", with index : the column of its mark
    sensor : from volts to pressure, "(V/5 - 0.115)/0.00385 bar" or "0.5 V = 0 bar, 4.5 V = 100 bar"
    delay : by which the sensor shows a pressure late, "0.8 ms"
    loss_angle : by which a motored peak comes before the dead centre, "0.7 deg"
    compression_ratio : where neither scene nor header has it
    smooth : width of a sliding cubic, "3 deg"; cycles : in the table, "mean", "all", "7" or "1-50"

    Returns
    -------
    Indicated : cylinders [deg, Pa], the table [rad, Pa], and sentences

    Raises
    ------
    InputError : what cannot be read; UndecidedError : what is asked for, with `options`

    >>> rows = "".join(f"{k},{1 + (abs(k) < 90) * (1 + np.cos(k / 90 * np.pi))}\n"
    ...     for k in range(-360, 360))
    >>> _ = Path("a.csv").write_text("CA [deg],PCYL1 [bar(a)]\n" + rows)
    >>> read_pressure("a.csv").cylinders[0].peaks.tolist()
    [300000.0]
    """
    settings = Options(**options)
    sheet = settings.sheet(file)
    known = scene.gas.stroke if scene is not None and scene.gas is not None else None
    header = of_header(sheet.above, sheet.dialect.decimal)
    shape = shape_of(scene, header, settings.compression_ratio)
    with sheet.errors():
        record = _record(sheet, settings, known, shape)
        remarks = [_read_as(sheet, record), *record.remarks]
        if header:
            remarks.append(_header_words(header))
        if scene is not None:
            remarks += differences(header, scene)
        first = None if record.rotation is None else peak_or_given(record, settings)
        if first is None or settings.firing_tdc is not None:
            found = _cylinders(record, settings, scene, shape, first)
        else:
            found = _by_pressure(record, settings, scene, shape, first)
        cylinders = found.cylinders
        table, words = table_of(record, cylinders, found.cut, shape, settings.cycles)
    speed = _speed(record, cylinders[0].firing, shape, sheet.name)
    remarks += found.remarks
    for cylinder in cylinders:
        remarks += sentences_of(cylinder, shape, found.level, found.doubted)
        remarks += levels(cylinder, record.stroke, found.level.absolute, found.doubted)
    if shape is None:
        remarks.append(
            "no stroke and rod length are known: without a scene no imep and no volumes are found"
        )
    return Indicated(
        source=sheet.name,
        stroke=record.stroke,
        absolute=found.level.absolute,
        aligned=len(cylinders) > 1 and len({each.firing for each in cylinders}) == 1,
        cycles="sequence" if table.x[-1] - table.x[0] > np.radians(record.period) else "mean",
        cylinders=cylinders,
        shape=shape,
        table=table,
        sentences=(*remarks, *(speed.sentences if speed else ()), words),
        speed=speed,
    )


class _Found(NamedTuple):
    """The cylinders, and their cycles before these were referenced; what their pressures are
    measured from; what their compression speaks against, else nothing; what was done."""

    cylinders: tuple[CylinderPressure, ...]
    cut: list[Cycles]
    level: Level
    doubted: str
    remarks: list[str]


def _record(sheet: Sheet, options: Options, stroke: int | None, shape: Shape | None) -> Record:
    headings = headings_of(sheet.above, sheet.values.shape[1])
    over_angle = options.angle is not None or any(map(is_angle, headings))
    at = None if over_angle else time_column(headings, sheet, options)
    if at is None:
        return record_of(sheet, headings, options, stroke)
    geometry = shape is not None and shape.ratio is not None
    return record_over_time(sheet, headings, at, options, stroke, geometry=geometry)


def _cylinders(
    record: Record,
    options: Options,
    scene: Scene | None,
    shape: Shape | None,
    first: float | None,
) -> _Found:
    """The cylinders by the first one's firing dead centre.

    first : the file's angle [deg] of it; None: as the options or the peak have it
    """
    cut, remarks = _cut(record, options, scene, first)
    reference, why, against = decide(cut, options, shape)
    halves = half_cycles(cut[0].phi, cut[0].pressure)
    if halves is not None:
        remarks.append(_half_words(cut[0].channel, *halves))
        against = ""  # the mean of compressions and gas exchanges is no compression
    why += f", though {against}" if against else ""
    cylinders, level = [], Level(absolute=True, pegged=reference.kind == "polytrope")
    for cycles in cut:
        added, absolute, words = refer(cycles, reference, shape)
        level = level._replace(absolute=absolute)
        look = "warning: " if against else ""
        remarks.append(f"{look}cylinder {cycles.channel.cylinder}: {words} ({why})")
        cylinders.append(cylinder_of(cycles, added, shape, options, level.shows_dead_centre))
        if options.loss_angle is not None and cylinders[-1].fired:
            remarks.append(
                f"warning: cylinder {cycles.channel.cylinder}: loss_angle is not used: it is of a "
                "motored cycle, which is nearly symmetric about its peak, and this one is not"
            )
    doubted = "the stroke" if halves else "the reference" if against else ""
    return _Found(tuple(cylinders), cut, level, doubted, remarks)


def _by_pressure(
    record: Record, options: Options, scene: Scene | None, shape: Shape | None, first: float
) -> _Found:
    """The same with the dead centre where the pressure has it, from a guess [deg].

    Raises
    ------
    UndecidedError : the pressure does not show it
    """
    for _ in range(_ROUNDS):
        found = _cylinders(record, options, scene, shape, first)
        centre = _centre(found.cylinders[0], shape if found.level.shows_dead_centre else None)
        if centre is None or not _PEAKS[0] < centre.peak < _PEAKS[1]:
            break
        if abs(centre.middle) < _SETTLED:
            found.remarks.append(
                f"the dead centre is taken where the pressure shows it, {first % 360.0:.2f} +- "
                f"{centre.half:.2f} degrees after the first edge of a revolution, by "
                f"{'its motored peak' if centre.motored else 'its compression'};"
                " firing_tdc says where it is known"
            )
            return found
        first = (first + centre.middle) % record.period
    raise UndecidedError(
        "where the dead centre lies is not said, and the pressure does not show it: a fired cycle "
        "has it in its compression alone, which must be a polytrope",
        ('firing_tdc="25 deg"', "a scene, compression_ratio and another reference"),
    )


def _centre(cylinder: CylinderPressure, shape: Shape | None) -> DeadCentre | None:
    """The dead centre by a peak that is surely motored, symmetric and alike in every cycle, else by
    the compression."""
    centre = cylinder.dead_centre
    alike = np.std(cylinder.peaks) < _ALIKE * np.mean(cylinder.peaks)
    if centre is not None and centre.motored and alike and abs(centre.skew) < _SYMMETRIC:
        return centre
    return fired_dead_centre(cylinder.angle, cylinder.mean, shape)


def _speed(record: Record, firing: float, shape: Shape | None, name: str) -> MeasuredSpeed | None:
    """The speed over the first cylinder's cycle angle."""
    if record.rotation is None:
        return None
    top = 0.0 if shape is None else float(np.degrees(shape.top))
    return speed_of(record.rotation, firing - top, name)


def _read_as(sheet: Sheet, record: Record) -> str:
    rows, columns = sheet.values.shape
    steps = np.diff(record.angle)
    least, most = float(np.min(steps)), float(np.max(steps))
    step = f"{most:.4g}" if most - least < 1e-3 else f"{least:.4g} to {most:.4g}"
    comma = "comma" if sheet.dialect.decimal == "," else "point"
    return (
        f"{sheet.name}: {rows} rows of {columns} columns from line {sheet.first} on, "
        f"{sheet.encoding}, separated by {named(sheet.dialect.separator)}s, decimal {comma}; "
        f"{record.stroke}-stroke, {record.angle[0]:g} to {record.angle[-1]:g} degrees in steps of "
        f"{step}"
    )


def _header_words(header: dict[str, float]) -> str:
    parts = [
        f"{name} {value:g}" if name == "compression ratio" else f"{name} {1e3 * value:g} mm"
        for name, value in header.items()
    ]
    return f"the header gives {', '.join(parts)}"


def _cut(
    record: Record, options: Options, scene: Scene | None, first: float | None
) -> tuple[list[Cycles], list[str]]:
    """Each cylinder's cycles from gas exchange to gas exchange; what was done."""
    channels, remarks = _pressures(record)
    sign = -1.0 if options.invert else 1.0
    filled = []
    for channel in channels:
        values, words = bridged(record, channel)
        filled.append(sign * values)
        remarks += words
        if record.rotation is None:
            remarks += cut_off_words(channel.name, sign * values[~np.isnan(values)])
    means = [np.nanmean(values, axis=0) for values in filled]
    for channel, values, mean in zip(channels, filled, means, strict=True):
        check_spike(record, channel, values)
        _check_sign(channel, mean, inverted=options.invert)
    if first is None:
        first = (
            firing_angle(record.angle, means[0], record.period)
            if options.firing_tdc is None
            else float(np.degrees(options.firing_tdc))
        )
    measured = lags(record.angle, means, record.period)
    known = _of_layout(channels, scene, record.period)
    nominal = places(measured, record.period, known)
    remarks += _lag_words(channels, measured, nominal, known)
    cut = []
    for k, (channel, values) in enumerate(zip(channels, filled, strict=True)):
        firing = first + nominal[k]
        for consecutive in (record.consecutive, False):
            start, phi, cycles = cut_cycles(
                record.angle, values, record.period, firing, consecutive
            )
            whole = ~np.any(np.isnan(cycles), axis=1)
            if np.any(whole):
                break
        joined = len(cycles) < len(values)
        if joined:
            remarks.append(
                f"cylinder {channel.cylinder}: cut during the gas exchange, {len(values)} recorded "
                f"cycles give {np.sum(whole)} whole ones"
            )
        cut.append(
            Cycles(
                channel,
                phi,
                cycles[whole],
                record.period,
                (firing + 180.0) % record.period - 180.0 if nominal[k] else firing,
                measured[k],
                _intake(record, channel.cylinder, start),
                start,
                bool(np.all(whole)) and (joined or start == 0),
            )
        )
    return cut, remarks


def _half_words(channel: Channel, low: float, high: float) -> str:
    return (
        f"warning: cylinder {channel.cylinder}: every second cycle compresses nothing: its dead "
        f"centre is {low / BAR:.2g} bar above its lowest pressure, that of the others "
        f"{high / BAR:.3g} bar; these are the halves of four-stroke cycles, which stroke=4 reads"
    )


def _pressures(record: Record) -> tuple[list[Channel], list[str]]:
    """The channels of the cylinders, and what the others are."""
    of_kind: dict[str, list[Channel]] = {}
    for channel in record.channels:
        of_kind.setdefault(channel.kind, []).append(channel)
    remarks = [
        f"{kind} of the cycles: {', '.join(each.name for each in channels)}, not in the table"
        for kind, channels in of_kind.items()
        if kind not in ("cycle", "other") and (kind != "mean" or "cycle" in of_kind)
    ]
    chosen = of_kind.get("cycle") or of_kind.get("mean")
    if not chosen:
        listed = ", ".join(each.name for each in record.channels)
        raise InputError(
            f"no column is the pressure of a cylinder; {listed} came; name the column, "
            'such as columns="PCYL1"'
        )
    if "cycle" not in of_kind:
        remarks.append("the file has mean cycles alone: their peaks are below those of the cycles")
    return sorted(chosen, key=lambda channel: channel.cylinder), remarks


def _check_sign(channel: Channel, mean: Array, *, inverted: bool) -> None:
    middle = float(np.median(mean))
    if middle - np.min(mean) > 1.5 * (np.max(mean) - middle):
        after, way_out = "", "give invert=True"
        if inverted:
            after, way_out = " after invert=True", "leave it out"
        raise InputError(
            f"{channel.name} is upside down{after}: its largest excursion is downwards, to "
            f"{np.min(mean) / BAR:.4g} bar; {way_out}, or give the names of the pressures alone, "
            'such as columns="PCYL1..4"'
        )


def _of_layout(
    channels: Sequence[Channel], scene: Scene | None, period: float
) -> list[float] | None:
    """By how much [deg] each cylinder fires after the first, by the scene's layout."""
    if scene is None or max(channel.cylinder for channel in channels) > len(scene.cylinders):
        return None
    phases = [np.degrees(scene.cylinders[each.cylinder - 1].phase) for each in channels]
    return [float(round((phases[0] - phase) % period, 9)) for phase in phases]


def _lag_words(
    channels: Sequence[Channel],
    measured: Sequence[float],
    nominal: Sequence[float],
    known: Sequence[float] | None,
) -> list[str]:
    if len(channels) == 1:
        return []
    if not any(nominal):
        return ["every column runs over its own cylinder's angle: all peak together"]
    sentences = []
    for k in range(1, len(channels)):
        text = (
            f"cylinder {channels[k].cylinder} fires {nominal[k]:.6g} degrees after cylinder "
            f"{channels[0].cylinder}, {measured[k]:.4g} by the flanks of their compression"
        )
        if known is not None and abs(known[k] - nominal[k]) > 1e-6:
            text = f"warning: {text}, and {known[k]:.6g} by the scene's layout: check firing_order"
        sentences.append(text)
    return sentences


def _intake(record: Record, cylinder: int, start: int) -> Array | None:
    """The intake's mean cycle, of this cylinder where each has one, over the cylinder's angles."""
    intakes = [each for each in record.channels if each.kind == "intake"]
    if not intakes:
        return None
    same = [each for each in intakes if each.cylinder == cylinder]
    return np.asarray(np.roll(np.nanmean((same or intakes)[0].values, axis=0), -start))
