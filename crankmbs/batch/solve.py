"""Settled scenes solved together: those that share a machine in one go, with rules as fine as the
error asked for needs."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.machine import OWN, Machine, key_of, machine_of
from crankmbs.batch.serves import loads_of
from crankmbs.batch.tables import LINEAR, Pass
from crankmbs.compare import LECTURES, QUANTITIES
from crankmbs.design.rebalance import mean_speed_of
from crankmbs.errors import CrankmbsError
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["ROUNDING", "Group", "mean_speed_together", "settled_together"]

ROUNDING = 64 * float(np.finfo(float).eps)  # of a value
_NUDGE = 4 * float(np.finfo(float).eps)  # of the greatest energy: what a period rounds
_CLEAR = 0.05  # rad: an energy that the largest torque does not take within it is clear of rest
_OF_QUANTITIES = 2 * len(QUANTITIES) * (1 + len(LECTURES))  # columns
_KEPT = 12  # machines
_NODES = 20_000  # of cases that the cache holds beside the tables
_NONE = 1e-11  # 1 - factor: nothing but rounding


@dataclass(frozen=True)
class Group:
    """Scenes of one machine that are solved.

    which : their numbers; scene : one of them
    answer, error : shape (n, columns) as `crankmbs.batch.loops.sum_up` fills them, and by how much
        they may be off; closure, relative : shape (n,), the largest difference of the energies of
        both passes over the greatest energy; the largest error of the speed and of the peaks of
        joints, relative
    """

    which: NDArray[np.intp]
    scene: Scene
    machine: Machine
    answer: Array
    error: Array
    closure: Array
    relative: Array


def settled_together(scenes: Sequence[Scene | None]) -> Iterator[Group]:
    """Solve the scenes that can be solved so, and whose answers err no more than they ask for;
    the others are in no group. One group after the other, as tables of many machines are large.

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> [group.which.tolist() for group in settled_together([scene, None, scene])]
    [[0, 2]]
    """
    alike: dict[Hashable, list[int]] = {}
    loads = [None if scene is None else loads_of(scene) for scene in scenes]
    for number, (scene, load) in enumerate(zip(scenes, loads, strict=True)):
        if scene is not None and load is not None:
            alike.setdefault(key_of(scene), []).append(number)
    for key, numbers in alike.items():
        own = [scene for scene in (scenes[k] for k in numbers) if scene is not None]
        given = np.array([loads[k] for k in numbers], dtype=np.float64)
        asked = np.array([scene.run.rtol for scene in own])
        with suppress(CrankmbsError):  # alone the scene says what it lacks
            yield from _of_machine(np.array(numbers), _Cases(key, own, given, asked))


_BY_SCENE = ("which", "answer", "error", "closure", "relative")


def mean_speed_together(scene: Scene) -> float:
    """`crankmbs.design.rebalance.mean_speed_of`, faster where the scene can be solved so.

    >>> round(mean_speed_together(load_scene("propeller").with_(run__until="settled")), 3)
    333.805
    """
    found = next(settled_together([scene]), None)
    return scene.settled_period / float(found.answer[0, 2]) if found else mean_speed_of(scene)


@dataclass(frozen=True)
class _Alike:
    """A scene that is equal to another where their machines are."""

    key: Hashable
    scene: Scene = field(compare=False)


@lru_cache(maxsize=_KEPT)
def _machine(alike: _Alike, finest: bool) -> Machine:
    """The machine of a scene, kept from block to block."""
    return machine_of(alike.scene, finest=finest)


@dataclass(frozen=True)
class _Cases:
    """Scenes of one machine, their loads and the relative errors asked for; shape (n, 3), (n,)."""

    key: Hashable
    scenes: list[Scene]
    loads: Array
    asked: Array


def _of_machine(which: NDArray[np.intp], cases: _Cases) -> list[Group]:
    """The scenes of one machine, by the coarsest rules that do: where these err too much the first
    one shows it; those that err too much by the finest are left."""
    found: list[Group] = []
    left, finest, sure = np.arange(len(which)), False, False
    while len(left):
        machine = _machine(_Alike(cases.key, cases.scenes[0]), finest)
        if machine.folds:
            break
        tried, rest = (left, left[:0]) if sure else (left[:1], left[1:])
        group = _solved(machine, tried, cases)
        good = group.relative <= cases.asked[tried]
        found.append(_part(group, good))
        coarse = tried[group.relative > cases.asked[tried]]  # not where there is no number
        sure, left = bool(good.any()), np.append(coarse, rest)
        if len(coarse):
            if machine.finest:
                left = rest
            finest, sure = True, False
    machines = {id(group.machine): group.machine for group in found}.values()
    every = [_merged([group for group in found if group.machine is one]) for one in machines]
    return [replace(group, which=which[group.which]) for group in every if len(group.which)]


def _part(group: Group, kept: NDArray[np.bool_]) -> Group:
    """Some of the scenes of a group."""
    return replace(group, **{name: getattr(group, name)[kept] for name in _BY_SCENE})


def _merged(groups: list[Group]) -> Group:
    """Groups of one machine as one."""
    every: dict[str, Any] = {
        name: np.concatenate([getattr(group, name) for group in groups]) for name in _BY_SCENE
    }
    return replace(groups[0], **every)


def _solved(machine: Machine, which: NDArray[np.intp], cases: _Cases) -> Group:
    """Both passes over some scenes; relative is no number where there is no periodic motion, or it
    is not sure that the run comes to it."""
    scenes = [cases.scenes[k] for k in which]
    starts = np.array([scene.start.speed for scene in scenes if scene.start is not None])
    inertias = np.array([scene.crank.moment_of_inertia for scene in scenes])
    given = inertias, cases.loads[which], starts
    (answer, ends), (check, other) = (
        _passed(machine, one, given, nudge)
        for one, nudge in ((machine.answer, 0.0), (machine.check, _NUDGE))
    )
    error = np.abs(answer - check) + ROUNDING * np.abs(answer)
    joints = OWN + 4 * machine.joints
    error[:, 5:7] += answer[:, 9:11]
    error[:, OWN:joints:4] += answer[:, OWN + 3 : joints : 4]
    error[:, joints::2] += answer[:, joints + 1 :: 2]
    begin, growth, _, most, least = answer.T[:5]
    torque = float(np.max(np.abs(machine.answer.of_angle[3]))) + np.abs(given[1][:, 0])
    clear = _CLEAR * torque
    first = machine.answer.of_angle[1]
    started = 0.5 * (inertias + float(first[0, 0])) * starts**2
    reached = np.minimum(started - begin, 0.0) + least > clear
    sure = (growth < -_NONE) & (least > clear) & reached
    shown = [2, 5, 6, *range(OWN, joints, 4)]
    with np.errstate(invalid="ignore"):  # where there is no periodic motion
        closure = np.max(np.abs(ends - other), axis=1) / most + ROUNDING
        apart = error[:, shown] / np.abs(answer[:, shown])
    relative = np.where(sure, np.max(np.nan_to_num(apart), axis=1), np.nan)
    return Group(which, scenes[0], machine, answer, error, closure, relative)


def _passed(
    machine: Machine, tables: Pass, given: tuple[Array, Array, Array], nudge: float
) -> tuple[Array, Array]:
    """Columns and energies of a pass over cases, so many at once as the cache holds."""
    from crankmbs.batch.loops import LANES, sum_up  # numba is loaded only when it is used

    inertias, loads, starts = given
    columns = np.empty((len(starts), OWN + 4 * machine.joints + _OF_QUANTITIES))
    ends = np.empty((len(starts), len(tables.of_angle[0])))
    about = machine.sense, list(QUANTITIES).index(LINEAR), OWN
    together = LANES * max(1, _NODES // (LANES * tables.of_angle[1].size))
    for k in range(0, len(starts), together):
        some = slice(k, k + together)
        off = np.full_like(starts[some], nudge)
        cases = inertias[some], loads[some], starts[some], off
        sum_up(about, *tables[:3], cases, (columns[some], ends[some]))
    return columns, ends
