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

    Where a table jumps, both run from jump to jump: pchip with SciPy's slopes at the ends (the
    parabola's through three rows, kept monotone), cubic with a third derivative that is continuous
    at the second row and the last but one; two rows are joined by a line, three by a parabola.
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
    wide = width > 0  # a repeated angle has a row without width
    chord = np.where(wide, rise, zero) / np.where(wide, width, zero + 1)
    if table.interpolation == "step":
        columns = [values, zero, zero, zero]
    elif table.interpolation == "linear":
        columns = [values, chord, zero, zero]
    else:
        slope, after = _slopes(width, chord, table.interpolation)
        width = np.where(wide, width, zero + 1)
        second = (3 * chord - 2 * slope - after) / width
        columns = [values, slope, second, (slope + after - 2 * chord) / (width * width)]
    return Pieces(knots[wide], np.stack(columns, axis=1)[wide], period)


def evaluate_pressure(
    table: PressureTable | PressurePieces, angle: Array, arithmetic: Arithmetic = LONG
) -> Array:
    """Pressure [Pa] at cycle angles [rad] of any shape; at a jump, the value after it."""
    pieces = pressure_pieces(table, arithmetic)
    index, local = pieces.locate(angle)
    c = pieces.coefficients[index]
    result: Array = ((c[..., 3] * local + c[..., 2]) * local + c[..., 1]) * local + c[..., 0]
    return result


def _slopes(width: Array, chord: Array, kind: str) -> tuple[Array, Array]:
    """Slopes of each piece at its beginning and at its end; those without width are jumps."""
    jumps = [k for k in range(len(width)) if width[k] == 0]
    if not jumps:
        slope = pchip_slopes(width, chord) if kind == "pchip" else _spline_slopes(width, chord)
        return slope, np.roll(slope, -1)
    slope, after = chord * 0, chord * 0
    find = _pchip_slopes_between if kind == "pchip" else spline_slopes_between
    for k, jump in enumerate(jumps):
        next_jump = jumps[k + 1] if k + 1 < len(jumps) else jumps[0] + len(width)
        pieces = np.arange(jump + 1, next_jump) % len(width)
        found = find(width[pieces], chord[pieces])
        slope[pieces], after[pieces] = found[:-1], found[1:]
    return slope, after


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


def _pchip_slopes_between(width: Array, chord: Array) -> Array:
    """Slopes at the rows from one jump to the next."""
    inner = pchip_slopes(width, chord)[1:]
    return np.array([_pchip_end(width, chord), *inner, _pchip_end(width[::-1], chord[::-1])])


def _pchip_end(width: Array, chord: Array) -> Number:
    """The slope of the parabola through the first three rows, at the first; kept monotone."""
    if len(chord) == 1:
        return chord[0]
    near, far = chord[0], chord[1]
    slope = near + (near - far) * width[0] / (width[0] + width[1])
    if slope * near <= 0:
        return near * 0
    return 3 * near if near * far <= 0 and abs(slope) > abs(3 * near) else slope


def spline_slopes_between(width: Array, chord: Array) -> Array:
    """Slopes at the rows from one jump to the next, the two pieces at either end one cubic."""
    if len(chord) == 1:
        return np.array([chord[0], chord[0]])
    w, c = width, chord
    if len(chord) == 2:
        middle = (w[1] * c[0] + w[0] * c[1]) / (w[0] + w[1])
        return np.array([2 * c[0] - middle, middle, 2 * c[1] - middle])
    inner = 3 * (w[1:] * c[:-1] + w[:-1] * c[1:])
    lower = np.array([w[0] * 0, *w[1:], w[-1] + w[-2]])
    diagonal = np.array([w[1], *(2 * (w[1:] + w[:-1])), w[-2]])
    upper = np.array([w[0] + w[1], *w[:-1], w[0] * 0])
    right = np.array([_one_cubic(w, c), *inner, _one_cubic(w[::-1], c[::-1])])
    return _tridiagonal(lower, diagonal, upper, right)


def _one_cubic(w: Array, c: Array) -> Number:
    """w1 s0 + (w0 + w1) s1 of a cubic through rows 0 to 2 with the slopes s0 and s1 at two."""
    return ((3 * w[0] + 2 * w[1]) * w[1] * c[0] + w[0] * w[0] * c[1]) / (w[0] + w[1])


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
