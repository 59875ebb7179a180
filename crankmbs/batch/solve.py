"""Scenes solved together, those that share a machine at once, with rules as fine as the error
asked for needs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from crankmbs.batch.machine import Machine, family_of, forces_of, key_of, machine_of
from crankmbs.batch.measures import Numbers, measure
from crankmbs.batch.passes import cases_of, passes_of
from crankmbs.batch.serves import loads_of
from crankmbs.design.rebalance import mean_speed_of
from crankmbs.errors import CrankmbsError
from crankmbs.numerics.arrays import Index
from crankmbs.scene.scene import Scene

__all__ = ["Group", "mean_speed_together", "solved_together"]

_KEPT = 12  # machines
_FEW = 4  # cases: a machine of no more is solved together with others
_MANY = 1_000_000  # forces at nodes at once: 8 MB, and several times as much beside them


class Group(NamedTuple):
    """Scenes that are solved together, of one machine or each of its own: their numbers, shape
    (n,), and what `crankmbs.batch.measures.measure` has of them."""

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
    served = {k: each for k, each in enumerate(scenes) if each is not None and loads_of(each)}
    alike, families = defaultdict[Hashable, list[int]](list), defaultdict[Hashable, list[int]](list)
    for number, scene in served.items():
        alike[key_of(scene)].append(number)
    for key, numbers in alike.items():
        with suppress(CrankmbsError):  # alone the scene says what it lacks
            family = family_of(served[numbers[0]])
            if family is not None:
                families[family if len(numbers) <= _FEW else key] += numbers
    for numbers in families.values():
        one = len({key_of(served[number]) for number in numbers}) == 1
        most = _MANY if one else _MANY // 2  # tables take as much
        many = max(1, most // forces_of(served[numbers[0]]))
        for first in range(0, len(numbers), many):
            which = numbers[first : first + many]
            with suppress(CrankmbsError):
                yield from _of_machine([served[number] for number in which], np.array(which), one)


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


def _of_machine(scenes: Sequence[Scene], which: Index, one: bool) -> Iterator[Group]:
    """The scenes of one machine, or of as many machines, by the coarsest rules that do; those that
    err too much by the finest, or have no motion, are left."""
    left = np.arange(len(which))
    for finest in (False, True):
        some = [scenes[k] for k in left.tolist()]
        if one:
            machine = _machine(_Alike(key_of(scenes[0]), scenes[0]), finest)
        else:
            machine = machine_of(*some, finest=finest)
        cases = cases_of(some)
        with np.errstate(all="ignore"):  # where there is no motion there are no numbers
            *passes, sure = passes_of(machine, cases)
            numbers, errors = measure(machine, cases, passes)
        good = sure & (numbers["relative"] <= cases.rtol)
        if good.any():
            chosen = ({name: of[name][good] for name in of} for of in (numbers, errors))
            yield Group(machine, which[left[good]], *chosen)
        left = left[sure & ~good]
        if machine.finest or len(left) == 0:
            return
