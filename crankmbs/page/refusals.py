"""Why the browser cannot run a scene with its knobs, so that the page replays the run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from crankmbs.errors import InputError
from crankmbs.mechanics.speed import speed_law
from crankmbs.motion.plan import plan_of
from crankmbs.scene.run import SETTLED
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["early_end", "refusals", "settling"]


def refusals(scene: Scene) -> tuple[str, ...]:
    """Why the browser cannot run a scene, one sentence each; none where it can.

    What shows only on the way, a crank that comes to rest, `early_end` says, and of turned knobs
    the page.

    >>> refusals(load_scene("propeller"))
    ()
    >>> refusals(load_scene("torque_driven"))[0]
    'rest: the crank starts from rest, where time must be the variable'
    """
    return tuple(_reasons(scene))


def early_end(scene: Scene) -> tuple[str, ...]:
    """Why a run that does not settle ends before its last cycle, which the page shows of it.

    >>> early_end(load_scene("run_down"))[0].partition(": friction")[0]
    'end: the run ends before its time, at rest at 4407.1 degrees'
    """
    if scene.start is None or settling(scene) is not None:
        return ()
    result = simulate(replace(scene, run=replace(scene.run, every=None)))
    return (f"end: the run ends before its time, {result.message}",) if result.status else ()


def settling(scene: Scene) -> Scene | None:
    """The scene until it has settled, as the page shows it where it can; else None.

    >>> settling(load_scene("propeller")).settles
    True
    >>> settling(load_scene("misfire")) is None
    True
    """
    try:
        settled = replace(scene, run=replace(scene.run, until=SETTLED))
    except InputError:
        return None
    return None if any(_reasons(settled)) else settled


def _reasons(scene: Scene) -> Iterator[str]:
    if scene.run.formulation == "multibody":
        yield "multibody: the scene asks for the multibody model, and the page solves one rotation"
    if any(load.parts.function is not None for load in scene.torque):
        yield "function: a load is a function of Python"
    yield from _of_forces(scene)
    yield from _of_fuel(scene)
    if any(abs(fold) < float("inf") for fold in plan_of(scene).folds):
        yield "fold: the rod folds onto the crank, where the motion is not determined"
    if scene.start is not None and scene.start.speed == 0.0:
        yield "rest: the crank starts from rest, where time must be the variable"
    if scene.motion is not None and _turns_back(scene):
        yield "reversal: the prescribed speed comes to rest or turns back"


def _of_forces(scene: Scene) -> Iterator[str]:
    for force in scene.force:
        if force.law.python is not None:
            yield "function: a force on a piston is a function of Python"
        elif not force.is_steady:
            yield "force: a force on the pistons changes with time or has a window"


def _of_fuel(scene: Scene) -> Iterator[str]:
    if scene.fuel is None:
        return
    if scene.settles:
        yield "settled fuel: the page settles what burns alike in every cycle"
    if scene.fuel.governor is not None:
        yield "governor: the governor decides each share of the fuel anew"
    if scene.fuel.scatter > 0.0:
        yield "random firing: scatter draws each share of the fuel from Python's random numbers"


def _turns_back(scene: Scene) -> bool:
    """Whether the prescribed speed is zero anywhere in the run."""
    assert scene.motion is not None
    law, (until, in_time) = speed_law(scene.motion), scene.end
    _, speed, _ = law.at_time(0.0)
    if float(speed) == 0.0:
        return True
    turn = law.turning_times[0]
    if turn == float("inf"):
        return False
    theta, speed, _ = law.at_time(turn)
    reached = turn >= until if in_time else abs(float(theta) - scene.motion.angle) >= until
    return not reached
