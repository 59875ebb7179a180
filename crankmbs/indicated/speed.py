"""The speed over the crank angle that a wheel shows, for `[motion]` and to compare a run with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from crankmbs.delimited import Sheet
from crankmbs.errors import InputError, UndecidedError, shown
from crankmbs.indicated.channels import several_words
from crankmbs.indicated.options import Options
from crankmbs.indicated.over_time import clock, most_edges, time_column, turned
from crankmbs.indicated.rotation import Rotation, rotation_of
from crankmbs.indicated.wheel import Wheel, first_edges, tick_of_times
from crankmbs.indicated.write import table_text
from crankmbs.numerics.arrays import Array
from crankmbs.scene.headings import TIME_UNITS, Heading, headings_of, is_angle, pick
from crankmbs.scene.tables import Table
from crankmbs.scene.units import DEGREE, RPM
from crankmbs.storage.files import text_in_one_move

__all__ = ["MeasuredSpeed", "motion_line", "read_speed", "speed_of"]

_STEP = 3.0  # degrees: ten rows for the shortest wave that is fitted
_FINE = 1e-8  # s: steps of a clock that are not worth a word
_EVEN = 1.3  # times the median step: a record's samples, and no teeth with a gap


@dataclass(frozen=True, eq=False)
class MeasuredSpeed:
    """The mean cycle's speed.

    table : crank angle [rad] over one period, its last row the first again, and speed [rad/s], as
        `SpeedFile` takes it with kind="angle_table"
    error, half_order_error [rad/s] : three standard deviations where they are largest, by what the
        teeth are off and the highest fitted order; of the half orders alone, which no error of the
        wheel touches
    source : the file; sentences : what was read and done
    """

    table: Table
    error: float
    half_order_error: float
    source: str
    sentences: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join(self.sentences)

    def __repr__(self) -> str:
        return f"<MeasuredSpeed {self.source}: {len(self.table.x)} rows>"

    def save(self, path: str | Path) -> Path:
        """Write the file that `[motion]` reads, with its source and what was done in its header.

        Raises
        ------
        OutputError : the file cannot be written
        """
        path = Path(path)
        columns = {
            "crank_angle_deg": np.divide(self.table.x, DEGREE),
            "speed_rpm": np.divide(self.table.y, RPM),
        }
        source = f"speed over the crank angle from {self.source}"
        usage = ["as [motion] of a scene:", motion_line(path.name)]
        text_in_one_move(path, table_text(source, self.sentences, usage, columns))
        return path


def motion_line(name: str) -> str:
    """What [motion] of a scene says of the file."""
    return f'speed = {{ file = "{name}", interpolation = "cubic" }}'


def speed_of(rotation: Rotation, firing: float, source: str) -> MeasuredSpeed:
    """The speed of the mean cycle over one period.

    firing : the wheel's angle [deg] of the firing dead centre, which a table of four strokes has at
        360 degrees, one of two at 0, as those of pressures have
    """
    zero = firing - _firing_place(rotation)
    angle = np.arange(0.0, rotation.period + 0.5 * _STEP, _STEP)
    speed = rotation.speed(angle + zero) * DEGREE
    error, half = (rotation.speed_error(half) * DEGREE for half in (False, True))
    table = Table(tuple(np.radians(angle).tolist()), tuple(speed.tolist()), source)
    return MeasuredSpeed(table, error, half, source, tuple(_words(rotation, speed, error, half)))


def _firing_place(rotation: Rotation) -> float:
    """The crank angle [deg] of the firing dead centre."""
    return 360.0 if rotation.period > 700.0 else 0.0


def _words(rotation: Rotation, speed: Array, error: float, half: float) -> Iterator[str]:
    yield from rotation.differing()
    clock = (
        f" and of a clock in steps of {1e6 * rotation.tick:.3g} us" if rotation.tick > _FINE else ""
    )
    yield (
        f"the speed of the mean cycle goes from {np.min(speed) / RPM:.5g} to "
        f"{np.max(speed) / RPM:.5g} rpm, by orders up to {rotation.orders} of a revolution, right "
        f"to {error / RPM:.2g} rpm by the errors of the teeth{clock}"
    )
    if rotation.period > 700.0:
        swing = np.ptp(speed[: len(speed) // 2] - speed[len(speed) // 2 : -1]) / 2.0
        yield (
            f"its half orders, half the difference of the two revolutions, swing by "
            f"{swing / RPM:.4g} rpm, right to {half / RPM:.2g} rpm: the teeth's errors cancel there"
        )


def read_speed(file: str | Path, wheel: Any = None, **options: Any) -> MeasuredSpeed:
    r"""Read the speed over the crank angle from a wheel's teeth.

    Parameters
    ----------
    file : text with the times of the teeth in one column, or a record of the wheel's signal over
        time
    wheel : "60-2", the teeth less the missing ones; "60-2 falling" for the falling edges
    stroke : 2 or 4, default 4: the speed comes again after one revolution or two
    firing_tdc : the firing dead centre, after the first edge after the first gap, "25 deg"; in the
        table it is at 360 degrees, with two strokes at 0; without, that edge is at 0
    columns : the column of the wheel, where others are beside it; index : of an encoder's mark;
        separator, decimal, skip : as in `Gas`

    Returns
    -------
    MeasuredSpeed : the table [rad, rad/s], its errors, and sentences

    Raises
    ------
    InputError : a wheel without a gap, teeth missing or doubled, less than two cycles, a clock that
        jumps; UndecidedError : no wheel

    >>> teeth = np.arange(36 * 9)[np.arange(36 * 9) % 36 < 35]
    >>> _ = Path("teeth.csv").write_text("".join(f"{k / 1800:.9f}\n" for k in teeth))
    >>> round(read_speed("teeth.csv", "36-1").table.y[0] * 30 / np.pi)
    3000
    """
    settings = Options(**{"wheel": wheel, "stroke": 4, **options})
    sheet = settings.sheet(file, least=1)
    with sheet.errors():
        if settings.wheel is None:
            raise UndecidedError(
                "which wheel has these teeth is not said",
                ('wheel="60-2", the teeth less the missing ones',),
            )
        headings = headings_of(sheet.above, sheet.values.shape[1])
        time = time_column(headings, sheet, settings)
        if time is None and any(map(is_angle, headings)):
            raise InputError(
                "the file is over the crank angle, and the speed is read from times of teeth, or "
                "from the signal of a wheel over time; a speed over the crank angle is what "
                "[motion] takes, as a file of crank_angle_deg,speed_rpm"
            )
        at = time or 0
        rotation = _rotation(sheet, headings, at, settings, settings.wheel)
    place, edge = _firing_place(rotation), f"the first {rotation.wheel.edge} edge"
    if settings.firing_tdc is None:
        firing, about = place, f"crank angle 0 is {edge}; firing_tdc is not given"
    else:
        firing = float(np.degrees(settings.firing_tdc))
        about = f"crank angle {place:g} is the firing dead centre, {firing:g} degrees after {edge}"
        if place:
            about += (
                "; teeth do not tell it from that of the gas exchange: if it is that one, "
                f'firing_tdc="{(firing + 360.0) % 720.0:g} deg" is the other'
            )
    measured = speed_of(rotation, firing, sheet.name)
    times = several_words(headings, at, time=True)
    return replace(measured, sentences=(*times, *rotation.words(), *measured.sentences, about))


def _rotation(
    sheet: Sheet, headings: Sequence[Heading], at: int, options: Options, wheel: Wheel
) -> Rotation:
    """The crank's turning by the times of teeth, or by a wheel's signal beside the times at
    ``at``."""
    width, stroke = sheet.values.shape[1], options.stroke or 4
    steps = np.diff(sheet.values[:, at])
    if width == 1 or np.nanmax(steps) > _EVEN * np.nanmedian(steps):
        time = _teeth_times(sheet, headings[at], at)
        return rotation_of(time, first_edges(time, wheel), wheel, stroke, tick_of_times(time))
    index = None if options.index is None else pick(headings, options.index, "index")[0]
    columns = [k for k in range(width) if k not in (at, index)]
    if options.columns is not None:
        columns = pick(headings, options.columns, "columns")
    time = clock(sheet, headings[at], at)
    signal = sheet.values[:, most_edges(sheet, columns)]
    marks = None if index is None else sheet.values[:, index]
    return turned(time, signal, marks, wheel, stroke)


def _teeth_times(sheet: Sheet, heading: Heading, at: int) -> Array:
    time = sheet.values[:, at] * TIME_UNITS.get(heading.unit, 1.0)
    bad = np.flatnonzero(~(np.diff(time) > 0.0))
    if len(bad):
        k = int(bad[0])
        raise InputError(
            f"{sheet.line(k + 1)}: the times of the teeth must rise; {shown(float(time[k + 1]))} s "
            f"came after {shown(float(time[k]))} s; cut the record there"
        )
    return time
