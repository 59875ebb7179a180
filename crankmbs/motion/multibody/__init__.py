"""Crank, rods and pistons as rigid bodies on joints, in exudyn: the independent check.

Every body has its own coordinates, every joint its multipliers: motion and reactions are exudyn's.
With the others it shares what is given to it, pressure, loads and prescribed speed, and the loop
closure: for consistent starts, to see that a rod has not turned over, for the gas's share of a
force between two steps (taken off and put back) and as the datum of the displacement. The method
(generalized alpha, index 3) is of order 2; runs at step sizes halved again and again give the
answer, extrapolated where that is sound, and its error.

A run is cut where gas or loads jump (`gas`, `landing`, `walk`, `beside`), for order 2 across. Run
over jumps as they are, with the last change stated, the relative error under the same cost cap is

                                            cut     run over
    v_twin, valves that jump             5.8e-5       4.6e-3
    propeller, a step at every row       5.0e-6       3.9e-1
    a load that steps in time            3.0e-6       3.8e-3
    a load that jumps with the speed     3.0e-6       2.7e-2
    a prescribed speed with corners      1.0e-5       4.2e-2

From jump to jump the true error is then up to five times the stated one, backwards from one twice,
as two runs err on the same side; and a speed held by a jump is not seen as held. The other scenes
change little.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.beside import errors_beside_jumps
from crankmbs.motion.multibody.error import SAFETY, Convergence
from crankmbs.motion.multibody.halvings import Halvings
from crankmbs.motion.multibody.problem import order_over_angle
from crankmbs.motion.multibody.samples import Sampled, aligned_variables
from crankmbs.motion.multibody.seen import Run, pieces_of_runs
from crankmbs.numerics.arrays import Array

__all__ = ["SAFETY", "run"]

_WORSE = 2.0  # a halving that makes the error so much larger only adds rounding
_MOTION = ("time", "crank_angle", "crank_speed", "crank_acceleration", "energy_residual")


def run(train: CrankTrain, rtol: float, cost_cap: float) -> tuple[Solution, Sequence[Run], Ending]:
    """Run the multibody model; halve its step until ``rtol`` is met or ``cost_cap`` [s] is near.

    Returns
    -------
    the solution, the pieces of its two finest runs, how they end

    Raises
    ------
    FormulationError : exudyn cannot take a single step of this scene
    InputError : a speed table that ends before the run does
    """
    runs = Halvings(train, cost_cap)
    try:
        status, message = runs.first()
        convergence = Convergence(runs.erratic_order, bent=order_over_angle(runs.problem) < 3)
        sampled = [Sampled(runs.problem, runs.paths[-1])]
        answer: dict[str, Array] = {}
        worst = latest = before = math.inf
        while not answer or (worst > rtol and runs.affords_another()):
            if not runs.halve():
                message += "; at a finer step exudyn's Newton iteration does not converge"
                if not answer:
                    answer, errors = convergence.answer(aligned_variables(runs.problem, sampled))
                break
            sampled = [*sampled, Sampled(runs.problem, runs.paths[-1])][-3:]
            found = convergence.answer(aligned_variables(runs.problem, sampled))
            latest, before = _worst(*found), latest
            if latest < worst or not answer:
                (answer, errors), worst = found, latest
            elif latest > _WORSE * worst:
                break
        errors = errors_beside_jumps(runs.problem, answer, errors)
        if not runs.moves:
            answer = {name: values[:1] for name, values in answer.items()}
        elif worst > rtol:
            message += runs.shortfall(rtol, worst, before / latest)
        followed, ending = pieces_of_runs(train, runs), runs.ending
    finally:
        runs.close()
    own = {name: value for name, value in answer.items() if name not in _MOTION}
    time, theta, omega, alpha, residual = (answer[name] for name in _MOTION)
    samples = Samples(time, theta, omega, alpha, residual, own)
    solution = Solution(samples, status, message, runs.iterations, runs.steps, errors=errors)
    return solution, followed, ending


def _worst(answer: dict[str, Array], errors: dict[str, float]) -> float:
    angle = answer["crank_angle"]
    peaks = {name: peak(values) for name, values in answer.items()}
    return relative_error(peaks, errors, peak(angle - angle[0]))
