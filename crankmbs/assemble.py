"""From the motion that a formulation gives to labelled variables, each with its error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.formulations.base import Array, Samples, Solution
from crankmbs.inertia import reduce
from crankmbs.pressure import PeriodicPressure
from crankmbs.reactions import reactions
from crankmbs.result import VARIABLES
from crankmbs.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Assembled", "assemble", "dataset"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # of a variable's peak: what the formulas round
_NOTHING = 1e-9  # of the largest variable of the same unit: zero but for rounding
_ANGLE_ROUNDING = 2 * float(np.finfo(float).eps)  # of the crank angle


class Assembled(NamedTuple):
    """A solution, every variable of the result at its samples, and a bound for its error."""

    solution: Solution
    variables: dict[str, Array]
    errors: dict[str, float]

    @property
    def relative_error(self) -> float:
        """The worst relative error: of the crank angle per radian turned, of each other variable
        relative to its peak."""
        return _relative_error(self.variables, self.errors)


def assemble(scene: Scene, pressure: PeriodicPressure | None, solution: Solution) -> Assembled:
    """Every variable of a result at the samples, and a bound for its largest error.

    The error is the difference between the answer and the better one of the solution, to which
    the rounding of the crank angle is added, propagated through the same formulas; where the
    formulation states its own errors they are taken.
    """
    variables = _variables(scene, pressure, solution.samples)
    if solution.errors:
        return Assembled(solution, variables, dict(solution.errors))
    better = solution.better or solution.samples
    rounding = better.theta * _ANGLE_ROUNDING
    rounded = Samples(
        better.time,
        better.theta + rounding,
        better.omega + _speed_change(better, rounding),
        better.alpha,
        better.energy_residual,
    )
    check = _variables(scene, pressure, rounded)
    needed = check["external_torque"]
    check |= better.own
    errors = {
        name: float(np.max(np.abs(values - check[name]))) + _ROUNDING * _peak(values)
        for name, values in variables.items()
    }
    # a free crank's acceleration at the rounded angle: where the torque needed is the one there
    missed = np.max(np.abs(check["external_torque"] - needed))
    errors["crank_acceleration"] += float(missed / np.min(reduce(scene, None, better.theta)[0]))
    late = better.time - solution.samples.time
    ahead = better.theta - solution.samples.theta - solution.samples.omega * late
    turned = float(np.max(np.abs(variables["crank_angle"]), initial=0.0))
    errors["crank_angle"] = float(np.max(np.abs(ahead))) + _ROUNDING * turned
    errors["energy_residual"] = _ROUNDING * _peak(variables["kinetic_energy"]) + float(
        np.max(np.abs(solution.samples.energy_residual - better.energy_residual))
    )
    return Assembled(solution, variables, errors)


def _speed_change(samples: Samples, ahead: Array) -> Array:
    """What the speed changes by while the crank turns ahead by an angle; near rest 0."""
    speed = np.abs(samples.omega)
    steep = np.zeros_like(speed)
    np.divide(samples.alpha, samples.omega, out=steep, where=speed > 0.01 * np.max(speed))
    return np.asarray(steep * ahead)


def _relative_error(variables: Mapping[str, Array], errors: Mapping[str, float]) -> float:
    """The worst relative error: of the crank angle per radian turned, of each other variable
    relative to its peak.

    The energy residual is a check and does not count; nor does a variable that is zero but for
    rounding, against the others of its unit.
    """
    angle = variables["crank_angle"]
    if np.ptp(angle) == 0.0:  # nothing moved, nothing was integrated
        return 0.0
    peaks = {name: _peak(values) for name, values in variables.items()}
    peaks["crank_angle"] = float(np.max(np.abs(angle - angle[0])))
    largest: dict[str, float] = {}
    for name, peak in peaks.items():
        unit = VARIABLES[name].units
        largest[unit] = max(largest.get(unit, 0.0), peak)
    ratios = [
        errors[name] / peak
        for name, peak in peaks.items()
        if name != "energy_residual" and peak > _NOTHING * largest[VARIABLES[name].units]
    ]
    return max(ratios, default=0.0)


def dataset(assembled: Assembled) -> xr.Dataset:
    """Label the variables with dimensions, units, long names and error estimates."""
    import xarray as xr

    _, variables, errors = assembled

    def labelled(name: str) -> xr.Variable:
        about = VARIABLES[name]
        attrs = {
            "units": about.units,
            "long_name": about.long_name,
            "error_estimate": errors[name],
        }
        dims = ("time", "cylinder") if about.per_cylinder else ("time",)
        return xr.Variable(dims, variables[name], attrs)

    cylinders = np.arange(1, variables["side_force"].shape[1] + 1)
    coordinates = {name: labelled(name) for name in ("time", "crank_angle")}
    number = xr.Variable("cylinder", cylinders, {"long_name": "cylinder number"})
    return xr.Dataset(
        {name: labelled(name) for name in VARIABLES if name not in coordinates},
        coords={**coordinates, "cylinder": number},
    )


def _variables(
    scene: Scene, pressure: PeriodicPressure | None, samples: Samples
) -> dict[str, Array]:
    return {
        "time": samples.time,
        "crank_angle": samples.theta,
        "crank_speed": samples.omega,
        "crank_acceleration": samples.alpha,
        "energy_residual": samples.energy_residual,
        **reactions(scene, pressure, samples.theta, samples.omega, samples.alpha),
        **samples.own,
    }


def _peak(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))
