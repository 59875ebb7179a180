"""The variables of a run at any time or crank angle between its samples, each with its error."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.errors import InputError, shown
from crankmbs.measures.between import Between, refined, sampled
from crankmbs.numerics.arrays import Array
from crankmbs.result import Result

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["interp"]

_HALVINGS = 60  # of an interval between two samples: to rounding
_HAIR = 1e-12  # of the run: an end may be so far off by rounding


def interp(
    result: Result, time: ArrayLike | None = None, crank_angle: ArrayLike | None = None
) -> xr.Dataset:
    """Every variable but the energy residual, at times or at crank angles.

    Between two samples a prescribed motion follows its law and that of a free crank the equation of
    motion (`crankmbs.measures.between.refined`); forces follow from it. Nothing is read off a
    straight line, and nothing is run again.

    Parameters
    ----------
    time : shape (n,) or one number [s], within the samples; or
    crank_angle : shape (n,) or one number [rad], unwrapped, as in ``result.data``

    Returns
    -------
    Dataset as ``result.data``, in the order asked for; ``error_estimate`` adds to that of the
    samples what a motion in coarser steps differs by between them, four times of it where a torque
    jumps over the angle

    Raises
    ------
    InputError : neither or both, no finite numbers, outside the samples; samples too far apart to
        tell the motion between them, or with a load between them that sets in or ends; an angle
        that a crank which turns back passes twice

    >>> found = interp(simulate(load_scene("propeller")), time=[0.1, 0.20001])
    >>> found.sizes["time"]
    2
    """
    if (time is None) == (crank_angle is None):
        came = "neither" if time is None else "both"
        raise InputError(f"give time or crank_angle, exactly one of the two; {came} came")
    name, unit = ("time", "s") if crank_angle is None else ("crank_angle", "rad")
    wanted = _inside(result, name, unit, time if crank_angle is None else crank_angle)
    motions = refined(result, 0)
    if not motions:
        raise InputError(
            "the samples are too far apart to tell the motion between them; run the scene with a "
            "smaller every"
        )
    times = [wanted if unit == "s" else _passed(result, motion, wanted) for motion in motions]
    found = [
        sampled(result, motion.train, result.data, when, motion.state(when)).data
        for when, motion in zip(times, motions, strict=True)
    ]
    _refuse_events(result, times[-1])
    return _with_errors(found, motions[-1].unsure, _fuel_jump(result, times[-1]))


def _inside(result: Result, name: str, unit: str, given: ArrayLike | None) -> Array:
    """What is asked for, shape (n,), none of it outside the samples."""
    try:
        wanted = np.atleast_1d(np.asarray(given, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError(f"{name} must be numbers [{unit}]; {shown(given)} came") from None
    if wanted.ndim != 1 or wanted.size == 0 or not np.all(np.isfinite(wanted)):
        raise InputError(f"{name} must be finite numbers [{unit}] in a row; {shown(given)} came")
    values = result.data[name].values
    low, high = float(values.min()), float(values.max())
    hair = _HAIR * max(abs(low), abs(high))
    outside = wanted[(wanted < low - hair) | (wanted > high + hair)]
    if outside.size:
        raise InputError(
            f"{name} must be within the samples, {low:.9g} to {high:.9g} {unit}; "
            f"{outside[0]:.9g} {unit} came"
        )
    return np.clip(wanted, low, high)


def _passed(result: Result, motion: Between, wanted: Array) -> Array:
    """The times [s] at which the crank passes angles, by halving the intervals they lie in."""
    time, angle = (result.data[name].values for name in ("time", "crank_angle"))
    sense = math.copysign(1.0, angle[-1] - angle[0])
    if np.any(sense * np.diff(angle) <= 0.0):
        raise InputError("the crank rests or turns back, and an angle has no one time; give time")
    after = np.searchsorted(sense * angle[1:-1], sense * wanted, side="left")
    low, high = time[after].copy(), time[np.minimum(after + 1, len(time) - 1)].copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        beyond = sense * (motion.state(middle)[0] - wanted) >= 0.0
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return np.asarray(0.5 * (low + high))


def _intervals(result: Result, time: Array) -> Array:
    """The numbers of the samples behind which times lie, not at one, shape (m,)."""
    samples = result.data["time"].values
    between = time[~np.isin(time, samples)]
    return np.unique(np.searchsorted(samples, between, side="right") - 1)


def _refuse_events(result: Result, time: Array) -> None:
    """Refuse times between two samples between which a load sets in or ends, or the crank stops."""
    speed = result.data["crank_speed"].values
    stops = bool(np.any(speed[1:] * speed[:-1] < 0.0) or np.any(speed[1:-1] == 0.0))
    windows = any(load.has_window for load in result.scene.torque)
    if result.keep is None or not (stops or windows):  # to find events may take longer than the run
        return
    samples, events = result.data["time"].values, result.events
    unlike = events["kind"].values != "fuel"
    when = events["time"].values[unlike]
    behind = np.searchsorted(samples, when, side="right") - 1
    hit = np.flatnonzero(np.isin(behind, _intervals(result, time)) & ~np.isin(when, samples))
    if hit.size:
        event, first = events["text"].values[unlike][hit[0]], behind[hit[0]]
        raise InputError(
            f"between the samples at {samples[first]:.9g} and {samples[first + 1]:.9g} s there is "
            f"an event ({event}), and they do not tell the motion there; leave out that stretch, "
            "or run the scene with a smaller every"
        )


def _fuel_jump(result: Result, time: Array) -> float:
    """The largest change of a share of the combustion in the intervals in which times lie: it is
    decided somewhere in one, where it does not act yet."""
    behind = _intervals(result, time)
    if "fuel" not in result.data or not behind.size:
        return 0.0
    fuel = result.data["fuel"].values
    return float(np.max(np.abs(fuel[behind + 1] - fuel[behind])))


def _with_errors(values: list[xr.Dataset], unsure: float, fuel_jump: float) -> xr.Dataset:
    """The last of these values, their errors larger by so many times what the first differ by."""
    other, found = values[0], values[-1]
    for name in found.variables:
        if "error_estimate" in found[name].attrs:
            apart = unsure * float(np.max(np.abs(found[name].values - other[name].values)))
            found[name].attrs["error_estimate"] += max(apart, fuel_jump * (name == "fuel"))
    return found
