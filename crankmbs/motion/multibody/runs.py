"""Runs at halved steps, what they cost, and how they end."""

from __future__ import annotations

import math
import time as clock

from crankmbs.errors import FormulationError
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.multibody.path import Path, coarsest_step, model_of, solve
from crankmbs.motion.multibody.problem import erratic_order, problem_of
from crankmbs.motion.multibody.samples import reached, slowed
from crankmbs.scene.units import RPM

__all__ = ["Runs"]

_SHARE = 1.0 / 3.0  # of the cost cap, for the coarsest run: the next costs twice as much
_RETRIES = 4
_AT_REST = 1e-6  # of the fastest speed
_FAILED = "exudyn's Newton iteration does not converge, or a rod turns over at a fold"
_HELD = "a jump of the loads drives the speed back from both sides"
_UNTOUCHED = 0.98  # of the time to where the solver fails: before it goes wrong


class Runs:
    """The last three runs of a problem, coarsest first.

    moves : False where the crank stays at rest
    """

    def __init__(self, train: CrankTrain, cost_cap: float) -> None:
        self._begin = clock.perf_counter()
        self.problem = problem_of(train)
        self.paths: list[Path] = []
        self.steps = self.iterations = 0
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
            if path.ending != "failed":
                break
            self._model.stiff = True
            self._step *= 0.25
        if not path.tables:
            why = _HELD if path.ending == "held" else "exudyn's Newton iteration does not converge"
            raise FormulationError(
                f"formulation 'multibody' cannot serve this scene: {why} at its start; choose auto"
            )
        self.paths = [path]
        if path.ending in ("complete", "held"):
            self.moves = reached(path)[0] > 0.0
            return self._end(path)
        return self._cut(path)

    def halve(self) -> bool:
        """One more run, at half the step; False, and no run more, where it fails."""
        self._halvings += 1
        path = self._run(math.inf)
        if path.ending != ("held" if self.paths[-1].ending == "held" else "complete"):
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
        if not gain > 1.0:
            return said + "a finer step brings no more"
        order = min(math.log2(gain), 4.0)
        cost = self._spent() + 2.0 * self._cost * (worst / rtol) ** (1.0 / order)
        return said + f"that would take about {_seconds(cost)}, {self._above()}"

    def _run(self, budget: float) -> Path:
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

    def _above(self) -> str:
        return f"above the cost cap of {self._cap:g} s"

    def _at_rest(self) -> tuple[int, str]:
        """A crank that nothing moves: a few steps give its reactions, and the start is returned."""
        plan = self.problem.plan
        self.problem = self.problem._replace(end=8.0 * self._step)
        self.paths = [self._run(math.inf)]
        return 1, (
            f"did not move: at rest at {math.degrees(plan.start):.6g} degrees, where no torque "
            "turns the crank"
        )

    def _end(self, path: Path) -> tuple[int, str]:
        _, theta, omega = reached(path)
        omega = omega if self.moves else 0.0
        degrees, plan = math.degrees(theta), self.problem.plan
        if path.ending == "held":
            return 1, f"held at {omega / RPM:.6g} rpm at {degrees:.6g} degrees: {_HELD}"
        if self.problem.rests:
            return 1, f"the prescribed speed comes to rest at {degrees:.6g} degrees, before the end"
        if min(abs(theta - fold) for fold in plan.folds) < 1e-9:
            return 1, (
                f"the rod folds onto the crank at {degrees:.6g} degrees, where the motion is not "
                "determined"
            )
        return 0, "reached the end of the run"

    def _cut(self, path: Path) -> tuple[int, str]:
        time, theta, _ = reached(path)
        plan = self.problem.plan
        where = f"at {math.degrees(theta):.6g} degrees, {time:.6g} s"
        if path.ending == "failed":
            self.problem = self.problem._replace(end=_UNTOUCHED * time)
            self.paths = [self._run(math.inf)]
            return -1, f"stopped {where}: {_FAILED}"
        share = (time if plan.until_time else abs(theta - plan.start)) / plan.until
        self.problem = self.problem._replace(end=time)
        if slowed(path) < _AT_REST:
            return 1, f"came to rest {where}, before the end of the run"
        whole = self._cost / share / _SHARE
        return (
            -1,
            f"stopped {where}: the whole run would take about {_seconds(whole)}, {self._above()}",
        )


def _seconds(cost: float) -> str:
    return f"{float(f'{cost:.2g}'):g} s"
