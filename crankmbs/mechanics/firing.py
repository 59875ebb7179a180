"""Each firing's share of the combustion: where it is decided, and how.

A cylinder decides where its compression begins, at the cycle angle of 180 degrees, where the
pressures with and without combustion are equal, and at the start; the share holds one period. An
angle passed again decides nothing.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.scene.fuel import Fuel, Governor
from crankmbs.scene.scene import Scene

__all__ = ["Ahead", "Firing", "FuelLaw", "governed"]

_SAME = 1e-8  # rad: decisions so near one another are one
_SPREAD = 4.0  # standard deviations: hardly a share scatters farther


class Firing(NamedTuple):
    """What has been decided: the shares of the cylinders, and what the next decision needs.

    time [s], theta [rad] : of the last decision; integral : the governor's
    set_in [rad/s] : speed at the decision at which the fuel set in, None before; over : whether it
    has ended for good
    low, high [rad] : crank angles between which all is decided
    imposed : the share that decisions take in place of the law's; None leaves it to the law
    """

    shares: tuple[float, ...]
    time: float
    theta: float
    integral: float
    set_in: float | None
    over: bool
    low: float
    high: float
    imposed: float | None = None


class Ahead(NamedTuple):
    """Decisions that are to come: their angles [rad] and places among those of one period, shape
    (n,), and what misfires and scatter leave of the share of each cylinder that decides, shape
    (n, cylinders), NaN of the others."""

    angles: Array
    slots: Index
    parts: Array


def governed(
    governor: Governor, integral: float, error: float, spent: float
) -> tuple[float, float]:
    """The share that a governor gives, and its integral after.

    K = integral + ki error spent; the share is clip(kp error + K, min, max); the integral becomes K
    unless this clips and the error drives it further.

    error [rad/s]; spent [s] since the last decision

    >>> governed(Governor(speed=100.0, kp=0.01, ki=0.1), 0.5, 2.0, 0.1)
    (0.54, 0.52)
    """
    more = integral + governor.ki * error * spent
    wanted = governor.kp * error + more
    share = min(max(wanted, governor.min), governor.max)
    driven = (wanted > governor.max and error > 0.0) or (wanted < governor.min and error < 0.0)
    return share, integral if driven else more


@dataclass(frozen=True, eq=False)
class FuelLaw:
    """The decisions of a scene with fuel, from the start's angle [rad] and speed [rad/s]."""

    scene: Scene
    fuel: Fuel
    start: tuple[float, float]

    @cached_property
    def angles(self) -> tuple[float, ...]:
        """Crank angles [rad] in one period at which a cylinder decides, increasing."""
        period = self.scene.period
        bottoms = sorted((math.pi - c.phase) % period for c in self.scene.cylinders)
        apart = [a for k, a in enumerate(bottoms) if k == 0 or a - bottoms[k - 1] > _SAME]
        if len(apart) > 1 and apart[0] + period - apart[-1] <= _SAME:
            apart.pop()
        return tuple(apart)

    @property
    def most(self) -> float:
        """A share that hardly any firing exceeds."""
        governor = self.fuel.governor
        return (governor.max if governor else 1.0) * (1.0 + _SPREAD * self.fuel.scatter)

    @cached_property
    def first(self) -> Firing:
        """What the start decides."""
        angle, speed = self.start
        governor = self.fuel.governor
        integral = governor.initial if governor else 0.0
        empty = Firing((), 0.0, angle, integral, None, False, angle, angle)
        count = len(self.scene.cylinders)
        return self._decided(empty, 0.0, angle, speed, dict.fromkeys(range(count), 1))

    def next(self, firing: Firing) -> tuple[float, float]:
        """Crank angles [rad], backwards and forwards, at which the next decision falls."""
        below = self._number(firing.low - _SAME, bisect_left) - 1
        above = self._number(firing.high + _SAME, bisect_right)
        return self._angle(below), self._angle(above)

    def ahead(self, theta: float, sense: float, reach: float) -> Ahead:
        """The decisions from an angle [rad] at which one falls on, in a sense of rotation, through
        so much [rad] and one more."""
        first, count = self._number(theta - _SAME, bisect_left), len(self.angles)
        most = (math.ceil(reach / self.scene.period) + 1) * count + 1
        turns, slot = np.divmod(first + int(sense) * np.arange(most), count)
        angles = turns * self.scene.period + np.array(self.angles)[slot]
        within = int(np.searchsorted(sense * (angles - theta), reach + _SAME)) + 1
        angles, slot = angles[:within], slot[:within]
        parts = self._slots[slot]
        if self.fuel.misfire or self.fuel.scatter:
            phases = [cylinder.phase for cylinder in self.scene.cylinders]
            for i, k in np.argwhere(parts == 1.0).tolist():
                cycle = self._cycle(phases[k], float(angles[i]), forwards=sense > 0.0)
                parts[i, k] = _part(self.fuel, k + 1, cycle)
        return Ahead(angles, slot, parts)

    @cached_property
    def _slots(self) -> Array:
        """1 where a cylinder decides at one of `angles`, else NaN."""
        decides = np.full((len(self.angles), len(self.scene.cylinders)), np.nan)
        for k, cylinder in enumerate(self.scene.cylinders):
            off = np.array(self.angles) + cylinder.phase - math.pi
            decides[np.abs(np.remainder(off + 1.0, self.scene.period) - 1.0) < 2.0 * _SAME, k] = 1.0
        return decides

    def decided(self, firing: Firing, time: float, theta: float, omega: float) -> Firing:
        """After the decision at one of the angles of `next`, at a time [s] and a speed [rad/s]."""
        forwards = theta > firing.high
        cycles = {
            k: self._cycle(c.phase, theta, forwards=forwards)
            for k, c in enumerate(self.scene.cylinders)
            if abs(math.remainder(theta + c.phase - math.pi, self.scene.period)) < 2.0 * _SAME
        }
        return self._decided(firing, time, theta, omega, cycles)

    def _decided(
        self, before: Firing, time: float, theta: float, omega: float, cycles: dict[int, int]
    ) -> Firing:
        """cycles : of the cylinders that decide, by their number from 0.

        While a share is imposed a governor's integral stays as it is.
        """
        fuel, governor, imposed = self.fuel, self.fuel.governor, before.imposed
        share, integral = 1.0, before.integral
        if governor is not None and imposed is None:
            spent = time - before.time
            mean = (theta - before.theta) / spent if spent > 0.0 else omega
            share, integral = governed(governor, integral, governor.speed - mean, spent)
        set_in, over = self._window(before, time, omega)
        if set_in is None or over:
            share = 0.0
        shares = list(before.shares or [0.0] * len(self.scene.cylinders))
        for k, cycle in cycles.items():
            shares[k] = share * _part(fuel, k + 1, cycle) if imposed is None else imposed
        low, high = min(theta, before.low), max(theta, before.high)
        return Firing(tuple(shares), time, theta, integral, set_in, over, low, high, imposed)

    def _window(self, before: Firing, time: float, omega: float) -> tuple[float | None, bool]:
        """The speed at which the fuel has set in, and whether it is over, judged at a decision."""
        fuel, set_in, over = self.fuel, before.set_in, before.over
        if fuel.until is not None and time >= fuel.until:
            over = True
        if set_in is None:
            met = fuel.from_speed is None or _met(fuel.from_speed, self.start[1], omega)
            return (omega if met and time >= fuel.after else None), over
        ended = fuel.until_speed is not None and _met(fuel.until_speed, set_in, omega)
        return set_in, over or ended

    def _cycle(self, phase: float, theta: float, *, forwards: bool) -> int:
        """Number of the cycle whose share is decided: how many firing dead centres, at the cycle
        angle of 360 degrees, it and those since the start hold."""
        period = self.scene.period
        begun = (self.start[0] + phase - 2.0 * math.pi) / period
        decided = round((theta + phase - math.pi) / period)
        if forwards:
            return decided - math.floor(begun + _SAME)
        return math.ceil(begun - _SAME) - decided + 1

    def _number(self, theta: float, side: Callable[[Sequence[float], float], int]) -> int:
        """How many decisions lie below an angle [rad], counted from the first above angle 0."""
        turns = math.floor(theta / self.scene.period)
        return turns * len(self.angles) + side(self.angles, theta - turns * self.scene.period)

    def _angle(self, number: int) -> float:
        turns, k = divmod(number, len(self.angles))
        return turns * self.scene.period + self.angles[k]


def _met(speed: float, before: float, now: float) -> bool:
    """Whether a speed has been met between two decisions, from either side."""
    return (before - speed) * (now - speed) <= 0.0


def _part(fuel: Fuel, cylinder: int, cycle: int) -> float:
    """What misfires and scatter leave of a share."""
    if any(one.cylinder == cylinder and one.strikes(cycle) for one in fuel.misfire or ()):
        return 0.0
    if fuel.scatter == 0.0:
        return 1.0
    return max(0.0, 1.0 + fuel.scatter * _normal(fuel.seed, cylinder, cycle))


@lru_cache(maxsize=100_000)
def _normal(seed: int, cylinder: int, cycle: int) -> float:
    """The random number of a firing, the same however the run came there."""
    return float(np.random.default_rng((seed, cylinder, cycle)).standard_normal())
