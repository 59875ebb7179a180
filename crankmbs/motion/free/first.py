"""The one sample at the start of a free motion."""

from __future__ import annotations

import math

import numpy as np

from crankmbs.mechanics.friction import friction_forces, friction_torque, held_share
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.torque import branch_at, branch_of
from crankmbs.motion.base import Samples, State
from crankmbs.motion.crank_angle.grid import Grid

__all__ = ["first_sample"]


def first_sample(grid: Grid, state: State) -> Samples:
    """The sample at a state. A crank at rest has the acceleration with which it sets out, and the
    friction that resists it; where friction holds it, none, and the friction that it takes."""
    train, shares, (time, theta, omega, *_) = grid.train, state.mode.shares, state
    inertia, slope, torque = reduce(train, theta, shares)
    of_angle = float(grid.at(state.mode.loads).outside(np.asarray(theta)))
    rest = float(torque - 0.5 * slope * omega**2) + of_angle
    torques, phases = train.scene.torque, state.mode.loads
    sliding = math.copysign(1.0, omega) if omega else 0.0
    rubbed = _friction(grid, state, sliding)
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
            rubbed = -(rest + outside) if abs(share) <= 1.0 else _friction(grid, state, sliding)
        motion = np.array([theta]), np.array([omega]), own.get("fuel")
        own["friction_force"] = friction_forces(train, *motion, np.array([sliding]))
    return Samples(
        time=np.array([time]),
        theta=np.array([theta]),
        omega=np.array([omega]),
        alpha=np.array([(rest + outside + rubbed) / float(inertia)]),
        energy_residual=np.zeros(1),
        own={"external_torque": np.array([outside + of_angle]), **own},
    )


def _friction(grid: Grid, state: State, sense: float) -> float:
    """Torque of the friction on the crank [N m] that slides in a sense."""
    if grid.train.scene.friction is None:
        return 0.0
    shares = state.mode.shares or None
    return float(friction_torque(grid.train, state.theta, state.omega, sense, shares))
