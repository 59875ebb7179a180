"""What of a scene the browser cannot run, each with its reason and the command that can."""

from __future__ import annotations

from collections.abc import Iterator

from crankmbs.mechanics.speed import speed_law
from crankmbs.motion.plan import plan_of
from crankmbs.scene.scene import Scene

__all__ = ["refusals"]


def refusals(scene: Scene) -> tuple[str, ...]:
    """Why the browser cannot run a scene, one sentence each; none where it can.

    What shows only on the way, a crank that comes to rest, the page says then.

    >>> refusals(load_scene("propeller"))
    ()
    >>> refusals(load_scene("torque_driven"))[0].partition(";")[0]
    'rest: the crank starts from rest, where time must be the variable'
    """
    return tuple(f"{reason}; run it with crankmbs run" for reason in _reasons(scene))


def _reasons(scene: Scene) -> Iterator[str]:
    if scene.run.formulation == "multibody":
        yield "multibody: asked for by name, and the page solves one rotation"
    if any(load.parts.function is not None for load in scene.torque):
        yield "function: a load is a function of Python"
    yield from _of_fuel(scene)
    if any(abs(fold) < float("inf") for fold in plan_of(scene).folds):
        yield "fold: the rod folds onto the crank, where the motion is not determined"
    if scene.start is not None and scene.start.speed == 0.0:
        yield "rest: the crank starts from rest, where time must be the variable"
    if scene.motion is not None and _turns_back(scene):
        yield "reversal: the prescribed speed comes to rest or turns back"


def _of_fuel(scene: Scene) -> Iterator[str]:
    if scene.fuel is None:
        return
    if scene.settles:
        yield "settled fuel: the page settles what burns alike in every cycle"
    if scene.fuel.governor is not None:
        yield "governor: it decides each share of the fuel anew"
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
