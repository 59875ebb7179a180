"""What a sweep has to do: which cases of which scene, in which blocks."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from importlib import metadata
from itertools import chain, product
from math import ceil, prod

from pydantic import TypeAdapter

from crankmbs.batch.serves import loads_of
from crankmbs.errors import CrankmbsError, InputError, shown
from crankmbs.scene.python_force import Force
from crankmbs.scene.python_load import Load
from crankmbs.scene.scene import Scene, check_scene
from crankmbs.sweep.block import Job, block_size
from crankmbs.sweep.cases import Cases, cases_of
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.fingerprint import fingerprint
from crankmbs.sweep.scenes import scene_of

__all__ = ["Box", "Plan", "check_possible", "plan_of"]

Box = tuple[slice, ...]
"""The places of a block's cases along each dimension."""

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

    @cached_property
    def boxes(self) -> list[Box]:
        """Of every block, in the order of its cases."""
        along = [
            [slice(first, min(first + chunk, length)) for first in range(0, length, chunk)]
            for chunk, length in zip(self.chunks, self.cases.shape, strict=True)
        ]
        return list(product(*along))

    def job(self, box: Box) -> Job:
        """A block as a worker takes it."""
        return Job(self.scene, self.cases.names, self.cases.values(box), self.series)

    @property
    def bytes(self) -> int:
        """What all its numbers take [B]."""
        columns = columns_of(self.scene, series=self.series).values()
        return 8 * self.cases.count * sum(prod(column.shape) for column in columns)

    @cached_property
    def identity(self) -> dict[str, str]:
        """What an unfinished sweep must have in common with this one to be resumed; what is empty,
        which nothing identifies, agrees with nothing."""
        functions = [load.function for load in self.scene.torque if isinstance(load, Load)]
        functions += [force.function for force in self.scene.force if isinstance(force, Force)]
        return {
            "version": metadata.version("crankmbs"),
            "scene": fingerprint(_SCENE.dump_python(self.scene, mode="json")),
            "functions": fingerprint(functions),
            "cases": self.cases.fingerprint,
            "keep": _KEEP[self.series],
        }


def plan_of(scene: Scene, vary: object, keep: str) -> Plan:
    """The plan of a sweep.

    Raises
    ------
    InputError : no scene, what cannot be varied, or nothing that can be kept

    >>> len(plan_of(load_scene("propeller"), {"rod.length": "0.14..0.2 m:3"}, "measures").boxes)
    1
    """
    check_scene(scene)
    if keep not in _KEEP:
        raise InputError(f'keep must be "measures" or "series"; {shown(keep)} came')
    plan = Plan(scene, cases_of(scene, vary), keep == "series")
    columns_of(scene, series=plan.series)  # whether the number of samples is known
    return plan


def check_possible(plan: Plan) -> None:
    """Refuse a sweep with scenes that cannot be built.

    Raises
    ------
    InputError : says how many and why
    """
    reasons: Counter[str] = Counter()
    first: tuple[object, ...] = ()
    for values in chain.from_iterable(plan.job(box).values for box in plan.boxes):
        try:
            scene_of(plan.scene, plan.cases.names, values)
        except CrankmbsError as error:
            first = first or values
            reasons[str(error)] += 1
    if reasons:
        reason, place = next(iter(reasons)), zip(plan.cases.names, first, strict=True)
        at = ", ".join(f"{name} = {shown(value)}" for name, value in place)
        raise InputError(
            f"{reasons.total()} of {plan.cases.count} scenes cannot be built; the first at {at}: "
            f"{reason}"
        )
