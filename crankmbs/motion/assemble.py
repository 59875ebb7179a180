"""From the motion that a formulation gives to labelled variables, each with its error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.peaks import peak, relative_error
from crankmbs.mechanics.reactions import Table, peaks_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.motion.base import Samples, Solution
from crankmbs.motion.motion import Passes
from crankmbs.motion.states import MOTION, balances_of, motion_rows, table_of
from crankmbs.numerics.arrays import Array, Labelled

__all__ = ["ANGLE_ROUNDING", "Assembled", "assemble", "labelled"]

_ROUNDING = 64 * float(np.finfo(float).eps)  # of a variable's peak: what the formulas round
_FEW = 32  # samples: among more there is one where nothing cancels
ANGLE_ROUNDING = 2 * float(np.finfo(float).eps)  # of the crank angle


@dataclass(frozen=True)
class Assembled:
    """A solution, every variable of the result at its samples, its largest absolute value there,
    and an estimate of its error.

    motion : makes the passes of the motion as they were solved; of a toy may be None
    """

    solution: Solution
    table: Table
    peaks: dict[str, float]
    errors: dict[str, float]
    motion: Callable[[], Passes] | None = None

    @property
    def variables(self) -> dict[str, Array]:
        """By name, with the shapes of a result."""
        return self.table.variables

    @cached_property
    def relative_error(self) -> float:
        """The worst relative error, as `crankmbs.mechanics.peaks` has it; 0 where nothing moved."""
        angle = self.solution.samples.theta
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
        an end in time     |f(b'') - f(a)| there counts too, b'' as far ahead as in the last turn
        free crank         alpha also errs by (torque that b' needs, less what it has) / min J

    Two variables have a law of their own:

        crank_angle        max |theta_b - theta_a - omega_a (t_b - t_a)|, at equal time
        energy_residual    its own peak: in the true motion the energy gained is the work done

    Where the formulation states errors they are taken.
    """
    table = table_of(train, solution.samples)
    peaks = table.largest(peaks_of(table.values))
    by_name = dict(zip(table.rows, peaks.tolist(), strict=True))
    errors = dict(solution.errors) or _errors(train, solution, table, by_name)
    return Assembled(solution, table, by_name, errors)


def _errors(
    train: CrankTrain, solution: Solution, table: Table, peaks: dict[str, float]
) -> dict[str, float]:
    """What `assemble` estimates, from the variables and their peaks."""
    answer, better = solution.samples, solution.better or solution.samples
    late = better.time - answer.time
    ahead = better.theta - answer.theta - answer.omega * late
    rounded = _turned_by_rounding(better)
    if late.any() and late[-1] == 0.0 != ahead[-1]:  # else it ends at an angle, at the same time
        rounded = _with_end_in_time(rounded, ahead)
    apart, missed, angles = _Passes(train.perturbed, answer, rounded, table).difference()
    largest = _ROUNDING * np.array(_sizes(peaks)) + apart
    errors = dict(zip(table.rows, largest.tolist(), strict=True))
    if missed:  # of a free crank, which has inertia at every angle; a driven one may have none
        errors["crank_acceleration"] += missed / float(reduce(train, angles).inertia.min())
    errors["crank_angle"] = peak(ahead) + _ROUNDING * peaks["crank_angle"]
    errors["energy_residual"] = peaks["energy_residual"] + _ROUNDING * peaks["kinetic_energy"]
    return errors


class _Passes(NamedTuple):
    """Two passes of one motion.

    perturbed : the crank train of the better one
    rounded : the better answer, turned ahead by the rounding of its angle; with one sample more it
        is compared with the last of the answer there
    table : the variables of the answer
    """

    perturbed: CrankTrain
    answer: Samples
    rounded: Samples
    table: Table

    def difference(self) -> tuple[Array, float, Array]:
        """What each variable changes by from the answer to the better one, at most; by how much the
        torque that the better motion needs differs from the one it is given [N m]; and the angles
        that motion passes [rad], but for those whole periods on.

        In one go; of a few samples, where the differences may cancel in a variable by chance, in
        three: the angle, the speed, the acceleration, whose changes are added up.
        """
        before, places, first = self.table.values, self.table.places, len(MOTION)
        total = np.zeros(len(self.table.rows))
        for samples in self._chain():
            balances, apart = balances_of(self.perturbed, samples), np.zeros(len(before))
            balanced = slice(first, first + sum(balances.rows.values()))
            apart[balanced] = balances.apart(before[balanced])
            missed = 0.0
            if samples.computed:
                row = places["external_torque"].start
                acting = samples.computed.get("external_torque", before[row])
                missed = peak(balances.row("external_torque")[: len(acting)] - acting)
            count = before.shape[1]
            apart[:first] = peaks_of(before[:first] - motion_rows(samples)[:, :count])
            for name, values in samples.computed.items():
                apart[places[name]] = peaks_of(before[places[name]] - values.T[..., :count])
            total += self.table.largest(apart)
            if samples is not self.rounded:
                before = table_of(self.perturbed, samples).values
        return total, missed, balances.period.angles

    def _chain(self) -> list[Samples]:
        if len(self.answer.time) > _FEW:
            return [self.rounded]
        count = len(self.answer.time)
        answer = self.answer.select(np.minimum(np.arange(len(self.rounded.time)), count - 1))
        turned = replace(answer, theta=self.rounded.theta)
        return [turned, replace(turned, omega=self.rounded.omega), self.rounded]


def _with_end_in_time(samples: Samples, ahead: Array) -> Samples:
    """With the last sample once more, its angle as far off as the passes were in the last turn.

    At an end in time that sample is the only one whose angle errs where the others are at angles,
    and two passes may agree in it by chance.

    ahead : shape (n,) [rad], by which the better answer is ahead at equal time
    """
    theta, end = samples.theta, samples.select(np.array([-1]))
    recent = ahead[np.abs(theta - theta[-1]) <= 2.0 * math.pi]
    more = math.copysign(peak(recent) - abs(ahead[-1]), ahead[-1])
    return Samples.joined([samples, replace(end, theta=end.theta + more)])


def _turned_by_rounding(samples: Samples) -> Samples:
    """The motion with the crank ahead by the rounding of its angle, and as fast as it is there."""
    rounding = ANGLE_ROUNDING * peak(samples.theta)
    omega = samples.omega + _speed_change(samples, rounding)
    return replace(samples, theta=samples.theta + rounding, omega=omega)


def _speed_change(samples: Samples, ahead: float) -> Array:
    """What the speed changes by while the crank turns ahead by an angle; near rest 0."""
    speed = np.abs(samples.omega)
    steep = np.zeros_like(speed)
    np.divide(samples.alpha, samples.omega, out=steep, where=speed > 0.01 * np.max(speed))
    return np.asarray(steep * ahead)


def labelled(assembled: Assembled) -> Labelled:
    """The variables with dimensions, units, long names and error estimates."""
    variables, errors = assembled.variables, assembled.errors
    table: Labelled = {
        name: about.labelled(variables[name], errors[name])
        for name, about in EVERY.items()
        if name in variables
    }
    counts = {EVERY[name].of: values.shape[-1] for name, values in variables.items()}
    for of in filter(None, counts):
        table[of] = ((of,), np.arange(1, counts[of] + 1), {"long_name": f"{of} number"})
    return table


def _sizes(peaks: dict[str, float]) -> list[float]:
    """What of each variable is rounded: its peak; of sums that may cancel the largest of a unit."""
    largest: dict[str, float] = {}
    for name, size in peaks.items():
        unit = EVERY[name].units
        largest[unit] = max(largest.get(unit, 0.0), size)
    return [largest[EVERY[n].units] if n in SUMS else p for n, p in peaks.items()]
