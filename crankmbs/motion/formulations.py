"""The formulations, smallest first: which scenes each serves, and how it runs one.

A new formulation is a file in this room that gives samples of the motion and its cells, and one
record here; what computes is imported when it runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from crankmbs.scene.drives import Oscillation, Ramp, SpeedFile
from crankmbs.scene.force import PistonForce
from crankmbs.scene.scene import Scene
from crankmbs.scene.torque import Torque

if TYPE_CHECKING:
    from crankmbs.mechanics.train import CrankTrain
    from crankmbs.motion.account import Account
    from crankmbs.motion.assemble import Assembled
    from crankmbs.motion.base import Samples, Solution
    from crankmbs.motion.motion import Passes
    from crankmbs.motion.multibody.free import Kept
    from crankmbs.numerics.arrays import Array

__all__ = ["FORMULATIONS", "Formulation", "serving"]

_HALVED = 1.5  # of what the last halving of multibody's steps changed: at order 1 it is the error


class Formulation(NamedTuple):
    """One way to solve a scene.

    refuses : scene -> why it cannot serve it; empty where it can
    run : crank train, rtol, cost cap [s] -> a solution, all its variables and their errors
    least_rtol : what it is content with unless more is asked for
    integrates : whether rtol changes anything
    dense : whether its steps are wider than samples, so that a run for its end alone costs less
    cost : scene -> a sentence on what a run takes, where that is much; else empty
    """

    name: str
    refuses: Callable[[Scene], str]
    run: Callable[[CrankTrain, float, float], Assembled]
    least_rtol: float = 0.0
    integrates: bool = True
    dense: bool = True
    cost: Callable[[Scene], str] = lambda _: ""


def serving(scene: Scene) -> tuple[Formulation, ...]:
    """Those that can serve a scene, smallest first.

    >>> [one.name for one in serving(load_scene("yi_diesel"))]
    ['kinetostatic', 'multibody']
    """
    return tuple(one for one in FORMULATIONS if not one.refuses(scene))


def _if_free(scene: Scene) -> str:
    return "the speed is free" if scene.motion is None else ""


def _if_prescribed(scene: Scene) -> str:
    return "the speed is prescribed" if scene.motion is not None else ""


def _if_settled_or_held(scene: Scene) -> str:
    if _may_be_held(scene):
        return "it does not follow how friction holds a crank at rest and lets it go"
    return "it follows a run and solves for no periodic motion" if scene.settles else ""


def _may_be_held(scene: Scene) -> bool:
    """Whether friction may hold a crank, for a time."""
    if scene.friction is None and not any(force.law.switches for force in scene.force):
        return False
    if scene.start is not None:
        loads: tuple[Torque | PistonForce, ...] = *scene.torque, *scene.force
        waits = any(load.has_window or not load.is_steady for load in loads)
        return waits or scene.fuel is not None or scene.start.speed == 0.0
    speed = scene.motion.speed if scene.motion else 0.0
    match speed:
        case Oscillation():
            return False
        case Ramp():
            return speed.start * speed.to <= 0.0
        case SpeedFile(file=table):
            return min(table.y) * max(table.y) <= 0.0
        case _:
            return speed == 0.0


def _kinetostatic(train: CrankTrain, _rtol: float, _cost_cap: float) -> Assembled:
    from crankmbs.motion import kinetostatic

    return _of_law(train, kinetostatic.run(train))


def _of_law(train: CrankTrain, solution: Solution) -> Assembled:
    """Samples of a prescribed motion, with all of it."""
    from crankmbs.motion import kinetostatic
    from crankmbs.motion.assemble import assemble

    keep = partial(kinetostatic.account, train)
    assembled = assemble(train, replace(solution, keep=keep))
    return replace(assembled, motion=partial(kinetostatic.passes, train))


def _free(train: CrankTrain, rtol: float, cost_cap: float, *, by_angle: bool) -> Assembled:
    from crankmbs.motion.free import settled

    return settled.run(train, rtol, cost_cap, by_angle=by_angle)


def _multibody(train: CrankTrain, rtol: float, cost_cap: float) -> Assembled:
    from crankmbs.motion import kinetostatic
    from crankmbs.motion.assemble import assemble
    from crankmbs.motion.multibody import beside, free

    if train.scene.motion is not None:
        sampled = kinetostatic.run(train)
        residual = sampled.samples.energy_residual
        return _of_law(train, _closed(beside.driven(train, sampled), residual))
    solution, kept = free.run(train, rtol, cost_cap)
    time = solution.samples.time
    residual = 0.0 * time
    if kept.motions:
        residual = kinetostatic.energy_residual(kept.motions[0].pieces, train, time)
    solution = replace(_closed(solution, residual), keep=partial(_account_of, kept))
    motion = partial(_passes_of, kept, solution.samples)
    return replace(assemble(train, solution), motion=motion)


def _closed(solution: Solution, residual: Array) -> Solution:
    """With the balance of energy of its motion [J], by the text of the others."""
    samples = replace(solution.samples, energy_residual=residual)
    rounding = 1e-14 * float(samples.computed["kinetic_energy"].max())
    errors = {**solution.errors, "energy_residual": float(abs(residual).max()) + rounding}
    return replace(solution, samples=samples, errors=errors)


def _cost_of_multibody(scene: Scene) -> str:
    from crankmbs.motion.multibody.cost import sentence

    return sentence(scene)


def _account_of(kept: Kept) -> Account:
    """What happened on the way of runs of multibody."""
    from crankmbs.motion.observer import Followed, account_of

    of = partial(Followed, kept.train, kept.start, ending=kept.ending)
    pieces = [motion.pieces for motion in kept.motions] or [()]
    return account_of([of(each) for each in pieces], _HALVED)


def _passes_of(kept: Kept, samples: Samples) -> Passes:
    """The motion of these runs."""
    from crankmbs.motion.motion import Motion, Passes

    if not kept.motions:
        alone = Motion.of_one(kept.train, samples)
        return Passes(alone, (alone,))
    trains = kept.train, kept.train.perturbed, kept.train, kept.train
    pairs = zip(trains, kept.motions, strict=False)
    answer, *checks = (Motion(one, each.pieces) for one, each in pairs)
    return Passes(answer, tuple(checks), _HALVED)


FORMULATIONS = (
    Formulation("kinetostatic", _if_free, _kinetostatic, integrates=False),
    Formulation("crank_angle", _if_prescribed, partial(_free, by_angle=True)),
    Formulation("minimal", _if_prescribed, partial(_free, by_angle=False)),
    # second order: more than 1e-5 costs minutes, and is to be asked for
    Formulation(
        "multibody",
        _if_settled_or_held,
        _multibody,
        least_rtol=1e-5,
        dense=False,
        cost=_cost_of_multibody,
    ),
)
