"""Periodic interpolation of a pressure table: its cubic pieces, in any arithmetic."""

from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import LONG, Arithmetic, Array, Number
from validation.oracles.machine import PressurePieces, PressureTable


@dataclass(frozen=True)
class Pieces:
    """p = sum_j coefficients[i, j] (angle - knots[i])**j between knots i and i + 1, periodic."""

    knots: Array
    coefficients: Array
    period: Number

    def locate(self, angle: Array) -> tuple[Array, Array]:
        """Index of the piece that holds each angle, and the angle from that piece's knot."""
        reduced = (angle - self.knots[0]) % self.period
        index = np.searchsorted(self.knots - self.knots[0], reduced, side="right") - 1
        return index, reduced - (self.knots[index] - self.knots[0])


def pressure_pieces(table: PressureTable | PressurePieces, arithmetic: Arithmetic = LONG) -> Pieces:
    """The polynomial pieces of a table, or those that are given.

    linear: chords. step: a value holds until the next row. pchip: Fritsch and Carlson's cubic
    Hermite with the weighted harmonic mean of the two neighbouring chords as slope, zero where
    they differ in sign (the interior formula of SciPy's PchipInterpolator), at every knot.
    cubic: the periodic spline with two continuous derivatives. Exact up to rounding.
    """
    if isinstance(table, PressurePieces):
        given = np.stack([arithmetic.array(row) for row in table.coefficients])
        return Pieces(arithmetic.array(table.knots), given, arithmetic.whole_turns(table.period))
    knots = arithmetic.array(table.angles)
    values = arithmetic.array(table.pressures)
    period = arithmetic.whole_turns(table.period)
    width = np.append(knots[1:], knots[0] + period) - knots
    rise = np.roll(values, -1) - values
    zero = arithmetic.zeros(len(knots))
    if table.interpolation == "step":
        columns = [values, zero, zero, zero]
    elif table.interpolation == "linear":
        columns = [values, rise / width, zero, zero]
    else:
        find = pchip_slopes if table.interpolation == "pchip" else _spline_slopes
        chord = rise / width
        slope = find(width, chord)
        after = np.roll(slope, -1)
        second = (3 * chord - 2 * slope - after) / width
        columns = [values, slope, second, (slope + after - 2 * chord) / (width * width)]
    return Pieces(knots, np.stack(columns, axis=1), period)


def evaluate_pressure(
    table: PressureTable | PressurePieces, angle: Array, arithmetic: Arithmetic = LONG
) -> Array:
    """Pressure [Pa] at cycle angles [rad] of any shape; at a jump, the value after it."""
    pieces = pressure_pieces(table, arithmetic)
    index, local = pieces.locate(angle)
    c = pieces.coefficients[index]
    result: Array = ((c[..., 3] * local + c[..., 2]) * local + c[..., 1]) * local + c[..., 0]
    return result


def pchip_slopes(width: Array, chord: Array) -> Array:
    """Slopes at the knots, the first one as if the last piece came before it."""
    slopes = chord * 0
    for i in range(len(chord)):
        before, after = chord[i - 1], chord[i]
        if before * after > 0:
            heavy = 2 * width[i] + width[i - 1]
            light = width[i] + 2 * width[i - 1]
            slopes[i] = (heavy + light) / (heavy / before + light / after)
    return slopes


def _spline_slopes(width: Array, chord: Array) -> Array:
    """Slopes that make the second derivative continuous: a cyclic tridiagonal system.

    width[i] s[i-1] + 2 (width[i] + width[i-1]) s[i] + width[i-1] s[i+1]
    = 3 (width[i] chord[i-1] + width[i-1] chord[i]),
    solved by two plain tridiagonal solves (Sherman and Morrison).
    """
    previous = np.roll(width, 1)
    lower, diagonal, upper = width, 2 * (width + previous), previous
    right = 3 * (width * np.roll(chord, 1) + previous * chord)
    gamma = -diagonal[0]
    corner = diagonal.copy()
    corner[0] = diagonal[0] - gamma
    corner[-1] = diagonal[-1] - upper[-1] * lower[0] / gamma
    border = right * 0
    border[0], border[-1] = gamma, upper[-1]
    plain = _tridiagonal(lower, corner, upper, right)
    rank_one = _tridiagonal(lower, corner, upper, border)
    ratio = lower[0] / gamma
    factor = (plain[0] + ratio * plain[-1]) / (1 + rank_one[0] + ratio * rank_one[-1])
    result: Array = plain - factor * rank_one
    return result


def _tridiagonal(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    diagonal, solution = diagonal.copy(), right.copy()
    for i in range(1, len(right)):
        ratio = lower[i] / diagonal[i - 1]
        diagonal[i] = diagonal[i] - ratio * upper[i - 1]
        solution[i] = solution[i] - ratio * solution[i - 1]
    solution[-1] = solution[-1] / diagonal[-1]
    for i in range(len(right) - 2, -1, -1):
        solution[i] = (solution[i] - upper[i] * solution[i + 1]) / diagonal[i]
    return solution
