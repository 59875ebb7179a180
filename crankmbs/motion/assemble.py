"""From the motion that a formulation gives to labelled variables, each with its error."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.mechanics.reactions import deviations, reactions
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import SUMS, VARIABLES
from crankmbs.motion.base import Samples, Solution
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import one_period

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ANGLE_ROUNDING", "Assembled", "assemble", "dataset"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # of a variable's peak: what the formulas round
_NOTHING = 1e-9  # of the largest variable of the same unit: zero but for rounding
_UNASKED = SUMS | {"energy_residual"}
_FEW = 32  # samples: among more there is one where nothing cancels
ANGLE_ROUNDING = 2 * float(np.finfo(float).eps)  # of the crank angle


class Assembled(NamedTuple):
    """A solution, every variable of the result at its samples, its largest absolute value there,
    and an estimate of its error."""

    solution: Solution
    variables: dict[str, Array]
    peaks: dict[str, float]
    errors: dict[str, float]

    @property
    def relative_error(self) -> float:
        """The worst relative error: of the crank angle per radian turned, of each other variable
        relative to its peak.

        The energy residual is a check and does not count, nor do sums in which the cylinders may
        cancel; nor does a variable that is zero but for rounding, against the others of its unit.
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
            if name not in _UNASKED and peak > _NOTHING * largest[VARIABLES[name].units]
        ]
        return max(ratios, default=0.0)


def assemble(train: CrankTrain, solution: Solution) -> Assembled:
    """Every variable of a result at the samples, and an estimate of its largest error.

    The error is the difference between the answer and the better one of the solution, to which
    the rounding of the crank angle is added, propagated through the same formulas; where the
    formulation states its own errors they are taken. At a few samples the differences of angle,
    speed and acceleration may cancel in a variable by chance: there what each makes is added up.
    So may two passes agree in the angle by chance at an end in time, the only sample whose angle
    errs where the others are at angles: it is taken to err as it does, or as much as in the last
    revolution, whichever makes more.
    """
    variables = _variables(train, solution.samples)
    peaks = {name: _peak(values) for name, values in variables.items()}
    if solution.errors:
        return Assembled(solution, variables, peaks, dict(solution.errors))
    answer, better = solution.samples, solution.better or solution.samples
    off = train.off  # the better answer's
    late = better.time - answer.time
    ahead = better.theta - answer.theta - answer.omega * late
    rounding = ANGLE_ROUNDING * _peak(better.theta)
    rounded = replace(
        better,
        theta=better.theta + rounding,
        omega=better.omega + _speed_change(better, rounding),
    )
    chain = [rounded]
    if len(better.time) <= _FEW:
        turned = replace(answer, theta=rounded.theta)
        chain[:0] = [turned, replace(turned, omega=rounded.omega)]
    errors = {name: _ROUNDING * size for name, size in _sizes(peaks).items()}
    before, missed = variables, 0.0
    for samples in chain:
        motion = (samples.theta, samples.omega, samples.alpha)
        apart = deviations(off, *motion, {**before, **samples.own})
        # a free crank's acceleration at the rounded angle: where the torque needed is the one there
        missed = apart["external_torque"] if samples.own else 0.0
        given = {**_motion(samples), **samples.own}
        apart |= {name: _peak(before[name] - values) for name, values in given.items()}
        errors = {name: error + apart[name] for name, error in errors.items()}
        if samples is not rounded:
            before = _variables(off, samples)
    if late.any() and late[-1] == 0.0 != ahead[-1]:  # else it ends at an angle, at the same time
        recent = ahead[np.abs(better.theta - better.theta[-1]) <= 2.0 * math.pi]
        more = math.copysign(_peak(recent) - abs(ahead[-1]), ahead[-1])
        last = replace(rounded, own={}).select(np.array([-1]))
        end = _variables(off, replace(last, theta=last.theta + more))
        if better.own:
            there = better.own["external_torque"][-1:]
            missed = max(missed, _peak(there - end["external_torque"]))
        for name in errors.keys() - better.own.keys():
            most = _peak(variables[name][-1:] - end[name]) + _ROUNDING * peaks[name]
            errors[name] = max(errors[name], most)
    if missed:  # of a free crank, which has inertia at every angle; a driven one may have none
        least = np.min(inertia_alone(train.scene, one_period(better.theta, train.scene.period)[0]))
        errors["crank_acceleration"] += missed / float(least)
    errors["crank_angle"] = _peak(ahead) + _ROUNDING * peaks["crank_angle"]
    # in the true motion the energy gained is the work done
    errors["energy_residual"] = peaks["energy_residual"] + _ROUNDING * peaks["kinetic_energy"]
    return Assembled(solution, variables, peaks, errors)


def _sizes(peaks: dict[str, float]) -> dict[str, float]:
    """What of each variable is rounded: its peak; of sums that may cancel the largest of a unit."""
    largest: dict[str, float] = {}
    for name, peak in peaks.items():
        unit = VARIABLES[name].units
        largest[unit] = max(largest.get(unit, 0.0), peak)
    return {n: largest[VARIABLES[n].units] if n in SUMS else p for n, p in peaks.items()}


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
        return xr.Variable(about.dims, variables[name], attrs)

    cylinders = np.arange(1, variables["side_force"].shape[1] + 1)
    coordinates = {name: labelled(name) for name in ("time", "crank_angle")}
    number = xr.Variable("cylinder", cylinders, {"long_name": "cylinder number"})
    return xr.Dataset(
        {name: labelled(name) for name in VARIABLES if name in variables.keys() - coordinates},
        coords={**coordinates, "cylinder": number},
    )


def _variables(train: CrankTrain, samples: Samples) -> dict[str, Array]:
    found = reactions(train, samples.theta, samples.omega, samples.alpha)
    return {**_motion(samples), **found, **samples.own}


def _motion(samples: Samples) -> dict[str, Array]:
    return {
        "time": samples.time,
        "crank_angle": samples.theta,
        "crank_speed": samples.omega,
        "crank_acceleration": samples.alpha,
        "energy_residual": samples.energy_residual,
    }


def _peak(values: Array) -> float:
    return max(float(values.max(initial=0.0)), -float(values.min(initial=0.0)))
