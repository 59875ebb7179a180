"""From the motion that a formulation gives to labelled variables, each with its error."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.reactions import deviations, reactions
from crankmbs.mechanics.tabulated import tabulate
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.motion.base import Samples, Solution
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.periodic import one_period

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ANGLE_ROUNDING", "Assembled", "assemble", "dataset"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # of a variable's peak: what the formulas round
_GIVEN = ("fuel", "friction_force")  # what reactions take from a formulation's own
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
        """The worst relative error, as `crankmbs.mechanics.peaks` has it; 0 where nothing moved."""
        angle = self.variables["crank_angle"]
        turned = peak(angle - angle[0])
        return relative_error(self.peaks, self.errors, turned) if turned else 0.0


def assemble(train: CrankTrain, solution: Solution) -> Assembled:
    """Every variable of a result at the samples, and an estimate of its largest error.

    With a the answer, b the better one (a itself where there is none), f a variable from angle,
    speed and acceleration, eps the unit of rounding and maxima over the samples,

        error of f = 64 eps max |f(a)| + max |f(b') - f(a)|

    where b' is b turned ahead by the rounding of its angle, 2 eps max |theta_b|. Three terms are
    more than the difference of two passes:

        few samples        sum of what angle, speed and acceleration make one after the other
        an end in time     at least |f(b'') - f(a)| there, b'' as far ahead as in the last turn
        free crank         alpha also errs by (torque that b' needs, less what it has) / min J

    Two variables have a law of their own:

        crank_angle        max |theta_b - theta_a - omega_a (t_b - t_a)|, at equal time
        energy_residual    its own peak: in the true motion the energy gained is the work done

    Where the formulation states errors they are taken.
    """
    variables = _variables(train, solution.samples)
    peaks = {name: peak(values) for name, values in variables.items()}
    if solution.errors:
        return Assembled(solution, variables, peaks, dict(solution.errors))
    answer, better = solution.samples, solution.better or solution.samples
    late = better.time - answer.time
    ahead = better.theta - answer.theta - answer.omega * late
    passes = _Passes(train.off, answer, _turned_by_rounding(better), variables)
    errors = {name: _ROUNDING * size for name, size in _sizes(peaks).items()}
    differences = list(passes.differences())
    missed = differences[-1][1]
    for apart, _ in differences:
        errors = {name: error + apart[name] for name, error in errors.items()}
    if late.any() and late[-1] == 0.0 != ahead[-1]:  # else it ends at an angle, at the same time
        apart, missed_there = passes.end_in_time(ahead)
        missed = max(missed, missed_there)
        for name, most in apart.items():
            errors[name] = max(errors[name], most + _ROUNDING * peaks[name])
    if missed:
        errors["crank_acceleration"] += missed / _least_inertia(train, better.theta)
    errors["crank_angle"] = peak(ahead) + _ROUNDING * peaks["crank_angle"]
    errors["energy_residual"] = peaks["energy_residual"] + _ROUNDING * peaks["kinetic_energy"]
    return Assembled(solution, variables, peaks, errors)


class _Passes(NamedTuple):
    """Two passes of one motion.

    off : the crank train of the better one
    rounded : the better answer, turned ahead by the rounding of its angle
    variables : of the answer
    """

    off: CrankTrain
    answer: Samples
    rounded: Samples
    variables: dict[str, Array]

    def differences(self) -> Iterator[tuple[dict[str, float], float]]:
        """What each variable changes by from the answer to the better one, at most; and by how
        much the torque that the better motion needs differs from the one it is given [N m].

        In one go; of a few samples, where the differences may cancel in a variable by chance, in
        three: the angle, the speed, the acceleration, whose changes are to be added up.
        """
        before = self.variables
        for samples in self._chain():
            motion = (samples.theta, samples.omega, samples.alpha)
            apart = deviations(self.off, *motion, {**before, **samples.own}, samples.own)
            missed = apart["external_torque"] if samples.own else 0.0
            given = {**_motion(samples), **samples.own}
            apart |= {name: peak(before[name] - values) for name, values in given.items()}
            yield apart, missed
            if samples is not self.rounded:
                before = _variables(self.off, samples)

    def _chain(self) -> list[Samples]:
        if len(self.answer.time) > _FEW:
            return [self.rounded]
        turned = replace(self.answer, theta=self.rounded.theta)
        return [turned, replace(turned, omega=self.rounded.omega), self.rounded]

    def end_in_time(self, ahead: Array) -> tuple[dict[str, float], float]:
        """The same at the last sample, its angle as far off as the passes were in the last turn.

        At an end in time that sample is the only one whose angle errs where the others are at
        angles, and two passes may agree in it by chance.

        ahead : shape (n,) [rad], by which the better answer is ahead at equal time
        """
        theta, own = self.rounded.theta, self.rounded.own
        recent = ahead[np.abs(theta - theta[-1]) <= 2.0 * math.pi]
        more = math.copysign(peak(recent) - abs(ahead[-1]), ahead[-1])
        given = {name: values for name, values in own.items() if name in _GIVEN}
        last = replace(self.rounded, own=given).select(np.array([-1]))
        end = _variables(self.off, replace(last, theta=last.theta + more))
        missed = peak(own["external_torque"][-1:] - end["external_torque"]) if own else 0.0
        names = self.variables.keys() - own.keys()
        return {name: peak(self.variables[name][-1:] - end[name]) for name in names}, missed


def _turned_by_rounding(samples: Samples) -> Samples:
    """The motion with the crank ahead by the rounding of its angle, and as fast as it is there."""
    rounding = ANGLE_ROUNDING * peak(samples.theta)
    omega = samples.omega + _speed_change(samples, rounding)
    return replace(samples, theta=samples.theta + rounding, omega=omega)


def _least_inertia(train: CrankTrain, theta: Array) -> float:
    """Of a free crank, which has inertia at every angle; a driven one may have none."""
    angles, _ = one_period(theta, train.repeats)
    return float(np.min(tabulate(train, angles).inertia))


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
        about = EVERY[name]
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
        {n: labelled(n) for n in EVERY if n in variables.keys() - coordinates},
        coords={**coordinates, "cylinder": number},
    )


def _variables(train: CrankTrain, samples: Samples) -> dict[str, Array]:
    given = (samples.own.get(name) for name in _GIVEN)
    found = reactions(train, samples.theta, samples.omega, samples.alpha, *given)
    return {**_motion(samples), **found, **samples.own}


def _sizes(peaks: dict[str, float]) -> dict[str, float]:
    """What of each variable is rounded: its peak; of sums that may cancel the largest of a unit."""
    largest: dict[str, float] = {}
    for name, size in peaks.items():
        unit = EVERY[name].units
        largest[unit] = max(largest.get(unit, 0.0), size)
    return {n: largest[EVERY[n].units] if n in SUMS else p for n, p in peaks.items()}


def _motion(samples: Samples) -> dict[str, Array]:
    return {
        "time": samples.time,
        "crank_angle": samples.theta,
        "crank_speed": samples.omega,
        "crank_acceleration": samples.alpha,
        "energy_residual": samples.energy_residual,
    }
