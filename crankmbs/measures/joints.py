"""Magnitudes of every joint's force over a window: largest value and mean over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crankmbs.measures.estimate import Estimate
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Joint", "JointForce", "joints_of"]


@dataclass(frozen=True)
class JointForce:
    """Magnitude of one joint's force over the window.

    joint : "main bearing", "crank pin", "piston pin" or "side force"
    cylinder : its number; None for the main bearing, which carries all of them
    peak [N] : largest value, between the samples too; crank_angle [rad], unwrapped, and cycle_angle
        [rad] of its cylinder say where that is
    mean [N] : over time
    """

    joint: str
    cylinder: int | None
    peak: Estimate
    mean: Estimate
    crank_angle: float
    cycle_angle: float | None


class Joint(NamedTuple):
    """A joint, the variables of its force, and its cylinder's number."""

    joint: str
    variables: tuple[str, ...]
    cylinder: int | None

    def force(self, variables: Mapping[str, Array]) -> Array:
        """Its components at points, shape (2, p) [N]; of the side force the second is zero."""
        columns = [variables[name] for name in self.variables]
        if self.cylinder is not None:
            columns = [column[:, self.cylinder - 1] for column in columns]
        return np.array([*columns, np.zeros_like(columns[0])][:2])

    def labelled(self, scene: Scene, peak: Estimate, mean: Estimate, angle: float) -> JointForce:
        """With its numbers; angle : of the crank where the peak is [rad]."""
        cycle_angle = None
        if self.cylinder is not None:
            cycle_angle = (angle + scene.cylinders[self.cylinder - 1].phase) % scene.period
        return JointForce(self.joint, self.cylinder, peak, mean, angle, cycle_angle)


def joints_of(scene: Scene) -> tuple[Joint, ...]:
    """The joints of a scene, from the main bearing up.

    >>> [joint.joint for joint in joints_of(load_scene("propeller"))]
    ['main bearing', 'crank pin', 'piston pin', 'side force']
    """
    numbers = range(1, len(scene.cylinders) + 1)
    joints = [Joint("main bearing", ("main_bearing_force_x", "main_bearing_force_y"), None)]
    for joint in ("crank pin", "piston pin"):
        stem = joint.replace(" ", "_")
        joints += [Joint(joint, (f"{stem}_force_x", f"{stem}_force_y"), k) for k in numbers]
    return (*joints, *(Joint("side force", ("side_force",), k) for k in numbers))
