"""Loops over cells of the crank angle, compiled by numba where that pays.

Loading numba takes longer than most single runs, so the arrays of the formulations come first and
these loops second: `pay` decides. Both give the same to rounding. Kernels of one file call none of
another (`crankmbs.stepper`), because numba's cache does not see a change there.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["affine", "at_angles", "kernel", "newton", "pay"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Branch = tuple[float, float, float, float]  # c0, ct, c1, c2 of `crankmbs.torque`
Solved = tuple[Array, Array, Array, Array, Array, Array]  # as `at_angles` unpacks them
F = TypeVar("F", bound=Callable[..., object])

_LOADING = 0.5  # s, for numba and the kernels from its cache
_MOST_NEWTON = 20
_SETTLED, _GOOD = 1e-14, 1e-11  # relative change of the energy in Newton's last step

_functions: list[Callable[..., object]] = []
_spent = 0.0  # s of work in this process that the kernels would have saved
are_compiled = False


def pay(seconds: float) -> bool:
    """Whether the kernels are compiled now, after a piece of work that takes the arrays so long.

    They are loaded where numba is imported already, or as soon as the arrays have cost as much
    time in this process as loading does.
    """
    global _spent
    _spent += seconds
    if not are_compiled and ("numba" in sys.modules or _spent > _LOADING):
        _compile()
    return are_compiled


def _compile() -> None:
    """Put the compiled kernels in the place of the plain ones, which call one another by name."""
    global are_compiled
    from numba import njit

    for function in _functions:
        try:
            compiled = njit(cache=True, error_model="numpy")(function)
        except RuntimeError:  # neither the package's folder nor the home folder can be written
            compiled = njit(error_model="numpy")(function)
        setattr(sys.modules[function.__module__], function.__name__, compiled)
    are_compiled = True


def kernel(function: F) -> F:
    """Mark a function to be compiled together with the others."""
    _functions.append(function)
    return function


@kernel
def affine(
    which: Index,
    maps: tuple[Array, Array, Array, Array],
    loads: tuple[Array, Array, Array],
    ends: tuple[float, float, float],
    width: Array,
    weights: Array,
    edges: Array,
    time: Array,
    torque: Array,
    slowness: Array,
) -> int:
    """Solve cells by affine maps, up to the end in time; fill what follows ``weights``, count them.

    which : row of the maps and loads for every cell; maps : as `crankmbs.collocation.Maps`; loads :
    push, rate and inertia at the nodes; ends : energy and time at the start, time at the end
    """
    gain, shift, growth, rise = maps
    push, rate, inertia = loads
    energy, t, t_end = ends
    edges[0], time[0] = energy, t
    for k in range(len(which)):
        c = which[k]
        spent = 0.0
        for j in range(len(weights)):
            e = gain[c, j] * energy + shift[c, j]
            torque[k, j] = push[c, j] + rate[c, j] * e
            slowness[k, j] = math.sqrt(0.5 * inertia[c, j] / e) if e > 0.0 else math.nan
            spent += weights[j] * slowness[k, j]
        energy += growth[c] * energy + rise[c]
        t += width[k] * spent
        edges[k + 1], time[k + 1] = energy, t
        if not t < t_end:
            return k + 1
    return len(which)


@kernel
def newton(
    branch: Branch,
    bounds: tuple[float, float, float],
    start: tuple[float, float, float],
    rule: tuple[Array, Array],
    cells: tuple[Array, Array, Array],
    edges: Array,
    time: Array,
    torque: Array,
    slowness: Array,
) -> int:
    """Solve cells by Newton's method, to the end of the branch; fill what follows ``cells``.

    branch : c0, ct, c1, c2; bounds : its end in time, its lowest and highest speed; start : energy,
    time and sense; rule : matrix and weights; cells : width, and inertia and torque at the nodes

    Returns
    -------
    cells solved, the last one across a bound; fewer where Newton's method does not converge
    """
    t_end, low, high = bounds
    begin, t, sense = start
    matrix, weights = rule
    width, inertia, rest = cells
    energy, room = np.empty(len(weights)), np.empty((len(weights) + 1, len(weights)))
    edges[0], time[0] = begin, t
    for k in range(len(width)):
        steps = width[k] * matrix
        last = torque[k - 1, -1] if k > 0 else 0.0
        for j in range(len(weights)):
            energy[j] = begin + sense * last * np.sum(steps[j])
        at = (begin, t, sense)
        if not _solve(energy, room, at, branch, steps, inertia[k], rest[k], torque[k], slowness[k]):
            return k
        inside = True
        for j in range(len(weights)):
            begin += sense * width[k] * weights[j] * torque[k, j]
            t += width[k] * weights[j] * slowness[k, j]
            inside = inside and low <= sense / slowness[k, j] <= high
        edges[k + 1], time[k + 1] = begin, t
        if not (inside and t < t_end):
            return k + 1
    return len(width)


@kernel
def _solve(
    energy: Array,
    room: Array,
    start: tuple[float, float, float],
    branch: Branch,
    steps: Array,
    inertia: Array,
    rest: Array,
    torque: Array,
    slowness: Array,
) -> bool:
    """Newton's method in one cell, from the guess in ``energy``; whether it converges."""
    c0, ct, c1, c2 = branch
    begin, t, sense = start
    stages = len(energy)
    new, system = room[0], room[1:]
    change = math.inf
    for _ in range(_MOST_NEWTON):
        for j in range(stages):
            slowness[j] = math.sqrt(0.5 * inertia[j] / energy[j]) if energy[j] > 0.0 else math.nan
        for j in range(stages):
            omega = sense / slowness[j]
            at = t
            for i in range(stages):
                at += steps[j, i] * slowness[i]
            torque[j] = rest[j] + c0 + ct * at + (c1 + c2 * omega) * omega
        if not change >= _SETTLED:
            break
        new[:] = begin
        for j in range(stages):
            omega = sense / slowness[j]
            rate = sense * (c1 + 2.0 * c2 * omega) / (inertia[j] * omega)
            push = sense * torque[j] - rate * energy[j]
            for i in range(stages):
                new[i] += steps[i, j] * push
                system[i, j] = (1.0 if i == j else 0.0) - steps[i, j] * rate
        _eliminate(system, new)
        change = 0.0
        for j in range(stages):
            change += abs(new[j] / energy[j] - 1.0)
            energy[j] = new[j]
    return change <= _GOOD


@kernel
def _eliminate(system: Array, right: Array) -> None:
    """Solve a small linear system in place, with pivoting; the answer is in ``right``."""
    n = len(right)
    for j in range(n):
        p = j + np.argmax(np.abs(system[j:, j]))
        right[j], right[p] = right[p], right[j]
        for i in range(j, n):
            system[j, i], system[p, i] = system[p, i], system[j, i]
        for i in range(j + 1, n):
            factor = system[i, j] / system[j, j]
            for k in range(j + 1, n):
                system[i, k] -= factor * system[j, k]
            right[i] -= factor * right[j]
    for j in range(n - 1, -1, -1):
        for k in range(j + 1, n):
            right[j] -= system[j, k] * right[k]
        right[j] /= system[j, j]


@kernel
def at_angles(
    u: Array,
    sense: float,
    to_legendre: Array,
    solved: Solved,
    cell: Index,
    at: Array,
    kinetic: Array,
) -> None:
    """Cell, time and energy at increasing angles u since the beginning; fills what follows
    ``solved``."""
    edges, width, energy, time, torque, slowness = solved
    s = len(to_legendre)
    by_torque, by_slowness, up, down = np.empty((4, s))  # and P_(j+1) = up z P_j - down P_(j-1)
    for j in range(s):
        up[j], down[j] = (2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0)
    k = -1
    for i in range(len(u)):
        if k < 0 or (u[i] > edges[k + 1] and k + 1 < len(width)):
            while k < 0 or (u[i] > edges[k + 1] and k + 1 < len(width)):
                k += 1
            for j in range(s):
                by_torque[j] = by_slowness[j] = 0.0
                for m in range(s):
                    by_torque[j] += to_legendre[j, m] * torque[k, m]
                    by_slowness[j] += to_legendre[j, m] * slowness[k, m]
                if j > 0:  # the integral of P_j is (P_(j+1) - P_(j-1)) / (4 j + 2) from 0 on
                    by_torque[j] /= 4.0 * j + 2.0
                    by_slowness[j] /= 4.0 * j + 2.0
        x = (u[i] - edges[k]) / width[k]
        z = 2.0 * x - 1.0
        gained, spent, before, p = x * by_torque[0], x * by_slowness[0], 1.0, z
        for j in range(1, s):
            after = up[j] * z * p - down[j] * before
            gained += (after - before) * by_torque[j]
            spent += (after - before) * by_slowness[j]
            before, p = p, after
        cell[i] = k
        at[i] = time[k] + width[k] * spent
        kinetic[i] = energy[k] + sense * width[k] * gained
