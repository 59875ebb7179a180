"""Tables that can be taken and are unlikely to be meant so: rows that are missing, or that scatter.

Each rule is one function of the scene that gives its sentences, as in `plausible`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.scene.cycles import SAME_ANGLE, cycles_in
from crankmbs.scene.drives import SpeedFile
from crankmbs.scene.gas import tables_of
from crankmbs.scene.scene import Scene
from crankmbs.scene.table_loads import OverAngle
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.units import BAR, DEGREE

__all__ = ["gaps", "scatter"]

# A cut record lacks a stroke or more, a hole in one many rows. Tables typed by hand are up to
# three times as coarse away from the peak as beside it, in steps of up to 60 degrees.
_WIDE = 30.0 * DEGREE
_TIMES_THE_OTHERS = 4.0

# Between rows of independent errors the deviation of a slope from its neighbours' mean changes
# sign in 77 of 100 cases, and is 1.6 times a usual slope; of a wave in n rows it changes sign in
# 2 / n. A thousandth of the square of the speed is an acceleration that digits leave.
_FEWEST = 20  # rows
_SIGN_CHANGES = 0.5
_OF_SLOPE = 0.3
_OF_SPEED_SQUARED = 1e-3


class _Rows(NamedTuple):
    """Rows that come again after a period: name : what the scene calls them; angle [rad], shape
    (n,); values in a unit, shape (columns, n); cycles : how many of the period they span [rad]."""

    name: str
    source: str
    interpolation: str
    angle: Array
    values: Array
    unit: str
    period: float
    cycles: int = 1


def gaps(scene: Scene) -> Iterator[str]:
    """A gap far wider than all others, between rows or from the last one to the first.

    Between two rows of one value it is meant to stay, and a step holds what it has.

    >>> list(gaps(load_scene("propeller")))
    []
    """
    for rows in (*_pressures(scene), *_over_angle(scene)):
        found = None if rows.interpolation == "step" else _gap(rows)
        if found is None:
            continue
        begin, end, usual, (before, after) = found
        what = rows.name.partition("[")[0].removeprefix("gas.")
        yield (
            f"{rows.name}: {Path(rows.source).name} has no row between {begin / DEGREE:.6g} and "
            f"{end / DEGREE:.6g} degrees, and elsewhere one every {usual / DEGREE:.3g} degrees "
            f"or less: {rows.interpolation} draws {(end - begin) / DEGREE:.6g} degrees there, "
            f"from {before:.4g} to {after:.4g} {rows.unit}; add the rows that are missing, "
            f"or, where the {what} is meant so, one or two between"
        )


def _pressures(scene: Scene) -> Iterator[_Rows]:
    """Of the gas."""
    gas = scene.gas
    for key in ("pressure", "motored", "crank_end") if gas else ():
        source = getattr(gas, key)
        for each in dict.fromkeys(source if isinstance(source, tuple) else (source,)):
            if gas and isinstance(each, Table | CylinderTable):
                tables = tables_of(each)
                bars = np.array([table.y for table in tables]) / BAR
                about = np.array(each.x), bars, "bar", gas.period, cycles_in(tables[0], gas.period)
                yield _Rows(f"gas.{key}", each.source, gas.interpolation, *about)


def _over_angle(scene: Scene) -> Iterator[_Rows]:
    """Of torques and forces over the crank angle."""
    for name, loads, unit in (("torque", scene.torque, "N m"), ("force", scene.force, "N")):
        for number, load in enumerate(loads, start=1):
            if isinstance(load, OverAngle):
                angle, values = np.array(load.file.x), np.array([load.file.y])
                about = load.file.source, load.interpolation, angle, values, unit
                yield _Rows(f"{name}[{number}]", *about, load.cycle.period)


def _gap(rows: _Rows) -> tuple[float, float, float, tuple[float, float]] | None:
    """Where a gap begins and ends, the widest of the others [rad], and the values around it."""
    count, columns = rows.cycles, rows.values
    angle = np.append(rows.angle, rows.angle[0] + count * rows.period)
    width = np.diff(angle)
    if len(width) <= count:
        return None
    usual, widest = np.sort(width)[[-1 - count, -1]]  # each cycle has the gap
    k = int(np.argmax(width))
    if widest < max(_WIDE, _TIMES_THE_OTHERS * usual) - SAME_ANGLE:
        return None
    before, after = columns[:, k], columns[:, (k + 1) % len(rows.angle)]
    if k + 1 < len(rows.angle) and np.array_equal(before, after):
        return None
    return float(angle[k]), float(angle[k + 1]), float(usual), (float(before[0]), float(after[0]))


def scatter(scene: Scene) -> Iterator[str]:
    """Rows of a speed whose errors make the acceleration: it alternates from row to row.

    >>> list(scatter(load_scene("yi_diesel")))
    []
    """
    speed = None if scene.motion is None else scene.motion.speed
    if not isinstance(speed, SpeedFile) or len(speed.file.x) < _FEWEST:
        return
    x, omega = np.array(speed.file.x), np.array(speed.file.y)
    slope = np.diff(omega) / np.diff(x)  # rad/s^2
    if speed.kind == "angle_table":
        slope *= 0.5 * (omega[1:] + omega[:-1])
    off = slope[1:-1] - 0.5 * (slope[:-2] + slope[2:])
    usual = float(np.median(np.abs(off)))
    least = max(
        _OF_SLOPE * float(np.median(np.abs(slope - np.median(slope)))),
        _OF_SPEED_SQUARED * float(np.max(np.abs(omega))) ** 2,
    )
    if usual <= least or np.mean(off[1:] * off[:-1] < 0.0) <= _SIGN_CHANGES:
        return
    inertia = scene.crank.moment_of_inertia
    torque = f", {_rounded(usual * inertia)} N m of the crank's inertia" if inertia else ""
    yield (
        f"motion.speed: the rows of {Path(speed.file.source).name} scatter: the acceleration "
        f"between them alternates from row to row by some {_rounded(usual)} rad/s^2{torque}, as "
        "errors of the rows make it; the forces and torques of the run hold that; smooth the "
        "speed, give fewer rows, or have crankmbs speed read it from the times of the teeth"
    )


def _rounded(value: float) -> str:
    """To two digits, without an exponent where that is short."""
    return f"{float(f'{value:.2g}'):g}"
