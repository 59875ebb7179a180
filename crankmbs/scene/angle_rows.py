"""The rows of a torque over the crank angle: their rules, and the periodic function they make."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from crankmbs.errors import InputError
from crankmbs.numerics.cycle import NEAR, Cycle
from crankmbs.scene.pressure_rows import Period, interpolate
from crankmbs.scene.tables import Table
from crankmbs.scene.units import DEGREE

__all__ = ["check_turns", "cycle_of", "is_of_halves"]


def is_of_halves(period: float) -> bool:
    """Whether a period [rad] is a multiple of half a revolution.

    >>> is_of_halves(3.0 * math.pi), is_of_halves(4.0)
    (True, False)
    """
    halves = period / math.pi
    return round(halves) > 0 and abs(halves - round(halves)) <= NEAR * halves


def check_turns(table: Table, declared: float | None) -> None:
    """Refuse rows that are no period: the declared one [rad], or else one or two revolutions.

    Raises
    ------
    InputError : the file, the rule, what came, and the way out
    """
    if declared is not None and not is_of_halves(declared):
        raise InputError(
            "period: must be a multiple of 180 degrees, so that it fits the engine's; "
            f"{declared / DEGREE:g} degrees came"
        )
    x, period = table.x, _period(table, declared)
    if x[-1] - x[0] > period + NEAR:
        of = f"the period of {period / DEGREE:g} degrees" if declared else "two revolutions"
        way_out = 'leave out the rest, or give a longer period, such as "3 rev"'
        raise InputError(
            f"{table.source}: the rows span {(x[-1] - x[0]) / DEGREE:g} degrees, more than {of}, "
            f"after which the torque repeats; {way_out}"
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


def cycle_of(table: Table, interpolation: str, declared: float | None) -> Cycle:
    """The torque over the crank angle; declared : its period [rad], if it is not by its rows.

    >>> cycle_of(Table([0.0, 3.0, 6.0], [1.0, 4.0, 1.0]), "linear", None)(np.array([1.5]))
    array([2.5])
    """
    x, y, period = list(table.x), list(table.y), _period(table, declared)
    before = [y[0]] if x[1] == x[0] else []  # a jump where the rows begin
    x, y = x[len(before) :], y[len(before) :]
    closing = [value for angle, value in zip(x, y, strict=True) if angle > x[0] + period - NEAR]
    count = len(x) - len(closing)
    last = [*closing, *before, y[0]][0]
    rows = Period(np.append(x[:count], x[0] + period), np.append(y[:count], last), last != y[0])
    return Cycle(*interpolate(rows, interpolation))


def _period(table: Table, declared: float | None) -> float:
    """The declared one, or one revolution where the rows span no more, else two [rad]."""
    if declared is not None:
        return round(declared / math.pi) * math.pi
    turns = 1 if table.x[-1] - table.x[0] <= 2.0 * math.pi + NEAR else 2
    return 2.0 * math.pi * turns
