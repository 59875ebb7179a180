"""The run of a scene in frames, from which the page replays it: motion, pressures, events."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from crankmbs.errors import InputError
from crankmbs.motion.motion import Motion
from crankmbs.motion.states import variables_at
from crankmbs.numerics.arrays import Array, Index
from crankmbs.page.export import machine
from crankmbs.page.film_words import Idea, idea_of
from crankmbs.result import Result
from crankmbs.result.event_words import marks
from crankmbs.scene.run import Extent
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM
from crankmbs.simulate import simulate

__all__ = ["Film", "film_of"]

_FEWEST, _MOST = 400, 18_000  # frames; 24 bytes each, in base64 576 kB of the page
_PRESSURES = 24_000  # over all cylinders: 256 kB; only the colour of the gas comes from them
_CHECKED = np.arange(1, 10, 2) / 10.0  # places between two frames at which their cubic is tried
_SHARE = 0.05  # of the last digit shown, by which cubics may be wrong there
_ANGLE_DIGITS, _SPEED_DIGITS = 1, 4  # after the point [deg]; of the highest speed [rpm]
_MARKS = 24


@dataclass(frozen=True)
class Film:
    """A run to replay.

    given : what the script takes
    idea : the question, and what to look at
    ending, error : how the run ended, and how exact the film is, in sentences
    """

    given: dict[str, Any]
    idea: Idea
    ending: str
    error: str


def film_of(scene: Scene) -> Film:
    """The run of a scene as `simulate` solves it.

    Raises
    ------
    InputError : a run that does not move, that ends for a numerical cause or is too long

    >>> film_of(load_scene("torque_driven")).ending
    'The run reached its end, 1 s, at 196.119 rpm.'
    """
    if scene.run.every is None:  # then the last cycle alone would be kept
        every = Extent(value=math.radians(1.0), unit="rad")
        scene = replace(scene, run=replace(scene.run, every=every))
    result = simulate(scene)
    motion = result.passes.answer
    if result.status < 0 or not motion.end > motion.begin:
        raise InputError(f"the page cannot replay this run: {result.message}")
    time, digits, between = _frames(motion, result.event_table.values("time"))
    frames, numerical = motion.at(time, in_time=True), _numerical(result)
    fuel = _fuel(result)
    indicator = None if scene.gas is None else scene.gas.indicator
    given = {
        "scene": machine(scene),
        "compression": None if indicator is None else indicator.compression_ratio,
        "time": time,
        "angle": frames.theta,
        "speed": frames.omega,
        **_pressures(motion),
        "marks": _marks(result),
        "fuel": fuel,
        "decimals": {
            "time": max(4 - math.floor(math.log10(motion.end - motion.begin)), 0),
            "speed": min(digits, _decimals(numerical[0])),
            "angle": min(_ANGLE_DIGITS, _decimals(numerical[1])),
        },
    }
    ending = _ending(result, motion.end, float(frames.omega[-1]))
    return Film(
        given, idea_of(result, fuel_varies=fuel is not None), ending, _error(between, numerical)
    )


def _frames(motion: Motion, events: Array) -> tuple[Array, int, tuple[float, float]]:
    """Times of frames, how many decimals of the speed in rpm they show rightly, and by how much the
    cubics between them are wrong [rpm, deg]. Events are among them, as what acts jumps there."""
    begin, end = motion.begin, motion.end
    inside = events[(events > begin) & (events < end)]
    first = np.unique(np.concatenate([np.linspace(begin, end, _FEWEST), inside[:_MOST]]))
    peak = float(np.max(np.abs(motion.at(first, in_time=True).omega))) / RPM
    most = max(_SPEED_DIGITS - math.floor(math.log10(peak or 1.0)) - 1, 1)
    for digits in (most, most - 1):
        allowed = _SHARE * 10.0**-digits, _SHARE * 10.0**-_ANGLE_DIGITS
        time = _refined(motion, first, allowed)
        if time is not None:
            wrong = _wrong(motion, time, np.arange(len(time) - 1))
            return time, digits, (float(wrong[0].max()), float(wrong[1].max()))
    raise InputError(
        f"the page cannot replay this run: its {abs(motion.turned) / math.tau:.6g} turns take more "
        f"than {_MOST} frames; end it earlier by run.until, or see it with crankmbs run"
    )


def _refined(motion: Motion, time: Array, allowed: tuple[float, float]) -> Array | None:
    """Times [s] with the middles of all intervals in which a cubic is wrong by more than is allowed
    [rpm, deg]; None where they become too many."""
    unsure = np.arange(len(time) - 1)
    while len(unsure):
        speed, angle = _wrong(motion, time, unsure)
        halved = unsure[(speed > allowed[0]) | (angle > allowed[1])]
        if len(time) + len(halved) > _MOST:
            return None
        time = np.insert(time, halved + 1, 0.5 * (time[halved] + time[halved + 1]))
        left = halved + np.arange(len(halved))
        unsure = np.sort(np.concatenate([left, left + 1]))
    return time


def _wrong(motion: Motion, time: Array, k: Index) -> tuple[Array, Array]:
    """By how much the cubic of the angle that the page draws between frames k and k + 1 is wrong in
    speed [rpm] and angle [deg], the most at places between them."""
    begin, end = time[k], time[k + 1]
    step = end - begin
    between = begin + _CHECKED[:, None] * step
    frames = motion.at(np.concatenate([begin, end]), in_time=True)
    (a, b), (v, w) = frames.theta.reshape(2, -1), frames.omega.reshape(2, -1)
    s, rise = _CHECKED[:, None], (b - a) / step
    bend, twist = 3.0 * rise - 2.0 * v - w, v + w - 2.0 * rise
    true = motion.at(between.ravel(), in_time=True)
    angle = a + step * s * (v + s * (bend + s * twist)) - true.theta.reshape(between.shape)
    speed = v + s * (2.0 * bend + 3.0 * s * twist) - true.omega.reshape(between.shape)
    return np.abs(speed).max(axis=0) / RPM, np.degrees(np.abs(angle).max(axis=0))


def _numerical(result: Result) -> tuple[float, float]:
    """Estimated error of speed [rpm] and angle [deg] at equal time. At samples in angle the time
    errs, by which the speed at equal time is wrong, too."""
    error = {
        name: float(variable[2]["error_estimate"])
        for name, variable in result.variables.items()
        if name in ("time", "crank_angle", "crank_speed")
    }
    late = float(np.max(np.abs(result.sampled("crank_acceleration")))) * error["time"]
    return (error["crank_speed"] + late) / RPM, math.degrees(error["crank_angle"])


def _decimals(error: float) -> int:
    """How many digits after the point an error leaves right, but for rounding."""
    return max(math.floor(-math.log10(10.0 * error)), 0) if 0.0 < error < math.inf else 0


def _pressures(motion: Motion) -> dict[str, Array]:
    """Gas pressures [Pa] at even times [s], cylinder by cylinder; none without gas."""
    scene = motion.train.scene
    count = 0 if scene.gas is None else max(_PRESSURES // len(scene.cylinders), 2)
    time = np.linspace(motion.begin, motion.end, count)
    if not count:
        return {"pressure_time": time, "pressure": time}
    pressure = variables_at(motion.train, motion.at(time, in_time=True))["gas_pressure"]
    return {"pressure_time": time, "pressure": pressure.T.ravel()}


def _marks(result: Result) -> list[dict[str, Any]]:
    """When the events happen that have a name, the first of each before others."""
    named = marks(result)
    words = [mark.words for mark in named]
    often = [words[:k].count(word) for k, word in enumerate(words)]
    shown = sorted(sorted(range(len(named)), key=often.__getitem__)[:_MARKS])
    return [{"time": named[k].time, "words": words[k]} for k in shown]


def _fuel(result: Result) -> dict[str, Array] | None:
    """The shares of the combustion that are decided, and when [s]; None where all are alike."""
    table = result.event_table
    decided = table.values("kind") == "fuel"
    time, share = table.values("time")[decided], table.values("share")[decided]
    return {"time": time, "share": share} if len(np.unique(share)) > 1 else None


def _ending(result: Result, end: float, speed: float) -> str:
    if result.status == 0:
        return f"The run reached its end, {end:.6g} s, at {speed / RPM:.6g} rpm."
    return f"The run ended at {end:.6g} s: {result.message}."


def _error(between: tuple[float, float], numerical: tuple[float, float]) -> str:
    speed, angle = (f"{size:.1g}" for size in numerical)
    return (
        f"Estimated numerical error of the run: {speed} rpm, {angle}°. Between its frames the film "
        f"follows the run to {between[0]:.1g} rpm and {between[1]:.1g}°."
    )
