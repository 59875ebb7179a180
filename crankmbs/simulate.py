"""The one verb: choose, run, refine until the asked error is met, and label the result."""

from __future__ import annotations

import dataclasses
import math
import time as clock

import numpy as np

from crankmbs.choose import choose, chosen
from crankmbs.errors import InputError
from crankmbs.mechanics.pressure import remarks
from crankmbs.mechanics.speed import speed_remarks
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.windows import place_of
from crankmbs.motion.assemble import labelled
from crankmbs.motion.ending import Ending
from crankmbs.numerics.function import Function
from crankmbs.result import Cost, Error, Result
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene, check_scene

__all__ = ["functions_of", "simulate", "why"]

_MOST_CYCLES = 10_000, 100  # of a run that is followed to its stop, and that calls functions
_NO_STOP = Ending.FADES, Ending.HUNTS, Ending.SWINGS  # its speed falls, but the crank goes on


def simulate(
    scene: Scene,
    *,
    formulation: str | None = None,
    rtol: float | None = None,
    cost_cap: float = 10.0,
) -> Result:
    """Run a scene and state the error of every variable.

    Parameters
    ----------
    formulation : None takes the scene's; "auto" the smallest exact one
    rtol : relative global error asked for, 1e-13 to 1e-2; None takes the scene's, for
        "multibody" at least 1e-5
    cost_cap [s] : each second stands for 20,000 steps of one cylinder that "multibody" takes, and
        for 50,000 evaluations after which a motion followed over time is given up

    Returns
    -------
    Result : status 0, 1 or -1 with a sentence; bad input raises

    Raises
    ------
    FormulationError : the formulation cannot serve the scene
    InputError : no scene, rtol or cost_cap out of range, a table that ends before the run

    >>> print(simulate(load_scene("torque_driven")).status)
    0
    """
    check_scene(scene)
    if rtol is not None and not 1e-13 <= rtol <= 1e-2:
        raise InputError(f"rtol must be from 1e-13 to 1e-2; {rtol!r} came")
    if not cost_cap > 0.0:
        raise InputError(f"cost_cap must be a time above 0 s; {cost_cap!r} came")
    functions = functions_of(scene)
    begin = clock.perf_counter()
    choice = choose(scene, formulation or scene.run.formulation)
    solver = chosen(choice)
    tolerance = max(scene.run.rtol, solver.least_rtol) if rtol is None else rtol
    assembled = solver.run(crank_train(scene), tolerance, cost_cap)
    solution = assembled.solution
    result = Result.unlabelled(
        labelled(assembled),
        scene=scene,
        formulation=choice.formulation,
        reasons=choice.reasons + remarks(scene) + speed_remarks(scene) + solution.reasons,
        status=solution.status,
        message=why(solution.status, solution.message, functions),
        cost=Cost(clock.perf_counter() - begin, solution.evaluations, solution.steps),
        error=Error(tolerance, assembled.relative_error),
        decay=solution.decay,
        keep=solution.keep,
        motion=assembled.motion,
    )
    if scene.settles and result.status == 1 and solution.unsettled not in _NO_STOP:
        result = dataclasses.replace(result, message=_slowing(result, cost_cap) or result.message)
    return result


def _slowing(result: Result, cost_cap: float) -> str:
    """Of a motion that does not settle, as it slows down: where and when the crank stops, and
    whether it turns back there, in a sentence; empty where it does not slow down.

    The scene is run on from its start, for twice the cycles that its drift lets expect, and for
    twice as many again, until it stops.
    """
    speed = result.sampled("crank_speed")
    begin, end = abs(float(speed[0])), float(speed[-1] * np.sign(speed[0]))
    stop, scene, status = _stop(result), result.scene, 0
    count = 2.0 * math.ceil(begin / (begin - end)) if 0.0 < end < begin else math.inf
    most = _MOST_CYCLES[crank_train(scene).has_functions]
    while stop is None and status == 0 and count < most:
        until, every = (Extent(value=size, unit="cycle") for size in (count, 1.0))
        run = dataclasses.replace(scene.run, until=until, every=every)
        longer, formulation = dataclasses.replace(scene, run=run), result.formulation
        on = simulate(longer, formulation=formulation, cost_cap=cost_cap)
        stop, status, count = _stop(on), on.status, 2.0 * count
    if stop is None:
        return ""
    time, angle, turns_back = stop
    then = "turns back" if turns_back else "comes to rest"
    turned = angle - float(result.sampled("crank_angle")[0])
    if abs(turned) < scene.settled_period:
        energy = float(result.sampled("kinetic_energy")[0])
        return Ending.TOO_LIGHT.said(angle, time=time, then=then, energy=energy)[1]
    return Ending.SLOWS_DOWN.said(angle, time=time, then=then)[1]


def _stop(result: Result) -> tuple[float, float, bool] | None:
    """Time [s] and crank angle [rad] at which a crank that turns first stops, to rest there or to
    turn back, and whether it does; None where it goes on."""
    before, stop = 0.0, None
    for cells in result.passes.answer.cells:
        sense = cells.acting.sense
        if stop is None and before and sense != before:
            stop = float(cells.time[0, 0]), float(cells.angle[0, 0])
        if stop is not None and sense == -before:
            return *stop, True
        if sense:
            before, stop = sense, None
    last = result.passes.answer.cells[-1]
    if stop is None and before and result.status == 1 and last.speed[-1, -1] == 0.0:
        stop = float(last.time[-1, -1]), float(last.angle[-1, -1])
    return None if stop is None else (*stop, False)


def functions_of(scene: Scene) -> list[tuple[str, Function]]:
    """The functions among the loads, each with where it stands in the scene; none has failed
    yet."""
    functions = []
    loads = crank_train(scene).loads
    for number, load in enumerate(loads, start=1):
        place = place_of(loads, number)
        if load.given.lacks:
            raise InputError(f"{place}: {load.given.lacks}")
        if load.parts.function is not None:
            load.parts.function.failure = ""
            functions.append((place, load.parts.function))
    return functions


def why(status: int, message: str, functions: list[tuple[str, Function]]) -> str:
    """How a run ended, by its status and message; where it broke off after a function had failed,
    what that did, in place of what it cost the solver."""
    failed = [f"{place}: {function.failure}" for place, function in functions if function.failure]
    if status >= 0 or not failed:
        return message
    stopped, _, _ = message.partition(": ")
    return f"{stopped}: {failed[0]}" if stopped.startswith("stopped") else f"{message}; {failed[0]}"
