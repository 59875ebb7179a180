"""How the crank turned, from the edges of a wheel whose teeth stand unevenly.

Over the mean cycle the time of an edge, as an angle at the mean speed, is that of its place plus a
Fourier series of low orders; what is left over, alike in every revolution, is where its tooth
stands. The half orders, the differences of the two revolutions of a four-stroke cycle, are free of
the teeth's errors; of whole orders they take some part, which the spread of what is left over
tells. The edges beside the gap, which a magnetic sensor shows late and early, are not fitted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from crankmbs.errors import InputError
from crankmbs.indicated.wheel import Wheel
from crankmbs.numerics.arrays import Array, Index

__all__ = ["Rotation", "rotation_of"]

_SIGMAS = 3.0  # standard deviations in a stated error
_FINEST = 12  # orders: a crank train's speed hardly has higher ones
_TEETH = 8  # an order takes so many teeth, or their errors would pass for speed
_GRID = np.arange(0.0, 720.0, 3.0)  # degrees
# A mean cycle closes, and where each cycle begins slower than it ends it lacks half the difference
# at either end; a series of finite order overshoots a jump by another 9 % of it.
_OF_JUMP = 0.59


class _Series(NamedTuple):
    """sum of coefficients times basis; covariance of the coefficients."""

    orders: Array
    constant: bool
    coefficients: Array
    covariance: Array

    def basis(self, angle: Array, slope: bool = False) -> Array:
        """Constant, cosines and sines, or their slopes [1/rad], shape (n, m)."""
        turned = np.radians(angle)[:, None] * self.orders
        parts = [np.cos(turned), np.sin(turned)]
        if slope:
            parts = [-self.orders * parts[1], self.orders * parts[0]]
        ones = np.full((len(angle), int(self.constant)), 0.0 if slope else 1.0)
        return np.hstack([ones, *parts])

    def at(self, angle: Array, slope: bool = False) -> Array:
        return self.basis(angle, slope) @ self.coefficients

    def variance(self, basis: Array) -> Array:
        return np.asarray(np.einsum("ij,jk,ik->i", basis, self.covariance, basis))

    @property
    def tail(self) -> float:
        """Amplitude of the slope at the highest order: about what higher ones may have."""
        n = len(self.orders)
        pair = self.coefficients[int(self.constant) :][[n - 1, 2 * n - 1]]
        return float(self.orders[-1] * np.hypot(*pair))


class Rotation(NamedTuple):
    """The crank's turning over a record.

    wheel; period : of the cycle [deg]; cycles : whole ones; begin, end : their times [s]
    teeth : shape (edges,) [deg]: by how much each tooth stands behind its place, as far as that
        shows beyond the fitted orders; angles count from where the first edge is seen
    orders : highest one that is fitted; angle_error : three standard deviations, largest [deg], and
        half a step of the clock
    tick : step of the clock [s] by which the times of edges are known, 0 of a signal with flanks
    speeds : of each cycle, shape (cycles,) [deg/s]
    angle, time : of all edges, shape (n,) [deg, s]
    """

    wheel: Wheel
    period: float
    cycles: int
    begin: float
    end: float
    teeth: Array
    orders: int
    angle_error: float
    tick: float
    speeds: Array
    angle: Array
    time: Array
    series: tuple[_Series, ...]

    def time_at(self, angle: Array) -> Array:
        """Times [s] at angles [deg] from the first edge, by a cubic spline through all edges."""
        return CubicSpline(self.angle, self.time)(angle)

    def words(self) -> list[str]:
        """The wheel's findings in sentences."""
        wheel, inner = self.wheel, self.teeth[1:-1] if self.wheel.missing else self.teeth
        sentences = [
            f"{self.cycles} whole cycles from {self.begin:.6g} to {self.end:.6g} s, at a mean of "
            f"{self.mean_speed / 6.0:.5g} rpm; beyond order {self.orders} the teeth are up to "
            f"{np.max(np.abs(inner)):.2g} degrees out of place, which is corrected; angles of the "
            f"mean cycle are then right to {self.angle_error:.2g} degrees; an eccentric wheel "
            "cannot be seen"
        ]
        if wheel.missing:
            first, last = (
                f"{abs(each):.2g} degrees {'late' if each > 0.0 else 'early'}"
                for each in self.teeth[[0, -1]]
            )
            sentences.append(
                f"judged by the other teeth, the first edge after the gap comes {first}, the last "
                f"one before it {last}"
            )
        return sentences

    @property
    def mean_speed(self) -> float:
        """Degrees per second over the whole cycles."""
        return self.cycles * self.period / (self.end - self.begin)

    def speed(self, angle: Array) -> Array:
        """Of the mean cycle, over the angle [deg] from the first edge, in degrees per second."""
        place = angle + self.teeth[0]
        slope = sum(each.at(place, slope=True) for each in self.series)
        return self.mean_speed / (1.0 + np.radians(slope))

    def speed_error(self, half: bool = False) -> float:
        """Largest error of `speed`, in degrees per second; of its half orders alone: that of the
        slopes, what higher orders may have, and the angle's error on the steepest part; in the
        half orders of 1 / (1 + slope) that of the whole ones, too, times twice their swing.

        Besides, that of the clock's steps: they are a sawtooth, which in the orders of the fit has
        a slope of orders times tick over pi at most; and of a speed that differs from cycle to
        cycle, where the mean one closes."""
        return self._steady_error(half) + _OF_JUMP * self.jump * (0.5 if half else 1.0)

    @property
    def jump(self) -> float:
        """Largest difference [deg/s] between the mean speeds of a cycle and the next."""
        return float(np.max(np.abs(np.diff(self.speeds))))

    def differing(self) -> list[str]:
        """A warning where the cycles' speeds differ by more than the error of a steady mean."""
        if np.ptp(self.speeds) <= self._steady_error(half=False):
            return []
        first, last, low, high = (
            each / 6.0 for each in (*self.speeds[[0, -1]], np.min(self.speeds), np.max(self.speeds))
        )
        return [
            f"warning: the mean speeds of the cycles lie from {low:.5g} to {high:.5g} rpm, "
            f"{first:.5g} of the first and {last:.5g} of the last, and differ by up to "
            f"{self.jump / 6.0:.3g} rpm from one to the next: the mean cycle is one of a steady "
            f"speed, and off by {_OF_JUMP * self.jump / 6.0:.2g} rpm where it closes; cut the "
            "record to cycles of one speed, or give [motion] a ramp or the speed over time"
        ]

    def _steady_error(self, half: bool) -> float:
        parts = self.series[1:] if half else self.series
        variance = sum(each.variance(each.basis(_GRID, slope=True)) for each in parts)
        relative = _SIGMAS * np.sqrt(np.max(variance)) + sum(each.tail for each in parts)
        relative += self.orders * self.mean_speed * self.tick / np.pi
        swing, mixed = self.speed(_GRID), 0.0
        if half:
            swing = 0.5 * (swing - np.roll(swing, len(_GRID) // 2))
            mixed = 2.0 * np.max(np.abs(swing)) / self.mean_speed * self._steady_error(half=False)
        steepest = np.max(np.abs(np.gradient(swing, _GRID)))
        return float(self.mean_speed * np.radians(relative) + steepest * self.angle_error + mixed)


def rotation_of(
    time: Array, first: Index, wheel: Wheel, stroke: int, tick: float = 0.0
) -> Rotation:
    """The rotation from the times [s] of a wheel's edges.

    first : the places of the first edges after the gaps; stroke : 2 or 4; tick : step [s] of the
        clock that has these times

    Raises
    ------
    InputError : less than two cycles
    """
    turns = stroke // 2
    cycles = (len(first) - 1) // turns
    if cycles < 2:
        raise InputError(
            f"{len(first) - 1} whole revolutions are less than two cycles of a "
            f"{stroke}-stroke engine, {2 * turns} revolutions; record longer"
            + (", or give stroke=2" if stroke == 4 else "")
        )
    m = wheel.edges
    place = np.arange(0.0, m) * wheel.pitch
    begins = time[first[: cycles * turns + 1 : turns]]
    rows = time[first[: cycles * turns, None] + np.arange(m)].reshape(cycles, turns * m)
    period = 360.0 * turns
    shares = (rows - begins[:-1, None]) / np.diff(begins)[:, None]
    late = (
        np.mean(shares * period, axis=0).reshape(turns, m)
        - place
        - 360.0 * np.arange(turns)[:, None]
    )
    good = np.full(m, True)
    if wheel.missing:
        good[[0, -1]] = False
    most = min(_FINEST, m // _TEETH)
    whole = _fit(place, late.mean(axis=0), np.arange(1.0, most + 1.0), good, constant=True)
    series = [whole]
    if turns == 2:
        series.append(_fit(place, 0.5 * (late[0] - late[1]), np.arange(0.5, most), good))
    teeth = late.mean(axis=0) - whole.at(place)
    every = np.arange(first[0], first[-1] + 1)
    number, turn = (every - first[0]) % m, (every - first[0]) // m
    bases = [each.basis(_GRID) - each.basis(np.zeros(1)) for each in series]
    variance = sum(each.variance(basis) for each, basis in zip(series, bases, strict=True))
    speeds = period / np.diff(begins)
    return Rotation(
        wheel=wheel,
        period=period,
        cycles=cycles,
        begin=float(begins[0]),
        end=float(begins[-1]),
        teeth=teeth,
        orders=most,
        angle_error=float(_SIGMAS * np.sqrt(np.max(variance)) + 0.5 * tick * np.mean(speeds)),
        tick=tick,
        speeds=speeds,
        angle=place[number] + teeth[number] - teeth[0] + 360.0 * turn,
        time=time[every],
        series=tuple(series),
    )


def _fit(
    place: Array, values: Array, orders: Array, good: np.ndarray, *, constant: bool = False
) -> _Series:
    """Least squares over one revolution; what is left over is taken for independent errors."""
    empty = _Series(orders, constant, np.empty(0), np.empty(0))
    basis = empty.basis(place[good])
    coefficients, *_ = np.linalg.lstsq(basis, values[good], rcond=None)
    residual = values[good] - basis @ coefficients
    variance = float(residual @ residual) / max(len(residual) - basis.shape[1], 1)
    return empty._replace(
        coefficients=coefficients, covariance=variance * np.linalg.inv(basis.T @ basis)
    )
