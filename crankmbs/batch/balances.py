"""What turns the crank and loads the joints at crank angles, in parts that belong to omega^2, alpha
and 1, at one sense of rotation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.journals import of_journals
from crankmbs.mechanics.newton_euler import UNITS, of_crank, of_cylinders, pushed
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import single

__all__ = ["Balances", "balances"]


class Balances(NamedTuple):
    """At n crank angles.

    inertia : J without the crank's [kg m2], shape (n,)
    crank : variables of the engine by name, shape (3, n)
    cylinders : of the cylinders, shape (cylinders, 3, n), or (cylinders, 1, n) of what depends on
        the angle alone; velocities per speed; as of each journal and shared pin
    friction : on the pistons, shape (cylinders, n) [N], in the sense of rotation
    """

    inertia: Array
    crank: dict[str, Array]
    cylinders: dict[str, Array]
    friction: Array


def balances(train: CrankTrain, theta: Array, sense: float) -> Balances:
    """Those at crank angles of shape (n,) [rad]; friction that does not depend on the speed is in
    what belongs to 1."""
    every = of_cylinders(train, theta, UNITS)
    rods = every.variables["crank_pin_force_x"], every.variables["crank_pin_force_y"]
    crank = of_crank(train.scene, theta, UNITS, every)
    cylinders = every.variables | of_journals(train.scene, theta, UNITS, rods)
    friction = np.zeros((len(train.scene.cylinders), len(theta)))
    if train.scene.friction is not None:
        slides = np.full_like(theta, sense)
        friction = friction_forces(train, theta, np.zeros_like(theta), slides=slides).T
        for name, more in pushed(train.scene, single(theta), friction).items():
            if name in cylinders:
                cylinders[name][:, 2] += more
            else:
                crank[name][2] += more[0]
    return Balances(every.inertia.sum(axis=0)[0], crank, cylinders, friction)
