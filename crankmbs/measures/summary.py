"""Summary measures of a run over its last cycle, each with its error."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from crankmbs.geometry import close_loop, dead_centres
from crankmbs.measures.between import refined
from crankmbs.measures.peak import rise
from crankmbs.measures.window import Window, integral, last_window, same_window
from crankmbs.result import Result

__all__ = ["Estimate", "JointForce", "Measures", "fluctuation", "mean_speed", "measure"]

Array = NDArray[np.float64]


class Estimate(NamedTuple):
    """A value and an estimate of its absolute error, in one unit."""

    value: float
    error: float


@dataclass(frozen=True)
class JointForce:
    """Magnitude of one joint's force over the window.

    joint : "main bearing", "crank pin", "piston pin" or "side force"
    cylinder : its number; None for the main bearing, which carries all of them
    peak [N] : largest sample; crank_angle [rad], unwrapped, and cycle_angle [rad] of its cylinder
        say where that sample is
    mean [N] : over time
    """

    joint: str
    cylinder: int | None
    peak: Estimate
    mean: Estimate
    crank_angle: float
    cycle_angle: float | None


@dataclass(frozen=True)
class Measures:
    """What a run amounts to over its window. Means of forces are over time.

    mean_speed [rad/s]; fluctuation : (max - min) / |mean speed|
    speed_gain [rad/s] : speed at the end less that at the beginning; 0 once a motion is periodic
    crank_torque [N m] : moment of all rods on the crank, external_torque [N m] : from outside;
        both means are work per angle turned, so that torque times mean speed is power
    indicated_power [W] : work of the gas on all pistons per time; None without gas
    imep [Pa] : work of the gas in one cycle over the displaced volume, per cylinder; None without
        gas or without a whole cycle
    energy_closure : max |energy residual| / peak kinetic energy over the whole run
    """

    window: Window
    mean_speed: Estimate
    fluctuation: Estimate
    speed_gain: Estimate
    joints: tuple[JointForce, ...]
    crank_torque: Estimate
    external_torque: Estimate
    indicated_power: Estimate | None
    imep: tuple[Estimate, ...] | None
    energy_closure: float


def measure(result: Result) -> Measures:
    """Sum up a run over its last whole cycle (or revolution, or the run).

    A value is that of the samples. Its error is what it differs by from the same measure of the
    motion between them (`crankmbs.measures.between.refined`), plus that measure's own error: the
    stated errors of the variables in it, the quadrature's (the spline through all points against
    that through every second one) and how far a peak may rise between two points
    (`crankmbs.measures.peak.rise`). It is infinite where a free crank turns or swings so far
    between two samples that they do not tell how.

    >>> measure(simulate(load_scene("propeller"))).window.kind
    'last cycle'
    """
    window = last_window(result)
    finer = refined(result, window.first)
    closure = _energy_closure(result)
    here = _measures(result, window, closure)
    there = finer and _measures(finer, same_window(window, finer), closure)
    found: Measures = _beside(here, there)
    return found


def _beside(found: Any, finer: Any) -> Any:
    """Measures with the errors that finer ones show, without them with infinite errors."""
    if isinstance(found, Estimate):
        if finer is None:
            return Estimate(found.value, math.inf)
        return Estimate(found.value, abs(found.value - finer.value) + finer.error)
    if isinstance(found, tuple):
        others = [None] * len(found) if finer is None else finer
        return tuple(_beside(*pair) for pair in zip(found, others, strict=True))
    if isinstance(found, Measures | JointForce):
        names = [field.name for field in fields(found)]
        parts = {name: _beside(getattr(found, name), getattr(finer, name, None)) for name in names}
        return replace(found, **parts)
    return found


def _measures(result: Result, window: Window, energy_closure: float) -> Measures:
    power, imep = _indicated(result, window)
    rods = result.data["crank_torque"]
    rods_error = _stated(result, "crank_torque") * rods.sizes["cylinder"]
    outside = result.data["external_torque"].values
    return Measures(
        window=window,
        mean_speed=mean_speed(result, window),
        fluctuation=fluctuation(result, window),
        speed_gain=_speed_gain(result, window),
        joints=tuple(_joints(result, window)),
        crank_torque=_mean_torque(result, window, rods.values.sum(axis=1), rods_error),
        external_torque=_mean_torque(result, window, outside, _stated(result, "external_torque")),
        indicated_power=power,
        imep=imep,
        energy_closure=energy_closure,
    )


def mean_speed(result: Result, window: Window) -> Estimate:
    """Mean speed over a window [rad/s]: the angle turned over the time it took, no quadrature. The
    error is that of the samples; `measure` adds that of a beginning between two of them."""
    if window.duration == 0.0:
        speed = float(result.data["crank_speed"].values[-1])
        return Estimate(speed, _stated(result, "crank_speed"))
    mean = window.angle / window.duration
    ends = _stated(result, "crank_angle") + abs(mean) * _stated(result, "time")
    return Estimate(mean, 2.0 * ends / window.duration)


def fluctuation(result: Result, window: Window) -> Estimate:
    """Coefficient of fluctuation over a window [1]: (max - min) / |mean speed|; NaN at rest. The
    error guesses from the samples how far the speed goes between them; `measure` looks there."""
    speed = result.data["crank_speed"].values
    mean = abs(mean_speed(result, window).value)
    if mean == 0.0:
        return Estimate(math.nan, math.nan)
    high = window.inside + int(np.argmax(speed[window.inside :]))
    low = window.inside + int(np.argmin(speed[window.inside :]))
    error = 2.0 * _stated(result, "crank_speed") + rise(speed, high) + rise(-speed, low)
    return Estimate(float(speed[high] - speed[low]) / mean, error / mean)


def _speed_gain(result: Result, window: Window) -> Estimate:
    """Where the window begins between two samples the speed there is that of the cubic through
    their speeds and accelerations."""
    names = ("time", "crank_speed", "crank_acceleration")
    time, speed, rate = (result.data[name].values for name in names)
    begin = float(speed[window.first])
    if window.first < window.inside:
        pair = [window.first, window.inside]
        begin = float(CubicHermiteSpline(time[pair], speed[pair], rate[pair])(window.begin))
    return Estimate(float(speed[-1]) - begin, 2.0 * _stated(result, "crank_speed"))


def _joints(result: Result, window: Window) -> list[JointForce]:
    rows = [_joint(result, window, "main bearing", "main_bearing_force", None)]
    for joint, name in (("crank pin", "crank_pin_force"), ("piston pin", "piston_pin_force")):
        rows += [_joint(result, window, joint, name, k) for k in _numbers(result)]
    rows += [_joint(result, window, "side force", "side_force", k) for k in _numbers(result)]
    return rows


def _joint(result: Result, window: Window, joint: str, name: str, number: int | None) -> JointForce:
    parts = [name] if name in result.data else [f"{name}_x", f"{name}_y"]
    columns = [result.data[part].values for part in parts]
    if number is not None:
        columns = [column[:, number - 1] for column in columns]
    size = np.sqrt(sum(column**2 for column in columns))
    stated = math.hypot(*(_stated(result, part) for part in parts))
    at = window.inside + int(np.argmax(size[window.inside :]))
    crank_angle = float(result.data["crank_angle"].values[at])
    cycle_angle = None
    if number is not None:
        phase = result.scene.cylinders[number - 1].phase
        cycle_angle = (crank_angle + phase) % result.scene.period
    mean = _mean(result, window, size)
    return JointForce(
        joint=joint,
        cylinder=number,
        peak=Estimate(float(size[at]), stated + rise(size, at)),
        mean=Estimate(mean.value, mean.error + stated),
        crank_angle=crank_angle,
        cycle_angle=cycle_angle,
    )


def _indicated(
    result: Result, window: Window
) -> tuple[Estimate | None, tuple[Estimate, ...] | None]:
    """Work of the gas force on the piston velocity: indicated power and imep."""
    scene = result.scene
    area = scene.piston.gas_area
    if scene.gas is None or area is None or window.duration == 0.0:
        return None, None
    force, velocity = (result.data[name].values for name in ("gas_force", "piston_velocity"))
    work, quadrature = integral(result, window, force * velocity)
    stated = np.mean(np.abs(force), axis=0) * _stated(result, "piston_velocity")
    stated = stated + np.mean(np.abs(velocity), axis=0) * _stated(result, "gas_force")
    error = quadrature + stated * window.duration
    power = Estimate(float(work.sum()) / window.duration, float(error.sum()) / window.duration)
    if window.kind != "last cycle":
        return power, None
    r, l, e = scene.crank.radius, scene.rod.length, scene.piston.offset
    top, bottom = close_loop(dead_centres(r, l, e), r, l, e).x
    volume = area * float(top - bottom)
    return power, tuple(
        Estimate(float(w) / volume, float(d) / volume) for w, d in zip(work, error, strict=True)
    )


def _energy_closure(result: Result) -> float:
    peak = float(np.max(result.data["kinetic_energy"].values))
    worst = float(np.max(np.abs(result.data["energy_residual"].values)))
    return worst / peak if peak > 0.0 else 0.0


def _mean_torque(result: Result, window: Window, torque: Array, stated: float) -> Estimate:
    """Work per angle turned; where none is turned, the mean over time."""
    if window.angle == 0.0:
        mean = _mean(result, window, torque)
        return Estimate(mean.value, mean.error + stated)
    speed = result.data["crank_speed"].values
    work, quadrature = integral(result, window, torque * speed)
    error = float(quadrature) + window.duration * (
        stated * float(np.max(np.abs(speed)))
        + float(np.max(np.abs(torque))) * _stated(result, "crank_speed")
    )
    return Estimate(float(work) / window.angle, error / abs(window.angle))


def _mean(result: Result, window: Window, values: Array) -> Estimate:
    """Mean over time with the error of its quadrature."""
    if window.duration == 0.0:
        return Estimate(float(values[-1]), 0.0)
    total, error = integral(result, window, values)
    return Estimate(float(total) / window.duration, float(error) / window.duration)


def _stated(result: Result, name: str) -> float:
    return float(result.data[name].attrs["error_estimate"])


def _numbers(result: Result) -> list[int]:
    return [int(number) for number in result.data["cylinder"].values]
