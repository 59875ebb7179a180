"""Inertia, dead centre and delay from the half orders of some cycles, with their intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import t as student

from validation.measured.free_run import Engine, FreeRun, Unknown, free_run
from validation.measured.logged import Array, Logged, half_orders, orders_of

__all__ = ["FITTED", "Identified", "identify", "slopes_of"]

FITTED = 2.5  # order: a rigid crank has no torsional vibration, and this one's begins above
_SCALES = np.array([0.01, 0.5, 5e-5])  # of ln inertia, dead centre [deg] and delay [s]
_CLOSE = 0.02  # of these scales: steps that end the fit
_ROUNDS = 12
_SHARE = 0.975  # of Student's distribution below the end of an interval of 95 %


class Identified(NamedTuple):
    """unknown : what fits best; covariance : of ln inertia, dead centre [deg] and, where it was
    free, delay [s], by the scatter of the cycles; misfit : root mean square of the residuals
    [1 of the speed]; factor : of a standard deviation, for an interval of 95 %."""

    unknown: Unknown
    covariance: Array
    misfit: float
    factor: float

    @property
    def interval(self) -> Array:
        """Half widths: inertia [kg m^2], dead centre [deg], delay [s]."""
        half = self.factor * np.sqrt(np.diag(self.covariance))
        return np.asarray(half * np.append(self.unknown.inertia, np.ones(len(half) - 1)))

    @property
    def correlation(self) -> Array:
        """Of the same."""
        deviation = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(deviation, deviation))


class _Fit:
    """Residuals of the orders of some cycles, each run beginning from the last one's energies."""

    def __init__(self, logged: Logged, engine: Engine, first: int, count: int) -> None:
        self._given = logged, engine, first, count
        self._measured = self._orders(logged.edge_times(first, count))
        self._guess: FreeRun | None = None

    def _orders(self, times: Array) -> Array:
        """Real and imaginary parts, shape (cycles, 2 orders)."""
        logged = self._given[0]
        half = half_orders(times, logged.edges)
        found = orders_of(half, logged.rotation.wheel.pitch, FITTED)
        return np.hstack([found.real, found.imag])

    def __call__(self, unknown: Unknown) -> Array:
        logged, engine, first, count = self._given
        self._guess = free_run(logged, engine, unknown, first, count, self._guess)
        return self._orders(self._guess.times) - self._measured


def identify(
    logged: Logged,
    engine: Engine,
    start: Unknown,
    first: int,
    count: int,
    *,
    delay: bool,
) -> Identified:
    """Least squares of the half orders up to 2.5 in ln inertia, dead centre and, if it is free,
    delay.

    The covariance is that of a sum over m cycles that scatter independently, (J'J)^-1 (sum of
    J_c' r_c r_c' J_c) (J'J)^-1 m / (m - 1): what the model errs by in all alike is not in it.
    """
    fit, free = _Fit(logged, engine, first, count), 3 if delay else 2
    steps = np.eye(free)
    zero = np.array([math.log(start.inertia), start.dead_centre, start.delay])

    def unknown(x: Array) -> Unknown:
        values = zero + _SCALES * np.append(x, np.zeros(3 - free))
        return start._replace(
            inertia=math.exp(values[0]), dead_centre=float(values[1]), delay=float(values[2])
        )

    x, change = np.zeros(free), np.full(free, np.inf)
    for _ in range(_ROUNDS):
        left = fit(unknown(x))
        slopes = np.stack([0.5 * (fit(unknown(x + e)) - fit(unknown(x - e))) for e in steps], -1)
        change, *_ = np.linalg.lstsq(slopes.reshape(-1, free), -left.ravel())
        x = x + change
        if np.max(np.abs(change)) < _CLOSE:
            break
    else:
        raise ValueError(f"{logged.name}: the fit does not converge")
    inverse = np.linalg.inv(np.einsum("cij,cik->jk", slopes, slopes))
    pulls = np.einsum("cij,ci->cj", slopes, left)
    covariance = inverse @ (pulls.T @ pulls) @ inverse * count / (count - 1.0)
    return Identified(
        unknown(x),
        covariance * np.outer(_SCALES[:free], _SCALES[:free]),
        float(np.sqrt(np.mean(left**2))),
        float(student.ppf(_SHARE, count - 1)),
    )


def slopes_of(
    logged: Logged, engine: Engine, unknown: Unknown, first: int, count: int, free: Sequence[int]
) -> Array:
    """How the mean half orders at the teeth change with ln inertia, dead centre [deg] and delay
    [s], those of ``free``; shape (edges, free)."""
    columns = []
    for k in free:
        step = np.zeros(3)
        step[k] = _SCALES[k]
        halves = []
        for sign in (-1.0, 1.0):
            moved = unknown._replace(
                inertia=unknown.inertia * math.exp(sign * step[0]),
                dead_centre=unknown.dead_centre + sign * step[1],
                delay=unknown.delay + sign * step[2],
            )
            times = free_run(logged, engine, moved, first, count).times
            halves.append(half_orders(times, logged.edges).mean(axis=0))
        columns.append((halves[1] - halves[0]) / (2.0 * _SCALES[k]))
    return np.column_stack(columns)
