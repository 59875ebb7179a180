"""Measured pressures that can be read and are unlikely to be what the cylinder had: levels that no
engine has, and peaks that an amplifier cut off."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.scene.levels import unlikely_compression, unlikely_peak
from crankmbs.scene.units import BAR

if TYPE_CHECKING:
    from crankmbs.indicated.findings import CylinderPressure

__all__ = ["cut_off", "cut_off_words", "levels"]

_ATMOSPHERE = 1.01325 * BAR
_BOTTOM = -180.0, 10.0  # degrees: the dead centre before the compression, and how far about it

# Rounded to digits, the top of a peak is flat, too, but a parabola: as far again from its middle it
# lies three of the steps by which rows differ below the top, and one for rounding. Where a signal
# is cut off, it leaves the top as steeply as it came. One that is held between its samples is flat
# everywhere.
_FLAT = 5  # rows
_STEPS = 8.0
_TIMES_THE_OTHERS = 3.0


def levels(cylinder: CylinderPressure, stroke: int, absolute: bool, doubted: str) -> Iterator[str]:
    """Warnings of the mean cycle's peak, and of the pressure with which its compression begins.

    doubted : what the compression speaks against, with which that pressure is doubted already
    """
    mean = cylinder.mean
    peak = float(np.max(mean)) - (_ATMOSPHERE if absolute else 0.0)
    said = list(unlikely_peak(peak, stroke))
    if absolute and not doubted:
        at = np.abs(cylinder.angle - _BOTTOM[0]) <= _BOTTOM[1]
        said += unlikely_compression(float(np.median(mean[at]))) if np.any(at) else ()
    for each in said:
        yield f"warning: cylinder {cylinder.number}: {each}"


def cut_off_words(name: str, signal: Array) -> list[str]:
    """A warning where the pressure of a column [Pa] was cut off."""
    rows = cut_off(signal)
    if not rows:
        return []
    return [
        f"warning: {name}: the signal stands still at its highest value, "
        f"{np.max(signal) / BAR:.4g} bar, over {rows} rows: the amplifier or the converter cut it "
        "off there; peaks and imep are too low, measure with a larger range"
    ]


def cut_off(signal: Array) -> int:
    """At how many rows a signal stands at its highest value because it was cut off there.

    signal : shape (n,), without missing rows, as it was recorded: smoothing and interpolation
        would round the top

    >>> top = 40.0 - (np.arange(-50.0, 51.0) / 10.0) ** 2
    >>> cut_off(np.round(top, 1)), cut_off(np.minimum(top, 39.0))
    (0, 21)
    """
    low, high = float(np.min(signal)), float(np.max(signal))
    rounding = 1e-9 * (high - low)
    steps = np.abs(np.diff(signal))
    if not np.any(steps > rounding):
        return 0
    least = float(np.min(steps[steps > rounding]))
    begin = np.append(0, np.flatnonzero(steps > rounding) + 1)
    rows = np.diff(begin, append=len(signal))
    top = signal[begin] >= high - rounding
    others = rows[~top & (signal[begin] > 0.5 * (low + high))]
    usual = float(np.median(others)) if others.size else 1.0
    count = 0
    for first, flat in zip(begin[top].tolist(), rows[top].tolist(), strict=True):
        before, behind = first - 1 - flat // 2, first + flat + flat // 2
        if flat < max(_FLAT, _TIMES_THE_OTHERS * usual) or before < 0 or behind >= len(signal):
            continue
        if high - max(signal[before], signal[behind]) > _STEPS * least:
            count += flat
    return count
