"""A function of time, crank angle and speed that someone wrote in Python, safe to call."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.cycle import tiled

__all__ = ["Function", "named"]

_BESIDE = 1e-9  # of a speed: so near beside a jump
_LEAST = 1e-150  # rad/s: so near beside rest, where a damper gives nothing and a jump all of it
_HAIR = 1e-9  # rad: so near a kink in the angle, by rounding, it may be past it
_EVERYWHERE = (-math.inf, math.inf)
_AHEAD = (5.0, -10.0, 10.0, -5.0, 1.0)  # shares of five equally spaced values in the next one
_NUDGE = 1e-6  # of the speed: of a difference quotient that Newton's method takes for a slope


def named(function: object) -> str:
    """The name of a function, as a reader knows it.

    >>> named(math.sin)
    'sin'
    """
    return str(getattr(function, "__name__", type(function).__name__))


def _beside(speed: float) -> float:
    """How far from a speed [rad/s] it is beside a jump there."""
    return _BESIDE * max(abs(speed), 1.0) if speed else _LEAST


def _continued(f: Callable[[float], float], x: float, low: float, high: float) -> float:
    """A function between two bounds; a little beyond, the polynomial through five of its values
    inside; far beyond the last of them."""
    edge = min(max(x, low), high)
    beyond = x - edge
    if beyond == 0.0:
        return f(x)
    if abs(beyond) > 0.2 * (high - low):
        return f(edge)
    return sum(share * f(edge - k * beyond) for k, share in enumerate(_AHEAD))


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

    @property
    def called(self) -> str:
        """Its name."""
        return named(self._function)

    def angles_in(self, period: float) -> Array:
        """Its angles repeated over a period [rad] of which its own is a part."""
        part = self.period or 2.0 * math.pi
        return tiled(np.array(self.angles), part, period)

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
            self.failure = f"{self.called} {why or f'gives {value:g}'} at {state}"
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
        if omega not in self.speeds:
            return self.number(t, theta, omega)
        return self.number(t, theta, omega + side * _beside(omega))

    def continued(
        self,
        state: tuple[float, float, float],
        t_end: float,
        angles: tuple[float, float],
        speeds: tuple[float, float],
    ) -> float:
        """Its value at a state (time, angle, speed); where that lies beyond a kink, what its values
        before make of it: a step that passes the kink, and is cut there, then sees none.

        t_end, angles, speeds : between which kinks its piece lies, [s], [rad], [rad/s]

        >>> step = Function(lambda t, theta, omega: float(theta >= 1.0), angles=(1.0,))
        >>> step.continued((0.0, 1.001, 5.0), math.inf, (0.0, 1.0), (0.0, math.inf))
        0.0
        """
        t, theta, omega = state
        t = t if t < t_end else math.nextafter(t_end, -math.inf)
        low, high = angles if self.angles else _EVERYWHERE
        hair = min(_HAIR, 0.25 * (high - low))
        least, most = speeds if self.speeds else _EVERYWHERE
        least, most = least + _beside(least), most - _beside(most)

        def at(angle: float) -> float:
            return _continued(lambda speed: self.number(t, angle, speed), omega, least, most)

        return _continued(at, theta, low + hair, high - hair)

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
