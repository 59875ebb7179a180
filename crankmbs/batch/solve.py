"""Scenes solved together: those that share a machine in one go, with rules as fine as the error
asked for needs."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from crankmbs.batch.machine import Machine, key_of, machine_of
from crankmbs.batch.measures import Numbers, measure
from crankmbs.batch.motion import Cases, part_of
from crankmbs.batch.passes import cases_of, pairs_of
from crankmbs.batch.serves import loads_of
from crankmbs.design.rebalance import mean_speed_of
from crankmbs.errors import CrankmbsError
from crankmbs.numerics.arrays import Index
from crankmbs.scene.scene import Scene

__all__ = ["Group", "mean_speed_together", "solved_together"]

_KEPT = 12  # machines
_MANY = 500_000  # forces at nodes at once: 4 MB, and several times as much beside them


class Group(NamedTuple):
    """Scenes of one machine that are solved together: their numbers, shape (n,), and what
    `crankmbs.batch.measures.measure` has of them."""

    machine: Machine
    which: Index
    numbers: Numbers
    errors: Numbers


def solved_together(scenes: Sequence[Scene | None]) -> Iterator[Group]:
    """Solve the scenes that can be solved so, and whose answers err no more than they ask for;
    the others are in no group. One group after the other, as tables of many machines are large.

    >>> scene = load_scene("propeller").with_(run__until="settled")
    >>> [group.which.tolist() for group in solved_together([scene, None, scene])]
    [[0, 2]]
    """
    alike: dict[_Alike, list[int]] = {}
    for number, scene in enumerate(scenes):
        if scene is not None and loads_of(scene) is not None:
            alike.setdefault(_Alike(key_of(scene), scene), []).append(number)
    for of, numbers in alike.items():
        of_machine = [scene for scene in (scenes[k] for k in numbers) if scene is not None]
        with suppress(CrankmbsError):  # alone the scene says what it lacks
            yield from _of_machine(of, np.array(numbers), cases_of(of_machine))


def mean_speed_together(scene: Scene) -> float:
    """`crankmbs.design.rebalance.mean_speed_of`, faster where the scene can be solved so.

    >>> round(mean_speed_together(load_scene("propeller").with_(run__until="settled")), 3)
    333.805
    """
    group = next(solved_together([scene]), None)
    if group is None:
        return mean_speed_of(scene)
    return scene.settled_period / float(group.numbers["duration"][0])


@dataclass(frozen=True)
class _Alike:
    """A scene that is equal to another where their machines are."""

    key: Hashable
    scene: Scene = field(compare=False)


@lru_cache(maxsize=_KEPT)
def _machine(alike: _Alike, finest: bool) -> Machine:
    """The machine of a scene, kept from block to block."""
    return machine_of(alike.scene, finest=finest)


def _of_machine(alike: _Alike, which: Index, cases: Cases) -> Iterator[Group]:
    """The scenes of one machine, by the coarsest rules that do; those that err too much by the
    finest are left."""
    left = np.arange(len(which))
    for finest in (False, True):
        machine = _machine(alike, finest)
        parts = [] if machine.folds else list(_parts(machine, left, cases))
        if not parts:
            return
        left = np.concatenate([part.which for part in parts])
        numbers = _joined([part.numbers for part in parts])
        errors = _joined([part.errors for part in parts])
        good = numbers["relative"] <= cases.rtol[left]
        if good.any():
            chosen = ({name: of[name][good] for name in of} for of in (numbers, errors))
            yield Group(machine, which[left[good]], *chosen)
        left = left[~good]
        if machine.finest or len(left) == 0:
            return


def _joined(parts: list[Numbers]) -> Numbers:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _parts(machine: Machine, which: Index, cases: Cases) -> Iterator[Group]:
    """Those of some cases that have a motion, some after the others."""
    many = max(1, _MANY // machine.answer.forces[:, :, 0].size)
    for first in range(0, len(which), many):
        some = which[first : first + many]
        pairs = pairs_of(machine, some, part_of(cases, some))
        if len(pairs.which):
            yield Group(machine, pairs.which, *measure(machine, pairs))
