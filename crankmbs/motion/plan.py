"""Where a run is sampled: exactly at start + k * every, in angle or time, and at its end."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import psutil

from crankmbs.errors import InputError
from crankmbs.mechanics.variables import VARIABLES, variables_of
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import DEGREE

__all__ = ["Plan", "folds_of", "plan_of"]


_LESS = 1.0 - 1e-6  # of a spacing: the samples that are kept beyond the last period reach so far
_ROUNDING = 8 * float(np.finfo(float).eps)  # of a value, as in `crankmbs.motion.cells.cell_of`
_HAIR = 1e-6  # rad: so near a fold the forces still have all their digits but the last few
_TIMES = 10  # what a run takes at its peak, saved at its end, over what it stores: 3 to 9 measured
_LITTLE = 16e6  # bytes: less than what was loaded to come here, and not worth to ask the system


class Room:
    """The memory that is free, for samples of so many numbers each; looked at where there are more
    than a few."""

    def __init__(self, numbers: int) -> None:
        self._numbers = numbers

    @cached_property
    def _free(self) -> int:
        """Bytes, without swapping."""
        return int(psutil.virtual_memory().available)

    def check(self, samples: float) -> None:
        """Refuse more samples than memory holds.

        Raises
        ------
        InputError : how many, what they take, what is free, and the way out
        """
        taken = samples * 8 * self._numbers * _TIMES
        if taken > _LITTLE and taken > self._free:
            raise InputError(
                f"run.every: {samples:.3g} samples of {self._numbers} numbers each came, which "
                f"take up to {taken / 1e9:.3g} GB, and {self._free / 1e9:.3g} GB are free; give a "
                'wider spacing, or every = "none" to keep the last cycle alone'
            )


@dataclass(frozen=True)
class Plan:
    """The samples of a run and its end.

    start [rad] : crank angle at time 0
    every : spacing, [rad] or [s]; in_time says which
    until : end, [s] if ``until_time``, else |theta - start| [rad]
    last [rad] : only the last stretch of this angle is kept; infinite when everything is
    folds [rad] : crank angles, backwards and forwards, where a rod as long as crank radius and
        offset together folds onto the crank; nothing can be said beyond
    room : the memory for the samples
    """

    start: float
    every: float
    in_time: bool
    until: float
    until_time: bool
    last: float = math.inf
    folds: tuple[float, float] = (-math.inf, math.inf)
    room: Room = field(default_factory=lambda: Room(len(VARIABLES)), compare=False)

    @property
    def angle_bounds(self) -> tuple[float, float]:
        """Crank angles [rad] at which the run ends, backwards and forwards."""
        reach = math.inf if self.until_time else self.until
        return max(self.start - reach, self.folds[0]), min(self.start + reach, self.folds[1])

    def folds_at(self, theta: float) -> bool:
        """Whether a motion that ends at this angle [rad] ends at a fold."""
        return min(abs(theta - fold) for fold in self.folds) < 1e-9

    @property
    def time_bound(self) -> float:
        """Time [s] at which the run ends."""
        return self.until if self.until_time else math.inf

    def between(self, begin: float, end: float) -> Array:
        """Grid values in (begin, end], but for rounding, in the order in which they are passed;
        angles or times.

        Raises
        ------
        InputError : more than memory holds
        """
        origin = 0.0 if self.in_time else self.start
        sign = 1.0 if end >= begin else -1.0
        a, b = sorted(((begin - origin) / self.every, (end - origin) / self.every))
        self.room.check(b - a)
        grid = origin + self.every * np.arange(math.floor(a) - 1, math.ceil(b) + 2)
        first, last = (sign * bound + _ROUNDING * abs(bound) for bound in (begin, end))
        inside = grid[(sign * grid > first) & (sign * grid <= last)]
        return np.asarray(inside if sign > 0 else inside[::-1])

    def samples(
        self,
        stretches: Iterable[tuple[float, float]],
        angle_at: Callable[[Array], Array],
        time_at: Callable[[Array, float, float], Array],
        final: float | None,
    ) -> tuple[Array, Array]:
        """Times [s] and crank angles [rad] of the samples, the last where the motion ends.

        stretches : their begins and ends [s]; the crank turns one way in each
        angle_at : crank angles [rad] at times [s]; time_at : when they are passed in a stretch
        final : crank angle at the end [rad], where that is known

        Raises
        ------
        InputError : more than memory holds
        """
        times, angles, end = [np.zeros(1)], [np.array([self.start])], 0.0
        for begin, end in stretches:
            if self.in_time:
                times.append(self.between(begin, end))
                angles.append(angle_at(times[-1]))
                continue
            turned, bound = angle_at(np.array([begin, end])).tolist()
            theta = self.between(turned, bound)
            # where a stretch begins on a sample, but for rounding, the one before it ends there
            angles.append(theta[np.abs(theta - turned) > self.hair])
            times.append(time_at(angles[-1], begin, end))
        time, theta = np.concatenate(times), np.concatenate(angles)
        last = float(angle_at(np.array([end]))[0]) if final is None else final
        near = np.abs(time - end) if self.in_time else np.abs(theta - last)
        near[:-1] = np.inf
        others = (time < end * (1.0 - 1e-12)) & (near > self.hair)
        others[0] = True
        time, theta = np.append(time[others], end), np.append(theta[others], last)
        far = np.flatnonzero(np.abs(theta - last) > self.last * (1.0 + 1e-12))
        first = int(far[-1]) + 1 if len(far) else 0
        return time[first:], theta[first:]

    def is_end(self, value: float, end: float) -> bool:
        """Whether a grid value and the end of the run are one sample."""
        return abs(value - end) <= self.hair

    @property
    def hair(self) -> float:
        """Samples nearer than this [rad or s] are one but for rounding."""
        return 1e-9 * self.every


def plan_of(scene: Scene) -> Plan:
    """The plan of a scene; with every = "none" the last period at 1 degree is kept, with the sample
    before it where it begins between two.

    Raises
    ------
    InputError : more samples than memory holds

    >>> plan_of(load_scene("coasting")).until
    0.5
    """
    start = scene.motion.angle if scene.motion is not None else 0.0
    start = scene.start.angle if scene.start is not None else start
    until, until_time = scene.end
    folds = folds_of(scene, start)
    if scene.run.every is None:
        last = scene.settled_period if until_time or until >= scene.settled_period else scene.period
        last += _LESS * DEGREE
        return Plan(start, DEGREE, False, until, until_time, last, folds)
    every, in_time = scene.run.every.resolve(scene.period)
    cylinders = len(scene.cylinders)
    room = Room(sum(cylinders if one.of else 1 for one in variables_of(scene).values()))
    if in_time == until_time:  # else their number shows on the way
        room.check(until / every)
    return Plan(start, every, in_time, until, until_time, folds=folds, room=room)


def folds_of(scene: Scene, start: float) -> tuple[float, float]:
    """The nearest crank angles [rad] around ``start`` at which a rod folds, drawn in by a hair."""
    ahead = []
    for cylinder, gear in zip(scene.cylinders, scene.running_gear, strict=True):
        r, l, e = gear.shape
        angles = [0.5 * math.pi] * (l - r + e <= 1e-15 * l)
        angles += [1.5 * math.pi] * (l - r - e <= 1e-15 * l)
        ahead += [(angle - cylinder.phase - start) % (2 * math.pi) for angle in angles]
    if not ahead:
        return -math.inf, math.inf
    return start + max(ahead) - 2 * math.pi + _HAIR, start + min(ahead) - _HAIR
