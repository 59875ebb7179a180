"""A free motion seen once a period, where it passes the angle of its start.

There its kinetic energy and its sense are all of its state. In the crank angle the energy obeys one
scalar equation, whose solutions do not cross: the energy after a period rises with the energy
before it. So what a run comes to is the first fixed point in the direction in which its first
period changes the energy, and no faster way to it may pass one by.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.friction import rubbing
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.grid import Grid
from crankmbs.motion.crank_angle.periods import Period, period_of
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.integrate import Setup, integrate
from crankmbs.motion.free.settling import LostError
from crankmbs.motion.plan import plan_of
from crankmbs.numerics.arrays import Array

__all__ = ["MOST_PERIODS", "PeriodMap", "Returned"]

MOST_PERIODS = 400  # periods that are tried before the search is given up

_SAMPLES = 36  # of a cycle, to see its least and its greatest speed
_ANGLES = 721  # of a cycle, at which the inertia is looked at
_LOOKS = 48  # at so many angles in a cycle, where they may depend on both
_SPEEDS = 65  # at which the slope of the loads is looked at, beside those of the rows of tables
_BESIDE = 1e-7  # of a row: on either side of it
_FLAT = 1e-6  # of the steepest slope: rounding
_CLEAR = 0.05  # rad: an energy that the largest torque does not take within it is clear of rest


class Returned(NamedTuple):
    """A period: how it ends, COMPLETE where the crank has turned through it; energy [J] and sense
    after it; least and greatest speed [rad/s], forwards or backwards; its duration [s]."""

    ending: Ending
    energy: float
    sense: float
    slow: float
    fast: float
    time: float


class PeriodMap:
    """Periods of a crank train from the angle of its start.

    by_angle : the crank angle is the variable wherever it can be; allowed : evaluations over time
    """

    def __init__(self, train: CrankTrain, allowed: int, *, by_angle: bool) -> None:
        scene = train.scene
        assert scene.start is not None
        self._train, self.scene, self.start = train, scene, scene.start
        self.inertia = float(reduce(train, scene.start.angle).inertia)
        every = scene.period / _SAMPLES
        parts = [load.parts for load in train.loads]
        tables = [np.abs(part.over_speed.knots) for part in parts if part.over_speed is not None]
        functions = [part.function for part in parts if part.function is not None]
        tables += [np.abs(function.speeds) for function in functions]
        # a function may depend on angle and speed together
        count = round(_LOOKS * scene.settled_period / scene.period) if functions else 1
        self._angles = np.linspace(0.0, scene.settled_period, count, endpoint=False)[:, None]
        rows = np.concatenate([np.empty(0), *tables])
        self._rows = np.concatenate([rows * (1.0 - _BESIDE), rows * (1.0 + _BESIDE)])
        self._plan = replace(plan_of(scene), every=every, in_time=False, last=math.inf)
        self._allowed, self._by_angle, self._periods = allowed, by_angle, 0
        self._closed: list[tuple[Grid, float, Period | None]] = []

    @cached_property
    def _inertias(self) -> Array:
        angles = np.linspace(0.0, self.scene.period, _ANGLES)
        return reduce(self._train, angles).inertia

    @property
    def least_inertia(self) -> float:
        """The smallest J [kg m2] of a period."""
        return float(self._inertias.min())

    @property
    def most_inertia(self) -> float:
        """The largest J [kg m2] of a period."""
        return float(self._inertias.max())

    def state(self, energy: float, sense: float) -> State:
        """The state that begins a period with this energy [J]."""
        omega = sense * math.sqrt(2.0 * energy / self.inertia)
        return State(0.0, self.start.angle, omega, 0.0)

    def energy(self, state: State) -> float:
        """Kinetic energy [J] of a state at the angle of the start."""
        return 0.5 * self.inertia * state.omega**2

    def period(self, grid: Grid, local: float, state: State, *, one_way: bool = False) -> Returned:
        """The period that begins in a state, by steps of this tolerance.

        one_way : it is given up, UNMOVED, where the crank stops or turns back

        Raises
        ------
        LostError : there have been too many
        """
        self._periods += 1
        if self._periods > MOST_PERIODS:
            raise LostError(Ending.WANDERS)
        setup = Setup(lambda *_: state, self._plan, self._allowed, one_way=one_way)
        one = integrate(grid, setup, local, by_angle=self._by_angle)
        omega, speed = float(one.samples.omega[-1]), np.abs(one.samples.omega)
        return Returned(
            one.ending,
            0.5 * self.inertia * omega**2,
            math.copysign(1.0, omega),
            float(speed.min()),
            float(speed.max()),
            float(one.samples.time[-1]),
        )

    @cached_property
    def _drag(self) -> float:
        """The largest torque of viscous friction per speed [N m s/rad] in a period."""
        angles = np.linspace(0.0, self.scene.period, _ANGLES)
        return float(rubbing(CrankTrain(self.scene, None), angles).drag.max())

    def slopes(self, slow: float, fast: float, sense: float) -> tuple[float, float]:
        """Least and greatest slope dT/domega [N m s] of loads and friction between two speeds
        [rad/s]; that of a jump is steep."""
        fast = max(fast, slow * (1.0 + 1e-6))
        inside = self._rows[(self._rows > slow) & (self._rows < fast)]
        speeds = np.geomspace(max(slow, 1e-6 * fast), fast, _SPEEDS)
        omega = sense * np.unique(np.concatenate([speeds, inside]))
        theta, omega = np.broadcast_arrays(self._angles, omega)
        torque = sum((load.parts(0.0, theta, omega) for load in self._train.loads), 0.0 * omega)
        slope = np.diff(torque) / np.diff(omega)
        least, most = float(slope.min()) - self._drag, float(slope.max())
        return least, most if most > _FLAT * abs(least) else min(most, 0.0)

    def closed_form(self, grid: Grid, sense: float) -> Period | None:
        """The affine map of a period, where loads are such that there is one at every speed."""
        for known, same_sense, one in self._closed:
            if known is grid and same_sense == sense:
                return one
        self._closed.append((grid, sense, self._composed(grid, sense)))
        return self._closed[-1][2]

    def _composed(self, grid: Grid, sense: float) -> Period | None:
        branch = branch_of(self._train.loads, 0.0, 0.0, rising=sense > 0.0)
        bounds = (branch.omega_low, branch.omega_high)
        if (
            grid.drags
            or not branch.is_affine_in_energy
            or any(0.0 < sense * b < math.inf for b in bounds)
        ):
            return None
        if not self._by_angle or any(map(math.isfinite, self._plan.folds)):
            return None
        period, theta = self.scene.settled_period, self.start.angle
        count = round(period / float(grid.edges[-1]) * (len(grid.edges) - 1)) + 2
        terms = grid.terms(theta, sense, count, theta + sense * period)
        return period_of(grid, terms, branch, sense)

    def turns(self, grid: Grid, one: Period, energy: float, sense: float) -> bool:
        """Whether the period that begins with this energy [J] stays clear of rest."""
        branch = branch_of(self._train.loads, 0.0, 0.0, rising=sense > 0.0)
        torque = float(grid.scale.max()) + abs(branch.c0)
        return bool(np.min(one.gain * energy + one.shift) > _CLEAR * torque)
