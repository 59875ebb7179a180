"""Summary measures of a run over its last cycle, each with its error."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from crankmbs.measures.between import Between, refined
from crankmbs.measures.joints import (
    Estimate,
    JointForce,
    apart,
    mean_over_time,
    peaks,
    stated,
)
from crankmbs.measures.peak import rise
from crankmbs.measures.span import Span, integral, measured_span, same_span
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

__all__ = ["Measures", "efficiency", "fluctuation", "mean_speed", "measure", "measured"]


@dataclass(frozen=True)
class Measures:
    """What a run amounts to over its window. Means of forces are over time.

    mean_speed [rad/s]; fluctuation : (max - min) / |mean speed|
    speed_gain [rad/s] : speed at the end less that at the beginning; 0 once a motion is periodic
    crank_torque [N m] : moment of all rods on the crank, external_torque [N m] : from outside;
        both means are work per angle turned, so that torque times mean speed is power
    indicated_power [W] : work of the gas on all pistons per time; None without gas
    imep [Pa] : work of the gas in a cycle, the mean of several, over the displaced volume, per
        cylinder; None without gas or without a whole cycle
    friction_power [W] : what the friction of all pistons takes per time; None without friction
    mechanical_efficiency : where the gas drives, the share of the indicated power that friction
        leaves; where it is driven, indicated power over that with the friction's; None without
        friction or gas
    energy_closure : max |energy residual| / peak kinetic energy over the whole run
    """

    window: Span
    mean_speed: Estimate
    fluctuation: Estimate
    speed_gain: Estimate
    joints: tuple[JointForce, ...]
    crank_torque: Estimate
    external_torque: Estimate
    indicated_power: Estimate | None
    imep: tuple[Estimate, ...] | None
    friction_power: Estimate | None
    mechanical_efficiency: Estimate | None
    energy_closure: float


def measure(result: Result) -> Measures:
    """Sum up a run over its last whole cycle (or revolution, or the run); a settled motion over
    its period.

    A value is that of the motion between the samples (`crankmbs.measures.between.refined`). Its
    error sums the stated errors of the variables in it, the quadrature's (the spline through all
    points against that through every second one) and, where the crank is free, what the value
    differs by from that of the coarser motion between the samples. Where a free crank turns or
    swings so far between two samples that they do not tell how, the value is that of the samples
    and its error infinite.

    >>> measure(simulate(load_scene("propeller"))).window.kind
    'last cycle'
    """
    return measured(result, refined(result, measured_span(result).first))


def measured(result: Result, motions: tuple[Between, ...]) -> Measures:
    """The same from the motion between the samples, that `refined` gives from the first sample of
    the `measured_span` on."""
    window = measured_span(result)
    closure = _energy_closure(result)
    if not motions:
        unknown: Measures = _beside(_measures(result, window, closure), None)
        return unknown
    missed = apart(result, motions)
    *coarser, found = (
        _measures(motion.result, same_span(window, motion.result), closure, motion, missed)
        for motion in motions
    )
    for other in coarser:
        found = _beside(found, other)
    return replace(found, window=window)


def _beside(found: Any, other: Any) -> Any:
    """Measures with the errors that others show besides, without others with infinite errors."""
    if isinstance(found, Estimate):
        apart = math.inf if other is None else abs(found.value - other.value)
        return Estimate(found.value, found.error + apart)
    if isinstance(found, tuple):
        others = [None] * len(found) if other is None else other
        return tuple(_beside(*pair) for pair in zip(found, others, strict=True))
    if isinstance(found, Measures | JointForce):
        names = [field.name for field in fields(found)]
        parts = {name: _beside(getattr(found, name), getattr(other, name, None)) for name in names}
        return replace(found, **parts)
    return found


def _measures(
    result: Result,
    window: Span,
    energy_closure: float,
    between: Between | None = None,
    missed: Array | float = 0.0,
) -> Measures:
    power, imep = _indicated(result, window)
    rubbed = _rubbed(result, window)
    rods = result.data["crank_torque"]
    rods_error = stated(result, "crank_torque") * rods.sizes["cylinder"]
    outside = result.data["external_torque"].values
    missed = np.broadcast_to(missed, 3 + 3 * rods.sizes["cylinder"])
    joints, high, low = peaks(result, window, between, missed)
    of_speed = float(missed[-1])
    return Measures(
        window=window,
        mean_speed=mean_speed(result, window),
        fluctuation=_coefficient(result, window, high, low, error=2.0 * of_speed),
        speed_gain=_speed_gain(result, window, of_speed),
        joints=joints,
        crank_torque=_mean_torque(result, window, rods.values.sum(axis=1), rods_error),
        external_torque=_mean_torque(result, window, outside, stated(result, "external_torque")),
        indicated_power=power,
        imep=imep,
        friction_power=rubbed,
        mechanical_efficiency=efficiency(power, rubbed),
        energy_closure=energy_closure,
    )


def mean_speed(result: Result, window: Span) -> Estimate:
    """Mean speed over a window [rad/s]: the angle turned over the time it took, no quadrature. The
    error is that of the samples; `measure` adds that of a beginning between two of them."""
    if window.duration == 0.0:
        speed = float(result.data["crank_speed"].values[-1])
        return Estimate(speed, stated(result, "crank_speed"))
    mean = window.angle / window.duration
    ends = stated(result, "crank_angle") + abs(mean) * stated(result, "time")
    return Estimate(mean, 2.0 * ends / window.duration)


def fluctuation(result: Result, window: Span) -> Estimate:
    """Coefficient of fluctuation of the samples over a window [1]: (max - min) / |mean speed|; NaN
    at rest. The error guesses from them how far the speed goes in between; `measure` looks there.
    """
    speed = result.data["crank_speed"].values
    high = window.inside + int(np.argmax(speed[window.inside :]))
    low = window.inside + int(np.argmin(speed[window.inside :]))
    beyond = rise(speed, high) + rise(-speed, low)
    return _coefficient(result, window, float(speed[high]), float(speed[low]), error=beyond)


def _coefficient(
    result: Result, window: Span, high: float, low: float, *, error: float
) -> Estimate:
    mean = abs(mean_speed(result, window).value)
    if mean == 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate((high - low) / mean, (2.0 * stated(result, "crank_speed") + error) / mean)


def _speed_gain(result: Result, window: Span, missed: float) -> Estimate:
    """Where the window begins between two samples the speed there is that of the cubic through
    their speeds and accelerations."""
    names = ("time", "crank_speed", "crank_acceleration")
    time, speed, rate = (result.data[name].values for name in names)
    begin = float(speed[window.first])
    if window.first < window.inside:
        pair = [window.first, window.inside]
        begin = float(CubicHermiteSpline(time[pair], speed[pair], rate[pair])(window.begin))
    return Estimate(float(speed[-1]) - begin, 2.0 * stated(result, "crank_speed") + missed)


def _indicated(result: Result, window: Span) -> tuple[Estimate | None, tuple[Estimate, ...] | None]:
    """Work of the gas force on the piston velocity: indicated power and imep."""
    scene = result.scene
    area = scene.piston.gas_area
    if scene.gas is None or area is None or window.duration == 0.0:
        return None, None
    work, error = _work(result, window, "gas_force")
    mean = Estimate(float(work.sum()) / window.duration, float(error.sum()) / window.duration)
    if window.kind not in ("last cycle", "settled period"):
        return mean, None
    cycles = abs(window.angle) / scene.period
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    top, bottom = close_loop(dead_centres(r, l, e), r, l, e).x
    volume = area * float(top - bottom)
    return mean, tuple(
        Estimate(float(w) / (cycles * volume), float(d) / (cycles * volume))
        for w, d in zip(work, error, strict=True)
    )


def _rubbed(result: Result, window: Span) -> Estimate | None:
    """What friction takes from all pistons per time."""
    if result.scene.friction is None or window.duration == 0.0:
        return None
    work, error = _work(result, window, "friction_force")
    return Estimate(-float(work.sum()) / window.duration, float(error.sum()) / window.duration)


def efficiency(indicated: Estimate | None, rubbed: Estimate | None) -> Estimate | None:
    """Of indicated power I and friction's R, or their works: (I - R) / I of an engine, I / (I - R)
    of what is driven, with the errors of both; None without either.

    >>> efficiency(Estimate(4.0, 0.0), Estimate(1.0, 0.1)).value
    0.75
    """
    if indicated is None or rubbed is None or indicated.value == 0.0:
        return None
    of_gas, left = indicated.value, indicated.value - rubbed.value
    value, whole = (left / of_gas, of_gas) if of_gas > 0.0 else (of_gas / left, left)
    apart = abs(rubbed.value) * indicated.error + abs(of_gas) * rubbed.error
    return Estimate(value, apart / whole**2)


def _work(result: Result, window: Span, force: str) -> tuple[Array, Array]:
    """Work of a force on every piston over a window [J], and its error."""
    along, velocity = (result.data[name].values for name in (force, "piston_velocity"))
    work, quadrature = integral(result, window, along * velocity)
    power = np.mean(np.abs(along), axis=0) * stated(result, "piston_velocity")
    power = power + np.mean(np.abs(velocity), axis=0) * stated(result, force)
    return work, quadrature + power * window.duration


def _energy_closure(result: Result) -> float:
    peak = float(np.max(result.data["kinetic_energy"].values))
    worst = float(np.max(np.abs(result.data["energy_residual"].values)))
    return worst / peak if peak > 0.0 else 0.0


def _mean_torque(result: Result, window: Span, torque: Array, own: float) -> Estimate:
    """Work per angle turned; where none is turned, the mean over time."""
    if window.angle == 0.0:
        mean = mean_over_time(result, window, torque)
        return Estimate(mean.value, mean.error + own)
    speed = result.data["crank_speed"].values
    work, quadrature = integral(result, window, torque * speed)
    error = float(quadrature) + window.duration * (
        own * float(np.max(np.abs(speed)))
        + float(np.max(np.abs(torque))) * stated(result, "crank_speed")
    )
    return Estimate(float(work) / window.angle, error / abs(window.angle))
