"""One run as the page shows it, with its comparison and its budget when they are asked for."""

from __future__ import annotations

import dataclasses
from functools import cached_property

from crankmbs.compare import Budget, Comparison, budget, compare
from crankmbs.errors import InputError
from crankmbs.figures.view import View, last_view
from crankmbs.result import Result
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["Outcome", "prepared", "run"]


@dataclasses.dataclass(frozen=True)
class Outcome:
    """A run that reached its end, seen from one cylinder, counted from 1."""

    result: Result
    cylinder: int

    def followed_by(self, scene: Scene, cylinder: int) -> Outcome:
        """The outcome of a scene and a cylinder, which may be this one's.

        Raises
        ------
        CrankmbsError : as for `run`
        """
        result = self.result if scene == self.result.scene else _finished(scene)
        cylinder = min(cylinder, len(scene.cylinders))
        same = result is self.result and cylinder == self.cylinder
        return self if same else Outcome(result, cylinder)

    @cached_property
    def view(self) -> View:
        """The last cycle."""
        return last_view(self.result)

    @cached_property
    def comparison(self) -> Comparison:
        """The run against the formulas."""
        return compare(self.result, self.cylinder)

    @cached_property
    def budget(self) -> Budget:
        """The error of the lecture, split into causes."""
        return budget(self.result, self.cylinder)


def prepared(scene: Scene) -> Scene:
    """The scene as the page runs it: for whole cycles, of which the last is kept.

    A run over time becomes one over as many whole cycles as it has, at least one, so that the
    crank angles shown are the same at every speed.
    """
    run = dataclasses.replace(scene.run, every=None)
    if scene.end[1]:
        angle = simulate(scene).data["crank_angle"].values
        cycles = max(1, int(abs(angle[-1] - angle[0]) / scene.period + 1e-9))
        run = dataclasses.replace(run, until=Extent(value=float(cycles), unit="cycle"))
    return dataclasses.replace(scene, run=run)


def run(scene: Scene) -> Outcome:
    """Simulate a prepared scene, seen from its first cylinder.

    Raises
    ------
    InputError : the run stops before its end; the message is its sentence
    CrankmbsError : a scene that cannot be run
    """
    return Outcome(_finished(scene), 1)


def _finished(scene: Scene) -> Result:
    result = simulate(scene)
    if result.status != 0:
        raise InputError(result.message)
    return result
