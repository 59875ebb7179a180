"""The number systems of the oracles, 80-bit floats, doubles and mpmath numbers, behind one
interface."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import mpmath
import numpy as np
from numpy.typing import NDArray

Number: TypeAlias = Any
"""A float, numpy.longdouble, mpmath.mpf, or a decimal string ("0.046" is exactly 46/1000)."""

Array: TypeAlias = NDArray[Any]
"""numpy.longdouble, or dtype object holding mpmath numbers."""


@dataclass(frozen=True)
class Arithmetic:
    """Conversion and the few functions the oracles need; cos, sin and arcsin work on arrays."""

    digits: int
    epsilon: Number
    pi: Number
    number: Callable[[Number], Number]
    cos: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    arcsin: Callable[[Any], Any]
    dtype: type

    def array(self, values: Sequence[Number] | Array) -> Array:
        """Values in this arithmetic."""
        return np.array([self.number(value) for value in values], dtype=self.dtype)

    def zeros(self, *shape: int) -> Array:
        """Zeros in this arithmetic."""
        return np.full(shape, self.number(0), dtype=self.dtype)

    def whole_turns(self, angle: Number) -> Number:
        """The turns, whole or and a half [rad], that a float stands for, else the angle itself: the
        float is not a period, which after a thousand turns is seen."""
        turns = self.pi * round(float(angle / self.pi))
        return turns if float(turns) == float(angle) else self.number(angle)


def _to_longdouble(value: Number) -> Number:
    if isinstance(value, str | np.longdouble):
        return np.longdouble(value)
    leading = float(value)  # an mpf in two parts: 53 bits and what is left
    if not np.isfinite(leading):
        return np.longdouble(leading)
    return np.longdouble(leading) + np.longdouble(float(value - leading))


def _longdouble() -> Arithmetic:
    if np.finfo(np.longdouble).nmant != 63:
        raise RuntimeError("the oracles need an 80-bit numpy.longdouble (64 bits of mantissa)")
    return Arithmetic(
        digits=19,
        epsilon=np.finfo(np.longdouble).eps,
        pi=4 * np.arctan(np.longdouble(1)),
        number=_to_longdouble,
        cos=np.cos,
        sin=np.sin,
        arcsin=np.arcsin,
        dtype=np.longdouble,
    )


def multiprecision(digits: int) -> Arithmetic:
    """mpmath numbers of `digits` decimal digits, in a context of their own."""
    context = mpmath.MPContext()
    context.dps = digits

    def number(value: Number) -> Number:
        if isinstance(value, np.longdouble) and np.isfinite(value):
            leading = float(value)
            return context.mpf(leading) + context.mpf(float(value - np.longdouble(leading)))
        if isinstance(value, np.generic):
            value = value.item()
        return context.mpf(value)

    def elementwise(function: Callable[[Number], Number]) -> Callable[[Any], Any]:
        return np.frompyfunc(function, 1, 1)

    return Arithmetic(
        digits=digits,
        epsilon=+context.eps,
        pi=+context.pi,
        number=number,
        cos=elementwise(context.cos),
        sin=elementwise(context.sin),
        arcsin=elementwise(context.asin),
        dtype=object,
    )


LONG = _longdouble()

DOUBLE = replace(
    LONG, digits=15, epsilon=np.finfo(np.float64).eps, pi=np.pi, number=float, dtype=np.float64
)
"""Four times as quick, where sums of many panels are taken and not their last digits."""


def distance(a: Number, b: Number) -> float:
    """|a - b| of two numbers of any kind, taken before it is rounded to double."""
    wide = multiprecision(40)
    return abs(float(wide.number(a) - wide.number(b)))
