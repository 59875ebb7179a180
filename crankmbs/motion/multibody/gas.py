"""GasForces forces over the crank angle, smooth between the angles at which one of them jumps.

A step of the pressure would ring in the solver. So a run is cut where a cylinder's pressure jumps,
and on a stretch between two jumps the forces go on without them.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.pressure import PeriodicPressure
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array

__all__ = ["NEAR", "GasForces", "GasStretch"]

Force = Callable[[float], float]

NEAR = 1e-9  # rad: a knot so close ahead is reached, as in PeriodicPressure
_JUMP = 1e-9  # of the highest pressure or slope: less is rounding
_MOST_JUMPS = 60  # in a period; a table of more steps is run over as it is


class GasForces:
    """The gas forces of a crank train; without gas all zero."""

    def __init__(self, train: CrankTrain) -> None:
        scene, pressure = train.scene, train.pressure
        self.phases = np.array([cylinder.phase for cylinder in scene.cylinders])
        self._pressure, self._period = pressure, scene.period
        self._area = scene.piston.gas_area or 0.0
        self._angles, self._rises = self._jumps()

    @property
    def jumps(self) -> bool:
        """Whether a force jumps anywhere."""
        return self._pressure is not None and len(_knots(self._pressure)[0]) > 0

    @property
    def order(self) -> int:
        """1 where forces jump within a stretch, 2 where they bend there, else 3."""
        if self._pressure is None:
            return 3
        jumps, bends = _knots(self._pressure)
        if len(jumps) > 0 and len(self._angles) == 0:
            return 1
        return 2 if len(bends) > 0 else 3

    def force(self, theta: Array) -> Array:
        """GasForces forces [N] towards the crank, shape (m, n), at crank angles of shape (m,)."""
        angles = theta[:, None] + self.phases
        if self._pressure is None:
            return np.zeros_like(angles)
        return np.asarray(self._area * self._pressure(angles))

    def scalar(self) -> Force:
        """The force [N] over the cycle angle [rad], from number to number.

        A bisection and a cubic in plain Python take 0.7 us; a symbolic tree of branches in
        exudyn's generic object, the only other way, costs 9 us a step.
        """
        assert self._pressure is not None
        first, period = float(self._pressure.knots[0]) - NEAR, self._pressure.period
        knots = (self._pressure.knots[:-1] - self._pressure.knots[0]).tolist()
        pieces = (self._area * self._pressure.coefficients.T).tolist()

        def force(angle: float) -> float:
            x = (angle - first) % period
            k = bisect_right(knots, x) - 1
            a, b, c, d = pieces[k]
            x -= knots[k] + NEAR
            return float(((a * x + b) * x + c) * x + d)

        return force

    def stretch(self, theta: float, sense: float) -> GasStretch:
        """The stretch that a motion of this sense (its sign) enters at a crank angle [rad]."""
        if len(self._angles) == 0:
            return GasStretch(self, -math.inf, math.inf, np.zeros((2, len(self.phases))))
        at = theta + math.copysign(NEAR, sense)
        turns = np.floor(at / self._period) + np.array([-1.0, 0.0, 1.0])
        angles = (self._angles + self._period * turns[:, None]).ravel()
        k = int(np.searchsorted(angles, at, side="right"))
        ends = np.array([k - 1, k])
        low, high = angles[ends]
        return GasStretch(self, float(low), float(high), self._rises[ends % len(self._angles)])

    def _jumps(self) -> tuple[Array, Array]:
        """Crank angles in a period at which a force jumps; what each cylinder's rises by there."""
        none = np.empty(0), np.empty((0, len(self.phases)))
        if self._pressure is None:
            return none
        found, _ = _knots(self._pressure)
        if not 0 < len(found) * len(self.phases) <= _MOST_JUMPS:
            return none
        angles = np.mod(self._pressure.knots[found][:, None] - self.phases, self._period)
        rise = _rises(self._pressure)[0][found]
        rises = self._area * rise[:, None, None] * np.eye(len(self.phases))
        angles, rises = angles.ravel(), rises.reshape(-1, len(self.phases))
        order = np.argsort(angles)
        angles, rises = angles[order], rises[order]
        apart = np.flatnonzero(np.diff(angles, prepend=-1.0) > NEAR)
        return angles[apart], np.add.reduceat(rises, apart, axis=0)


@dataclass(frozen=True)
class GasStretch:
    """GasForces forces between the crank angles ``low`` and ``high`` [rad], and smoothly beyond.

    rises : shape (2, n) [N], what each cylinder's force rises by at low and at high
    """

    gas: GasForces
    low: float
    high: float
    rises: Array

    def force(self, theta: Array) -> Array:
        """GasForces forces [N] towards the crank, shape (m, n), at crank angles of shape (m,)."""
        below, above = theta < self.low - NEAR, theta >= self.high - NEAR
        lifted = below[:, None] * self.rises[0] - above[:, None] * self.rises[1]
        return np.asarray(self.gas.force(theta) + lifted)

    def functions(self) -> list[Force]:
        """The same cylinder by cylinder, from crank angle to force."""
        return [self._function(k, self.gas.scalar()) for k in range(len(self.gas.phases))]

    def _function(self, k: int, force: Force) -> Force:
        phase = float(self.gas.phases[k])
        low, high = self.low - NEAR, self.high - NEAR
        at_low, at_high = (float(rise) for rise in self.rises[:, k])
        if at_low == 0.0 and at_high == 0.0:
            return lambda theta: force(theta + phase)

        def without_jumps(theta: float) -> float:
            lifted = at_low if theta < low else -at_high if theta >= high else 0.0
            return force(theta + phase) + lifted

        return without_jumps


def _knots(pressure: PeriodicPressure) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers of the knots at which the pressure jumps, and of those at which it bends."""
    _, _, slopes, values = pressure.coefficients
    value, slope = _rises(pressure)
    jumps = np.abs(value) > _JUMP * np.max(np.abs(values))
    bends = np.abs(slope) > _JUMP * np.max(np.abs(slopes))
    return np.flatnonzero(jumps), np.flatnonzero(bends)


def _rises(pressure: PeriodicPressure) -> Array:
    """What pressure [Pa] and slope [Pa/rad] rise by at each knot but the last, shape (2, n)."""
    a, b, c, d = pressure.coefficients
    x = np.diff(pressure.knots)
    ends = np.array([((a * x + b) * x + c) * x + d, (3.0 * a * x + 2.0 * b) * x + c])
    return np.asarray(np.array([d, c]) - np.roll(ends, 1, axis=1))
