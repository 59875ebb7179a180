"""Runs at halved steps, what they cost, and how they end."""

from __future__ import annotations

import math
import time as clock

from crankmbs.errors import FormulationError
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.problem import erratic_order, problem_of
from crankmbs.motion.multibody.samples import reached, slowed
from crankmbs.motion.multibody.stepped import Stepped, coarsest_step, model_of, solve

__all__ = ["Halvings"]

_SHARE = 1.0 / 3.0  # of the cost cap, for the coarsest run: the next costs twice as much
_RETRIES = 4  # with a quarter of the step each time, where the coarsest diverges
_GAINS = 1.01  # less by a halving is none: the cost would be astronomic, and overflows
_AT_REST = 1e-6  # of the fastest speed
_HELD = "a jump of the loads drives the speed back from both sides"
_NO_STEP = "exudyn's Newton iteration does not converge"
_STILL = 1e-9  # rad/s: a speed that a stretch has landed on
_UNTOUCHED = 0.98  # of the time to where the solver fails: before it goes wrong


class Halvings:
    """The last three runs of a problem, coarsest first.

    moves : False where the crank stays at rest
    ending : of the runs, once the first is made
    """

    def __init__(self, train: CrankTrain, cost_cap: float) -> None:
        self._begin = clock.perf_counter()
        self.problem = problem_of(train)
        self.paths: list[Stepped] = []
        self.steps = self.iterations = 0
        self.ending = Ending.COMPLETE
        self._model = model_of(self.problem)
        self._step, self.moves = coarsest_step(self.problem, self._model)
        self._halvings = 0
        self._cap = cost_cap
        self._cost = 0.0  # wall time of the last run [s]

    def close(self) -> None:
        """Let go of exudyn's memory."""
        self._model.close()

    def first(self) -> tuple[int, str]:
        """The coarsest run; return status and message.

        Where it fails or takes too long, the problem is cut to the stretch that was reached, so
        that the finer runs give that stretch and its error.

        Raises
        ------
        FormulationError : not even a first stretch is reached
        """
        if not self.moves:
            return self._at_rest()
        for _ in range(_RETRIES):
            path = self._run(_SHARE * self._cap)
            if path.ending is not Ending.DIVERGED:
                break
            self._model.stiff = True
            self._step *= 0.25
        if not path.tables:
            held = path.ending is Ending.HELD
            why = _HELD if held else _NO_STEP
            raise FormulationError(
                f"formulation 'multibody' cannot serve this scene: {why} at its start; choose auto"
            )
        self.paths = [path]
        if path.ending in (Ending.COMPLETE, Ending.HELD):
            self.moves = reached(path)[0] > 0.0
            return self._end(path)
        return self._cut(path)

    def halve(self) -> bool:
        """One more run, at half the step; False, and no run more, where it fails."""
        self._halvings += 1
        path = self._run(math.inf)
        held = self.paths[-1].ending is Ending.HELD
        if path.ending is not (Ending.HELD if held else Ending.COMPLETE):
            return False
        self.paths = [*self.paths, path][-3:]
        return True

    @property
    def erratic_order(self) -> int:
        """That of the problem, and 1 where the runs went over bends or jumps of the loads."""
        blind = any(path.blind for path in self.paths)
        return 1 if blind else erratic_order(self.problem)

    def affords_another(self) -> bool:
        """Whether a run at half the last step fits under the cost cap."""
        return self._spent() + 2.0 * self._cost <= self._cap

    def shortfall(self, rtol: float, worst: float, gain: float) -> str:
        """What to say where ``rtol`` is not met; ``gain`` is what the last halving brought."""
        if math.isinf(worst):
            return "; its error is unknown"
        said = f"; relative error {worst:.1e} reached, {rtol:.0e} asked for: "
        if not gain > _GAINS:
            return said + "a finer step brings no more"
        order = min(math.log2(gain), 4.0)
        cost = self._spent() + 2.0 * self._cost * (worst / rtol) ** (1.0 / order)
        return (
            said
            + f"that would take about {_rounded(cost):g} s, above the cost cap of {self._cap:g} s"
        )

    def _run(self, budget: float) -> Stepped:
        begin = clock.perf_counter()
        path = solve(
            self.problem,
            self._model,
            self._step,
            self._halvings,
            None if math.isinf(budget) else lambda: clock.perf_counter() - begin < budget,
        )
        self._cost = clock.perf_counter() - begin
        self.steps += path.steps
        self.iterations += path.iterations
        return path

    def _spent(self) -> float:
        return clock.perf_counter() - self._begin

    def _at_rest(self) -> tuple[int, str]:
        """A crank that nothing moves: a few steps give its reactions, and the start is returned."""
        plan = self.problem.plan
        self.problem = self.problem._replace(end=8.0 * self._step)
        self.paths = [self._run(math.inf)]
        self.ending = Ending.UNMOVED
        return self.ending.said(plan.start)

    def _end(self, path: Stepped) -> tuple[int, str]:
        _, theta, omega = reached(path)
        ending, scene = path.ending, self.problem.scene
        if ending is Ending.HELD and scene.friction and abs(omega) < _STILL:
            ending = Ending.STICKS
        elif ending is not Ending.HELD and self.problem.rests:
            ending = Ending.LAW_RESTS
        elif ending is not Ending.HELD and self.problem.plan.folds_at(theta):
            ending = Ending.FOLD
        self.ending = ending
        return ending.said(theta, omega if self.moves else 0.0)

    def _cut(self, path: Stepped) -> tuple[int, str]:
        time, theta, _ = reached(path)
        plan = self.problem.plan
        if path.ending is Ending.DIVERGED:
            self.problem = self.problem._replace(end=_UNTOUCHED * time)
            self.paths = [self._run(math.inf)]
            self.ending = Ending.DIVERGED
            return self.ending.said(theta, time=time)
        share = (time if plan.until_time else abs(theta - plan.start)) / plan.until
        self.problem = self.problem._replace(end=time)
        if slowed(path) < _AT_REST:
            self.ending = Ending.SLOWED
            return self.ending.said(theta, time=time)
        whole = self._cost / share / _SHARE
        self.ending = Ending.CALLED_OFF
        return self.ending.said(theta, time=time, whole=_rounded(whole), cap=self._cap)


def _rounded(cost: float) -> float:
    return float(f"{cost:.2g}")
