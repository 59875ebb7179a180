"""Orders: the harmonics of a sampled quantity over one cycle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from crankmbs.errors import InputError
from crankmbs.measures.span import last_span
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["Orders", "orders"]


@dataclass(frozen=True)
class Orders:
    """A quantity as mean + sum of amplitude cos(order angle + phase) over one cycle.

    order : shape (n,), per revolution of the crank; a four-stroke cycle gives halves
    amplitude : shape (n,) or (n, cylinders) [unit of the quantity]; phase [rad] alike
    mean : over the angle [unit]; shape () or (cylinders,)
    """

    order: Array
    amplitude: Array
    phase: Array
    mean: Array


def orders(result: Result, name: str, highest: float = 12.0) -> Orders:
    """Split a variable into its orders over the last whole cycle.

    c_k = (2 / P) int f exp(-i k angle) d(angle) over the period P, by the trapezoid rule on even
    angles, which is exact to rounding for a smooth periodic quantity and errs with the square of
    the spacing times the jump between the cycle's two ends otherwise. Samples on even angles are
    taken as they are, others through a cubic spline. No error is stated: that of the variable is
    at most doubled in an amplitude, what the samples miss comes on top.

    Parameters
    ----------
    name : a variable of the result; per cylinder ones are split over each cylinder's cycle angle,
        all others over the crank angle
    highest : largest order wanted; it must stay below half the samples per revolution

    Raises
    ------
    InputError : no such variable, no whole cycle in the run, a reversal in it, an order too high

    >>> float(orders(simulate(load_scene("propeller")), "crank_torque").order[0])
    0.5
    """
    if name not in result.data.data_vars:
        raise InputError(
            f"{name!r} is no variable of the result: {', '.join(map(str, result.data))}"
        )
    window = last_span(result)
    if window.kind != "last cycle":
        raise InputError("orders need one whole cycle; let the run last longer")
    angle = result.data["crank_angle"].values[window.first :] * math.copysign(1.0, window.angle)
    if np.any(np.diff(angle) <= 0.0):
        raise InputError("orders need a crank that turns one way; it reverses in the last cycle")
    period = result.scene.period
    per_revolution = 2.0 * math.pi / period
    count = round(period / float(np.median(np.diff(angle))))
    wanted = int(highest / per_revolution + 1e-9)
    if wanted < 1 or 2 * wanted >= count:
        raise InputError(
            f"highest must be from {per_revolution:g} to below {count * per_revolution / 2:g}, "
            f"half the samples per revolution; {highest:g} came"
        )
    spline = CubicSpline(angle, result.data[name].values[window.first :])
    even = angle[-1] - period + period * np.arange(count) / count
    parts = np.fft.rfft(spline(even), axis=0) / count
    mean, parts = parts[0].real, parts[1 : wanted + 1]
    order = per_revolution * np.arange(1.0, wanted + 1.0, dtype=np.float64)
    sense = math.copysign(1.0, window.angle)
    cosine_phase = np.angle(parts) - _column(order * even[0], parts)
    phase = sense * cosine_phase
    if "cylinder" in result.data[name].dims:
        phase = phase - np.outer(order, [c.phase for c in result.scene.cylinders])
    wrapped = np.mod(phase + math.pi, 2.0 * math.pi) - math.pi
    return Orders(order, 2.0 * np.abs(parts), wrapped, mean)


def _column(values: Array, like: NDArray[np.complex128]) -> Array:
    return values.reshape(-1, *[1] * (like.ndim - 1))
