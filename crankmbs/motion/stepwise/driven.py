"""A prescribed motion in steps over time: its law says where it stands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crankmbs.mechanics.speed import SpeedLaw, speed_law
from crankmbs.mechanics.torque import pushing
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.assemble import Assembled, assemble
from crankmbs.motion.base import Samples, Solution, State
from crankmbs.motion.driven import decisions, monotone_stretches, windows_at
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan, folds_of
from crankmbs.motion.states import applied_forces
from crankmbs.motion.stepwise.standing import Moving, Standing, commanded, said

__all__ = ["Prescribed"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # as in `assemble`


class Prescribed:
    """The steps of a crank train whose speed is prescribed."""

    def __init__(self, train: CrankTrain) -> None:
        scene = train.scene
        assert scene.motion is not None
        self._train, self._law = train, speed_law(scene.motion)
        start = scene.motion.angle
        self._plan = Plan(start, 1.0, True, 0.0, True, folds=folds_of(scene, start))

    def begin(self) -> Standing:
        """Where it starts."""
        theta, omega, _ = _at(self._law, 0.0)
        return Standing((State(0.0, theta, omega, 0.0, begun(self._train)),))

    def advance(
        self, standing: Standing, until: float, torque: float, share: float | None
    ) -> Standing:
        """One step; see `crankmbs.motion.stepwise.standing.Steps`. There is no torque to hold.

        Raises
        ------
        InputError : a speed table ends before
        """
        state = commanded(standing.states[0], torque, share)
        if self._plan.folds_at(state.theta):
            return standing._replace(ending=Ending.FOLD, angle=state.theta)
        stretches, _ = monotone_stretches(replace(self._plan, until=until), self._law)
        for _, end in stretches:
            if end > state.time:
                state = self._carried(state, end)
        theta, omega, _ = _at(self._law.perturbed, state.time)
        ahead = max(standing.ahead, abs(theta - state.theta))
        faster = max(standing.faster, abs(omega - state.omega))
        ending = Ending.COMPLETE if state.time == until else Ending.FOLD
        return Standing((state,), ahead, faster, ending, state.theta)

    def _carried(self, first: State, time: float) -> State:
        """The state at a later time, up to which the crank turns one way or rests."""
        theta, omega, _ = _at(self._law, time)
        last = State(time, theta, omega, 0.0)
        mode = first.mode
        if self._train.law is not None:
            for decision in decisions(self._train, self._law, first, last):
                mode = decision.mode
        return last._replace(mode=windows_at(self._train, mode, time))

    def moving(self, standing: Standing) -> Moving:
        """The motion by its law."""
        (state,) = standing.states
        alpha = _at(self._law, state.time)[2]
        errors = (
            apart + _ROUNDING * abs(value)
            for apart, value in zip(standing[1:3], state[1:3], strict=True)
        )
        return Moving(state.theta, state.omega, alpha, *errors)

    def said(self, standing: Standing) -> tuple[int, str]:
        """Status and sentence of the last step."""
        return said(standing)

    def assembled(self, standing: Standing) -> Assembled:
        """Every variable, beside a law that is off by as much as this one may be."""
        (state,) = standing.states
        answer, better = (self._sample(law, state) for law in (self._law, self._law.perturbed))
        return assemble(self._train, Solution(answer, *self.said(standing), 0, 0, better))

    def _sample(self, law: SpeedLaw, state: State) -> Samples:
        shares = state.mode.shares
        computed = {"fuel": np.array([shares])} if shares else {}
        time = np.array([state.time])
        theta, omega, alpha = law.at_time(time)
        if self._train.pushes:
            pushes = pushing(self._train, state.mode.loads)
            computed["applied_force"] = applied_forces(self._train, pushes, (time, theta, omega))
        return Samples(time, theta, omega, alpha, np.zeros(1), computed)


def _at(law: SpeedLaw, time: float) -> tuple[float, float, float]:
    theta, omega, alpha = (float(value) for value in law.at_time(time))
    return theta, omega, alpha
