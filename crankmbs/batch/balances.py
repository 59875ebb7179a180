"""What turns the crank and loads the joints at crank angles, in parts that belong to omega^2, alpha
and 1, at one sense of rotation."""

from __future__ import annotations

import numpy as np

from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.inertia import gas_at, moving_inertias, rod_centre
from crankmbs.mechanics.newton_euler import UNITS, balanced, place_of, pushed
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import single
from crankmbs.scene.scene import Scene

__all__ = ["by_powers", "without_crank"]


def by_powers(train: CrankTrain, theta: Array, sense: float) -> dict[str, Array]:
    """Every variable at crank angles of shape (n,) [rad], velocities per speed; friction that does
    not depend on the speed is in what belongs to 1.

    Returns
    -------
    shape (3, n) of the crank, (3, n, cylinders) of each cylinder, as of each journal; (1, n,
    cylinders) of what depends on the angle alone, with "net_pressure" on the pistons [Pa]

    >>> by_powers(crank_train(load_scene("propeller")), np.zeros(2), 1.0)["side_force"].shape
    (3, 2, 1)
    """
    scene, parts = train.scene, balanced(train, theta, UNITS)
    if scene.friction is not None:
        slides = np.full_like(theta, sense)
        rubbed = friction_forces(train, theta, np.zeros_like(theta), slides=slides).T
        for name, more in pushed(scene, place_of(scene, theta), single(theta), rubbed).items():
            parts[name][:, 2] += more
        parts["friction_force"] = rubbed[:, None]
    net, gas = parts["gas_pressure"], gas_at(train, theta) if scene.double_acting else None
    if gas is not None:
        net = gas[:, np.newaxis]
    return {"net_pressure": net.transpose(1, 2, 0)} | {
        name: each.transpose(1, 2, 0) if EVERY[name].of else each[0] for name, each in parts.items()
    }


def without_crank(scene: Scene, theta: Array) -> Array:
    """J at crank angles [rad] without the crank's, shape (n,) [kg m2]; the same whichever it
    has."""
    gears, loop = place_of(scene, theta)
    centre = rod_centre(loop, gears.radius, gears.rod_centre / gears.length)
    return np.asarray(moving_inertias(gears, loop, centre).sum(axis=0))
