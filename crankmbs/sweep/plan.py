"""What a sweep has to do: which cases of which scene, in which blocks."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from importlib import metadata
from itertools import chain
from math import ceil, prod

import numpy as np
from pydantic import TypeAdapter

from crankmbs.batch.serves import loads_of
from crankmbs.errors import CrankmbsError, InputError, shown
from crankmbs.scene.python_force import Force
from crankmbs.scene.python_load import Load
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.block import Job, block_size
from crankmbs.sweep.cases import Cases, cases_of
from crankmbs.sweep.columns import columns_of, dims_of
from crankmbs.sweep.fingerprint import fingerprint
from crankmbs.sweep.scenes import scene_of

__all__ = ["Plan", "check_possible", "plan_of"]

_KEEP = ("measures", "series")
_SCENE = TypeAdapter(Scene)


@dataclass(frozen=True)
class Plan:
    """Cases of a scene; series : whether the samples of each are kept."""

    scene: Scene
    cases: Cases
    series: bool

    @cached_property
    def chunks(self) -> tuple[int, ...]:
        """Cases in a block along each dimension: they follow one another, the last the fastest."""
        together = not self.series and loads_of(self.scene) is not None
        size = block_size(self.cases.count, series=self.series, together=together)
        shape: list[int] = []
        for length in reversed(self.cases.shape):
            shape.insert(0, ceil(length / ceil(length / size)))
            size = max(size // length, 1)
        return tuple(shape)

    @property
    def blocks(self) -> int:
        """How many blocks there are."""
        return prod(self._grid)

    def region(self, number: int) -> tuple[slice, ...]:
        """Where the cases of a block lie; blocks are counted from 0."""
        places = zip(
            np.unravel_index(number, self._grid), self.chunks, self.cases.shape, strict=True
        )
        return tuple(slice(int(k) * n, min((int(k) + 1) * n, most)) for k, n, most in places)

    def rows(self, number: int) -> range:
        """The cases of a block, all of them counted from 0."""
        region = self.region(number)
        first = int(np.ravel_multi_index([places.start for places in region], self.cases.shape))
        return range(first, first + prod(places.stop - places.start for places in region))

    @property
    def _grid(self) -> tuple[int, ...]:
        """Blocks along each dimension."""
        return tuple(ceil(n / k) for n, k in zip(self.cases.shape, self.chunks, strict=True))

    def job(self, number: int) -> Job:
        """A block as a worker takes it."""
        return Job(self.scene, self.cases.names, self.cases.values(self.rows(number)), self.series)

    @property
    def bytes(self) -> int:
        """What all its numbers take [B]."""
        sizes = {dim: len(at) for dim, at in dims_of(self.scene, series=self.series).items()}
        columns = columns_of(self.scene, series=self.series).values()
        return 8 * self.cases.count * sum(prod(sizes[d] for d in column.dims) for column in columns)

    @cached_property
    def identity(self) -> dict[str, str]:
        """What an unfinished sweep must have in common with this one to be resumed; what is empty,
        which nothing identifies, agrees with nothing."""
        functions = [load.function for load in self.scene.torque if isinstance(load, Load)]
        functions += [force.function for force in self.scene.force if isinstance(force, Force)]
        scene = json.dumps(_SCENE.dump_python(self.scene, mode="json"), sort_keys=True)
        return {
            "version": metadata.version("crankmbs"),
            "scene": hashlib.sha256(scene.encode()).hexdigest(),
            "functions": fingerprint(functions),
            "cases": self.cases.fingerprint,
            "keep": _KEEP[self.series],
        }


def plan_of(scene: Scene, vary: object, keep: str) -> Plan:
    """The plan of a sweep.

    Raises
    ------
    InputError : no scene, what cannot be varied, or nothing that can be kept

    >>> plan_of(load_scene("propeller"), {"rod.length": "0.14..0.2 m:3"}, "measures").blocks
    1
    """
    check_scene(scene)
    if keep not in _KEEP:
        raise InputError(f'keep must be "measures" or "series"; {shown(keep)} came')
    plan = Plan(scene, cases_of(scene, vary), keep == "series")
    dims_of(scene, series=plan.series)  # whether the number of samples is known
    return plan


def check_possible(plan: Plan) -> None:
    """Refuse a sweep with scenes that cannot be built.

    Raises
    ------
    InputError : says how many and why
    """
    reasons: Counter[str] = Counter()
    first: tuple[object, ...] = ()
    every = chain.from_iterable(plan.job(number).values for number in range(plan.blocks))
    for values in every:
        try:
            scene_of(plan.scene, plan.cases.names, values)
        except CrankmbsError as error:
            first = values if not reasons else first
            reasons[str(error)] += 1
    if reasons:
        reason, place = next(iter(reasons)), zip(plan.cases.names, first, strict=True)
        at = ", ".join(f"{name} = {shown(value)}" for name, value in place)
        raise InputError(
            f"{reasons.total()} of {plan.cases.count} scenes cannot be built; the first at {at}: "
            f"{reason}"
        )
