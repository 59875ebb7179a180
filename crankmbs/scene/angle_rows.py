"""The rows of a torque over the crank angle: their rules, and the periodic function they make."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from crankmbs.errors import InputError
from crankmbs.numerics.cycle import NEAR, Cycle
from crankmbs.scene.pressure_rows import Period, interpolate
from crankmbs.scene.tables import Table, check_abscissae
from crankmbs.scene.units import DEGREE

__all__ = ["check_turns", "cycle_of"]


def check_turns(table: Table) -> None:
    """Refuse rows that are no one or two revolutions.

    Raises
    ------
    InputError : the file, the rule, what came, and the way out
    """
    check_abscissae(table, "crank angles", jumps=True)
    x, period = table.x, _period(table)
    if x[-1] - x[0] > period + NEAR:
        raise InputError(
            f"{table.source}: the rows span {(x[-1] - x[0]) / DEGREE:g} degrees, more than two "
            "revolutions, after which the torque repeats; leave out the rest"
        )
    for k, (a, b) in enumerate(pairwise(x)):
        if 0.0 < b - a <= NEAR:
            raise InputError(
                f"{table.source}: rows {k + 1} and {k + 2} lie {(b - a) / DEGREE:.2g} degrees "
                "apart, too near to be told apart; give both the same angle for a jump, or drop one"
            )
    widest = max(*(b - a for a, b in pairwise(x)), x[0] + period - x[-1])
    if widest > 0.5 * period + NEAR:
        raise InputError(
            f"{table.source}: a gap of {widest / DEGREE:g} degrees without a row; the table must "
            f"span the {period / DEGREE:g} degrees after which it repeats with no gap above half"
        )


def cycle_of(table: Table, interpolation: str) -> Cycle:
    """The torque over the crank angle.

    >>> cycle_of(Table([0.0, 3.0, 6.0], [1.0, 4.0, 1.0]), "linear")(np.array([1.5]))
    array([2.5])
    """
    x, y, period = list(table.x), list(table.y), _period(table)
    before = [y[0]] if x[1] == x[0] else []  # a jump where the rows begin
    x, y = x[len(before) :], y[len(before) :]
    closing = [value for angle, value in zip(x, y, strict=True) if angle > x[0] + period - NEAR]
    count = len(x) - len(closing)
    last = [*closing, *before, y[0]][0]
    rows = Period(np.append(x[:count], x[0] + period), np.append(y[:count], last), last != y[0])
    return Cycle(*interpolate(rows, interpolation))


def _period(table: Table) -> float:
    """One revolution where the rows span no more, else two [rad]."""
    turns = 1 if table.x[-1] - table.x[0] <= 2.0 * math.pi + NEAR else 2
    return 2.0 * math.pi * turns
