"""Loads turned up or down until a motion settles to a wanted mean speed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from crankmbs.errors import InputError
from crankmbs.scene.drives import Start
from crankmbs.scene.run import SETTLED, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.torque import Torque
from crankmbs.simulate import simulate

__all__ = ["mean_speed_of", "rebalanced"]

_MOST = 30  # runs
_FARTHEST = 4.0  # factor by which one run changes the share


def mean_speed_of(scene: Scene) -> float:
    """The mean speed that a scene settles to [rad/s], without its sign, by a run.

    Raises
    ------
    InputError : it does not settle

    >>> round(mean_speed_of(load_scene("propeller").with_(run__until="settled")), 3)
    333.805
    """
    result = simulate(scene)
    if result.status != 0:
        raise InputError(f"settled_speed: with other loads {result.message}")
    time = result.data["time"].values
    return scene.settled_period / float(time[-1] - time[0])


def rebalanced(
    scene: Scene, mean_speed: float, mean: Callable[[Scene], float] = mean_speed_of
) -> Scene:
    """The scene with its loads scaled by one share, so that it settles to a mean speed [rad/s].

    Those loads are scaled that take work at that speed, as a brake is turned up or down; where none
    does, those that give some. The share is found by secants between the logarithms of share and
    mean speed, nearly a line where loads are powers of the speed, to the scene's rtol. The motion
    then starts at this speed.

    mean : the mean speed that a scene settles to, as `mean_speed_of` gives it

    Raises
    ------
    InputError : a prescribed speed, no load that depends on the speed, or no share that will do

    >>> brake = rebalanced(load_scene("propeller"), 300.0).torque[0]
    >>> print(f"{brake.coefficient:.3e} N m s^2")
    1.175e-04 N m s^2
    """
    if scene.start is None:
        raise InputError(
            "settled_speed: loads give the mean speed of a free crank; under [motion] vary "
            "motion.speed instead"
        )
    if not any(load.parts.over_speed or load.parts.function for load in scene.torque):
        raise InputError(
            "settled_speed: no load of the scene depends on the speed, so that none settles it; "
            "add one, such as a quadratic one"
        )
    if not mean_speed * scene.start.speed > 0.0:
        raise InputError(
            f"settled_speed: must be a speed in the sense of start.speed; {mean_speed:g} rad/s came"
        )
    free = replace(
        scene,
        start=Start(angle=scene.start.angle, speed=mean_speed),
        run=Run(until=SETTLED, rtol=scene.run.rtol),
    )
    scaled = _scaled(free, math.exp(_share(free, abs(mean_speed), mean)))
    return replace(scaled, run=scene.run)


def _share(scene: Scene, mean_speed: float, mean: Callable[[Scene], float]) -> float:
    """The logarithm of the share."""
    share, slope = 0.0, -0.5  # of a quadratic load: mean speed as share^(-1/2)
    before: tuple[float, float] | None = None
    for _ in range(_MOST):
        off = math.log(mean(_scaled(scene, math.exp(share))) / mean_speed)
        if abs(off) <= scene.run.rtol:
            return share
        if before is not None and share != before[0]:
            slope = (off - before[1]) / (share - before[0])
        before = share, off
        if not slope < 0.0:
            break
        share -= max(min(off / slope, math.log(_FARTHEST)), -math.log(_FARTHEST))
    raise InputError(
        f"settled_speed: no share of the loads was found with which the motion settles to "
        f"{mean_speed:.6g} rad/s; give loads that grow with the speed"
    )


def _scaled(scene: Scene, share: float) -> Scene:
    assert scene.start is not None
    speed = scene.start.speed
    torques = [math.copysign(1.0, speed) * _at(load, speed) for load in scene.torque]
    side = -1.0 if any(torque < 0.0 for torque in torques) else 1.0
    pairs = zip(scene.torque, torques, strict=True)
    loads = (load.scaled(share, 1.0) if side * torque > 0.0 else load for load, torque in pairs)
    return replace(scene, torque=tuple(loads))


def _at(load: Torque, speed: float) -> float:
    """Torque of a load at a speed [N m], what it does over the angle left out."""
    over_time, over_speed, _, function = load.parts
    total = 0.0 if over_time is None else float(over_time(0.0))
    total += 0.0 if over_speed is None else float(over_speed(speed))
    if function is not None:
        total += float(function(np.zeros(()), np.zeros(()), np.array(speed)))
    return total
