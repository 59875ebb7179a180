"""The model beside a motion that another formulation found: from one state on, and at states."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from crankmbs.mechanics.firing import Firing
from crankmbs.mechanics.speed import speed_law
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import Phases
from crankmbs.motion.base import State
from crankmbs.motion.mode import Mode
from crankmbs.motion.multibody.answer import Answers
from crankmbs.motion.multibody.forces import EVERYWHERE, Bounds, Forces
from crankmbs.motion.multibody.free import follow
from crankmbs.motion.multibody.model import Model
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
        k = int(np.searchsorted(self.angles, firing.theta + _NEAR * np.sign(firing.integral)))
        return float(ends[k]), float(ends[k + 1])

    def decided(self, firing: Firing, time: float, theta: float, omega: float) -> Firing:
        """What holds from a crank angle on, in the sense in which it is passed."""
        return self.at(time, theta, omega)

    def at(self, time: float, theta: float, omega: float) -> Firing:
        """What holds at a state; its ``integral`` is the sense of rotation."""
        sense = float(np.sign(omega))
        k = int(np.searchsorted(self.angles, theta + _NEAR * sense))
        return Firing(tuple(self.rows[k].tolist()), time, theta, sense, None, False, theta, theta)


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
        train, firing = replace(train, law=law), shares.at(*state)
        mode = Mode(phases, *shares.next(firing), firing)
    return follow(train, State(*state, 0.0, mode), times, rtol, steps)


def consistent(
    train: CrankTrain, motion: dict[str, Array], acts: Array, *, driven: bool
) -> dict[str, Array]:
    """Accelerations, multipliers and all that follows from them at states of a motion.

    motion : at states of shape (m,), "time", "crank_angle", "crank_speed"; of a driven crank its
        "crank_acceleration", else "external_torque"; "fuel" and, for a crank at rest,
        "friction_force" and "applied_force" where there are
    acts : shape (m, loads), which of the loads do
    """
    theta, omega = motion["crank_angle"], motion["crank_speed"]
    model, forces = Model(train.scene), Forces(train)
    try:
        gas = forces.gas(theta, motion.get("fuel"))
        senses, rests = np.sign(omega), omega[:, None] == 0.0
        friction = forces.friction(theta, omega, gas, senses)
        applied = forces.applied(motion["time"], theta, omega, senses, acts)
        friction = np.where(rests, motion.get("friction_force", 0.0), friction)
        applied = np.where(rests, motion.get("applied_force", 0.0), applied)
        torque = None if driven else motion["external_torque"]
        alpha = motion["crank_acceleration"] if driven else None
        pushes = gas, friction, applied
        return Answers(model, forces, ()).under(pushes, torque, theta, omega, alpha)
    finally:
        model.close()


def initial(train: CrankTrain, step: float) -> tuple[Array, Array, Array]:
    """Coordinates at the start of a scene, their velocities and accelerations, from which a run
    with steps of this length [s] does not ring; of a prescribed speed a constant one."""
    scene, model, forces = train.scene, Model(train.scene), Forces(train)
    law = None if scene.motion is None else speed_law(scene.motion)
    if law is not None:
        theta, omega, _ = (float(each) for each in law.at_time(0.0))
    else:
        assert scene.start is not None
        theta, omega = scene.start.angle, scene.start.speed
    bounds = Bounds(EVERYWHERE, EVERYWHERE, EVERYWHERE)
    model.torque, model.pushes = (
        forces.load(bounds, Mode()),
        forces.pushes(bounds, Mode(), theta, 1.0),
    )
    try:
        _, *found = model.quiet_start((0.0, theta, omega), step, driven=law is not None)
    finally:
        model.close()
    return tuple(found)
