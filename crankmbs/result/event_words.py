"""What is marked of the way of a run, and what it is called."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crankmbs.motion.firings import firings
from crankmbs.numerics.arrays import Array
from crankmbs.result.record import Result

__all__ = ["Mark", "did_not_fire", "marks"]


class Mark(NamedTuple):
    """Time [s], crank angle [rad] and crank speed [rad/s]; words that stand in a figure, and in a
    list of events."""

    time: float
    crank_angle: float
    crank_speed: float
    words: str
    text: str


def marks(result: Result) -> list[Mark]:
    """What is marked of a run, in the order of time: every event but decisions on the fuel, and in
    their place the first firing of a fuel that is waited for, and the last of one that is cut.

    A share is decided half a turn before its cylinder fires; what is marked is the passage of the
    firing dead centre, as `crankmbs.motion.firings.firings` finds it, where there is one.

    >>> marks(simulate(load_scene("run_up").with_(run__until="0.1 s")))[0].words
    'starter on'
    """
    table, scene = result.event_table, result.scene
    names = [load.called for load in scene.torque]
    names = [f"{name} {k}" if names.count(name) > 1 else name for k, name in enumerate(names, 1)]
    columns = ("time", "crank_angle", "crank_speed", "kind", "load", "text")
    found = [
        Mark(
            time,
            angle,
            speed,
            f"{names[load - 1]} {kind.removeprefix('load ')}" if load else kind,
            text,
        )
        for time, angle, speed, kind, load, text in zip(
            *(table.values(name).tolist() for name in columns), strict=True
        )
        if kind != "fuel"
    ]
    return sorted([*found, *_firings(result)], key=lambda mark: mark.time)


def did_not_fire(result: Result) -> bool:
    """Whether a share of the combustion above 0 is decided in a run, and no cylinder fires with it.

    >>> did_not_fire(simulate(load_scene("run_up").with_(run__until="0.07 s")))
    True
    """
    if result.motion is None or not np.any(_decided(result)[1] > 0.0):
        return False
    motion = result.passes.answer
    return motion.begin == 0.0 and not len(firings(motion).time)


def _firings(result: Result) -> list[Mark]:
    """The first of a fuel that is waited for, if the motion there is kept, and the last of one that
    is cut."""
    fuel, (time, share) = result.scene.fuel, _decided(result)
    with_fuel = np.flatnonzero(share > 0.0)
    if fuel is None or result.motion is None or not len(with_fuel):
        return []
    motion = result.passes.answer
    waits = fuel.after > 0.0 or fuel.from_speed is not None
    ends = fuel.until is not None or fuel.until_speed is not None
    named = dict[str, int]()
    if waits and motion.begin <= time[with_fuel[0]]:
        named["first firing"] = 0
    if ends and with_fuel[-1] + 1 < len(time):
        named["last firing"] = -1
    found = np.array(firings(motion) if named else ())
    if not found.size:
        return []
    rows = {words: found[:, k].tolist() for words, k in named.items()}
    return [Mark(time, at, speed, words, words) for words, (time, at, speed) in rows.items()]


def _decided(result: Result) -> tuple[Array, Array]:
    """Times [s] of the decisions on the fuel, and the shares that are decided."""
    table = result.event_table
    fuel = table.values("kind") == "fuel"
    return table.values("time")[fuel], table.values("share")[fuel]
