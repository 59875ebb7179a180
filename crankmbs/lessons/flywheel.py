"""The textbook formula of the flywheel, from a run at constant speed."""

from __future__ import annotations

import dataclasses

from crankmbs.design.flywheel import excess
from crankmbs.lessons.runs import changed
from crankmbs.measures import measure
from crankmbs.result import Result
from crankmbs.scene.drives import Motion
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["estimate", "held", "with_inertia"]


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


def estimate(result: Result) -> float:
    """The textbook's coefficient of fluctuation for the machine of a run."""
    work, energy = excess(held(result))
    return work / energy
