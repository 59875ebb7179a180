"""Which formulation a scene needs: the smallest that is exact, and why. Pure; runs nothing."""

from __future__ import annotations

from typing import NamedTuple

from crankmbs.errors import FormulationError
from crankmbs.motion import formulations
from crankmbs.scene.scene import Scene
from crankmbs.scene.sentences import did_you_mean

__all__ = ["Choice", "choose", "chosen"]


class Choice(NamedTuple):
    """The formulation, and the sentences that say why."""

    formulation: str
    reasons: tuple[str, ...]


def choose(scene: Scene, formulation: str = "auto") -> Choice:
    """Choose the formulation of a scene, or check the one asked for.

    Raises
    ------
    FormulationError : the one asked for cannot serve the scene; says which can

    >>> choose(load_scene("propeller")).formulation
    'crank_angle'
    """
    serves = [one.name for one in formulations.serving(scene)]
    if formulation == "auto":
        return Choice(serves[0], _reasons(scene))
    if formulation not in serves:
        refusals = {one.name: one.refuses(scene) for one in formulations.FORMULATIONS}
        raise FormulationError(
            f"formulation {formulation!r} cannot serve this scene: "
            f"{refusals.get(formulation, 'no such formulation')}; "
            f"choose auto, {', '.join(serves[:-1])} or {serves[-1]}"
            f"{did_you_mean(formulation, serves)}"
        )
    cost = _named(formulation).cost(scene)
    asked = f"asked for; auto would choose {serves[0]}"
    return Choice(formulation, (asked, cost) if cost else (asked,))


def chosen(choice: Choice) -> formulations.Formulation:
    """The formulation of a choice."""
    return _named(choice.formulation)


def _named(name: str) -> formulations.Formulation:
    return next(one for one in formulations.FORMULATIONS if one.name == name)


def _reasons(scene: Scene) -> tuple[str, ...]:
    if scene.motion is not None:
        return (
            "the speed is prescribed, so nothing has to be integrated: algebra gives every joint "
            "force and the torque that the drive must give",
        )
    n = len(scene.cylinders)
    parts = "crank, rod and piston are" if n == 1 else f"crank, {n} rods and {n} pistons are"
    reasons = [
        f"{parts} rigid and closed in loops, so one free rotation describes them exactly; with "
        "the crank angle as the variable no step crosses a knot of the pressure table"
        if scene.gas is not None
        else f"{parts} rigid and closed in loops, so one free rotation describes them exactly"
    ]
    if scene.start is not None and scene.start.speed == 0.0:
        reasons.append("it starts from rest: the first part is integrated over time, by minimal")
    return tuple(reasons)
