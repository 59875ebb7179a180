"""What a formula may ask for: the names of its parameters, and the value of each."""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from crankmbs.compare.bodies import Bodies, bodies_of
from crankmbs.compare.excerpt import Excerpt
from crankmbs.compare.quantities import cycle_angles
from crankmbs.errors import InputError
from crankmbs.mechanics.axes import gravity_vector
from crankmbs.mechanics.inertia import reduce
from crankmbs.numerics.arrays import Array

__all__ = ["WORDS", "Word", "Words"]


class Words:
    """The values of the words at the samples of a run.

    per_cylinder : for a quantity of the cylinder compared, of shape (n,); else for one of the whole
        engine, with shape (n, cylinders) of what every cylinder has
    """

    def __init__(self, excerpt: Excerpt, *, per_cylinder: bool) -> None:
        self._excerpt, self._per_cylinder = excerpt, per_cylinder
        self.scene, self.theta = excerpt.result.scene, excerpt.theta
        self.omega, self.alpha, self.mean = excerpt.omega, excerpt.alpha, excerpt.mean_speed
        self.reduced = reduce(excerpt.train, self.theta)

    def of_cylinder(self, curves: Array) -> Array:
        """The cylinder's column; for the whole engine all of them."""
        return curves[:, self._excerpt.cylinder - 1] if self._per_cylinder else curves

    def _curve(self, name: str) -> Array:
        """A variable that every cylinder has; zero where the scene has none of the kind."""
        zeros = np.zeros((len(self.theta), len(self.scene.cylinders)))
        return self.of_cylinder(self._excerpt.variables.get(name, zeros))

    @property
    def bodies(self) -> Bodies:
        """Lengths and masses of the cylinder, or of every one for the whole engine."""
        return bodies_of(self.scene, self._excerpt.cylinder if self._per_cylinder else None)

    def area(self, area: Array | float) -> Array | float | None:
        """An area; None where the scene has none."""
        return area if np.all(np.asarray(area) > 0.0) else None

    def gravity(self, axis: int) -> float:
        """Gravity along X (0) or Y (1), of the cylinder or, for the whole engine, of the engine."""
        cylinder = self.scene.cylinders[self._excerpt.cylinder - 1]
        return gravity_vector(self.scene, cylinder.bank if self._per_cylinder else 0.0)[axis]

    def __getitem__(self, name: str) -> Array | float:
        """The value of a word.

        Raises
        ------
        InputError : the scene has no such number
        """
        _, _, read, lacking = WORDS[name]
        if read is None:
            return self._curve(name)
        value: Array | float | None
        value = attrgetter(read)(self) if isinstance(read, str) else read(self)
        if value is None:
            raise InputError(
                f"{name}: {lacking}, so that no formula can ask for it; give the number itself in "
                "the formula"
            )
        return value


class Word(NamedTuple):
    """read : an attribute of `Words`, or what computes it from these; None of a variable of the
    result; lacking : why a scene may not have it."""

    units: str
    meaning: str
    read: str | Callable[[Words], Array | float | None] | None = None
    lacking: str = ""


WORDS = {
    "theta": Word("rad", "crank angle, unwrapped", "theta"),
    "phi": Word("rad", "cycle angle", lambda w: w.of_cylinder(cycle_angles(w.scene, w.theta))),
    "omega": Word("rad/s", "the run's crank speed", "omega"),
    "alpha": Word("rad/s^2", "the run's crank acceleration", "alpha"),
    "mean_omega": Word("rad/s", "mean of the crank speed over time", "mean"),
    "start_omega": Word(
        "rad/s",
        "crank speed of [start]",
        lambda w: None if w.scene.start is None else w.scene.start.speed,
        "the scene has no [start]",
    ),
    "gas_pressure": Word("Pa", "pressure of the head end less ambient"),
    "crank_end_pressure": Word("Pa", "pressure of the crank end less ambient"),
    "gas_force": Word("N", "gas force on the piston towards the crank"),
    "friction_force": Word("N", "wall's friction on the piston towards the crank"),
    "applied_force": Word("N", "force from outside on the piston towards the crank"),
    "reduced_inertia": Word("kg m^2", "J(theta), of the whole crank train", "reduced.inertia"),
    "reduced_slope": Word("kg m^2/rad", "dJ/dtheta", "reduced.slope"),
    "generalized_force": Word("N m", "of gas and weights on the crank", "reduced.torque"),
    "crank_radius": Word("m", "r", "bodies.crank_radius"),
    "crank_inertia": Word(
        "kg m^2",
        "about the crank axis, with the flywheel",
        "scene.crank.moment_of_inertia",
    ),
    "crank_mass": Word("kg", "of the crank", "scene.crank.mass"),
    "crank_center_of_mass": Word("m", "of the crank, from its axis", "scene.crank.center_of_mass"),
    "rod_length": Word("m", "l", "bodies.rod_length"),
    "rod_ratio": Word("1", "lambda = r/l", lambda w: w.bodies.crank_radius / w.bodies.rod_length),
    "rod_mass": Word("kg", "of the rod", "bodies.rod_mass"),
    "rod_center_of_mass": Word("m", "of the rod, from the crank pin", "bodies.rod_center_of_mass"),
    "rod_inertia": Word("kg m^2", "about the rod's centre of mass", "bodies.rod_inertia"),
    "piston_mass": Word("kg", "of the piston", "bodies.piston_mass"),
    "piston_area": Word(
        "m^2",
        "of the piston",
        lambda w: w.area(w.bodies.piston_area),
        "the scene has neither piston.bore nor piston.area",
    ),
    "crank_end_area": Word(
        "m^2",
        "of the piston less the piston rod's",
        lambda w: w.area(w.bodies.crank_end_area),
        "the scene has neither piston.bore nor piston.area",
    ),
    "offset": Word("m", "e, of the cylinder axis in +Y", "bodies.offset"),
    "reciprocating_mass": Word(
        "kg",
        "piston, and the rod's mass at its pin",
        lambda w: w.bodies.piston_mass + w.bodies.masses.piston_pin,
    ),
    "rod_crank_pin_mass": Word("kg", "the rod's mass at the crank pin", "bodies.masses.crank_pin"),
    "gravity_x": Word("m/s^2", "gravity along X", lambda w: w.gravity(0)),
    "gravity_y": Word("m/s^2", "gravity along Y", lambda w: w.gravity(1)),
    "cylinders": Word("1", "how many there are", lambda w: len(w.scene.cylinders)),
}
"""The words by name; SI units, all angles in rad. Curves are of shape (n,), one value a sample; of
phi, gas and friction a formula of the whole engine gets shape (n, cylinders)."""
