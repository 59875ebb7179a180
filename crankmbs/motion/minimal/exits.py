"""Where a step over time leaves what it may not: knots of the crank angle, bounds of the speed.

A step is a polynomial of degree 7 in its fraction x, of (theta, omega, work) by ascending power.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import DOP853, Radau
from scipy.linalg import invpascal, pascal

from crankmbs.numerics.arrays import Array

__all__ = ["first_exit", "interpolant", "value"]

_DEGREE = 7
_NEWTON = 60  # steps, or halvings of the bracket, to a root
_REAL = 1e-7  # of a root: a smaller imaginary part is rounding's


def interpolant(solver: DOP853 | Radau) -> Array:
    """The polynomial of a solver's last step, shape (8, 3): SciPy's own, of order 7; of Radau the
    cubic."""
    dense: Any = solver.dense_output()
    row = np.zeros((_DEGREE + 1, 3))
    row[0] = dense.y_old
    if isinstance(solver, DOP853):
        row += _NESTED @ dense.F
    else:
        row[1:4] = dense.Q.T
    return row


def value(row: Array, x: float) -> list[float]:
    """(theta, omega, work) at the fraction x of a step."""
    values = row[_DEGREE]
    for coefficients in row[_DEGREE - 1 :: -1]:
        values = values * x + coefficients
    return [float(one) for one in values]


def first_exit(
    row: Array, angles: tuple[float, float], speeds: tuple[float, ...]
) -> tuple[float, int, float]:
    """Fraction of a step where the motion first leaves a limit; which component that limits, 0 the
    angle, 1 the speed; and the limit. (1, -1, 0) where it leaves none.

    angles : of which the motion is between, in the same measure as the step's [rad]
    speeds : one of them 0, so that the angle is monotone up to the first [rad/s]; a step that
        begins on one of them must come back to it

    >>> row = np.zeros((8, 3))
    >>> row[:3, 0], row[:2, 1] = (0.0, 1.0, -0.5), (1.0, -1.0)
    >>> first_exit(row, (-9.0, 0.375), (0.0,))
    (0.5, 0, 0.375)
    """
    first, which, limit = 1.0, -1, 0.0
    for speed in speeds:
        if math.isfinite(speed):
            off = row[:, 1].copy()
            off[0] -= speed
            root = _first_root(off)
            if root <= 1.0 and (root < first or which < 0):
                first, which, limit = root, 1, speed
    begin, end = float(row[0, 0]), value(row, first)[0]
    ahead = angles[end > begin]
    if end != begin and (end - ahead) * (begin - ahead) <= 0.0:
        off = row[:, 0].copy()
        off[0] -= ahead
        first, which, limit = _bracketed(off.tolist(), first), 0, ahead
    return first, which, limit


def _first_root(row: Array) -> float:
    """The first x above 0, up to 1, at which a polynomial changes its sign; infinite if none."""
    while len(row) > 1 and row[0] == 0.0:
        row = row[1:]
    control = row @ _BERNSTEIN[len(row) - 1]
    if control.min() > 0.0 or control.max() < 0.0 or not np.isfinite(control).all():
        return math.inf  # it is as its control points
    roots = np.roots(row[::-1])
    near = np.abs(roots.imag) <= _REAL * np.abs(roots)
    inside = np.sort(roots.real[near & (roots.real > 0.0) & (roots.real <= 1.0 + _REAL)])
    ends = np.append(np.minimum(inside, 1.0), 1.0)
    for x, after in pairwise(ends):
        beyond = np.polyval(row[::-1], 0.5 * (x + after))
        if beyond * row[0] < 0.0 or (x == after and np.polyval(row[::-1], 1.0) * row[0] <= 0.0):
            return float(x)
    return math.inf


def _bracketed(row: list[float], high: float) -> float:
    """The root of a monotone polynomial between 0 and ``high``, by Newton's method."""
    low, rises, x = 0.0, row[0] < 0.0, high
    for _ in range(_NEWTON):
        value = slope = 0.0
        for coefficient in reversed(row):
            slope = slope * x + value
            value = value * x + coefficient
        if value == 0.0:
            return x
        low, high = (x, high) if (value < 0.0) == rises else (low, x)
        new = x - value / slope if slope != 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if new in (x, low, high):
            return new
        x = new
    return x


def _nested() -> Array:
    """Powers of what SciPy nests: F0 x + F1 x (1 - x) + F2 x^2 (1 - x) + ..."""
    power, table = np.array([1.0]), np.zeros((_DEGREE + 1, _DEGREE))
    for i in range(_DEGREE):
        power = np.convolve(power, [0.0, 1.0] if i % 2 == 0 else [1.0, -1.0])
        table[: len(power), i] = power
    return table


def _to_bernstein(degree: int) -> Array:
    """Powers to control points between 0 and 1, from the right: binom(j, i) / binom(n, i)."""
    binomials = np.abs(invpascal(degree + 1, kind="lower"))
    return np.asarray(binomials.T / pascal(degree + 1, kind="lower")[-1][:, None])


_NESTED = _nested()
_BERNSTEIN = [_to_bernstein(degree) for degree in range(_DEGREE + 1)]
