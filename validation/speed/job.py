"""The numbers of a scene that the peers can serve: a free crank with smooth loads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.pressure import pressures_of
from crankmbs.scene.loads import Constant, Quadratic, Viscous
from crankmbs.scene.scene import Scene

__all__ = ["Cylinder", "Job", "NotServed", "job_of"]

Array = NDArray[np.float64]


class NotServed(Exception):
    """The peers cannot serve this scene; the text says why."""


@dataclass(frozen=True)
class Cylinder:
    """One cylinder.

    phase, bank : [rad]
    knots, force : cycle angles [rad], shape (n + 1,), and between them the gas force towards the
        crank as cubics of the angle behind the knot [N, by descending power], shape (4, n)
    """

    phase: float
    bank: float
    knots: Array
    force: Array


@dataclass(frozen=True)
class Job:
    """A free crank and its cylinders, alike but for phase, bank and gas; SI units.

    gravity : its two components [m/s2]
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
    cylinders: tuple[Cylinder, ...]
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
        return any(cylinder.force.any() for cylinder in self.cylinders)

    @property
    def has_torque(self) -> bool:
        """Whether there is a torque on the crank."""
        return (self.constant, self.viscous, self.quadratic) != (0.0, 0.0, 0.0)

    @property
    def alone(self) -> Cylinder:
        """The one cylinder, whose axis is the engine's X.

        Raises
        ------
        NotServed : there are several, or it has a phase or a bank
        """
        cylinder, *others = self.cylinders
        if others or cylinder.phase or cylinder.bank:
            raise NotServed("written for one cylinder of phase 0 and bank 0")
        return cylinder


def job_of(scene: Scene, times: Array) -> Job:
    """The numbers of a scene.

    Raises
    ------
    NotServed : prescribed speed, a torque from a table
    """
    if scene.start is None:
        raise NotServed("a prescribed speed leaves the peers nothing to integrate")
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
    area, none = scene.piston.gas_area or 0.0, (np.array([0.0, scene.period]), np.zeros((4, 1)))
    gas = [(one.knots, area * one.coefficients) for one in pressures or ()]
    cylinders = [
        Cylinder(one.phase, one.bank, *(gas[k] if gas else none))
        for k, one in enumerate(scene.cylinders)
    ]
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
        cylinders=tuple(cylinders),
        constant=torque[Constant],
        viscous=torque[Viscous],
        quadratic=torque[Quadratic],
        theta=scene.start.angle,
        omega=scene.start.speed,
        times=times,
    )
