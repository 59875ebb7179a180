"""The numbers of crank, rod and piston as the lectures' formulas take them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.lecture import two_mass_rod
from crankmbs.lecture.masses import TwoMassRod
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["Bodies", "bodies_of"]


class Bodies(NamedTuple):
    """In SI units: one number of all cylinders, or shape (cylinders,) where they are unlike.

    rod_center_of_mass, rod_inertia : from the crank pin and about itself
    piston_area, crank_end_area : of both ends; 0 where the scene has none
    """

    crank_radius: Array | float
    rod_length: Array | float
    offset: Array | float
    rod_mass: Array | float
    rod_center_of_mass: Array | float
    rod_inertia: Array | float
    piston_mass: Array | float
    piston_area: Array | float
    crank_end_area: Array | float

    @property
    def lengths(self) -> dict[str, Array | float]:
        """What the kinematics of a cylinder depend on [m], as the lectures' formulas take it."""
        return {name: getattr(self, name) for name in ("crank_radius", "rod_length", "offset")}

    @property
    def masses(self) -> TwoMassRod:
        """The rod as two masses."""
        return two_mass_rod(
            rod_mass=self.rod_mass,
            rod_length=self.rod_length,
            center_of_mass=self.rod_center_of_mass,
        )


def bodies_of(scene: Scene, cylinder: int | None = None) -> Bodies:
    """The numbers of every cylinder, or those of one by its number.

    >>> bodies_of(load_scene("propeller")).crank_radius
    0.046
    """
    cylinders = []
    for radius, rod, piston in scene.running_gear:
        gear_and_rod = radius, rod.length, piston.offset, rod.mass, rod.center_of_mass
        areas = piston.gas_area or 0.0, piston.crank_end_area if piston.gas_area else 0.0
        cylinders.append((*gear_and_rod, rod.moment_of_inertia, piston.mass, *areas))
    if cylinder is not None or not scene.unlike:
        return Bodies(*cylinders[(cylinder or 1) - 1])
    return Bodies(*np.array(cylinders).T)
