"""Means of the sizes of forces over time: loops over forces and cases, compiled by numba
(`crankmbs.numerics.kernels`)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["integrate"]

Rule = tuple[Array, Array, Array, Array]  # as `crankmbs.batch.tables.Pass` has it

_STEPS, _CLOSE = 16, 1e-7  # towards a zero; of a cell
_BENT = 0.6  # of what a force changes by across a piece: where it is less it has a bend, or nearly
_DEEPEST = 16  # halvings of a cell


@kernel
def integrate(
    asked: NDArray[np.intp],
    curves: tuple[Array, Array, Array, Array],
    motions: tuple[Array, Array, Array, Array],
    rule: Rule,
    found: Array,
) -> None:
    """Fill the integrals over time of the sizes of forces [N s], shape (k, q).

    asked : shape (q, any); of every force its first row and how many rows make it up
    curves : as `crankmbs.batch.walk.walk` has them
    motions : omega^2, alpha and omega of the cases, shape (k, 3, n), 1 / |omega|, shape (k, n);
        width times weight of the nodes, shape (n,); width of the cells [rad]
    """
    (of, rest, _, _), (courses, slow, share, width) = curves, motions
    n = len(share)
    first, second, size, none = np.empty(n), np.empty(n), np.empty(n), np.empty(0)
    for k in range(len(courses)):
        course, over = courses[k], (slow[k], share)
        for q in range(len(asked)):
            row, rows = asked[q, 0], asked[q, 1]
            _put_together(of[row], rest[row, 0, 0], course, first)
            if rows == 2:
                _put_together(of[row + 1], rest[row + 1, 0, 0], course, second)
                for i in range(n):
                    size[i] = math.sqrt(first[i] * first[i] + second[i] * second[i])
                found[k, q] = _integral((first, second, size), over, width, rule)
            else:
                found[k, q] = _integral((first, none, first), over, width, rule)


@kernel
def _put_together(of: Array, constant: Array, course: Array, curve: Array) -> None:
    """Fill A omega^2 + B alpha + C."""
    a, b, square, alpha = of[0], of[1], course[0], course[1]
    for i in range(len(curve)):
        curve[i] = a[i] * square[i] + b[i] * alpha[i] + constant[i]


@kernel
def _integral(
    curve: tuple[Array, Array, Array], over: tuple[Array, Array], width: Array, rule: Rule
) -> float:
    """Integral of a size over time; over : 1 / |omega|, and its weights over the angle.

    Where a force is small beside what it changes by its size bends. There the cell is split where
    a single component passes zero; else it is halved until it does not bend, or is small enough.
    """
    (first, second, size), (slow, share), (_, weights, nodes, _) = curve, over, rule
    s, total = len(nodes), 0.0
    paired = len(second) > 0
    halves, made = np.empty((2, s, s)), False
    stack, depths = np.empty((_DEEPEST + 2, 3, s)), np.empty(_DEEPEST + 2, np.intp)
    stack[:] = 0.0
    piece = np.empty((3, s))
    for c in range(len(width)):
        low, high = c * s, c * s + s - 1
        least, sum_of_cell = math.inf, 0.0
        for i in range(low, high + 1):
            least = min(least, abs(size[i]))
            sum_of_cell += share[i] * slow[i] * abs(size[i])
        across = first[high] - first[low]
        other = second[high] - second[low] if paired else 0.0
        if least * least >= _BENT * _BENT * (across * across + other * other):
            total += sum_of_cell
            continue
        if not made:
            made = True
            for side in range(2):
                for j in range(s):
                    _basis(0.5 * (nodes[j] + side), rule, halves[side, j])
        for j in range(s):
            stack[0, 0, j], stack[0, 2, j] = first[low + j], slow[low + j]
            if paired:
                stack[0, 1, j] = second[low + j]
        split = -1.0 if paired else _split(stack[0, 0], stack[0, 2], rule)
        if split >= 0.0:
            total += width[c] * split
            continue
        depths[0], left = 0, 1
        while left > 0:
            left -= 1
            depth = depths[left] + 1
            piece[:] = stack[left]
            for side in range(2):
                half, to = halves[side], stack[left]
                for part in range(3):
                    for j in range(s):
                        to[part, j] = 0.0
                        for i in range(s):
                            to[part, j] += half[j, i] * piece[part, i]
                least, sum_of_piece = math.inf, 0.0
                for j in range(s):
                    here = math.sqrt(to[0, j] * to[0, j] + to[1, j] * to[1, j])
                    least = min(least, here)
                    sum_of_piece += weights[j] * to[2, j] * here
                across, other = to[0, s - 1] - to[0, 0], to[1, s - 1] - to[1, 0]
                bent = least * least < _BENT * _BENT * (across * across + other * other)
                if bent and depth < _DEEPEST:
                    depths[left] = depth
                    left += 1
                else:
                    total += 0.5**depth * width[c] * sum_of_piece
    return total


@kernel
def _basis(x: float, rule: Rule, basis: Array) -> None:
    """Fill the Lagrange polynomials of the nodes at a place in a cell, from 0 to 1."""
    _, _, nodes, barycentric = rule
    total = 0.0
    for j in range(len(nodes)):
        apart = x - nodes[j]
        if apart == 0.0:
            basis[:] = 0.0
            basis[j] = 1.0
            return
        basis[j] = barycentric[j] / apart
        total += basis[j]
    for j in range(len(nodes)):
        basis[j] /= total


@kernel
def _value(x: float, values: Array, rule: Rule) -> float:
    """The polynomial through values at the nodes, somewhere in a cell, from 0 to 1."""
    _, _, nodes, barycentric = rule
    above = below = 0.0
    for j in range(len(nodes)):
        apart = x - nodes[j]
        weight = barycentric[j] / (apart if apart != 0.0 else 1e-200)
        above, below = above + weight * values[j], below + weight
    return above / below


@kernel
def _split(force: Array, slow: Array, rule: Rule) -> float:
    """The integral over a cell, from 0 to 1, of the size of a force times another, on both sides of
    where it passes zero; negative where it does so more than once."""
    _, weights, nodes, _ = rule
    s, passes, end, x = len(nodes), 0, 1.0, 0.0
    a, b, of_a, of_b = 0.0, 0.0, 0.0, 0.0
    before, of_before = 0.0, _value(0.0, force, rule)
    for j in range(s + 1):
        here, of_here = (nodes[j], force[j]) if j < s else (end, _value(end, force, rule))
        if (of_here > 0.0) != (of_before > 0.0):
            passes, a, b, of_a, of_b = passes + 1, before, here, of_before, of_here
        before, of_before = here, of_here
    if passes > 1:
        return -1.0
    kept = 0
    for _ in range(_STEPS if passes == 1 else 0):  # regula falsi; an end kept twice counts half
        x = a - of_a * (b - a) / (of_b - of_a)
        of_x = _value(x, force, rule)
        if (of_x > 0.0) == (of_b > 0.0):
            of_a, kept = of_a * (0.5 if kept < 0 else 1.0), -1
            b, of_b = x, of_x
        else:
            of_b, kept = of_b * (0.5 if kept > 0 else 1.0), 1
            a, of_a = x, of_x
        if of_x == 0.0 or b - a < _CLOSE:
            break
    total = 0.0
    for side in range(2):
        begin, wide = (0.0, x) if side == 0 else (x, 1.0 - x)
        for j in range(s if wide > 0.0 else 0):
            at = begin + wide * nodes[j]
            total += wide * weights[j] * abs(_value(at, force, rule)) * _value(at, slow, rule)
    return total
