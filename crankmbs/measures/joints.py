"""Largest values over the window: of every joint's force and of the speed, each with its error."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crankmbs.measures.between import Between
from crankmbs.measures.knots import tops
from crankmbs.measures.peak import highest
from crankmbs.measures.span import Span, integral
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["Estimate", "JointForce", "apart", "mean_over_time", "peaks", "stated"]


class Estimate(NamedTuple):
    """A value and an estimate of its absolute error, in one unit."""

    value: float
    error: float


@dataclass(frozen=True)
class JointForce:
    """Magnitude of one joint's force over the window.

    joint : "main bearing", "crank pin", "piston pin" or "side force"
    cylinder : its number; None for the main bearing, which carries all of them
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


def peaks(
    result: Result, window: Span, between: Between | None, missed: Array
) -> tuple[tuple[JointForce, ...], float, float]:
    """The joint forces, highest and lowest speed over the window; without the motion between the
    samples theirs.

    missed : shape (joints + 2,) [N, rad/s], errors of the motion between the samples, as `apart`
        tells them
    """
    places, data = _places(result), _values(result)
    time, values = data["time"], _rows(result, data)
    means = _means(result, window, values[: len(places)])
    samples = time[window.inside :], values[:, window.inside :]
    if between is None:
        when, top = highest(*samples, None)
        angle, beside = np.interp(when, time, data["crank_angle"]), np.zeros(len(top))
    else:
        _, angle, top, beside = tops(
            between, window, samples, lambda t: _rows(result, between.variables(t))
        )
    errors = [math.hypot(*(stated(result, part) for part in place.parts)) for place in places]
    of_peak = [
        Estimate(float(peak), error + float(more) + float(off))
        for peak, error, more, off in zip(top, errors, missed, beside, strict=False)
    ]
    of_mean = [Estimate(m.value, m.error + error) for m, error in zip(means, errors, strict=True)]
    joints = tuple(
        _joint(result, place, *found)
        for place, *found in zip(places, of_peak, of_mean, angle.tolist(), strict=False)
    )
    return joints, float(top[-2]), -float(top[-1])


def apart(result: Result, motions: Sequence[Between]) -> Array:
    """What every joint's force, the speed and the negative speed may err in the finer of two
    motions by what it differs from the coarser at most, shape (joints + 2,); nothing for one
    alone."""
    coarse, fine = (_rows(result, _values(m.result)) for m in (motions[0], motions[-1]))
    differs = np.max(np.abs(fine[:, :: len(motions)] - coarse), axis=1)
    return np.asarray(motions[-1].unsure * differs)


def _values(result: Result) -> dict[str, Array]:
    return {str(name): variable.values for name, variable in result.data.variables.items()}


def _rows(result: Result, variables: Mapping[str, Array]) -> Array:
    """The force of every joint, the speed and the negative speed, shape (joints + 2, times)."""
    speed = variables["crank_speed"]
    return np.stack([*(_size(variables, place) for place in _places(result)), speed, -speed])


class _Place(NamedTuple):
    """A joint, the variables of its force, and its cylinder's number."""

    joint: str
    parts: tuple[str, ...]
    number: int | None


def _places(result: Result) -> list[_Place]:
    numbers = [int(number) for number in result.data["cylinder"].values]
    of_crank = ("main_bearing_force_x", "main_bearing_force_y")
    places = [_Place("main bearing", of_crank, None)]
    for joint in ("crank pin", "piston pin"):
        stem = joint.replace(" ", "_")
        places += [_Place(joint, (f"{stem}_force_x", f"{stem}_force_y"), k) for k in numbers]
    return places + [_Place("side force", ("side_force",), k) for k in numbers]


def _size(variables: Mapping[str, Array], place: _Place) -> Array:
    columns = [variables[part] for part in place.parts]
    if place.number is not None:
        columns = [column[:, place.number - 1] for column in columns]
    return np.asarray(np.sqrt(sum(column**2 for column in columns)))


def _joint(
    result: Result, place: _Place, peak: Estimate, mean: Estimate, crank_angle: float
) -> JointForce:
    cycle_angle = None
    if place.number is not None:
        phase = result.scene.cylinders[place.number - 1].phase
        cycle_angle = (crank_angle + phase) % result.scene.period
    return JointForce(
        joint=place.joint,
        cylinder=place.number,
        peak=peak,
        mean=mean,
        crank_angle=crank_angle,
        cycle_angle=cycle_angle,
    )


def _means(result: Result, window: Span, rows: Array) -> list[Estimate]:
    """Means over time of quantities at the samples, shape (q, samples)."""
    if window.duration == 0.0:
        return [Estimate(float(values[-1]), 0.0) for values in rows]
    total, error = (part / window.duration for part in integral(result, window, rows.T))
    return [Estimate(*both) for both in zip(total.tolist(), error.tolist(), strict=True)]


def mean_over_time(result: Result, window: Span, values: Array) -> Estimate:
    """Mean over time of values at the samples, with the error of its quadrature."""
    (mean,) = _means(result, window, values[None])
    return mean


def stated(result: Result, name: str) -> float:
    """The stated error of a variable."""
    return float(result.data[name].attrs["error_estimate"])
