"""From the motion that a formulation gives to labelled variables, each with its error."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.formulations.base import Array, Samples, Solution
from crankmbs.inertia import reduce
from crankmbs.pressure import PeriodicPressure
from crankmbs.reactions import reactions
from crankmbs.result import VARIABLES
from crankmbs.sampling import one_period
from crankmbs.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ANGLE_ROUNDING", "Assembled", "assemble", "dataset"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # of a variable's peak: what the formulas round
_NOTHING = 1e-9  # of the largest variable of the same unit: zero but for rounding
_FEW = 32  # samples: among more there is one where nothing cancels
ANGLE_ROUNDING = 2 * float(np.finfo(float).eps)  # of the crank angle


class Assembled(NamedTuple):
    """A solution, every variable of the result at its samples, its largest absolute value there,
    and a bound for its error."""

    solution: Solution
    variables: dict[str, Array]
    peaks: dict[str, float]
    errors: dict[str, float]

    @property
    def relative_error(self) -> float:
        """The worst relative error: of the crank angle per radian turned, of each other variable
        relative to its peak.

        The energy residual is a check and does not count; nor does a variable that is zero but for
        rounding, against the others of its unit.
        """
        angle = self.variables["crank_angle"]
        turned = _peak(angle - angle[0])
        if turned == 0.0:  # nothing moved, nothing was integrated
            return 0.0
        peaks = self.peaks | {"crank_angle": turned}
        largest: dict[str, float] = {}
        for name, peak in peaks.items():
            unit = VARIABLES[name].units
            largest[unit] = max(largest.get(unit, 0.0), peak)
        ratios = [
            self.errors[name] / peak
            for name, peak in peaks.items()
            if name != "energy_residual" and peak > _NOTHING * largest[VARIABLES[name].units]
        ]
        return max(ratios, default=0.0)


def assemble(scene: Scene, pressure: PeriodicPressure | None, solution: Solution) -> Assembled:
    """Every variable of a result at the samples, and a bound for its largest error.

    The error is the difference between the answer and the better one of the solution, to which
    the rounding of the crank angle is added, propagated through the same formulas; where the
    formulation states its own errors they are taken. At a few samples the differences of angle,
    speed and acceleration may cancel in a variable by chance: there what each makes is added up.
    So may two passes agree in the angle by chance at an end in time, the only sample whose angle
    errs where the others are at angles: it is taken to err as it does, or as much as in the last
    revolution, whichever makes more.
    """
    variables = _variables(scene, pressure, solution.samples)
    peaks = {name: _peak(values) for name, values in variables.items()}
    if solution.errors:
        return Assembled(solution, variables, peaks, dict(solution.errors))
    better = solution.better or solution.samples
    late = better.time - solution.samples.time
    ahead = better.theta - solution.samples.theta - solution.samples.omega * late
    rounding = ANGLE_ROUNDING * _peak(better.theta)
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
    chain = [variables, check]
    if len(better.time) <= _FEW:
        turned = replace(solution.samples, theta=rounded.theta)
        faster = replace(turned, omega=rounded.omega)
        chain[1:1] = [_variables(scene, pressure, samples) for samples in (turned, faster)]
    errors = {
        name: sum(_peak(a[name] - b[name]) for a, b in pairwise(chain)) + _ROUNDING * peak
        for name, peak in peaks.items()
    }
    # a free crank's acceleration at the rounded angle: where the torque needed is the one there
    missed = _peak(check["external_torque"] - needed)
    if late.any() and late[-1] == 0.0 != ahead[-1]:  # else it ends at an angle, at the same time
        recent = ahead[np.abs(better.theta - better.theta[-1]) <= 2.0 * math.pi]
        more = math.copysign(_peak(recent) - abs(ahead[-1]), ahead[-1])
        last = rounded.select(np.array([-1]))
        end = _variables(scene, pressure, replace(last, theta=last.theta + more))
        missed = max(missed, _peak(check["external_torque"][-1:] - end["external_torque"]))
        for name in errors.keys() - better.own.keys():
            most = _peak(variables[name][-1:] - end[name]) + _ROUNDING * peaks[name]
            errors[name] = max(errors[name], most)
    least = np.min(reduce(scene, None, one_period(better.theta, scene.period)[0])[0])
    errors["crank_acceleration"] += missed / float(least)
    errors["crank_angle"] = _peak(ahead) + _ROUNDING * peaks["crank_angle"]
    # in the true motion the energy gained is the work done
    errors["energy_residual"] = peaks["energy_residual"] + _ROUNDING * peaks["kinetic_energy"]
    return Assembled(solution, variables, peaks, errors)


def _speed_change(samples: Samples, ahead: float) -> Array:
    """What the speed changes by while the crank turns ahead by an angle; near rest 0."""
    speed = np.abs(samples.omega)
    steep = np.zeros_like(speed)
    np.divide(samples.alpha, samples.omega, out=steep, where=speed > 0.01 * np.max(speed))
    return np.asarray(steep * ahead)


def dataset(assembled: Assembled) -> xr.Dataset:
    """Label the variables with dimensions, units, long names and error estimates."""
    import xarray as xr

    variables, errors = assembled.variables, assembled.errors

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
    return max(float(values.max(initial=0.0)), -float(values.min(initial=0.0)))
