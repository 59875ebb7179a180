"""Where a polynomial step first leaves the pieces it was computed for."""

import math
from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import Arithmetic, Array, Number
from validation.oracles.taylor import derivative, evaluate

NODES = 16
TAIL = 8


@dataclass(frozen=True)
class Exit:
    """The step reaches `bound` at `time` after its start; `upper` tells which end it is."""

    time: Number
    bound: Number
    upper: bool


def root(series: Array, left: Number, right: Number, arithmetic: Arithmetic) -> Number:
    """The zero of a series that changes sign in [left, right]: Newton, kept in by bisection."""
    slope = derivative(series)
    rising = evaluate(series, right) > evaluate(series, left)
    fine = 4 * arithmetic.epsilon * right
    at, move = (left + right) / 2, right - left
    while abs(move) > fine:
        value, steep = evaluate(series, at), evaluate(slope, at)
        if (value > 0) == rising:
            right = at
        else:
            left = at
        newton = -value / steep if steep != 0 else 2 * move
        if left <= at + newton <= right and abs(newton) <= abs(move) / 2:
            move = newton
        else:
            move = (left + right) / 2 - at
        at = at + move
    return at


def first_exit(
    series: Array, bounds: tuple[Number, Number], until: Number, arithmetic: Arithmetic
) -> Exit | None:
    """The first time in (0, until] at which the series is outside its bounds, if any.

    Looks at evenly spaced nodes and, so that no excursion between them is missed, at the turning
    points.
    """
    nodes = np.arange(NODES + 1) * until / NODES
    slope = derivative(series)
    steep = evaluate(slope, nodes)
    turning = [
        root(slope, nodes[k], nodes[k + 1], arithmetic)
        for k in range(NODES)
        if steep[k] * steep[k + 1] < 0
    ]
    nodes = np.array(sorted([*nodes, *turning]), dtype=nodes.dtype)
    values = evaluate(series, nodes[1:])
    outside = np.flatnonzero((values < bounds[0]) | (values > bounds[1]))
    if not len(outside):
        return None
    k = outside[0]
    upper = bool(values[k] > bounds[1])
    shifted = series.copy()
    shifted[0] = series[0] - bounds[upper]
    return Exit(root(shifted, nodes[k], nodes[k + 1], arithmetic), bounds[upper], upper)


def step_size(series: Array, arithmetic: Arithmetic) -> Number:
    """The step after which what the series leaves out is below rounding.

    The last terms give the radius of convergence, radius = (|first| / |last|)**(1 / distance), the
    smallest of the last TAIL terms counting (a symmetric motion has zeros among them), against the
    first three, the best of them counting (one is zero at rest). The step is
    radius (epsilon / 4)**(1 / order); a polynomial of low degree gets a second.
    """
    logs = [_log(term) for term in series]
    order = len(series) - 1
    tails = [
        max((logs[j] - logs[k]) / (k - j) for j in range(3))
        for k in range(order + 1 - TAIL, order + 1)
        if logs[k] > -math.inf
    ]
    if not tails:
        return arithmetic.number(1)
    return arithmetic.number(math.exp(min(tails) + math.log(arithmetic.epsilon / 4) / order))


def _log(value: Number) -> float:
    return -math.inf if value == 0 else math.log(abs(float(value)))
