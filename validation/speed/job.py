"""The numbers of a scene that the peers can serve: one cylinder, free, with smooth loads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.pressure import pressures_of
from crankmbs.scene.loads import Constant, Quadratic, Viscous
from crankmbs.scene.scene import Scene

__all__ = ["Job", "NotServed", "job_of"]

Array = NDArray[np.float64]


class NotServed(Exception):
    """The peers cannot serve this scene; the text says why."""


@dataclass(frozen=True)
class Job:
    """One cylinder whose axis is the engine's X, on a free crank; SI units.

    gravity : its two components [m/s2]
    knots, force : cycle angles [rad], shape (n + 1,), and between them the gas force towards the
        crank as cubics of the angle behind the knot [N, by descending power], shape (4, n)
    constant, viscous, quadratic : torque c0 - c1 omega - c2 omega |omega| on the crank
    theta, omega : start; times : shape (m,) [s], where the answer is wanted
    """

    radius: float
    crank_inertia: float
    crank_mass: float
    crank_center: float
    rod_length: float
    rod_mass: float
    rod_center: float
    rod_inertia: float
    piston_mass: float
    offset: float
    gravity: tuple[float, float]
    knots: Array
    force: Array
    constant: float
    viscous: float
    quadratic: float
    theta: float
    omega: float
    times: Array

    @property
    def end(self) -> float:
        """End of the run [s]."""
        return float(self.times[-1])

    @property
    def turns(self) -> float:
        """About how many revolutions, at the speed of the start; at least one."""
        return max(abs(self.omega) * self.end / (2.0 * math.pi), 1.0)

    @property
    def has_gas(self) -> bool:
        """Whether there is a gas force."""
        return bool(self.force.any())

    @property
    def has_torque(self) -> bool:
        """Whether there is a torque on the crank."""
        return (self.constant, self.viscous, self.quadratic) != (0.0, 0.0, 0.0)


def job_of(scene: Scene, times: Array) -> Job:
    """The numbers of a scene.

    Raises
    ------
    NotServed : prescribed speed, several cylinders, a phase or a bank, a torque from a table
    """
    if scene.start is None:
        raise NotServed("a prescribed speed leaves the peers nothing to integrate")
    (cylinder, *others) = scene.cylinders
    if others or cylinder.phase or cylinder.bank:
        raise NotServed("the peers' scripts are written for one cylinder of phase 0 and bank 0")
    torque = dict.fromkeys((Constant, Viscous, Quadratic), 0.0)
    for load in scene.torque:
        match load:
            case Constant():
                torque[Constant] += load.torque
            case Viscous() | Quadratic():
                torque[type(load)] += load.coefficient
            case _:
                raise NotServed(
                    "the peers' scripts know constant, viscous and quadratic torques, not a "
                    f"{load.kind.replace('_', ' ')}"
                )
    pressures, gravity = pressures_of(scene), scene.gravity
    pressure = None if pressures is None else pressures[0]
    knots = np.array([0.0, scene.period]) if pressure is None else pressure.knots
    force = np.zeros((4, 1)) if pressure is None else pressure.coefficients
    pull, towards = (0.0, 0.0) if gravity is None else (gravity.acceleration, gravity.angle)
    return Job(
        radius=scene.crank.radius,
        crank_inertia=scene.crank.moment_of_inertia,
        crank_mass=scene.crank.mass,
        crank_center=scene.crank.center_of_mass,
        rod_length=scene.rod.length,
        rod_mass=scene.rod.mass,
        rod_center=scene.rod.center_of_mass,
        rod_inertia=scene.rod.moment_of_inertia,
        piston_mass=scene.piston.mass,
        offset=scene.piston.offset,
        gravity=(pull * math.cos(towards), pull * math.sin(towards)),
        knots=knots,
        force=force * (scene.piston.gas_area or 0.0),
        constant=torque[Constant],
        viscous=torque[Viscous],
        quadratic=torque[Quadratic],
        theta=scene.start.angle,
        omega=scene.start.speed,
        times=times,
    )
