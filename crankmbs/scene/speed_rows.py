"""The rows of a speed over the crank angle: their rules, and the function that they make."""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.scene.cycles import SAME_ANGLE
from crankmbs.scene.pressure_rows import close, closing_row, interpolate
from crankmbs.scene.tables import Table
from crankmbs.scene.units import DEGREE, RPM

__all__ = ["check_over_angle", "from_first_row", "over_angle", "remarks_on", "repeats"]

_TURN = 2.0 * math.pi
_CLOSING = 0.01  # of the range of the speeds: so far a measured cycle may miss its beginning
_STANDS = 1e-9  # of the largest speed: as slow a crank stands


def from_first_row(table: Table) -> Table:
    """The rows over the time since the first one; their source says so.

    >>> from_first_row(Table([5.0, 6.0], [9.0, 8.0], "a.csv"))
    Table(x=(0.0, 1.0), y=(9.0, 8.0), source='a.csv from 5 s on')
    """
    begin = table.x[0]
    x = tuple(time - begin for time in table.x)
    return Table(x, table.y, f"{table.source} from {begin:.9g} s on")


def repeats(table: Table) -> bool:
    """Whether the rows are one or two revolutions that close, and so come again.

    >>> repeats(Table([0.0, 3.0, 2.0 * math.pi], [9.0, 8.0, 9.0]))
    True
    """
    period = table.x[-1] - table.x[0]
    if min(abs(period - _TURN), abs(period - 2.0 * _TURN)) > SAME_ANGLE:
        return False
    apart = closing_row(table, period)
    return apart is not None and apart <= _CLOSING * (max(table.y) - min(table.y))


def over_angle(table: Table, interpolation: str) -> tuple[Array, Array]:
    """Knots [rad] and the cubics between them, as in `scipy.interpolate.PPoly`; of rows that
    repeat over exactly their period, periodic.

    >>> over_angle(Table([0.0, 1.0, 2.0], [4.0, 4.0, 4.0]), "cubic")[1][3].tolist()
    [4.0, 4.0]
    """
    if repeats(table):
        period = _TURN * round((table.x[-1] - table.x[0]) / _TURN)
        return interpolate(close(table, period), interpolation)
    kind = CubicSpline if interpolation == "cubic" else PchipInterpolator
    pieces = kind(table.x, table.y)
    return np.asarray(pieces.x), np.asarray(pieces.c)


def check_over_angle(table: Table, interpolation: str) -> None:
    """Refuse a speed that comes to zero, as no angle beyond is ever reached.

    Raises
    ------
    InputError : the file, where it does, and the way out
    """
    knots, coefficients = over_angle(table, interpolation)
    pieces = PPoly(coefficients, knots)
    turning = pieces.derivative().roots(discontinuity=False, extrapolate=False)
    angle = np.sort(np.concatenate([table.x, turning[np.isfinite(turning)]]))
    speed = np.where(np.isin(angle, table.x), np.interp(angle, table.x, table.y), pieces(angle))
    sense = math.copysign(1.0, table.y[0])
    slow = np.flatnonzero(sense * speed <= _STANDS * max(map(abs, table.y)))
    if len(slow) == 0:
        return
    at = float(angle[slow[0]])
    between = "" if at in table.x else f", between two rows of the {interpolation} curve"
    way_out = ', or use interpolation = "pchip"' if between and interpolation == "cubic" else ""
    raise InputError(
        f"{table.source}: a speed over the crank angle must keep its sign and never come to 0, or "
        f"the crank gets no farther; at {at / DEGREE:g} degrees it is {speed[slow[0]] / RPM:g} rpm"
        f"{between}; leave out such rows{way_out}, or give the speed over time, time_s"
    )


def remarks_on(table: Table) -> tuple[str, ...]:
    """What a reader should know of what was made of the rows, in sentences."""
    if not repeats(table):
        return ()
    apart = abs(table.y[-1] - table.y[0])
    if apart == 0.0:
        return ()
    return (
        f"{table.source}: the closing row, {apart / RPM:.3g} rpm from the first one, is dropped",
    )
