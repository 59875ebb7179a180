"""A function of time, crank angle and speed that someone wrote in Python, safe to call."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["Function", "named"]

_BESIDE = 1e-9  # of a speed: so near beside a jump
_NUDGE = 1e-6  # of the speed: of a difference quotient that Newton's method takes for a slope


def named(function: object) -> str:
    """The name of a function, as a reader knows it.

    >>> named(math.sin)
    'sin'
    """
    return str(getattr(function, "__name__", type(function).__name__))


class Function:
    """Where it raises or gives no finite number it is NaN, and `failure` says so.

    function : (t, theta, omega) -> a number, pure
    times, angles, speeds : where it bends or jumps, [s], [rad] and [rad/s]; angles within a period,
        or a revolution where it has none
    period [rad] : after which it comes again, of what does not depend on the time
    declared : whether it is known to bend and jump nowhere else
    """

    declared = False

    def __init__(
        self,
        function: Callable[[float, float, float], float],
        times: tuple[float, ...] = (),
        angles: tuple[float, ...] = (),
        speeds: tuple[float, ...] = (),
        period: float | None = None,
    ) -> None:
        self.period = period
        self.times, self.angles, self.speeds = sorted(times), sorted(angles), sorted(speeds)
        self.failure = ""
        self._function = function

    def angles_in(self, period: float) -> Array:
        """Its angles repeated over a period [rad] of which its own is a part."""
        part = self.period or 2.0 * math.pi
        turns = part * np.arange(round(period / part))[:, None]
        return np.asarray((np.array(self.angles) % part + turns).ravel())

    def number(self, t: float, theta: float, omega: float) -> float:
        """Its value at one time [s], angle [rad] and speed [rad/s]; NaN where it has none."""
        if not math.isfinite(t + theta + omega):  # a trial far off: it asks for nothing
            return math.nan
        try:
            value, why = float(self._function(t, theta, omega)), ""
        except Exception as error:  # whatever the function of a user may raise
            value, why = math.nan, f"raises {type(error).__name__}: {error}"
        if not math.isfinite(value):
            state = f"t = {t:.6g} s, theta = {theta:.6g} rad, omega = {omega:.6g} rad/s"
            self.failure = f"{named(self._function)} {why or f'gives {value:g}'} at {state}"
            return math.nan
        return value

    def __call__(self, t: Array, theta: Array, omega: Array) -> Array:
        """Its values at times [s], angles [rad] and speeds [rad/s] of one shape.

        >>> Function(lambda t, theta, omega: t + omega)(np.ones(2), np.ones(2), np.ones(2))
        array([2., 2.])
        """
        at = np.broadcast_arrays(t, theta, omega)
        flat = [np.ascontiguousarray(one, dtype=np.float64).ravel() for one in at]
        values = self._quick(flat)
        if values is None:
            rows = zip(*(one.tolist() for one in flat), strict=True)
            values = np.array([self.number(*row) for row in rows])
        return np.asarray(values.reshape(at[0].shape))

    def beside(self, t: float, theta: float, omega: float, side: float) -> float:
        """Its value, and at a speed where it may jump that of the side (a sign) of this speed."""
        at_kink = omega in self.speeds
        return self.number(t, theta, omega + side * _BESIDE * max(abs(omega), 1.0) * at_kink)

    def slope(self, t: Array, theta: Array, omega: Array) -> Array:
        """About its derivative in the speed."""
        nudge = _NUDGE * np.abs(omega)
        return np.asarray((self(t, theta, omega + nudge) - self(t, theta, omega)) / nudge)

    def _quick(self, at: list[Array]) -> Array | None:
        """Its values, if none raises and all are finite numbers."""
        try:
            values = self._values(at)
        except Exception:  # again one by one, which tells where it was
            return None
        return values if np.isfinite(values).all() else None

    def _values(self, at: list[Array]) -> Array:
        """Its values at times, angles and speeds of shape (n,)."""
        return np.asarray(self._each(*at), dtype=np.float64)

    @cached_property
    def _each(self) -> np.ufunc:
        """The function of one number after the other, as Python floats."""
        function = self._function
        each: np.ufunc = np.frompyfunc(lambda *at: float(function(*at)), 3, 1)
        return each
