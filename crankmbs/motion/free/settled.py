"""What a free run settles to: the periodic motion that it comes to from its start, if any.

The fixed point of the energy over a period is sought once, coarsely, from the start on; then found
again on the grid of either pass. So its error, and what 1 / (1 - factor) makes of it, is in the
difference of the passes like any other.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.assemble import Assembled
from crankmbs.motion.base import Decay, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.crank_angle.periods import Period
from crankmbs.motion.ending import Ending
from crankmbs.motion.free import passes
from crankmbs.motion.free.fixed_point import Limit, fixed_point
from crankmbs.motion.free.fuelled import Fuelled
from crankmbs.motion.free.period_map import MOST_PERIODS, LostError, PeriodMap

__all__ = ["run"]

_EPS = float(np.finfo(float).eps)
_ROUNDING = 4 * _EPS  # of the energy, that a period rounds
_POLISHES = 8  # steps at most; they end where a step is not half the one before


def run(train: CrankTrain, rtol: float, cost_cap: float, *, by_angle: bool) -> Assembled:
    """Solve a free motion, or the periodic motion that it settles to where that is asked for.

    Parameters are those of `crankmbs.motion.free.passes.run`.
    """
    if not train.scene.settles:
        return passes.run(train, rtol, cost_cap, by_angle=by_angle)
    allowed = passes.evaluations(cost_cap)
    try:
        grid = passes.first_grid(train, rtol)
        settling: _Settling | Fuelled
        if train.law is None:
            period_map = PeriodMap(train, allowed, by_angle=by_angle)
            settling = _Settling(period_map, fixed_point(period_map, grid))
        else:
            settling = Fuelled(train, grid, allowed, by_angle=by_angle)
        lead = passes.Lead(grid, rtol * min(settling.damping, 1.0), settling.begin)
        found = passes.run(train, rtol, cost_cap, by_angle=by_angle, lead=lead)
        decay = settling.decay()
    except LostError as lost:
        found = passes.run(train, rtol, cost_cap, by_angle=by_angle)
        return found if found.solution.status != 0 else _said(found, lost)
    return found if found.solution.status != 0 else _settled(found, decay)


def _said(found: Assembled, lost: LostError) -> Assembled:
    """The period from the start, with the reason why nothing settles."""
    samples = found.solution.samples
    at = float(samples.theta[-1]), float(samples.omega[-1])
    status, message = lost.ending.said(*at, periods=MOST_PERIODS, factor=lost.factor)
    solution = replace(found.solution, status=status, message=message, unsettled=lost.ending)
    return replace(found, solution=solution)


def _settled(found: Assembled, decay: Decay) -> Assembled:
    """The settled period, with what it leaves of a disturbance."""
    _, mark, short = found.solution.message.partition(";")
    message = (
        f"settled: a disturbance decays to {100.0 * decay.factor:.4g} % per period{mark}{short}"
    )
    return replace(found, solution=replace(found.solution, message=message, decay=decay))


class _Settling:
    """A limit on the grids of the passes."""

    def __init__(self, period_map: PeriodMap, limit: Limit) -> None:
        self._period_map, self._limit = period_map, limit
        # grids, energies and closed forms of the passes
        self._seen: list[tuple[Grid, float, Period | None]] = []

    @property
    def damping(self) -> float:
        """1 less the factor."""
        return self._limit.damping

    def begin(self, grid: Grid, local: float) -> State:
        """Where the settled period begins on a grid, by periods with this tolerance; on one that
        checks another away from where it does there, by what rounding may make of it."""
        period_map, limit = self._period_map, self._limit
        one = period_map.closed_form(grid, limit.sense) if limit.affine else None
        energy = self._polished(grid, local) if one is None else -one.rise / one.growth
        if grid.checks and self._seen:
            more = _ROUNDING * limit.swing / limit.damping * energy
            energy += math.copysign(more, energy - self._seen[-1][1])
        self._seen.append((grid, energy, one))
        return period_map.state(energy, limit.sense)

    def decay(self) -> Decay:
        """The factor by which a disturbance changes in a period, and its error: what it differs by
        between the grids of both passes besides."""
        (factor, _), (other, error) = (self._factor(*seen) for seen in self._seen[-2:])
        return Decay(other, error + abs(other - factor))

    def _factor(self, grid: Grid, energy: float, one: Period | None) -> tuple[float, float]:
        if one is not None:
            return 1.0 + one.growth, _ROUNDING
        return self._period_map.slope(grid, energy, self._limit.sense)[:2]

    def _polished(self, grid: Grid, local: float) -> float:
        """The fixed point on a grid, from the one before."""
        period_map, limit, before = self._period_map, self._limit, math.inf
        energy = self._seen[-1][1] if self._seen else limit.energy
        for _ in range(_POLISHES):
            returned = period_map.period(grid, local, period_map.state(energy, limit.sense))
            if returned.ending is not Ending.COMPLETE:
                raise LostError(returned.ending)
            step = (returned.energy - energy) / limit.damping
            if abs(step) > 0.5 * before:
                break  # nothing but what the periods err
            energy, before = energy + step, abs(step)
            if before <= _EPS * energy:
                break
        return energy
