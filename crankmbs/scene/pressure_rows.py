"""The rows of a pressure table: their rules, how they close the period, and what joins them.

Two rows at one angle are a jump, from the first value to the second. Interpolation runs from jump
to jump; without any it is periodic.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.scene.cycles import SAME_ANGLE, check_whole, cycles_in
from crankmbs.scene.tables import Table
from crankmbs.scene.units import BAR, DEGREE

__all__ = ["Period", "check_rows", "close", "closing_row", "interpolate", "overshoot"]


_CLOSING = 0.01  # of the range of the pressures: so far a measured cycle may miss its beginning


class Period(NamedTuple):
    """Rows over exactly one period.

    angle : shape (n + 1,) [rad]; inside, but not at its ends, a repeated angle is a jump
    value : shape (n + 1,) [Pa]; the first is that after the ends, the last that before them
    jumps : whether the pressure jumps where the period ends
    """

    angle: Array
    value: Array
    jumps: bool


def check_rows(
    table: Table,
    period: float,
    cycles: str | None,
    *,
    absolute: bool,
    closing: float | None,
) -> None:
    """Refuse what cannot be one period [rad] of a pressure, or several where ``cycles`` allows it.

    closing [Pa] : how far a closing row may lie from the first; None: 1 % of the range

    Raises
    ------
    InputError : the file, the rule, what came, and the way out
    """
    file, angle = table.source, table.x
    if len(angle) < 2:
        raise InputError(f"{file}: a pressure table needs at least two rows")
    _check_order(table)
    count = cycles_in(table, period)
    span = angle[-1] - angle[0]
    if count > 1:
        _check_several(table, period, cycles)
    _check_closing(table, count * period, closing)
    stroke = round(period / math.pi)
    if stroke == 4 and abs(span - 0.5 * period) < SAME_ANGLE and table.y[-1] == table.y[0]:
        raise InputError(
            f"{file}: the rows close after {span / DEGREE:g} degrees, as a two-stroke cycle "
            "does; give stroke = 2, or the other half of the four-stroke cycle"
        )
    widest = max([*(b - a for a, b in pairwise(angle)), count * period - span])
    if widest > period / 2.0 + SAME_ANGLE:
        of_two = stroke == 4 and span <= 0.5 * period + SAME_ANGLE
        way_out = "; give stroke = 2 where the rows are those of a two-stroke cycle"
        raise InputError(
            f"{file}: a gap of {widest / DEGREE:g} degrees without a row; the table must "
            f"span the cycle of {period / DEGREE:g} degrees with no gap above its half"
            f"{way_out if of_two else ''}"
        )
    lowest = min(table.y)
    if absolute and lowest < 0.0:
        raise InputError(
            f"{file}: an absolute pressure cannot be negative; {lowest:.6g} Pa came at "
            f"{angle[table.y.index(lowest)] / DEGREE:g} degrees; correct what the pressures are "
            "measured from, or give absolute = false when the file is gauge"
        )


def closing_row(table: Table, period: float) -> float | None:
    """How far [Pa] the row that closes the period lies from the one that opens it; None without."""
    first, last = _ends(table, period)
    if not last:
        return None
    return max(abs(a - b) for a, b in zip(first, last[-len(first) :], strict=False))


def close(table: Table, period: float) -> Period:
    """The rows over one period, the first one repeated in place of a closing row."""
    first, last = _ends(table, period)
    jumps = len(first) == 2 or len(last) == 2
    before = last[0] if len(last) > len(first) else first[0]
    inner = slice(len(first) - 1, len(table.x) - len(last))
    angle = np.append(table.x[inner], table.x[0] + period)
    return Period(angle, np.append(table.y[inner], before), jumps)


def interpolate(rows: Period, interpolation: str) -> tuple[Array, Array]:
    """Knots [rad] over one period and the cubics between them, as in `scipy.interpolate.PPoly`.

    step holds a value until the next row; linear joins the rows; pchip keeps monotone stretches
    monotone (no overshoot); cubic is the C2 spline, from jump to jump with SciPy's not-a-knot ends.
    """
    angle, value, jumps = rows
    return _interpolated(angle.tobytes(), value.tobytes(), jumps, interpolation)


@lru_cache(maxsize=32)
def _interpolated(
    angles: bytes, values: bytes, jumps: bool, interpolation: str
) -> tuple[Array, Array]:
    """The same for the rows' doubles: runs of one table, one after the other, share its cubics,
    which therefore nobody may write to."""
    angle, value = np.frombuffer(angles), np.frombuffer(values)
    knots, cubics = _joined(angle, value, jumps, interpolation)
    knots.flags.writeable = cubics.flags.writeable = False
    return knots, cubics


def _joined(angle: Array, value: Array, jumps: bool, interpolation: str) -> tuple[Array, Array]:
    """Knots and cubics of rows."""
    cuts = np.flatnonzero(np.diff(angle) == 0.0) + 1
    if not jumps and len(cuts) == 0:
        return angle, _periodic(angle, value, interpolation)
    if not jumps:  # begin at a jump, so that no stretch runs across the period's end
        k, period = cuts[0], angle[-1] - angle[0]
        angle = np.concatenate([angle[k:-1], angle[:k] + period])
        value = np.concatenate([value[k:-1], value[:k]])
        cuts = cuts[1:] - k
    stretches = list(zip(np.split(angle, cuts), np.split(value, cuts), strict=True))
    knots = np.concatenate([*(x[:-1] for x, _ in stretches), angle[-1:]])
    return knots, np.concatenate([_open(x, y, interpolation) for x, y in stretches], axis=1)


def overshoot(knots: Array, coefficients: Array) -> tuple[float, float, float]:
    """How far [Pa] a piece goes at most beyond both its ends; between which angles [rad]."""
    pieces = PPoly(coefficients, knots)
    turning = pieces.derivative().roots(discontinuity=False, extrapolate=False)
    turning = turning[np.isfinite(turning)]
    if len(turning) == 0:
        return 0.0, float(knots[0]), float(knots[1])
    k = np.clip(np.searchsorted(knots, turning, side="right") - 1, 0, len(knots) - 2)
    begin = coefficients[-1]
    width = np.diff(knots)
    end = ((coefficients[0] * width + coefficients[1]) * width + coefficients[2]) * width + begin
    value = pieces(turning)
    beyond = np.maximum(value - np.maximum(begin, end)[k], np.minimum(begin, end)[k] - value)
    most = int(np.argmax(beyond))
    return max(float(beyond[most]), 0.0), float(knots[k[most]]), float(knots[k[most] + 1])


def _check_several(table: Table, period: float, cycles: str | None) -> None:
    """Refuse a file of several periods that nobody asked for, or whose last one is not whole."""
    if cycles is None:
        span, stroke = table.x[-1] - table.x[0], round(period / math.pi)
        from_python = "; a Table has its angles in radians" if table.source == Table.source else ""
        raise InputError(
            f"{table.source}: the rows span {span / DEGREE:g} degrees, more than the period of "
            f"{period / DEGREE:g}; check stroke, {stroke} came, or for a file of several cycles "
            f'give cycles = "mean" or "sequence"{from_python}'
        )
    check_whole(table, period)


def _check_order(table: Table) -> None:
    file, x = table.source, table.x
    for k, (a, b) in enumerate(pairwise(x)):
        if b < a:
            raise InputError(
                f"{file}: crank angles must not decrease (two rows at one angle are a jump); in "
                f"row {k + 2} {b / DEGREE:g} follows {a / DEGREE:g} degrees"
            )
        if a == b and k > 0 and x[k - 1] == a:
            raise InputError(
                f"{file}: rows {k} to {k + 2} all stand at {a / DEGREE:g} degrees; give two, a "
                "jump from the first pressure to the second"
            )
        if 0.0 < b - a <= SAME_ANGLE:
            raise InputError(
                f"{file}: rows {k + 1} and {k + 2} lie {(b - a) / DEGREE:.2g} degrees apart, too "
                "near to be told apart; give both the same angle for a jump, or drop one"
            )


def _check_closing(table: Table, period: float, closing: float | None) -> None:
    apart, most = closing_row(table, period), max(table.y) - min(table.y)
    allowed = _CLOSING * most if closing is None else closing
    if apart is not None and apart > allowed:
        at, whose = table.x[-1] / DEGREE, "1 % of the range" if closing is None else "closing"
        raise InputError(
            f"{table.source}: the closing row, at {at:g} degrees, must equal the first one, as the "
            f"pressure is periodic; it lies {apart / BAR:.3g} bar from it, more than "
            f"{allowed / BAR:.3g} bar ({whose}); drop the row, raise closing, or give two rows at "
            f"{at:g} degrees for a jump"
        )


def _ends(table: Table, period: float) -> tuple[list[float], list[float]]:
    """Pressures of the one or two rows that open the period; of the up to two that close it."""
    x, y = table.x, table.y
    opens = [y[0], y[1]] if x[1] == x[0] else [y[0]]
    return opens, [b for a, b in zip(x, y, strict=True) if a > x[0] + period - SAME_ANGLE]


def _open(angle: Array, value: Array, interpolation: str) -> Array:
    """The cubics from one jump to the next."""
    if interpolation == "cubic":
        return np.asarray(CubicSpline(angle, value).c)
    if interpolation == "pchip":
        return np.asarray(PchipInterpolator(angle, value).c)
    return _straight(angle, value, interpolation)


def _periodic(angle: Array, value: Array, interpolation: str) -> Array:
    if interpolation == "cubic":
        return np.asarray(CubicSpline(angle, value, bc_type="periodic").c)
    if interpolation != "pchip":
        return _straight(angle, value, interpolation)
    # three rows more on either side make the one-sided end slopes of pchip irrelevant
    n, period = len(angle) - 1, angle[-1] - angle[0]
    k = np.arange(-3, n + 4)
    wide_angle = angle[k % n] + (k // n) * period
    wide = PchipInterpolator(wide_angle, value[k % n])
    return np.asarray(wide.c[:, 3 : 3 + n])


def _straight(angle: Array, value: Array, interpolation: str) -> Array:
    width, rise = np.diff(angle), np.diff(value)
    zero = np.zeros_like(width)
    slope = zero if interpolation == "step" else rise / width
    return np.array([zero, zero, slope, value[:-1]])
