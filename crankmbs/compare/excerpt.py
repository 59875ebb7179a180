"""The samples of a run that are compared: those of its last cycle, for one cylinder."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.compare.bodies import bodies_of
from crankmbs.compare.lectured import Formulas, lectured
from crankmbs.compare.quantities import OBSERVABLES, cycle_angles, observed, variable_of
from crankmbs.compare.size import Size, size_of
from crankmbs.errors import InputError
from crankmbs.measures import Span, last_span
from crankmbs.mechanics.peaks import negligible
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.mechanics.variables import EVERY
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result
from crankmbs.scene.scene import Scene

__all__ = ["Answer", "Excerpt", "LeftOut", "at_fold", "check_comparable", "excerpt_of", "vanishing"]

Answer = dict[str, Array]

_FOLD = 0.01  # cosine of the rod angle; below it the formulas lose digits with its third power


class LeftOut(NamedTuple):
    """A quantity that could not be compared with a reference, or split into a cause, and why."""

    quantity: str
    what: str
    reason: str


@dataclass(frozen=True)
class Excerpt:
    """The samples of a run's last whole cycle (or revolution, or the run), and one cylinder.

    samples : shape (m,), their indices; those within 0.6 degrees of a rod square to its
        cylinder, where it folds onto the crank and the formulas lose their digits, are left out
    variables : of the run by their names in `crankmbs.result.VARIABLES`, shape (n,) or
        (n, cylinders); where they are, and between them, once points there have been added
    mean_speed [rad/s] : time mean
    cylinder : number of the one that is compared
    others : further variables of the result to compare, by their names in OBSERVABLES
    """

    result: Result
    window: Span
    cylinder: int
    samples: NDArray[np.intp]
    variables: Answer
    mean_speed: float
    train: CrankTrain
    others: tuple[str, ...] = ()

    @property
    def theta(self) -> Array:
        """Crank angle [rad], shape (n,)."""
        return self.variables["crank_angle"]

    @property
    def omega(self) -> Array:
        """Crank speed [rad/s], shape (n,)."""
        return self.variables["crank_speed"]

    @property
    def alpha(self) -> Array:
        """Crank acceleration [rad/s2], shape (n,)."""
        return self.variables["crank_acceleration"]

    def simulated(self) -> Answer:
        """The run's values, in the lectures' quantities."""
        return self.quantities(self.variables, self.omega, self.alpha)

    def newton_euler(self, scene: Scene, *, constant_speed: bool = False) -> Answer:
        """The exact closed form at the run's theta, at its speed or the mean of it; ``scene`` may
        differ. The applied forces on the pistons are the run's."""
        omega, alpha = self._speeds(constant_speed)
        loads = {}
        if scene.force:
            loads["applied_force"] = self.variables["applied_force"]
        train = replace(self.train, scene=scene)
        variables = reactions(train, self.theta, omega, alpha, loads)
        return self.quantities(variables, omega, alpha)

    def lecture(self, formulas: Formulas, *, constant_speed: bool) -> Answer:
        """The lectures' formulas at the run's theta, at its speed or the mean of it."""
        omega, alpha = self._speeds(constant_speed)
        return self._of_cylinder(lectured(formulas, self.train, self.theta, omega, alpha))

    def angles(self, quantity: str) -> Array:
        """Cycle angle of the cylinder; for quantities of the whole engine the crank angle [rad]."""
        if not OBSERVABLES[quantity].per_cylinder:
            return self.theta
        return self.theta + self.result.scene.cylinders[self.cylinder - 1].phase

    def size(self, quantity: str, curve: Array) -> Size:
        """Maximum and RMS of a curve over these points."""
        return size_of(curve, self.angles(quantity), self.result.scene.period)

    def _speeds(self, constant_speed: bool) -> tuple[Array, Array]:
        """omega and alpha: the run's, or its mean speed and 0."""
        if not constant_speed:
            return self.omega, self.alpha
        zeros = np.zeros_like(self.alpha)
        return zeros + self.mean_speed, zeros

    def quantities(self, variables: Answer, omega: Array, alpha: Array) -> Answer:
        """Those of the variables of a result at theta, omega and alpha."""
        scene = self.result.scene
        phi = cycle_angles(scene, self.theta)
        answer = observed(bodies_of(scene), variables, phi, omega, alpha)
        further = {name: variable_of(name) for name in self.others}
        answer |= {name: variables[of] for name, of in further.items() if of in variables}
        return self._of_cylinder(answer)

    def _of_cylinder(self, answer: Answer) -> Answer:
        """The curves of the cylinder compared and of the whole engine, without those left out."""
        missing = self.left_out()
        return {
            name: curve[:, self.cylinder - 1] if OBSERVABLES[name].per_cylinder else curve
            for name, curve in answer.items()
            if name not in missing
        }

    def left_out(self) -> dict[str, str]:
        """Quantities that this run lacks, and why."""
        if self.train.pressure is None:
            return {"gas torque": "the scene has no gas"}
        return {}

    def lacks(self, quantity: str) -> str:
        """Why the run has none of a quantity."""
        return self.left_out().get(quantity, "the run has none")


def at_fold(rod_angle: Array) -> NDArray[np.bool_]:
    """Where any rod is at its fold, from rod angles of shape (n, cylinders) [rad]."""
    return np.asarray(np.min(np.cos(rod_angle), axis=1) < _FOLD)


def vanishing(answers: Iterable[Answer]) -> dict[str, str]:
    """Quantities that are zero to rounding in every answer, and why they are left out."""
    peaks: dict[str, float] = {}
    for answer in answers:
        for name, curve in answer.items():
            peaks[name] = max(peaks.get(name, 0.0), float(np.max(np.abs(curve))))
    zero = negligible(peaks, {name: OBSERVABLES[name].units for name in peaks})
    return {name: "it is zero but for rounding" for name in peaks if name in zero}


def check_comparable(scene: Scene, cylinder: int) -> None:
    """Raise InputError where formulas cannot be compared: the scene has no cylinder of this number,
    counted from 1, or it has [fuel]."""
    count = len(scene.cylinders)
    if not 1 <= cylinder <= count:
        raise InputError(f"cylinder must be from 1 to {count}; {cylinder} came")
    if scene.fuel is not None:
        raise InputError(
            "fuel: the formulas of the lectures know one pressure for all firings; remove [fuel] "
            "to compare with them"
        )


def excerpt_of(result: Result, cylinder: int, others: tuple[str, ...] = ()) -> Excerpt:
    """The last cycle of a run for a cylinder, counted from 1; ``others`` as in `Excerpt`.

    Raises
    ------
    InputError : no such cylinder, a scene with fuel, or every sample at a fold
    """
    check_comparable(result.scene, cylinder)
    window = last_span(result)
    folded = at_fold(result.data["rod_angle"].values)
    samples = np.flatnonzero(~folded[window.inside :]) + window.inside
    if len(samples) == 0:
        raise InputError("the rod is folded onto the crank all the time: nothing can be compared")
    data = result.variables
    names = [name for name in EVERY if name in data and name != "energy_residual"]
    variables = {name: np.asarray(data[name][1][samples]) for name in names}
    mean = variables["crank_speed"][-1]
    if window.duration > 0.0:
        mean = window.angle / window.duration
    train = crank_train(result.scene)
    return Excerpt(result, window, cylinder, samples, variables, float(mean), train, others)
