"""What a free run settles to: the periodic motion that it comes to from its start, if any.

The fixed point of the energy over a period is sought once, coarsely, from the start on; then found
again on the grid of either pass. So its error, and what 1 / (1 - factor) makes of it, is in the
difference of the passes like any other.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.assemble import Assembled
from crankmbs.motion.base import Decay, State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.ending import Ending
from crankmbs.motion.free import passes
from crankmbs.motion.free.fixed_point import Limit, fixed_point
from crankmbs.motion.free.fuelled import Fuelled
from crankmbs.motion.free.period_map import MOST_PERIODS, PeriodMap
from crankmbs.motion.free.settling import LostError, Settling
from crankmbs.numerics.arrays import Array

__all__ = ["run"]

_WIDE = 0.25, 0.5  # of the energy
_EPS = float(np.finfo(float).eps)


def run(train: CrankTrain, rtol: float, cost_cap: float, *, by_angle: bool) -> Assembled:
    """Solve a free motion, or the periodic motion that it settles to where that is asked for.

    Parameters are those of `crankmbs.motion.free.passes.run`.
    """
    if not train.scene.settles:
        return passes.run(train, rtol, cost_cap, by_angle=by_angle)
    allowed = passes.evaluations(cost_cap)
    try:
        grid = passes.first_grid(train, rtol)
        if train.law is None:
            period_map = PeriodMap(train, allowed, by_angle=by_angle)
            settling = _of_energy(period_map, fixed_point(period_map, grid))
        else:
            settling = Fuelled(train, grid, allowed, by_angle=by_angle).settling()
        lead = passes.Lead(grid, rtol * min(settling.damping, 1.0), settling.begin)
        assembled = passes.run(train, rtol, cost_cap, by_angle=by_angle, lead=lead)
        decay = settling.decay()
    except LostError as lost:
        assembled = passes.run(train, rtol, cost_cap, by_angle=by_angle)
        return assembled if assembled.solution.status != 0 else _said(assembled, lost, allowed)
    return assembled if assembled.solution.status != 0 else _settled(assembled, decay)


def _said(assembled: Assembled, lost: LostError, allowed: int) -> Assembled:
    """The period from the start, with the reason why nothing settles."""
    samples = assembled.solution.samples
    at = float(samples.theta[-1]), float(samples.omega[-1])
    numbers = {"periods": MOST_PERIODS, "factor": lost.factor, "allowed": allowed}
    status, message = lost.ending.said(*at, **numbers)
    solution = replace(assembled.solution, status=status, message=message, unsettled=lost.ending)
    return replace(assembled, solution=solution)


def _settled(assembled: Assembled, decay: Decay) -> Assembled:
    """The settled period, with what it leaves of a disturbance."""
    _, mark, short = assembled.solution.message.partition(";")
    message = (
        f"settled: a disturbance decays to {100.0 * decay.factor:.4g} % per period{mark}{short}"
    )
    return replace(assembled, solution=replace(assembled.solution, message=message, decay=decay))


def _of_energy(period_map: PeriodMap, limit: Limit) -> Settling:
    """That of a crank train without fuel, whose periods hand on their energy alone."""

    def image(grid: Grid, local: float, at: Array) -> Array:
        one = period_map.closed_form(grid, limit.sense) if limit.affine else None
        if one is not None:
            return np.asarray(at + (one.growth * at + one.rise))
        returned = period_map.period(grid, local, state(at))
        if returned.ending is not Ending.COMPLETE:
            raise LostError(returned.ending)
        return np.array([returned.energy])

    def state(at: Array) -> State:
        return period_map.state(float(at[0]), limit.sense)

    at, slope = np.array([limit.energy]), np.array([[1.0 - limit.damping]])
    settling = Settling(at, slope, image, state, lambda at: at, limit.swing)
    return replace(settling, widths=_WIDE, errs=_EPS) if limit.affine else settling
