"""The indicator diagram: cylinder pressure from polytropes over the exact volume.

A polytrope of the volume is no polynomial of the crank angle, but the solvers work on piecewise
cubics. So the angle is split until a cubic through four points of each piece follows the diagram
to a relative 1e-9: the pieces are the pressure, each solver integrates the same ones, and what they
may miss of the diagram is in the stated errors. Pieces seven times as many would follow it to 5e-13
and make a run take three times as long.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from crankmbs.mechanics.geometry import (
    Shape,
    bottom_position,
    close_loop,
    dead_centres,
    throw_angles,
    top_position,
)
from crankmbs.mechanics.knots import KNOT, apart
from crankmbs.numerics.arrays import Array
from crankmbs.scene.gas import Gas, Indicator

__all__ = ["INDICATOR_RTOL", "fit", "indicator_pieces", "relative_volume"]

Stroke = tuple[float, float, Callable[[Array], Array]]

INDICATOR_RTOL = 1e-9  # of the absolute pressure

_NONE = np.empty(0)

_SUPPORT = np.array([0.0, 0.25, 0.75, 1.0])  # Chebyshev's extrema: the ends are met exactly
_BETWEEN = np.array([0.1, 0.5, 0.9])  # where a cubic through the support errs most
_TO_POWERS = np.linalg.inv(np.vander(_SUPPORT, 4))


def indicator_pieces(gas: Gas, shape: Shape, *, fires: bool = True) -> tuple[Array, Array]:
    """The diagram of ``gas.indicator`` in a cylinder as a periodic piecewise cubic, gauge.

    From the true gas-exchange top dead centre: intake; compression p V^n = const; at the firing
    dead centre a rise to the peak pressure, held until V = pre_expansion * V_clearance; expansion
    p V^n = const; at the bottom dead centre the blow-down to the exhaust pressure. A two-stroke
    cycle has compression and expansion alone. Dead centres are where the diagram jumps; there two
    pieces meet with different values.

        V / V_clearance = 1 + (compression_ratio - 1) (x_top - x) / (x_top - x_bottom)

    Parameters
    ----------
    gas : with an indicator; shape : radius of the throw, length of the rod and offset [m]
    fires : else the compression's polytrope is run back down to the bottom dead centre

    Returns
    -------
    knots : shape (n + 1,) [rad] cycle angle, increasing over one period
    coefficients : shape (4, n) [Pa by descending power of (angle - knots[i]) in rad], as in
        `scipy.interpolate.PPoly`; within 1e-9 of the absolute pressure of the diagram

    >>> scene = load_scene("grega_lecture")
    >>> knots, coefficients = indicator_pieces(scene.gas, scene.running_gear[0].shape)
    """
    assert gas.indicator is not None
    assert gas.ambient is not None
    parts = [fit(*stroke) for stroke in _strokes(gas, gas.indicator, shape, fires)]
    knots = np.concatenate([*(left for left, _ in parts), [parts[0][0][0] + gas.period]])
    coefficients = np.concatenate([cubic for _, cubic in parts], axis=1)
    coefficients[-1] -= gas.ambient
    return knots, coefficients


def _strokes(gas: Gas, indicator: Indicator, shape: Shape, fires: bool) -> list[Stroke]:
    """(begin, end, absolute pressure) of each smooth part of the cycle."""
    top, bottom = dead_centres(*shape)
    turn = 2.0 * math.pi
    ratio = indicator.compression_ratio
    stroke = top_position(*shape) - bottom_position(*shape)

    def volume(angle: Array) -> Array:
        return relative_volume(shape, ratio, angle)

    def held(pressure: float) -> Callable[[Array], Array]:
        return lambda angle: np.full_like(angle, pressure)

    def compression(angle: Array) -> Array:
        return indicator.intake_pressure * (ratio / volume(angle)) ** indicator.n_compression

    def expansion(angle: Array) -> Array:
        spread = indicator.pre_expansion / volume(angle)
        return indicator.peak_pressure * spread**indicator.n_expansion

    fired = burnt = turn + top
    closed: list[Stroke] = [(bottom, fired, compression)]
    if fires and indicator.pre_expansion > 1.0:
        above = np.array((indicator.pre_expansion - 1.0) / (ratio - 1.0) * stroke)
        burnt = turn + float(throw_angles(above, stroke - above, *shape)[0])
        closed.append((fired, burnt, held(indicator.peak_pressure)))
    closed.append((burnt, turn + bottom, expansion if fires else compression))
    if gas.stroke == 2:
        return closed
    assert indicator.exhaust_pressure is not None
    return [
        (top, bottom, held(indicator.intake_pressure)),
        *closed,
        (turn + bottom, turn + fired, held(indicator.exhaust_pressure)),
    ]


def relative_volume(shape: Shape, ratio: float, angle: Array) -> Array:
    """V / V_clearance at cycle angles [rad], for a compression ratio."""
    x_top, x_bottom = top_position(*shape), bottom_position(*shape)
    share = (x_top - close_loop(angle, *shape).x) / (x_top - x_bottom)
    return np.asarray(1.0 + (ratio - 1.0) * share)


def fit(
    begin: float, end: float, pressure: Callable[[Array], Array], shared: Array = _NONE
) -> tuple[Array, Array]:
    """(left knots, cubics) of one stroke: pieces are halved until each is good enough.

    Quarter turns are knots from the start: a rod no longer than radius + offset folds there. So are
    those [rad] ``shared`` with another pressure: the solvers step from knot to knot of both.
    """
    quarter = 0.5 * math.pi
    quarters = np.arange(math.ceil(begin / quarter), math.ceil(end / quarter)) * quarter
    inner = apart(np.concatenate([quarters, shared]))
    inner = inner[(inner > begin + KNOT) & (inner < end - KNOT)]
    edges = np.concatenate([[begin], inner, [end]])
    pieces = np.array(list(pairwise(edges)))
    lefts: list[Array] = []
    cubics: list[Array] = []
    while len(pieces):
        left, width = pieces[:, :1], np.diff(pieces)
        cubic = _TO_POWERS @ pressure(left + width * _SUPPORT).T
        exact = pressure(left + width * _BETWEEN).T
        missed = np.abs(np.vander(_BETWEEN, 4) @ cubic - exact) > INDICATOR_RTOL * exact
        good = ~missed.any(axis=0)
        lefts.append(left[good, 0])
        cubics.append(cubic[:, good] / width[good, 0] ** np.array([[3], [2], [1], [0]]))
        middle = pieces[~good].mean(axis=1)
        pieces = np.concatenate(
            [
                np.column_stack([pieces[~good, 0], middle]),
                np.column_stack([middle, pieces[~good, 1]]),
            ]
        )
    knots = np.concatenate(lefts)
    order = np.argsort(knots)
    return knots[order], np.concatenate(cubics, axis=1)[:, order]
