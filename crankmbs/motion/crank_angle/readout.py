"""Solved cells of the crank angle read at angles or times: loops over samples, compiled by numba
(`crankmbs.numerics.kernels`)."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

Coefficients = tuple[float, float, float, float]  # c0, ct, c1, c2 of `crankmbs.mechanics.torque`


__all__ = ["carried", "inside", "motion", "read"]

Solved = tuple[Array, Array, Array, Array, Array, Array]  # as `read` unpacks them
_MOST_NEWTON = 100  # steps; bisecting alone takes 53


@kernel
def read(
    given: Array,
    in_time: bool,
    sense: float,
    to_legendre: Array,
    solved: Solved,
    found: tuple[Index, Array, Array, Array],
) -> None:
    """Fill ``found`` with the cell, the position in it from 0 to 1, time and energy at increasing
    times, or else angles since the beginning."""
    edges, width, energy, time, torque, slowness = solved
    cell, position, at, kinetic = found
    s, k = len(to_legendre), -1
    of = _room(s)
    for i in range(len(given)):
        now, entered = float(given[i]), k < 0
        while k < 0 or (now > (time[k + 1] if in_time else edges[k + 1]) and k + 1 < len(width)):
            k, entered = k + 1, True
        if entered:
            _enter(k, to_legendre, torque, slowness, of)
        h = float(width[k])
        if in_time:
            x = _inverted((now - float(time[k])) / h, (float(time[k + 1]) - float(time[k])) / h, of)
        else:
            x = (now - float(edges[k])) / h
        gained, spent, _ = _integrals(of, x)
        cell[i], position[i] = k, x
        at[i] = now if in_time else float(time[k]) + h * spent
        kinetic[i] = float(energy[k]) + sense * h * gained


@kernel
def inside(
    cell: int,
    places: Array,
    sense: float,
    to_legendre: Array,
    solved: Solved,
    found: tuple[Array, Array],
) -> None:
    """Fill ``found`` with time and energy at places in one cell, 0 to 1."""
    _, width, energy, time, torque, slowness = solved
    at, kinetic = found
    of, h = _room(len(to_legendre)), float(width[cell])
    _enter(cell, to_legendre, torque, slowness, of)
    for i in range(len(places)):
        gained, spent, _ = _integrals(of, places[i])
        at[i] = float(time[cell]) + h * spent
        kinetic[i] = float(energy[cell]) + sense * h * gained


@kernel
def _room(s: int) -> Array:
    """For torque and slowness as sums of P_j, and of P_j what `_integrals` needs."""
    of = np.empty((5, s))
    for j in range(s):
        of[2, j], of[3, j] = (2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0)
        of[4, j] = 1.0 / (4.0 * j + 2.0)
    return of


@kernel
def _enter(cell: int, to_legendre: Array, torque: Array, slowness: Array, of: Array) -> None:
    """Torque and slowness of a cell as sums of P_j."""
    for j in range(len(to_legendre)):
        of[0, j] = of[1, j] = 0.0
        for m in range(len(to_legendre)):
            of[0, j] += to_legendre[j, m] * torque[cell, m]
            of[1, j] += to_legendre[j, m] * slowness[cell, m]


@kernel
def _integrals(of: Array, x: float) -> tuple[float, float, float]:
    """Integrals from 0 to x of the two polynomials, and the value of the second at x."""
    z = 2.0 * x - 1.0
    first, second, value, before, p = x * of[0, 0], x * of[1, 0], of[1, 0], 1.0, z
    for j in range(1, of.shape[1]):
        after = of[2, j] * z * p - of[3, j] * before
        rise = (after - before) * of[4, j]
        first += rise * of[0, j]
        second += rise * of[1, j]
        value += p * of[1, j]
        before, p = p, after
    return first, second, value


@kernel
def _inverted(target: float, whole: float, of: Array) -> float:
    """Where the integral of the second polynomial, which rises to ``whole`` at 1, is ``target``:
    Newton's method, bisecting where it leaves its bracket."""
    low, high, x = 0.0, 1.0, min(max(target / whole, 0.0), 1.0)
    for _ in range(_MOST_NEWTON):
        _, spent, slope = _integrals(of, x)
        excess = spent - target
        if excess == 0.0:
            break
        low, high = (low, x) if excess > 0.0 else (x, high)
        new = x - excess / slope
        if not low < new < high:  # nor back to an end: rounding would send it to and fro
            new = 0.5 * (low + high)
        settled, x = abs(new - x) <= 4e-16 * high, new
        if settled:
            break
    return x


@kernel
def motion(
    which: Index,
    of_angle: tuple[Array, Array, Array],
    sense: float,
    branch: Coefficients,
    at: tuple[Array, Array],
    found: tuple[Array, Array, Array],
) -> None:
    """Fill ``found`` with speed, torque from outside and acceleration at the angles ``which``.

    of_angle : J, J_1 and torque of gas and gravity; at : time and energy
    """
    (inertia, slope, torque), (time, energy), (omega, outside, alpha) = of_angle, at, found
    c0, ct, c1, c2 = branch
    for i in range(len(which)):
        k = which[i]
        w = sense * math.sqrt(2.0 * max(energy[i], 0.0) / inertia[k])
        load = c0 + ct * time[i] + (c1 + c2 * w) * w
        omega[i], outside[i] = w, load
        alpha[i] = (torque[k] + load - 0.5 * slope[k] * w * w) / inertia[k]


@kernel
def carried(growth: Array, gained: Array, more: Array) -> None:
    """Energy more at every edge, filled, of which cells grow by a part and gain a further one."""
    more[0] = 0.0
    for k in range(len(gained)):
        more[k + 1] = more[k] + (growth[k] * more[k] + gained[k])
