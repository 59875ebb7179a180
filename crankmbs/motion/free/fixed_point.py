"""From the start of a free run to what it settles to: the nearest fixed point of its period map.

Steps towards it are as wide as the slopes of the loads allow without passing a nearer one by.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.period_map import PeriodMap, Returned
from crankmbs.motion.free.settling import FINE, STEP, WIDE, LostError, slope_of
from crankmbs.numerics.arrays import Array

__all__ = ["Limit", "fixed_point"]

_SEARCH = 1e-9  # relative error of the energy with which the search ends
_LOCAL = 1e-10  # tolerance of its periods
_FARTHEST = 1e6  # of the energy: where it grows there, too, it is taken to grow without bound
_SLOWEST = 1e-24  # of the energy: where it falls there, too, it is taken to fall to nothing
_REACHES = (_FARTHEST, 1e3, 30.0, 3.0, 0.7, 0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-5)  # of the energy
_BEYOND = 1.5  # of a Newton step: far enough to lie behind the fixed point
_AT_EDGE = 1e-4  # of the energy: so near a point from where the crank does not turn on
_CLOSE = 1e-3  # of the energy: between points so near there is one fixed point
_FLIPS = 3  # changes of sense before it is given up
_NONE = 1e-11  # 1 - factor, or of the energy, gained in a period: nothing but rounding


class Limit(NamedTuple):
    """Energy [J] and sense where a settled period begins; 1 - factor; its greatest energy over
    the one there; whether its map is affine."""

    energy: float
    sense: float
    damping: float
    swing: float
    affine: bool


def fixed_point(period_map: PeriodMap, grid: Grid) -> Limit:
    """What the run from the start comes to.

    Raises
    ------
    LostError : it does not settle
    """
    start = period_map.start
    return _FixedPoint(period_map, grid).from_state(State(0.0, start.angle, start.speed, 0.0))


class _FixedPoint:
    def __init__(self, period_map: PeriodMap, grid: Grid) -> None:
        self._period_map, self._grid = period_map, grid

    def from_state(self, state: State) -> Limit:
        """What comes of a state."""
        period_map = self._period_map
        for _ in range(_FLIPS):
            limit = self._in_closed_form(state)
            if limit is not None:
                return limit
            returned = period_map.period(self._grid, _LOCAL, state)
            if returned.ending is not Ending.COMPLETE:
                raise LostError(returned.ending)
            if returned.sense * state.omega > 0.0:
                after = self._walk(state, returned)
                if isinstance(after, Limit):
                    return after
                state = after
            else:  # from rest, or turned round
                state = period_map.state(returned.energy, returned.sense)
        raise LostError(Ending.WANDERS)

    def _in_closed_form(self, state: State) -> Limit | None:
        """The limit of an affine map, where no period on the way to it comes near rest."""
        period_map, sense = self._period_map, math.copysign(1.0, state.omega)
        energy = period_map.energy(state)
        one = period_map.closed_form(self._grid, sense) if energy > 0.0 else None
        if one is None or not period_map.turns(self._grid, one, energy, sense):
            return None
        gained = one.growth * energy + one.rise
        if one.growth >= -_NONE:
            if abs(gained) <= _NONE * float((one.gain * energy + one.shift).max()):
                raise LostError(Ending.BALANCED)
            if gained > 0.0 and one.growth == 0.0:
                raise LostError(Ending.RUNS_AWAY)
            return None
        limit = -one.rise / one.growth
        if not (limit > 0.0 and period_map.turns(self._grid, one, limit, sense)):
            return None
        inside = one.gain * limit + one.shift
        return Limit(limit, sense, -one.growth, float(inside.max()) / limit, affine=True)

    def _walk(self, state: State, first: Returned) -> Limit | State:
        """From a state and its period to the nearest fixed point in the direction in which the
        energy changes; the state in which the crank turns the other way where it stalls before."""
        period_map, sense = self._period_map, first.sense
        energy, returned, edge = period_map.energy(state), first, math.inf
        least = _SLOWEST * energy
        loses = 0.0  # of an energy more, in a period, by the last two
        while True:
            gained = returned.energy - energy
            if abs(gained) <= _NONE * energy:
                return self._limit_at(energy, sense)
            reach = self._reach(returned, energy, gained, loses, edge)
            other = energy + math.copysign(reach, gained)
            if reach <= _SEARCH * energy:
                return self._limit_at(other, sense)
            if other <= least:
                raise LostError(Ending.FADES)
            trial = period_map.state(other, sense)
            beyond = period_map.period(self._grid, _LOCAL, trial, one_way=True)
            if beyond.ending is not Ending.COMPLETE or beyond.sense != sense:
                if reach <= _AT_EDGE * energy:
                    return self._stalled(energy, sense)
                edge = reach / 3.0
            elif (beyond.energy - other) * gained > 0.0:
                if reach >= _FARTHEST * energy:
                    raise LostError(Ending.RUNS_AWAY)
                edge = edge - reach if edge > reach else math.inf
                loses = (gained - (beyond.energy - other)) / (other - energy)
                energy, returned = other, beyond
            elif reach > _CLOSE * energy and self._may_be_several(returned, beyond):
                edge = reach / 2.0
            else:
                return self._limit_at(self._between(energy, other, sense), sense)

    def _reach(
        self, returned: Returned, energy: float, gained: float, loses: float, edge: float
    ) -> float:
        """How far from an energy [J] the next period may be tried without missing a fixed point.

        Over a period a difference of energies grows by exp(int T' / J dt), T' the slope of the
        loads: where it is nowhere less than T'_min the gain falls by at most 1 - exp(T'_min t / J)
        of the way. Where T' is nowhere above 0 there is one fixed point at most.
        """
        period_map, safe = self._period_map, 0.0
        held = returned.time / period_map.least_inertia
        for part in _REACHES:
            reach, slow, fast, longer = min(part * energy, edge), returned.slow, returned.fast, 1.0
            if gained > 0.0:
                fast = math.sqrt(fast**2 + 2.0 * reach / period_map.least_inertia)
            elif reach >= energy:
                continue
            else:
                longer = 1.0 / math.sqrt(1.0 - reach / energy)
                slow /= longer
            least, most = period_map.slopes(slow, fast, returned.sense)
            falls = -math.expm1(min(least * held * longer, 0.0))
            if falls * reach <= abs(gained):
                return max(reach, safe)
            safe = max(safe, abs(gained) / falls)
            if most <= 0.0:
                mean = 0.5 * sum(period_map.slopes(returned.slow, returned.fast, returned.sense))
                falls = loses if loses > 0.0 else -math.expm1(mean * held)
                return min(reach, _BEYOND * abs(gained) / falls) if falls > 0.0 else reach
        return safe

    def _may_be_several(self, one: Returned, other: Returned) -> bool:
        """Whether there may be more than one fixed point between two periods."""
        slow, fast = min(one.slow, other.slow), max(one.fast, other.fast)
        return self._period_map.slopes(slow, fast, one.sense)[1] > 0.0

    def _between(self, energy: float, other: float, sense: float) -> float:
        """The fixed point between two energies [J]."""
        period_map = self._period_map

        def gained(trial: float) -> float:
            return (
                period_map.period(self._grid, _LOCAL, period_map.state(trial, sense)).energy - trial
            )

        return float(brentq(gained, energy, other, xtol=_SEARCH * energy, rtol=_SEARCH))

    def _limit_at(self, energy: float, sense: float) -> Limit:
        """The limit at a fixed point, with how fast it is reached."""
        period_map, at = self._period_map, np.array([energy])

        def image(trial: Array) -> Array:
            state = period_map.state(float(trial[0]), sense)
            return np.array([period_map.period(self._grid, FINE, state).energy])

        factor, wide = (float(slope_of(image, at, at, width)[0, 0]) for width in (STEP, WIDE))
        if 1.0 - factor <= abs(wide - factor) + FINE / STEP:
            raise LostError(Ending.BALANCED)
        fast = period_map.period(self._grid, _LOCAL, period_map.state(energy, sense)).fast
        swing = max(0.5 * fast**2 * period_map.most_inertia / energy, 1.0)
        return Limit(energy, sense, 1.0 - factor, swing, affine=False)

    def _stalled(self, energy: float, sense: float) -> State:
        """Where the crank turns after it has stopped, if it does."""
        period_map = self._period_map
        while True:
            returned = period_map.period(self._grid, _LOCAL, period_map.state(energy, sense))
            if returned.ending is not Ending.COMPLETE:
                raise LostError(returned.ending)
            if returned.sense != sense:
                return period_map.state(returned.energy, returned.sense)
            energy = returned.energy
