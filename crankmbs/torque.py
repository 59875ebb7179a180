"""Torques from outside on the free crank: on every smooth stretch one small polynomial.

Each load of a scene is linear or quadratic in the speed, or linear in time between the rows of a
table. So on a stretch without a kink their sum is

    T(t, omega) = c0 + ct t + c1 omega + c2 omega^2

and a `Branch` is these four numbers with the bounds of the stretch. The solvers continue a branch
smoothly beyond its bounds, land on the bound, and take the next branch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crankmbs.drives import Constant, Quadratic, SpeedTable, TimeTable, Torque, Viscous
from crankmbs.errors import InputError
from crankmbs.tables import Table

__all__ = ["Branch", "branch_at", "branch_of", "torque_at"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Branch:
    """T = c0 + ct t + c1 omega + c2 omega^2 [N m] up to ``t_end`` [s], from ``omega_low`` to
    ``omega_high`` [rad/s]."""

    c0: float
    ct: float
    c1: float
    c2: float
    t_end: float
    omega_low: float
    omega_high: float

    def __call__(self, t: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s] and speeds [rad/s]."""
        omega = np.asarray(omega, dtype=np.float64)
        return np.asarray(self.c0 + self.ct * np.asarray(t) + (self.c1 + self.c2 * omega) * omega)

    @property
    def coefficients(self) -> tuple[float, float, float, float]:
        """c0, ct, c1 and c2."""
        return self.c0, self.ct, self.c1, self.c2

    @property
    def is_affine_in_energy(self) -> bool:
        """Whether the torque is c0 + c2 omega^2: then dE/dtheta is linear in E."""
        return self.ct == 0.0 and self.c1 == 0.0


def branch_of(torques: tuple[Torque, ...], t: float, omega: float, *, rising: bool) -> Branch:
    """The smooth stretch of all loads together that begins at (t, omega).

    Parameters
    ----------
    t [s] : on a row of a time table the stretch after it counts
    omega [rad/s] : on a row of a speed table, or at rest, the stretch above counts if ``rising``

    Raises
    ------
    InputError : a time table has come to its end

    >>> branch_of((Constant(torque=2.0),), 0.0, 0.0, rising=True).c0
    2.0
    """
    c0 = ct = c1 = c2 = 0.0
    t_end, low, high = math.inf, -math.inf, math.inf
    for number, load in enumerate(torques, start=1):
        match load:
            case Constant():
                c0 += load.torque
            case Viscous():
                c1 -= load.coefficient
            case Quadratic():
                forward = omega > 0.0 or (omega == 0.0 and rising)
                c2 -= load.coefficient if forward else -load.coefficient
                low, high = (max(low, 0.0), high) if forward else (low, min(high, 0.0))
            case TimeTable():
                if t >= load.file.x[-1]:
                    raise InputError(
                        f"torque[{number}].file: {load.file.source}: the time table ends at "
                        f"{load.file.x[-1]:g} s, before the run does; lengthen the table or "
                        "shorten the run"
                    )
                value, slope, _, end = _piece(load.file, t, after=True)
                c0, ct, t_end = c0 + value, ct + slope, min(t_end, end)
            case SpeedTable():
                value, slope, below, above = _piece(load.file, omega, after=rising)
                c0, c1 = c0 + value, c1 + slope
                low, high = max(low, below), min(high, above)
    return Branch(c0, ct, c1, c2, t_end, low, high)


def branch_at(torques: tuple[Torque, ...], t: float, omega: float, rest: float) -> Branch | None:
    """The branch that the motion enters at (t, omega).

    rest [N m] : torque of gas and gravity minus J_1 omega^2 / 2; with a load's torque added its
        sign is that of the acceleration

    Returns
    -------
    Branch, or None where a jump of a speed table drives the speed back from both sides, so that
    no motion leaves this speed
    """
    above = branch_of(torques, t, omega, rising=True)
    below = branch_of(torques, t, omega, rising=False)
    push, pull = float(above(t, omega)), float(below(t, omega))
    if rest + push > 0.0:
        return above
    if rest + pull < 0.0:
        return below
    jumps = pull - push > 1e-12 * max(abs(pull), abs(push))
    return None if jumps else above


def torque_at(torques: tuple[Torque, ...], t: Array, omega: Array) -> Array:
    """Torque of all loads [N m] at times [s] and speeds [rad/s] of one shape, on any stretches.

    On a row where a table jumps it is one of the two values; a time table's ends are held.

    >>> torque_at((Viscous(coefficient=2.0),), np.zeros(2), np.array([1.0, -3.0]))
    array([-2.,  6.])
    """
    total = np.zeros_like(omega)
    for load in torques:
        match load:
            case Constant():
                total += load.torque
            case Viscous():
                total -= load.coefficient * omega
            case Quadratic():
                total -= load.coefficient * omega * np.abs(omega)
            case TimeTable():
                total += np.interp(t, load.file.x, load.file.y)
            case SpeedTable():
                total += np.interp(omega, load.file.x, load.file.y)
    return total


def _piece(table: Table, at: float, *, after: bool) -> tuple[float, float, float, float]:
    """Intercept, slope and bounds of the linear piece at an abscissa; the ends are held."""
    x, y = table.x, table.y
    k = int(np.searchsorted(x, at, side="right" if after else "left"))
    if k == 0:
        return y[0], 0.0, -math.inf, x[0]
    if k == len(x):
        return y[-1], 0.0, x[-1], math.inf
    slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return y[k] - slope * x[k], slope, x[k - 1], x[k]
