"""A record over time of a cylinder's pressure and a wheel, and what of its speed is free of errors.

Between two teeth the crank takes the time D, once in each revolution of a cycle. The tooth's error
is the same in both, so 1/2 ln(D_2 / D_1), the half orders of ln omega, is free of it. J(theta) is
the same, too: omega_1^2 / omega_2^2 is the ratio of the kinetic energies at one angle, in which the
torque of the reciprocating masses cancels.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PPoly

from crankmbs.delimited import decode, read_sheet
from crankmbs.indicated.over_time import turned
from crankmbs.indicated.rotation import Rotation
from crankmbs.indicated.sensor import sensor_of
from crankmbs.indicated.wheel import wheel_of

__all__ = ["Array", "Logged", "half_orders", "orders_of", "read_logged"]

Array = NDArray[np.float64]

_TURNS = 2  # of a four-stroke cycle
_ORDERS = np.arange(0.5, 12.0)


class Logged(NamedTuple):
    """A record.

    digest : SHA-256 of the file; time [s], pressure [Pa] : shape (n,), as the sensor has them
    integral : of the pressure over the time [Pa s], by a cubic spline
    begin : wheel angle [deg] at which the first cycle begins, which fires in its second revolution
    cycles : whole ones from there on
    """

    name: str
    digest: str
    time: Array
    pressure: Array
    integral: PPoly
    rotation: Rotation
    begin: float
    cycles: int

    @property
    def edges(self) -> int:
        """Of a revolution."""
        return self.rotation.wheel.edges

    def edge_times(self, first: int, count: int) -> Array:
        """Times [s] of cycles ``first`` to ``first + count - 1``, the last the next one's first."""
        return self.rotation.time[self._edges(first, count)]

    def edge_angles(self, first: int, count: int) -> Array:
        """The same in degrees from the first of them."""
        angle = self.rotation.angle[self._edges(first, count)]
        return np.asarray(angle - angle[0])

    def _edges(self, first: int, count: int) -> slice:
        a = round(self.begin / 360.0) * self.edges + first * _TURNS * self.edges
        return slice(a, a + count * _TURNS * self.edges + 1)

    def pressures(self, angle: Array, delay: float) -> Array:
        """Means over the steps between wheel angles [deg], evenly apart, at those angles, of a
        sensor that shows them late by ``delay`` [s]; beyond the record its first or last value."""
        step, whole = angle[1] - angle[0], self.rotation.angle
        edges = np.clip(np.append(angle, angle[-1] + step) - 0.5 * step, whole[0], whole[-1])
        until = np.clip(self.rotation.time_at(edges) + delay, self.time[0], self.time[-1])
        lasts = np.diff(until)
        held = np.interp(until[:-1], self.time, self.pressure)
        sums = np.diff(self.integral(until))
        return np.asarray(np.where(lasts > 0.0, sums / np.where(lasts > 0.0, lasts, 1.0), held))


def read_logged(path: Path, wheel: str, sensor: str) -> Logged:
    """A file of three columns without names: time in s, sensor in V, wheel in V."""
    content = path.read_bytes()
    time, volts, signal = read_sheet(path.name, decode(content, path.name)).values.T
    rotation = turned(time, signal, None, wheel_of(wheel), 2 * _TURNS)
    pressure = sensor_of(sensor)(volts)
    found = Logged(
        path.stem,
        hashlib.sha256(content).hexdigest(),
        time,
        pressure,
        CubicSpline(time, pressure).antiderivative(),
        rotation,
        0.0,
        rotation.cycles,
    )
    angle = np.arange(0.0, rotation.cycles * rotation.period)
    mean = found.pressures(angle, 0.0).reshape(rotation.cycles, -1).mean(axis=0)
    if np.argmax(mean) >= 360:
        return found
    turns = round((rotation.angle[-1] - 360.0) // 360.0)
    return found._replace(begin=360.0, cycles=turns // _TURNS)


def half_orders(times: Array, edges: int) -> Array:
    """1/2 ln(omega_1 / omega_2) at each tooth, shape (cycles, edges), from the edges' times."""
    steps = np.diff(times).reshape(-1, _TURNS, edges)
    return np.asarray(0.5 * np.log(steps[:, 1] / steps[:, 0]))


def orders_of(half: Array, pitch: float, most: float) -> Array:
    """Complex amplitudes of the orders 0.5, 1.5, ... up to ``most``, by least squares with all up
    to 11.5; shape (..., orders).

    half : shape (..., edges), at the middles of the intervals, the last of which is the gap
    """
    edges = half.shape[-1]
    places = np.append(np.arange(0.0, edges) * pitch, 360.0)
    turned_by = np.radians(0.5 * (places[1:] + places[:-1]))[:, None] * _ORDERS
    fit = np.linalg.pinv(np.hstack([np.cos(turned_by), np.sin(turned_by)]))
    parts = half @ fit.T
    count, wanted = len(_ORDERS), round(most + 0.5)
    return np.asarray((parts[..., :count] - 1j * parts[..., count:])[..., :wanted])
