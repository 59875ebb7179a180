"""Where a stretch ends before its time: at a crank angle or at a speed, met exactly.

The solver runs a few steps beyond, with loads that go on as they were; the table is then cut.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs.motion.multibody.step_table import ROWS, StepTable
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.roots import invert_monotone

__all__ = [
    "LEAST_STEPS",
    "PASSED",
    "Bounds",
    "Watch",
    "angle_passed",
    "cut_at_angle",
    "cut_at_speed",
]

LEAST_STEPS = ROWS + 2
PASSED = 1e-8  # rad
_BESIDE = 1e-10  # of a speed, and of a step in time: so near it is on it
_ON = 1e-12  # rad: so near a bound it is on it
_ANGLE = ("crank_angle", "crank_speed")
_SPEED = ("crank_speed", "crank_acceleration")


class Bounds(NamedTuple):
    """Crank angles [rad] and speeds [rad/s], lower and upper, between which a stretch runs."""

    angles: tuple[float, float]
    speeds: tuple[float, float]

    def speeds_left(self) -> tuple[float, float]:
        """Speeds [rad/s] beyond which the range of speeds is left, whatever the rounding."""
        slow, fast = self.speeds
        return slow - _BESIDE * abs(slow), fast + _BESIDE * abs(fast)


class Watch:
    """Ends a stretch a little beyond its bounds, or calls it off.

    idle : whether it has nothing to watch, so that it need not be asked
    """

    def __init__(self, bounds: Bounds, go_on: Callable[[], bool] | None) -> None:
        self.idle = go_on is None and not any(math.isfinite(x) for pair in bounds for x in pair)
        self._low, self._high = bounds.angles[0] - PASSED, bounds.angles[1] + PASSED
        self._slow, self._fast = bounds.speeds_left()
        self._go_on = go_on
        self._count = self._beyond = self._past_speed = 0
        self.called_off = False

    def __call__(self, theta: float, omega: float) -> bool:
        """Whether to go on after a step to this crank angle [rad] and speed [rad/s]."""
        self._count += 1
        inside = self._low < theta < self._high
        self._beyond = 0 if inside else self._beyond + 1
        left = self._count > 1 and not self._slow <= omega <= self._fast
        if left or self._past_speed:
            self._past_speed += 1  # what comes after is no answer, even if it comes back
        if self._count % 64 == 0 and self._go_on is not None and not self._go_on():
            self.called_off = inside
        if self.called_off:
            return False
        return max(self._beyond, self._past_speed) <= ROWS // 2 or self._count <= LEAST_STEPS


def angle_passed(table: StepTable, angles: tuple[float, float]) -> tuple[float, float] | None:
    """The bound that a table ends at or beyond, if it does, and the sense (a sign) to pass it.

    A crank that rests on a bound does not pass it.
    """
    theta = table.column("crank_angle")
    theta = theta[table.times > table.after - _BESIDE * table.step]
    for bound, sense in zip(angles, (-1.0, 1.0), strict=True):
        if sense * (theta[-1] - bound) >= 0.0:
            return None if np.max(np.abs(theta - bound)) <= _ON else (bound, sense)
    return None


def cut_at_angle(table: StepTable, bound: float, sense: float) -> StepTable:
    """End a table where its crank angle last comes to a bound, in this sense (a sign).

    It ends where it begins if it lies beyond the bound from there on. An excursion to this side may
    be shorter than a step: then it turns back between the beginning and the next row.
    """
    times, theta = table.times, table.column("crank_angle")
    later = times > table.after + _BESIDE * table.step
    times, short = times[later], sense * (bound - theta[later])
    inside = np.flatnonzero(short > 0.0)
    if len(inside) > 0:
        k = int(inside[-1])
        return _cut(table, _ANGLE, bound, (times[k], times[k + 1]))
    resting = int(np.argmax(short < -_ON))  # rows on the bound before it leaves
    if resting > 0:
        return table._replace(until=float(times[resting - 1]))
    begin = table.after
    angle, speed = (float(x[0]) for x in table.with_rate(*_ANGLE, np.array([begin])))
    if sense * speed < 0.0:
        turned = _cut(table, _SPEED, 0.0, (begin, times[0]))
        return _cut(table, _ANGLE, bound, (turned.until, times[0]))
    if sense * (bound - angle) > _ON:
        return _cut(table, _ANGLE, bound, (begin, times[0]))
    return table._replace(until=begin)


def cut_at_speed(table: StepTable, bounds: Bounds) -> tuple[StepTable, float] | None:
    """End a table where its speed first leaves its range; also the end of the range it leaves by.

    The row that the stretch begins with may lie on a bound.
    """
    omega, times = table.column("crank_speed"), table.times
    slow, fast = bounds.speeds_left()
    half = 0.5 * table.step
    within = (times > table.after + half) & (times < table.until + half)
    left = np.flatnonzero(within & ((omega < slow) | (omega > fast)))
    if len(left) == 0:
        return None
    k = int(left[0])
    bound = bounds.speeds[0] if omega[k] < slow else bounds.speeds[1]
    between = max(times[k - 1], table.after), times[k]
    return _cut(table, _SPEED, bound, between), bound


def _cut(
    table: StepTable, names: tuple[str, str], bound: float, between: tuple[float, float]
) -> StepTable:
    """End a table where a variable, given with its rate, comes to a bound between two times."""

    def value(time: Array) -> tuple[Array, Array]:
        return table.with_rate(*names, time)

    low, high = (np.array([time]) for time in between)
    until = float(invert_monotone(value, np.array([bound]), low, high)[0])
    return table._replace(until=max(until, table.after))
