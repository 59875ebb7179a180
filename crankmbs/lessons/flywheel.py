"""The textbook formula of the flywheel, from a run at constant speed."""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.integrate import cumulative_simpson

from crankmbs.lessons.runs import changed
from crankmbs.measures import measure
from crankmbs.result import Result
from crankmbs.scene.drives import Motion
from crankmbs.scene.scene import Extent, Scene
from crankmbs.simulate import simulate

__all__ = ["estimate", "excess", "held", "with_inertia"]


def with_inertia(scene: Scene, inertia: float) -> Scene:
    """The scene with another inertia [kg m2] of crank and flywheel."""
    return changed(scene, crank={"inertia": inertia})


def held(result: Result) -> Result:
    """One cycle of the same machine at the constant mean speed of a run."""
    run = dataclasses.replace(result.scene.run, until=Extent(value=1.0, unit="cycle"))
    motion = Motion(speed=measure(result).mean_speed.value)
    return simulate(
        dataclasses.replace(result.scene, start=None, torque=(), motion=motion, run=run)
    )


def excess(even: Result) -> tuple[float, float]:
    """(W [J], J omega^2 [J]) of the textbook formula, from a run at constant speed."""
    angle = even.data["crank_angle"].values
    work = cumulative_simpson(even.data["crank_torque"].values.sum(axis=1), x=angle, initial=0.0)
    surplus = work - work[-1] * (angle - angle[0]) / (angle[-1] - angle[0])
    return float(np.ptp(surplus)), 2.0 * float(even.data["kinetic_energy"].values.mean())


def estimate(result: Result) -> float:
    """The textbook's coefficient of fluctuation for the machine of a run."""
    work, energy = excess(held(result))
    return work / energy
