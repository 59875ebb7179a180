"""Scenes solved together: those that share a machine in one go, with rules as fine as the error
asked for needs."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch import runs, settled
from crankmbs.batch.group import Cases, Group, merged
from crankmbs.batch.machine import Machine, key_of, machine_of
from crankmbs.batch.serves import loads_of
from crankmbs.design.rebalance import mean_speed_of
from crankmbs.errors import CrankmbsError
from crankmbs.scene.scene import Scene

__all__ = ["mean_speed_together", "solved_together"]

_KEPT = 12  # machines


def solved_together(scenes: Sequence[Scene | None]) -> Iterator[Group]:
    """Solve the scenes that can be solved so, and whose answers err no more than they ask for;
    the others are in no group. One group after the other, as tables of many machines are large.

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> [group.which.tolist() for group in solved_together([scene, None, scene])]
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
            yield from _of_machine(np.array(numbers), Cases(key, own, given, asked))


def mean_speed_together(scene: Scene) -> float:
    """`crankmbs.design.rebalance.mean_speed_of`, faster where the scene can be solved so.

    >>> round(mean_speed_together(load_scene("propeller").with_(run__until="settled")), 3)
    333.805
    """
    found = next(solved_together([scene]), None)
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


def _of_machine(which: NDArray[np.intp], cases: Cases) -> list[Group]:
    """The scenes of one machine, by the coarsest rules that do: where these err too much the first
    one shows it; those that err too much by the finest are left."""
    found: list[Group] = []
    left, finest, sure = np.arange(len(which)), False, False
    while len(left):
        machine = _machine(_Alike(cases.key, cases.scenes[0]), finest)
        if machine.folds:
            break
        tried, rest = (left, left[:0]) if sure else (left[:1], left[1:])
        solved = settled.solved if cases.scenes[0].settles else runs.solved
        group = solved(machine, tried, cases.part(tried))
        good = group.relative <= cases.asked[tried]
        found.append(group.part(good))
        coarse = tried[group.relative > cases.asked[tried]]  # not where there is no number
        sure, left = bool(good.any()), np.append(coarse, rest)
        if len(coarse):
            if machine.finest:
                left = rest
            finest, sure = True, False
    machines = {id(group.machine): group.machine for group in found}.values()
    every = [merged([group for group in found if group.machine is one]) for one in machines]
    return [replace(group, which=which[group.which]) for group in every if len(group.which)]
