"""Torques from outside on the free crank: on every smooth stretch one small polynomial.

Each load of a scene is linear or quadratic in the speed, or linear in time between the rows of a
table. So on a stretch without a kink their sum is

    T(t, omega) = c0 + ct t + c1 omega + c2 omega^2

and a `Branch` is these four numbers with the bounds of the stretch. The solvers continue a branch
smoothly beyond its bounds, land on the bound, and take the next branch. A `Course` is all branches
from one jump to the next, for a solver that crosses the rows between them at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError
from crankmbs.numerics.arrays import Array
from crankmbs.scene.drives import Constant, Quadratic, SpeedTable, TimeTable, Torque, Viscous
from crankmbs.scene.tables import Table

__all__ = ["Branch", "Course", "Tables", "branch_at", "branch_of", "course_of", "torque_at"]

Tables = tuple[Array, Array, Array, Array]  # times, in_time, speeds and in_speed of `Course`


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
    def tables(self) -> Tables:
        """The same as a course without a row."""
        in_time, in_speed = np.array([[self.c0, self.ct]]), np.array([[0.0, self.c1, self.c2]])
        return np.empty(0), in_time, np.empty(0), in_speed

    def slope(self, omega: Array) -> Array:
        """dT/domega [N m s/rad] at speeds [rad/s]."""
        return self.c1 + 2.0 * self.c2 * omega

    @property
    def is_affine_in_energy(self) -> bool:
        """Whether the torque is c0 + c2 omega^2: then dE/dtheta is linear in E."""
        return self.ct == 0.0 and self.c1 == 0.0


@dataclass(frozen=True, eq=False)
class Course:
    """T = f(t) + g(omega) [N m], continuous up to ``t_end`` [s], from ``omega_low`` to
    ``omega_high`` [rad/s], with kinks at rows of tables.

    times : shape (k,) [s], increasing; in_time : shape (k + 1, 2), of f before, between and after
        them the coefficients by ascending power
    speeds : shape (n,) [rad/s]; in_speed : shape (n + 1, 3), the same of g
    """

    times: Array
    in_time: Array
    speeds: Array
    in_speed: Array
    t_end: float
    omega_low: float
    omega_high: float

    is_affine_in_energy = False

    @property
    def is_steady(self) -> bool:
        """Whether it is a function of the speed alone."""
        return not self.in_time[:, 1].any()

    @property
    def tables(self) -> Tables:
        """times, in_time, speeds and in_speed."""
        return self.times, self.in_time, self.speeds, self.in_speed

    def __call__(self, t: ArrayLike, omega: ArrayLike) -> Array:
        """Torque [N m] at times [s] and speeds [rad/s]."""
        t, omega = np.asarray(t, dtype=np.float64), np.asarray(omega, dtype=np.float64)
        f = self.in_time[np.searchsorted(self.times, t, side="right")]
        g = self.in_speed[np.searchsorted(self.speeds, omega, side="right")]
        of_speed = g[..., 0] + (g[..., 1] + g[..., 2] * omega) * omega
        return np.asarray(f[..., 0] + f[..., 1] * t + of_speed)

    def slope(self, omega: Array) -> Array:
        """dT/domega [N m s/rad] at speeds [rad/s], above a row where one is."""
        k = np.searchsorted(self.speeds, omega, side="right")
        _, linear, square = self.in_speed.T
        return np.asarray(linear[k] + 2.0 * square[k] * omega)


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


def course_of(torques: tuple[Torque, ...], branch: Branch, t: float) -> Branch | Course:
    """What continues a branch of these loads from a time [s] on, without a jump and in its sense of
    rotation; a branch where that has no kink."""
    by_time = [load.file for load in torques if isinstance(load, TimeTable)]
    by_speed = [load.file for load in torques if isinstance(load, SpeedTable)]
    if not by_time and not by_speed:
        return branch
    last = min((table.x[-1] for table in by_time), default=math.inf)
    times, in_time, _, t_end = _continued(by_time, [t, last], t, branch.t_end)
    low, high = branch.omega_low, branch.omega_high
    speeds, in_speed, low, high = _continued(by_speed, [0.0], low, high)
    if len(times) == len(speeds) == 0:
        return replace(branch, t_end=t_end, omega_low=low, omega_high=high)
    steady = tuple(load for load in torques if not isinstance(load, TimeTable | SpeedTable))
    rest = branch_of(steady, 0.0, 0.0, rising=low >= 0.0)
    in_time[:, 0] += rest.c0
    in_speed = np.column_stack([in_speed, np.full(len(in_speed), branch.c2)])
    in_speed[:, 1] += rest.c1
    return Course(times, in_time, speeds, in_speed, t_end, low, high)


def _continued(
    tables: Sequence[Table], ends: list[float], low: float, high: float
) -> tuple[Array, Array, float, float]:
    """Kinks of a sum of tables around a piece, intercept and slope between them, and the bounds
    that jumps and ``ends`` set."""
    columns = [(np.array(table.x), np.array(table.y)) for table in tables]
    jumps = np.concatenate([ends, *(x[1:][np.diff(x) == 0.0] for x, _ in columns)])
    low = float(np.max(jumps[jumps <= low], initial=-math.inf))
    high = float(np.min(jumps[jumps >= high], initial=math.inf))
    rows = np.unique(np.concatenate([np.empty(0), *(x for x, _ in columns)]))
    rows = rows[(rows > low) & (rows < high)]
    known = rows if len(rows) else [bound for bound in (low, high) if math.isfinite(bound)] or [0.0]
    edges = np.concatenate([[max(low, known[0] - 1.0)], rows, [min(high, known[-1] + 1.0)]])
    pieces = np.zeros((len(rows) + 1, 2))
    for x, y in columns:
        k = np.searchsorted(x, 0.5 * (edges[1:] + edges[:-1]))
        after = np.clip(k, 1, len(x) - 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = (y[after] - y[after - 1]) / (x[after] - x[after - 1])
        slope = np.where((k > 0) & (k < len(x)), slope, 0.0)
        near = np.minimum(k, len(x) - 1)
        pieces += np.column_stack([y[near] - slope * x[near], slope])
    bent = np.diff(pieces[:, 1]) != 0.0
    return rows[bent], pieces[np.append(True, bent)], low, high


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
