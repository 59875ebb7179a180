"""Magnitudes of every joint's force over a window: largest value and mean over time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crankmbs.measures.estimate import Estimate
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Joint", "JointForce", "joints_of", "kinds_of", "shell_area"]


@dataclass(frozen=True)
class JointForce:
    """Magnitude of one joint's force over the window.

    joint : "main bearing", "crank pin", "piston pin", "side force"; with bearings "main journal",
        and "shared pin" where two rods share one
    cylinder : its number; None for the main bearing, which carries all of them, and for journals
    number : of the joint among its like; None of the main bearing
    area [m2] : over which its specific load is taken; None without a shell
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
    number: int | None = None
    area: float | None = None

    @property
    def specific_peak(self) -> Estimate | None:
        """Peak over diameter times width [Pa]; None without a shell."""
        return None if self.area is None else Estimate(*(x / self.area for x in self.peak))

    @property
    def specific_mean(self) -> Estimate | None:
        """Mean over diameter times width [Pa]; None without a shell."""
        return None if self.area is None else Estimate(*(x / self.area for x in self.mean))


class Joint(NamedTuple):
    """A joint and the variables of its force; of : what it is one of, "cylinder", "journal" or
    "pin", and its number among those; nothing of the main bearing."""

    joint: str
    variables: tuple[str, ...]
    of: str = ""
    number: int | None = None

    def force(self, variables: Mapping[str, Array]) -> Array:
        """Its components at points, shape (2, ..., p) [N]; of the side force the second is
        zero."""
        columns = [variables[name] for name in self.variables]
        if self.number is not None:
            columns = [column[..., self.number - 1] for column in columns]
        return np.array([*columns, np.zeros_like(columns[0])][:2])

    @property
    def cylinder(self) -> int | None:
        """The number of its cylinder; None where it is none's."""
        return self.number if self.of == "cylinder" else None


def joints_of(scene: Scene) -> tuple[Joint, ...]:
    """The joints of a scene, from the main bearing up, then its journals and shared pins.

    >>> [joint.joint for joint in joints_of(load_scene("propeller"))]
    ['main bearing', 'crank pin', 'piston pin', 'side force']
    """
    joints = [Joint("main bearing", _components("main_bearing_force"))]
    cylinders, throws = len(scene.cylinders), scene.throws
    joints += _alike("crank pin", _components("crank_pin_force"), "cylinder", cylinders)
    joints += _alike("piston pin", _components("piston_pin_force"), "cylinder", cylinders)
    joints += _alike("side force", ("side_force",), "cylinder", cylinders)
    if throws is not None:
        count = len(throws.rods)
        joints += _alike("main journal", _components("main_journal_force"), "journal", count)
        if throws.shared:
            joints += _alike("shared pin", _components("pin_force"), "pin", count - 1)
    return tuple(joints)


class Kind(NamedTuple):
    """Joints of one name: what each is one of, and their places among all."""

    joint: str
    of: str
    rows: slice

    @property
    def key(self) -> str:
        """How its measures are named."""
        return self.joint.replace(" ", "_")


def kinds_of(scene: Scene) -> list[Kind]:
    """The kinds of joints of a scene, in the order of `joints_of`.

    >>> [kind.rows.stop for kind in kinds_of(load_scene("v_twin"))]
    [1, 3, 5, 7]
    """
    kinds, begin = [], 0
    for (joint, of), count in Counter((each.joint, each.of) for each in joints_of(scene)).items():
        kinds.append(Kind(joint, of, slice(begin, begin + count)))
        begin += count
    return kinds


def _components(name: str) -> tuple[str, str]:
    return f"{name}_x", f"{name}_y"


def _alike(joint: str, variables: tuple[str, ...], of: str, count: int) -> list[Joint]:
    return [Joint(joint, variables, of, number) for number in range(1, count + 1)]


def shell_area(scene: Scene, joint: str) -> float | None:
    """Projected area of the shell of a joint [m2], if it has one.

    >>> shell_area(load_scene("propeller"), "crank pin") is None
    True
    """
    bearings = scene.bearings
    if bearings is None:
        return None
    shell = {"crank pin": bearings.crank_pin, "main journal": bearings.main_journal}.get(joint)
    return None if shell is None else shell.area
