"""What turns the crank and loads the joints at crank angles, in parts that belong to omega^2, alpha
and 1, at one sense of rotation: of several machines at once, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.axes import Gears, axes_of, gears_of
from crankmbs.mechanics.friction import friction_forces
from crankmbs.mechanics.geometry import close_loops, lengths_of
from crankmbs.mechanics.inertia import ends_at, gas_at
from crankmbs.mechanics.journals import of_journals
from crankmbs.mechanics.newton_euler import UNITS, Place, of_crank, of_cylinders, pushed
from crankmbs.mechanics.train import CrankTrain
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.periodic import single

__all__ = ["Balances", "balances"]


class Balances(NamedTuple):
    """At n crank angles.

    inertia : J without the crank's [kg m2], shape (n,)
    crank : variables of the engine by name, shape (3, n)
    cylinders : of the cylinders, shape (cylinders, 3, n), or (cylinders, 1, n) of what depends on
        the angle alone; velocities per speed; as of each journal and shared pin
    pushes : on the pistons, shape (rows, cylinders, n) [N]: of the gas, of friction, and in
        double-acting cylinders of the gas in the head end and in the crank end
    """

    inertia: Array
    crank: dict[str, Array]
    cylinders: dict[str, Array]
    pushes: Array


def balances(trains: Sequence[CrankTrain], of: Index, theta: Array, sense: float) -> Balances:
    """Those of machines that differ in running gear and gas, at crank angles of shape (n,) [rad];
    friction that does not depend on the speed is in what belongs to 1.

    of : which machine each angle is of, shape (n,), in their order
    """
    scene = trains[0].scene
    gears = Gears(*np.array([gears_of(train.scene) for train in trains]).T[:, np.newaxis, of])
    at = Place(gears, close_loops(theta, axes_of(scene).phases, lengths_of(*gears[:3])))
    pressure, head, friction = np.zeros((3, *at.loop.x.shape))
    ends = np.searchsorted(of, np.arange(len(trains) + 1)).tolist()
    for train, some in zip(trains, map(slice, ends, ends[1:]), strict=False):
        angles = theta[some]
        if (net := gas_at(train, angles)) is not None:
            pressure[:, some] = net
            head[:, some] = ends_at(train, angles, net).get("gas_pressure", net)
        if scene.friction is not None:
            slides = np.full_like(angles, sense)
            rubbed = friction_forces(train, angles, np.zeros_like(angles), slides=slides)
            friction[:, some] = rubbed.T
    every = of_cylinders(scene, at, pressure, UNITS)
    rods = every.variables["crank_pin_force_x"], every.variables["crank_pin_force_y"]
    crank = of_crank(scene, theta, UNITS, every)
    cylinders = every.variables | of_journals(scene, theta, UNITS, rods)
    if scene.friction is not None:
        for name, more in pushed(scene, at, single(theta), friction).items():
            if name in cylinders:
                cylinders[name][:, 2] += more
            else:
                crank[name][2] += more[0]
    pushes = [gears.area * pressure, friction]
    if scene.double_acting:
        pushes += [gears.area * head, gears.area * (pressure - head)]
    return Balances(every.inertia.sum(axis=0)[0], crank, cylinders, np.array(pushes))
