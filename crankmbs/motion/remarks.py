"""What a reader of a run has to know besides: windows that did not end or begin, a governor
that hunts, and a crank that turned back under a load over its angle."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crankmbs.mechanics.windows import Phase, place_of
from crankmbs.motion.base import Samples
from crankmbs.motion.mode import Mode
from crankmbs.numerics.arrays import Array
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM

__all__ = ["remarks"]

_SWINGS = 3  # from one end to the other: a load step makes one, and one back


def remarks(scene: Scene, mode: Mode, samples: Samples) -> tuple[str, ...]:
    """A sentence for each window that waits for a time or a speed at the end of a run, for a
    governor whose share goes from its least to its greatest and back throughout the second half of
    it, and for each load over the angle of a crank that turned back.

    mode : at the end

    >>> simulate(load_scene("propeller")).message
    'reached the end of the run'
    """
    shares = samples.computed.get("fuel")
    said = [*_windows(scene, mode, float(samples.time[-1])), *_turned_back(scene, samples.omega)]
    fuel, firing = scene.fuel, mode.firing
    if fuel is not None and firing is not None:
        if firing.set_in is None and fuel.from_speed is not None:
            said.append(
                f"fuel: from_speed, {fuel.from_speed / RPM:.6g} rpm, was not met where shares are "
                "decided, and the engine did not start"
            )
        if shares is not None:
            said += _hunting(fuel, shares[len(shares) // 2 :])
    return tuple(said)


def _windows(scene: Scene, mode: Mode, end: float) -> Iterator[str]:
    loads = *scene.torque, *scene.force
    for number, (load, phase) in enumerate(zip(loads, mode.loads, strict=False), start=1):
        place = place_of(loads, number)
        if phase is Phase.ACTING and load.until_speed is not None:
            yield (
                f"{place}: until_speed, {load.until_speed / RPM:.6g} rpm, was not met, "
                "and the load never let go"
            )
        if phase is Phase.DUE and (load.after or 0.0) >= end:
            yield (
                f"{place}: after, {load.after:.6g} s, is not before the end of the run, "
                f"{end:.6g} s, and the load never set in"
            )
        if phase is Phase.WAITING and load.from_speed is not None:
            yield (
                f"{place}: from_speed, {load.from_speed / RPM:.6g} rpm, was not met, and "
                "the load never set in"
            )


def _turned_back(scene: Scene, omega: Array) -> Iterator[str]:
    if not np.min(omega) < 0.0 < np.max(omega):
        return
    for number, load in enumerate(scene.torque, start=1):
        if load.parts.over_angle is not None:
            yield (
                f"torque[{number}]: the crank turned back, and the {load.called} is the same at an "
                "angle whichever way the crank turns"
            )


def _hunting(fuel: Fuel, shares: Array) -> Iterator[str]:
    """Of the cylinder that goes from end to end most often; scatter hides the ends."""
    governor, most = fuel.governor, 0
    if governor is None or fuel.scatter > 0.0 or governor.min == governor.max:
        return
    misfiring = {one.cylinder - 1 for one in fuel.misfire or ()}
    for k in set(range(shares.shape[1])) - misfiring:
        at_end = (shares[:, k] >= governor.max).astype(int) - (shares[:, k] <= governor.min)
        most = max(most, int(np.count_nonzero(np.diff(at_end[at_end != 0]))))
    if most >= _SWINGS:
        yield (
            f"the governor hunts: in the second half of the run its share went {most} times from "
            f"one end, {governor.min:g} or {governor.max:g}, to the other; lower its gains"
        )
