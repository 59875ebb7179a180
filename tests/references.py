"""The true error of a result, variable by variable, against the oracles' motion at its samples."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs import Result, Scene
from validation.adapter import machine_of, reference_motion, reference_variables
from validation.oracles.free_motion import free_motion

__all__ = [
    "FLOOR",
    "Errors",
    "Reference",
    "assert_within_stated",
    "reference_at_angles",
    "reference_of",
    "true_errors",
    "worst_ratio",
]

Array = NDArray[np.float64]

FLOOR = 2e-11  # of a variable's peak: below it no statement about errors is asked for


class Reference(NamedTuple):
    """The exact motion at the samples of a run, shape (n,) each."""

    time: Array
    theta: Array
    omega: Array
    alpha: Array


class Errors(NamedTuple):
    """Of one variable: its largest true error, the stated one, its peak."""

    true: float
    stated: float
    peak: float

    @property
    def ratio(self) -> float:
        """True error over the stated one, which need not be below the floor."""
        least = max(self.stated, FLOOR * self.peak)
        return self.true / least if least else 0.0


def reference_of(result: Result, samples: slice = slice(None)) -> Reference:
    """The oracle's free motion at the samples of a result: at equal times, or where they lie on
    crank angles at equal angles."""
    motion = reference_motion(result)
    columns = (motion.time, motion.theta, motion.omega, motion.alpha)
    return Reference(*(np.asarray(column, dtype=float)[samples] for column in columns))


def reference_at_angles(scene: Scene, angles: Array) -> Reference:
    """The oracles' free motion at crank angles that it passes one after the other without a
    reversal; the first is where it starts."""
    assert scene.start is not None
    motion = free_motion(
        machine_of(scene), scene.start.angle, scene.start.speed, angles=angles.tolist()
    )
    return Reference(motion.time, motion.theta, motion.omega, motion.alpha)


def true_errors(
    result: Result, reference: Reference, samples: NDArray[np.intp] | None = None
) -> dict[str, Errors]:
    """Every variable of the result against the reference, at the samples of these numbers; without
    them at the first ones.

    A sample on a crank angle errs in the time at which it is passed; the error of the crank angle
    itself is the one at equal time.
    """
    data = result.data.isel(time=slice(len(reference.time)) if samples is None else samples)
    exact = reference_variables(result.scene, reference.theta, reference.omega, reference.alpha)
    exact |= {
        "time": reference.time,
        "crank_speed": reference.omega,
        "crank_acceleration": reference.alpha,
    }
    errors = {name: np.abs(data[name].values - exact[name].astype(float)) for name in exact}
    late = data["time"].values - reference.time
    ahead = data["crank_angle"].values - reference.theta
    errors["crank_angle"] = np.abs(ahead - reference.omega * late - 0.5 * reference.alpha * late**2)
    peaks = {name: float(np.abs(data[name].values).max()) for name in errors}
    # the oracle finds it as what is left of all other torques
    peaks["external_torque"] = max(peaks["external_torque"], peaks["crank_torque"])
    return {
        name: Errors(float(error.max()), float(data[name].attrs["error_estimate"]), peaks[name])
        for name, error in errors.items()
    }


def worst_ratio(result: Result) -> float:
    """The worst true over stated error of a free motion, against the oracle at its times."""
    return max(errors.ratio for errors in true_errors(result, reference_of(result)).values())


def assert_within_stated(result: Result, exact: Result) -> None:
    """No variable differs from that of a far more exact run by over twice its stated error."""
    for name, variable in result.data.variables.items():
        if name not in ("cylinder", "energy_residual"):
            off = np.max(np.abs(variable.values - exact.data[name].values))
            peak = np.max(np.abs(variable.values))
            assert off <= 2.0 * variable.attrs["error_estimate"] + 1e-11 * peak, name
