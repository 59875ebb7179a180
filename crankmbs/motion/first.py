"""The one sample at a state of a free motion, from the state alone."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from crankmbs.mechanics.friction import friction_forces, friction_torque, held_share
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.torque import branch_at, branch_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import Samples, State

__all__ = ["first_sample"]


def first_sample(train: CrankTrain, state: State, of_angle: float) -> Samples:
    """The sample at a state. A crank at rest has the acceleration with which it sets out, and the
    friction that resists it; where friction holds it, none, and the friction that it takes.

    of_angle [N m] : what the loads give over the crank angle
    """
    shares, (time, theta, omega, *_) = state.mode.shares, state
    reduction = reduce(train, theta, shares)
    of_angle += state.mode.held
    rest = float(reduction.rest(omega)) + of_angle
    torques, phases = train.scene.torque, state.mode.loads
    rub = partial(friction_torque, train, theta, omega, shares=shares or None)
    sliding = math.copysign(1.0, omega) if omega else 0.0
    rubbed = float(rub(sliding))
    branch = branch_at(torques, state[:3], rest + rubbed, phases)
    held = branch is None and omega == 0.0
    branch = branch or branch_of(torques, time, omega, rising=True, phases=phases)
    outside = float(branch(time, omega))
    outside += sum(f.number(time, theta, omega) for f in branch.functions)
    outside = -rest if held else outside
    own = {"fuel": np.array([shares])} if shares else {}
    if train.scene.friction is not None:
        if omega == 0.0:
            share = float(held_share(train, theta, rest + outside, shares))
            sliding = min(max(share, -1.0), 1.0)
            rubbed = -(rest + outside) if abs(share) <= 1.0 else float(rub(sliding))
        motion = np.array([theta]), np.array([omega]), own.get("fuel")
        own["friction_force"] = friction_forces(train, *motion, np.array([sliding]))
    return Samples(
        time=np.array([time]),
        theta=np.array([theta]),
        omega=np.array([omega]),
        alpha=np.array([(rest + outside + rubbed) / float(reduction.inertia)]),
        energy_residual=np.array([state.residual]),
        own={"external_torque": np.array([outside + of_angle]), **own},
    )
