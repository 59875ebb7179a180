"""The gas: pressure difference across the piston as a periodic piecewise cubic of the cycle angle.

Whatever the scene gives, a table or an indicator diagram, becomes one set of knots and polynomial
pieces. The solvers need the pieces themselves: a knot is a step boundary, and each piece can be
continued beyond its knots.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator

from crankmbs.indicator import INDICATOR_RTOL, indicator_pieces
from crankmbs.machine import Gas
from crankmbs.scene import Scene

__all__ = ["PeriodicPressure", "crank_angle_knots", "pressure_of", "repeat"]

Array = NDArray[np.float64]

_KNOT = 1e-9  # rad: an angle this close below a knot counts as on it, so rounding does not
# decide the side of a pressure step


@dataclass(frozen=True)
class PeriodicPressure:
    """Piecewise cubic, periodic in the cycle angle.

    knots : shape (n + 1,) [rad], increasing, the last one period above the first
    coefficients : shape (4, n) [Pa, by descending power of (angle - knots[i]) in rad]
    missed : shape (4, n), alike: what the pieces may be off from the pressure that they stand for;
        None where they are that pressure
    """

    knots: Array
    coefficients: Array
    missed: Array | None = None

    @property
    def off(self) -> PeriodicPressure:
        """A pressure as far from this one as the true pressure may be."""
        if self.missed is None:
            return self
        return PeriodicPressure(self.knots, self.coefficients + self.missed)

    @property
    def period(self) -> float:
        """Period [rad]."""
        return float(self.knots[-1] - self.knots[0])

    def __call__(self, cycle_angle: ArrayLike) -> Array:
        """Pressure difference across the piston [Pa]; at a step the value after it.

        cycle_angle : shape (...) [rad], any number of periods
        """
        angle = np.asarray(cycle_angle, dtype=np.float64)
        within = np.mod(angle - self.knots[0] + _KNOT, self.period) - _KNOT
        index = np.searchsorted(self.knots[1:-1] - self.knots[0], within + _KNOT, side="right")
        return self.piece(index, within - (self.knots[index] - self.knots[0]))

    def piece(self, index: NDArray[np.intp], distance: ArrayLike) -> Array:
        """Value [Pa] of the pieces ``index`` at ``distance`` [rad] behind their first knot."""
        a, b, c, d = self.coefficients[:, index]
        x = np.asarray(distance, dtype=np.float64)
        return np.asarray(((a * x + b) * x + c) * x + d)


def pressure_of(scene: Scene) -> PeriodicPressure | None:
    """The pressure difference across the piston of a scene; None without gas.

    cubic is the periodic C2 spline; pchip keeps monotone stretches monotone (no overshoot), also
    across the period's end; linear joins the rows; step holds a value until the next row.

    >>> pressure = pressure_of(load_scene("propeller"))
    """
    gas = scene.gas
    if gas is None:
        return None
    if gas.indicator is not None:
        knots, coefficients = indicator_pieces(scene)
        absolute = coefficients + np.array([[0.0], [0.0], [0.0], [gas.ambient or 0.0]])
        return PeriodicPressure(knots, coefficients, INDICATOR_RTOL * absolute)
    angle, value = _closed_rows(gas)
    return PeriodicPressure(angle, _coefficients(angle, value, gas.interpolation))


def _closed_rows(gas: Gas) -> tuple[Array, Array]:
    """Rows over exactly one period, gauge, in cycle angle, the first repeated at the end."""
    assert gas.pressure is not None
    angle, value = np.array(gas.pressure.x), np.array(gas.pressure.y)
    if angle[-1] - angle[0] > gas.period - 1e-9:
        angle, value = angle[:-1], value[:-1]
    if gas.zero == "firing_tdc" and gas.stroke == 4:
        angle = angle + 2.0 * np.pi
    value = value - (gas.ambient or 0.0)
    return np.append(angle, angle[0] + gas.period), np.append(value, value[0])


def _coefficients(angle: Array, value: Array, interpolation: str) -> Array:
    width, rise = np.diff(angle), np.diff(value)
    zero = np.zeros_like(width)
    if interpolation == "step":
        return np.array([zero, zero, zero, value[:-1]])
    if interpolation == "linear":
        return np.array([zero, zero, rise / width, value[:-1]])
    if interpolation == "cubic":
        return np.asarray(CubicSpline(angle, value, bc_type="periodic").c)
    # three rows more on either side make the one-sided end slopes of pchip irrelevant
    n, period = len(width), angle[-1] - angle[0]
    k = np.arange(-3, n + 4)
    wide_angle = angle[k % n] + (k // n) * period
    wide = PchipInterpolator(wide_angle, value[k % n])
    return np.asarray(wide.c[:, 3 : 3 + n])


def crank_angle_knots(scene: Scene, pressure: PeriodicPressure | None) -> Array:
    """Crank angles in [0, period) at which the pressure of any cylinder changes its piece.

    Returns
    -------
    shape (n,) [rad], increasing, cylinders merged; empty without gas
    """
    if pressure is None:
        return np.empty(0)
    angles = [np.mod(pressure.knots[:-1] - c.phase, scene.period) for c in scene.cylinders]
    merged = np.unique(np.concatenate(angles))
    merged = merged[np.append(True, np.diff(merged) > _KNOT)]
    if scene.period - merged[-1] + merged[0] <= _KNOT:
        merged = merged[:-1]
    return np.asarray(merged)


def repeat(knots: Array, period: float, low: float, high: float) -> Array:
    """The knots of one period [rad], repeated over the open interval from ``low`` to ``high``."""
    first, last = math.floor(low / period), math.floor(high / period)
    tiled = (np.arange(first, last + 1)[:, None] * period + knots).ravel()
    return np.asarray(tiled[(tiled > low) & (tiled < high)])
