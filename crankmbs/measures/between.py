"""The motion between the samples of a result: the same run, many times more finely sampled."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crankmbs.inertia import reduce
from crankmbs.pressure import pressure_of
from crankmbs.reactions import reactions
from crankmbs.result import Result
from crankmbs.scene import Scene
from crankmbs.schema import DEGREE
from crankmbs.speed import speed_law
from crankmbs.torque import torque_at

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["refined"]

Array = NDArray[np.float64]

_SPACING = 0.1 * DEGREE  # where samples are no farther apart their sums hardly change
_FEWEST, _MOST = 2, 512  # parts of one interval
_PASSES = 6  # the speed hardly changes what drives it: each leaves a small part of the error
_SETTLED = 0.1  # of the speed: where the last pass changes it more they lead nowhere


def refined(result: Result, first: int) -> Result | None:
    """The result from sample ``first`` on, with every interval cut into equal parts of time.

    A prescribed motion is taken from its law. That of a free crank is the equation of motion
    integrated across each interval and bent to meet the samples at both ends, so that it feels gas
    and loads between them. Where loads settle the speed faster than the samples follow their torque
    is linear between them. Joint forces are those of `crankmbs.reactions.reactions`.

    Returns
    -------
    Result, or None where a free crank turns or swings so far from one sample to the next that they
    do not tell how

    >>> print(refined(simulate(load_scene("propeller")), 0).data.sizes["time"] > 50_000)
    True
    """
    data = result.data.isel(time=slice(first, None))
    if data.sizes["time"] < 2:
        return replace(result, data=data)
    spacing = float(np.mean(np.abs(np.diff(data["crank_angle"].values))))
    parts = min(max(math.ceil(spacing / _SPACING), _FEWEST), _MOST)
    motion: tuple[Array, Array, Array, Array] | None
    if result.scene.motion is None:
        motion = _free(result.scene, data, parts)
    else:
        time = _joined(_cut(data["time"].values, parts))
        motion = (time, *speed_law(result.scene.motion).at_time(time))
    return None if motion is None else replace(result, data=_labelled(result, *motion))


def _free(scene: Scene, data: xr.Dataset, parts: int) -> tuple[Array, Array, Array, Array] | None:
    """Time, angle, speed and acceleration of a free crank, if they can be told."""
    pressure = pressure_of(scene)
    names = ("time", "crank_angle", "crank_speed", "external_torque")
    time, theta, omega, outside = (data[name].values for name in names)
    width, s = np.diff(time)[:, None], np.linspace(0.0, 1.0, parts + 1)
    t, linear = _cut(time, parts), _cut(outside, parts)
    beside = _cut(outside - torque_at(scene.torque, time, omega), parts)
    # where the speed follows its loads faster than samples follow one another passes would diverge
    rate = _steepness(scene, time, omega) / reduce(scene, None, theta)[0]
    stiff = np.maximum(rate[:-1], rate[1:])[:, None] * width > 1.0

    def bent(speed: Array) -> tuple[Array, Array]:
        """Angle and speed that meet the angles of the samples, the speeds at both ends kept."""
        angle = theta[:-1, None] + _running(speed, width)
        missing = (theta[1:] - angle[:, -1])[:, None]
        angle = angle + missing * s**2 * (3.0 - 2.0 * s)
        return angle, speed + missing * 6.0 * s * (1.0 - s) / width

    def driven(angle: Array, speed: Array) -> Array:
        """Acceleration there."""
        inertia, slope, given = reduce(scene, pressure, angle)
        torque = np.where(stiff, linear, torque_at(scene.torque, t, speed) + beside)
        return np.asarray((given + torque - 0.5 * slope * speed**2) / inertia)

    angle, speed = bent(_cut(omega, parts))
    for _ in range(_PASSES):
        gained = omega[:-1, None] + _running(driven(angle, speed), width)
        before, (angle, speed) = speed, bent(gained + s * (omega[1:] - gained[:, -1])[:, None])
    change, size = (np.max(np.abs(q), axis=1) for q in (speed - before, speed))
    if not np.all(change <= _SETTLED * size):
        return None
    return _joined(t), _joined(angle), _joined(speed), _joined(driven(angle, speed))


def _steepness(scene: Scene, t: Array, omega: Array) -> Array:
    """How fast the torque of all loads changes with the speed [N m s]."""
    nudge = 1e-6 * float(np.max(np.abs(omega))) + 1e-12
    above, below = (torque_at(scene.torque, t, omega + sign * nudge) for sign in (1.0, -1.0))
    return np.asarray(np.abs(above - below) / (2.0 * nudge))


def _cut(values: Array, parts: int) -> Array:
    """Values on the straight lines between neighbours, shape (n - 1, parts + 1)."""
    s = np.linspace(0.0, 1.0, parts + 1)
    return np.asarray(values[:-1, None] + s * np.diff(values)[:, None])


def _joined(rows: Array) -> Array:
    """One row after the other; of the two values where they meet the later one counts."""
    return np.append(rows[:, :-1], rows[-1, -1])


def _running(values: Array, width: Array) -> Array:
    """Integral from the beginning of each interval of this width on, by the trapezoid rule less
    what the slopes at the ends of each part show it to miss."""
    slope = np.gradient(values, axis=1, edge_order=2)
    each = 0.5 * (values[:, 1:] + values[:, :-1]) - np.diff(slope, axis=1) / 12.0
    gained = np.cumsum(each * width / (values.shape[1] - 1), axis=1)
    return np.concatenate([np.zeros((len(values), 1)), gained], axis=1)


def _labelled(result: Result, time: Array, theta: Array, omega: Array, alpha: Array) -> xr.Dataset:
    """Every variable but the energy residual, with the errors that the result states."""
    import xarray as xr

    found = reactions(result.scene, pressure_of(result.scene), theta, omega, alpha)
    found |= {"time": time, "crank_angle": theta, "crank_speed": omega, "crank_acceleration": alpha}
    rows = {name: (result.data[name].dims, v, result.data[name].attrs) for name, v in found.items()}
    coordinates = {name: rows.pop(name) for name in ("time", "crank_angle")}
    return xr.Dataset(rows, {**coordinates, "cylinder": result.data["cylinder"]})
