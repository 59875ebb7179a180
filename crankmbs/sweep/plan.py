"""What a sweep has to do: which cases of which scene, in which blocks."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from importlib import metadata
from itertools import chain
from math import prod

from pydantic import TypeAdapter

from crankmbs.batch.serves import loads_of
from crankmbs.errors import CrankmbsError, InputError, shown
from crankmbs.scene.python_load import Load
from crankmbs.scene.scene import Scene
from crankmbs.sweep.block import Job, block_size
from crankmbs.sweep.cases import Cases, cases_of
from crankmbs.sweep.columns import columns_of, dims_of
from crankmbs.sweep.scenes import scene_of
from crankmbs.sweep.told import NotTold, digest_of

__all__ = ["Plan", "check_possible", "plan_of"]

_KEPT = ("measures", "series")
_SCENE = TypeAdapter(Scene)


@dataclass(frozen=True)
class Plan:
    """Cases of a scene; series : whether the samples of each are kept."""

    scene: Scene
    cases: Cases
    series: bool

    @cached_property
    def size(self) -> int:
        """Cases in a block."""
        return block_size(self.cases.count, series=self.series, together=self._together)

    @property
    def _together(self) -> bool:
        """Whether cases that share a machine are solved together."""
        return not self.series and loads_of(self.scene) is not None

    @property
    def blocks(self) -> int:
        """How many blocks there are."""
        return -(-self.cases.count // self.size)

    def rows(self, number: int) -> range:
        """The cases of a block, which is counted from 0."""
        return range(number * self.size, min((number + 1) * self.size, self.cases.count))

    def job(self, number: int) -> Job:
        """A block as a worker takes it."""
        return Job(self.scene, self.cases.names, self.cases.values(self.rows(number)), self.series)

    @property
    def bytes(self) -> int:
        """What all its numbers take [B]."""
        sizes = {dim: len(at) for dim, at in dims_of(self.scene, series=self.series).items()}
        columns = columns_of(self.scene, series=self.series).values()
        return 8 * self.cases.count * sum(prod(sizes[d] for d in one.dims) for one in columns)

    @cached_property
    def identity(self) -> dict[str, str]:
        """What two sweeps that are one agree in; what is empty agrees with nothing."""
        scene = json.dumps(_SCENE.dump_python(self.scene, mode="json"), sort_keys=True)
        return {
            "version": metadata.version("crankmbs"),
            "scene": hashlib.sha256(scene.encode()).hexdigest(),
            "functions": self._functions,
            "cases": self.cases.digest,
            "keep": _KEPT[self.series],
        }

    @property
    def _functions(self) -> str:
        """What tells the functions of the loads, which a file has by name only, from others; empty
        where nothing does."""
        try:
            return digest_of([one.function for one in self.scene.torque if isinstance(one, Load)])
        except NotTold:
            return ""


def plan_of(scene: Scene, vary: object, keep: str) -> Plan:
    """The plan of a sweep.

    Raises
    ------
    InputError : no scene, what cannot be varied, or nothing that can be kept

    >>> plan_of(load_scene("propeller"), {"rod.length": "0.14..0.2 m:3"}, "measures").blocks
    1
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a Scene, such as load_scene reads; {shown(scene)} came")
    if keep not in _KEPT:
        raise InputError(f'keep must be "measures" or "series"; {shown(keep)} came')
    plan = Plan(scene, cases_of(scene, vary), keep == "series")
    dims_of(scene, series=plan.series)  # whether the number of samples is known
    return plan


def check_possible(plan: Plan) -> None:
    """Refuse a sweep with scenes that cannot be.

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
        (said, _), where = next(iter(reasons.items())), zip(plan.cases.names, first, strict=True)
        at = ", ".join(f"{name} = {shown(value)}" for name, value in where)
        raise InputError(
            f"{reasons.total()} of {plan.cases.count} scenes cannot be; the first at {at}: {said}"
        )
