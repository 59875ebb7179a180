"""Where a stretch ends before its time: at a crank angle or at a speed, met exactly.

The solver runs a few steps beyond, with loads that go on as they were; the table is then cut.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs.formulations.base import Array
from crankmbs.formulations.multibody.model import Record
from crankmbs.formulations.multibody.table import ROWS, Table
from crankmbs.roots import invert_monotone

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
_BESIDE = 1e-10  # of a speed: so near it is on it


class Bounds(NamedTuple):
    """Crank angles [rad] and speeds [rad/s], lower and upper, between which a stretch runs."""

    angles: tuple[float, float]
    speeds: tuple[float, float]

    def speeds_left(self) -> tuple[float, float]:
        """Speeds [rad/s] beyond which the range of speeds is left, whatever the rounding."""
        slow, fast = self.speeds
        return slow - _BESIDE * abs(slow), fast + _BESIDE * abs(fast)


class Watch:
    """Ends a stretch a little beyond its bounds, or calls it off."""

    def __init__(self, bounds: Bounds, go_on: Callable[[], bool]) -> None:
        self._low, self._high = bounds.angles[0] - PASSED, bounds.angles[1] + PASSED
        self._slow, self._fast = bounds.speeds_left()
        self._go_on = go_on
        self._count = self._beyond = self._past_speed = 0
        self.called_off = False

    def __call__(self, theta: float, omega: float) -> bool:
        self._count += 1
        inside = self._low < theta < self._high
        self._beyond = 0 if inside else self._beyond + 1
        left = self._count > 1 and not self._slow <= omega <= self._fast
        if left or self._past_speed:
            self._past_speed += 1  # what comes after is no answer, even if it comes back
        if self._count % 64 == 0 and not self._go_on():
            self.called_off = inside
        if self.called_off:
            return False
        return max(self._beyond, self._past_speed) <= ROWS // 2 or self._count <= LEAST_STEPS


def angle_passed(record: Record, angles: tuple[float, float]) -> float | None:
    """The bound that the last crank angle of a run lies at or beyond, if it does."""
    theta = float(record.position[-1, 2])
    return angles[0] if theta <= angles[0] else angles[1] if theta >= angles[1] else None


def cut_at_angle(table: Table, bound: float) -> Table:
    """End a table where its crank angle last comes to a bound."""
    theta, times = table.column("crank_angle"), table.times
    sense = math.copysign(1.0, theta[-1] - theta[-ROWS])
    k = int(np.flatnonzero(sense * (theta - bound) < 0.0)[-1])
    return _cut(table, ("crank_angle", "crank_speed"), bound, (times[k], times[k + 1]))


def cut_at_speed(table: Table, bounds: Bounds) -> tuple[Table, float] | None:
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
    return _cut(table, ("crank_speed", "crank_acceleration"), bound, between), bound


def _cut(table: Table, names: tuple[str, str], bound: float, between: tuple[float, float]) -> Table:
    """End a table where a variable, given with its rate, comes to a bound between two times."""

    def value(time: Array) -> tuple[Array, Array]:
        return table.with_rate(*names, time)

    low, high = (np.array([time]) for time in between)
    until = float(invert_monotone(value, np.array([bound]), low, high)[0])
    return table._replace(until=max(until, table.after))
