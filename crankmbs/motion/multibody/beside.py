"""The model beside a motion that another formulation found: from one state on, and at states."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from crankmbs.mechanics.firing import Firing
from crankmbs.mechanics.speed import speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phases
from crankmbs.motion.base import State
from crankmbs.motion.mode import Mode, begun
from crankmbs.motion.multibody.answer import Answers
from crankmbs.motion.multibody.forces import EVERYWHERE, Limits
from crankmbs.motion.multibody.free import refined
from crankmbs.motion.multibody.integrate import enter
from crankmbs.motion.multibody.runs import Motion, Runs
from crankmbs.numerics.arrays import Array

__all__ = ["Shares", "consistent", "initial", "integrated"]

_NEAR = 1e-8  # rad


class Shares(NamedTuple):
    """Shares of the combustion as they are known: in place of a law of decisions.

    angles : shape (n,) [rad], increasing, at which they change; rows : before the first and after
        each, shape (n + 1, cylinders)
    """

    angles: Array
    rows: Array

    def next(self, firing: Firing) -> tuple[float, float]:
        """Crank angles [rad], backwards and forwards, at which they change next."""
        ends = np.concatenate([[-np.inf], self.angles, [np.inf]])
        k = self._number(firing.theta, firing.integral)
        return float(ends[k]), float(ends[k + 1])

    def decided(self, _: Firing | None, time: float, theta: float, omega: float) -> Firing:
        """What holds from a crank angle on, in the sense in which it is passed; ``integral`` keeps
        the sense."""
        shares = tuple(self.rows[self._number(theta, omega)].tolist())
        return Firing(shares, time, theta, omega, None, False, theta, theta)

    def _number(self, theta: float, sense: float) -> int:
        return int(np.searchsorted(self.angles, theta + _NEAR * np.sign(sense)))


def integrated(
    train: CrankTrain,
    state: tuple[float, float, float],
    acting: tuple[Phases, Shares | None],
    times: Array,
    rtol: float,
    steps: int,
) -> tuple[dict[str, Array], dict[str, float]]:
    """Every variable of a free crank at later times [s], shape (m,), integrated from a time [s],
    crank angle [rad] and speed [rad/s]; and the error of each.

    acting : phases of the loads' windows, and shares of the combustion; rtol
        asked for; steps : allowed

    Raises
    ------
    FormulationError : exudyn cannot take a single step from there
    """
    phases, shares = acting
    mode = Mode(phases)
    if shares is not None:
        law: Any = shares  # it is asked for no more
        train, firing = replace(train, law=law), shares.decided(None, *state)
        mode = Mode(phases, *shares.next(firing), firing)
    limits = Limits(float(times[-1]), EVERYWHERE, steps)

    def places(answer: Motion) -> tuple[Array, Array]:
        return times, answer.at_times(times)[1]

    with closing(Answers(train)) as answers:
        runs = Runs(answers.forces, answers.model, State(*state, 0.0, mode), limits)
        return refined(runs, answers, rtol, places, by_angle=False)[:2]


def consistent(train: CrankTrain, motion: Mapping[str, Array], *, driven: bool) -> dict[str, Array]:
    """Accelerations, multipliers and all that follows from them at states of a motion, as
    `crankmbs.motion.multibody.answer.Answers.consistent` says."""
    with closing(Answers(train)) as answers:
        return answers.consistent(motion, driven=driven)


def initial(train: CrankTrain, step: float) -> tuple[Array, Array, Array]:
    """Coordinates at the start of a scene, their velocities and accelerations, from which a run
    with steps of this length [s] does not ring, under the forces of the side of a jump to which the
    crank moves; of a prescribed speed a constant one."""
    scene = train.scene
    if scene.motion is not None:
        theta, omega, _ = map(float, speed_law(scene.motion).at_time(0.0))
    else:
        assert scene.start is not None
        theta, omega = scene.start.angle, scene.start.speed
    with closing(Answers(train)) as answers:
        state = State(0.0, theta, omega, 0.0, begun(train))
        enter(answers.model, answers.forces, state, 0.0, Limits(math.inf, EVERYWHERE, 0))
        _, quiet = answers.model.quiet_start(state[:3], step, driven=scene.motion is not None)
    return quiet.position[0], quiet.velocity[0], quiet.acceleration[0]
