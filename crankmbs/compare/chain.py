"""The chain of causes: a formula's idealizations, lifted one after the other up to the run."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import cached_property

from crankmbs import lecture
from crankmbs.compare.bodies import bodies_of
from crankmbs.compare.excerpt import Answer, Excerpt
from crankmbs.compare.lectured import S1
from crankmbs.errors import InputError, shown
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import did_you_mean

__all__ = ["CAUSES", "REST", "Idealized", "checked_chain"]


CAUSES = {
    "series": "the truncated series",
    "datum": "the datum",
    "constant speed": "assuming constant speed",
    "two-mass rod": "the two-mass rod",
    "gravity": "neglecting gravity",
    "friction": "neglecting friction",
    "forces": "neglecting the forces on the pistons",
    "solver": "the solver",
}
"""The causes in their default order, and how a sentence names them."""

REST = "rest"  # all causes that a chain does not name


def checked_chain(chain: Sequence[str] | None, scene: Scene) -> tuple[str, ...]:
    """The causes in the order in which they are lifted; REST last where some are not named.

    Raises
    ------
    InputError : no such cause, one that comes twice, none at all
    """
    missing = {"friction"} if scene.friction is None else set()
    missing |= set() if scene.force else {"forces"}
    applicable = tuple(name for name in CAUSES if name not in missing)
    if chain is None:
        return applicable
    if isinstance(chain, str) or not isinstance(chain, Sequence) or not chain:
        raise InputError(
            f'chain must be a list of causes, such as ["series", "solver"]; {shown(chain)} came'
        )
    for k, name in enumerate(chain):
        if name not in CAUSES:
            hint = did_you_mean(name, list(CAUSES)) if isinstance(name, str) else ""
            raise InputError(f"chain: a cause is {', '.join(CAUSES)}; {shown(name)} came{hint}")
        if name in chain[:k]:
            raise InputError(f"chain: each cause once; {shown(name)} came twice; leave one out")
    return (*chain, *([] if set(applicable) <= set(chain) else [REST]))


class Idealized:
    """The answers under idealizations, each evaluated once.

    An idealization is named like the cause that lifts it. With "series" the answer includes
    the error of the formula, without "solver" that of the run.
    """

    def __init__(self, excerpt: Excerpt) -> None:
        self.excerpt = excerpt
        self._exact: dict[frozenset[str], Answer] = {}

    @property
    def all(self) -> frozenset[str]:
        """Every idealization of what the scene has."""
        return frozenset(checked_chain(None, self.excerpt.result.scene))

    @cached_property
    def run(self) -> Answer:
        """The quantities of the run."""
        return self.excerpt.simulated()

    @cached_property
    def closed_form(self) -> Answer:
        """The exact closed form at the motion of the run."""
        return self.excerpt.newton_euler(self.excerpt.result.scene)

    def exact(self, idealized: frozenset[str]) -> Answer:
        """The closed form under these but "series", with the run's error unless "solver" is one;
        under none the run itself."""
        idealized = (idealized - {"series"}) & self.all
        if idealized not in self._exact:
            self._exact[idealized] = self._evaluate(idealized) if idealized else self.run
        return self._exact[idealized]

    def series(self, *, constant_speed: bool) -> Answer:
        """S1's formulas minus the closed form under all its idealizations, at constant speed or at
        the run's.

        Raises
        ------
        InputError : the series diverge
        """
        formula = self.excerpt.lecture(S1, constant_speed=constant_speed)
        exact = self.exact(self.all - (set() if constant_speed else {"constant speed"}))
        return {name: formula[name] - exact[name] for name in formula}

    def _evaluate(self, idealized: frozenset[str]) -> Answer:
        scene = self.excerpt.result.scene
        if "gravity" in idealized:
            scene = dataclasses.replace(scene, gravity=None)
        if "friction" in idealized:
            scene = dataclasses.replace(scene, friction=None)
        if "forces" in idealized:
            scene = dataclasses.replace(scene, force=())
        if "two-mass rod" in idealized:
            scene = scene.two_mass
        answer = self.excerpt.newton_euler(scene, constant_speed="constant speed" in idealized)
        if "gas torque" in answer:  # the same at every speed, also where the mean is 0
            answer["gas torque"] = self.closed_form["gas torque"]
        if "datum" in idealized:
            shift = lecture.datum_shift(**bodies_of(scene, self.excerpt.cylinder).lengths)
            answer["piston displacement"] = answer["piston displacement"] + shift
        if "solver" not in idealized:
            at_run = self.closed_form
            answer = {name: answer[name] + (self.run[name] - at_run[name]) for name in answer}
        return answer
