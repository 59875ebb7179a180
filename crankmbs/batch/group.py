"""Scenes of one machine that are solved together, and what comes of them."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.lanes import LANES
from crankmbs.batch.machine import OWN, Machine
from crankmbs.compare import LECTURES, QUANTITIES
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["NUDGE", "ROUNDING", "Cases", "Group", "clear", "group_of", "merged", "room", "together"]

ROUNDING = 64 * float(np.finfo(float).eps)
"""Of a value."""

NUDGE = 4 * float(np.finfo(float).eps)
"""What a period rounds, of the greatest energy."""

_CLEAR = 0.05  # rad: an energy that the largest torque does not take within it is clear of rest
_OF_QUANTITIES = 2 * len(QUANTITIES) * (1 + len(LECTURES))  # columns
_NODES = 20_000  # of cases that the cache holds beside the tables


@dataclass(frozen=True)
class Cases:
    """Scenes of one machine, their loads and the relative errors asked for; shape (n, 3), (n,)."""

    key: Hashable
    scenes: list[Scene]
    loads: Array
    asked: Array

    def part(self, which: NDArray[np.intp]) -> Cases:
        """Some of them."""
        scenes = [self.scenes[k] for k in which]
        return Cases(self.key, scenes, self.loads[which], self.asked[which])

    @property
    def starts(self) -> Array:
        """Speeds at the start [rad/s], shape (n,)."""
        return np.array([one.start.speed for one in self.scenes if one.start is not None])

    @property
    def inertias(self) -> Array:
        """Of the crank [kg m2], shape (n,)."""
        return np.array([one.crank.moment_of_inertia for one in self.scenes])


@dataclass(frozen=True)
class Group:
    """Scenes of one machine that are solved.

    which : their numbers; scene : one of them; begin : shape (n,) [rad], the crank angle at which
        the period begins that is summed up
    answer, error : shape (n, columns) as `crankmbs.batch.walk.walk` fills them, the first two as
        the motion has them, and by how much they may be off; closure, relative : shape (n,), the
        largest difference of the energies of both passes over the greatest energy; the largest
        error of the speed and of the peaks of joints, relative, no number where it is not sure that
        the motion is the one asked for
    """

    which: NDArray[np.intp]
    scene: Scene
    machine: Machine
    begin: Array
    answer: Array
    error: Array
    closure: Array
    relative: Array

    def part(self, kept: NDArray[np.bool_]) -> Group:
        """Some of the scenes."""
        return replace(self, **{name: getattr(self, name)[kept] for name in _BY_SCENE})


_BY_SCENE = ("which", "begin", "answer", "error", "closure", "relative")


def merged(groups: list[Group]) -> Group:
    """Groups of one machine as one."""
    every: dict[str, Any] = {
        name: np.concatenate([getattr(group, name) for group in groups]) for name in _BY_SCENE
    }
    return replace(groups[0], **every)


def group_of(
    machine: Machine,
    cases: Cases,
    which: NDArray[np.intp],
    begin: Array,
    sure: NDArray[np.bool_],
    passes: tuple[tuple[Array, Array], tuple[Array, Array]],
) -> Group:
    """What two passes found for some of the cases: columns, and energies at the ends of cells;
    begin, sure : shape (n,), as `Group` has it, and whether the motion is the one asked for."""
    (answer, ends), (check, other) = passes
    error = np.abs(answer - check) + ROUNDING * np.abs(answer)
    joints = OWN + 4 * machine.joints
    error[:, 5:7] += answer[:, 9:11]
    error[:, OWN:joints:4] += answer[:, OWN + 3 : joints : 4]
    error[:, joints::2] += answer[:, joints + 1 :: 2]
    shown = [2, 5, 6, *range(OWN, joints, 4)]
    with np.errstate(invalid="ignore"):  # where there is no motion
        closure = np.max(np.abs(ends - other), axis=1) / answer[:, 3] + ROUNDING
        apart = error[:, shown] / np.abs(answer[:, shown])
    relative = np.where(sure, np.max(np.nan_to_num(apart), axis=1), np.nan)
    return Group(which, cases.scenes[0], machine, begin, answer, error, closure, relative)


def clear(machine: Machine, loads: Array) -> Array:
    """An energy [J] that is clear of rest, shape (n,), where parts of the loads, shape (n, any),
    are no larger [N m]."""
    torque = float(np.max(np.abs(machine.answer.of_angle[3])))
    return np.asarray(_CLEAR * (torque + np.sum(np.abs(loads), axis=1)))


def room(machine: Machine, count: int) -> tuple[Array, Array]:
    """For the columns of so many cases, and for where their peaks are, as
    `crankmbs.batch.walk.walk` fills them."""
    columns = np.empty((count, OWN + 4 * machine.joints + _OF_QUANTITIES))
    return columns, np.full((count, 2 + machine.joints + _OF_QUANTITIES // 2, 2), np.nan)


def together(count: int, nodes: int) -> list[slice]:
    """So many cases in parts of which the cache holds what they have at so many nodes."""
    many = LANES * max(1, _NODES // (LANES * nodes))
    return [slice(k, k + many) for k in range(0, count, many)]
