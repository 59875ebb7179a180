"""Numbers whose sign is unlikely to be meant: of a load, of a force, of the speed itself.

Each rule is one function of the scene that gives its sentences, as in `plausible`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.mechanics.pressure import crank_ends_of, pressures_of
from crankmbs.scene.scene import Scene

__all__ = ["backwards", "drives_on", "pushes_on"]

_NO_WORK = 1e-3  # of the largest pressure times what all pistons sweep: a cycle without a sense


def backwards(scene: Scene) -> Iterator[str]:
    """A crank that turns in the sense of -theta through a cycle of the gas, which has a sense.

    >>> list(backwards(load_scene("propeller")))
    []
    """
    key, speed = "start", scene.start.speed if scene.start is not None else 0.0
    if scene.motion is not None and isinstance(scene.motion.speed, float):
        key, speed = "motion", scene.motion.speed
    heads = pressures_of(scene) or ()
    if speed >= 0.0 or not heads:
        return
    work = _gas_work(scene)
    most = max(abs(each.peak[1]) for each in heads)
    swept = sum(gear.stroke * (gear.piston.gas_area or 0.0) for gear in scene.running_gear)
    if abs(work) > _NO_WORK * most * swept:
        yield (
            f"{key}.speed: at a negative speed the crank passes the cycle of the gas backwards, "
            f"which does {-work:.4g} J of work in it, and {work:.4g} J at a positive one; an "
            "engine that turns clockwise is described from its other end, with a positive speed "
            "and the opposite signs of piston.offset and banks"
        )


def drives_on(scene: Scene) -> Iterator[str]:
    """A load that turns the crank on where the gas does so already has the wrong sign."""
    start = scene.start
    if start is None or start.speed == 0.0 or start.speed * _gas_work(scene) <= 0.0:
        return
    for number, load in enumerate(scene.torque, start=1):
        torque = float(load(0.0, start.angle, start.speed))
        if torque * start.speed > 0.0:
            yield (
                f"torque[{number}]: the {load.called} of {torque:+.4g} N m at the "
                "start drives, as the gas does; a load that brakes has the sign opposite to the "
                "speed's"
            )


def pushes_on(scene: Scene) -> Iterator[str]:
    """A force over the travel that does work on the crank where a motor already drives it, and no
    gas takes the work of both, has the wrong sign."""
    start = scene.start
    if start is None or scene.gas is not None:
        return
    always = [load for load in scene.torque if not load.has_window]
    ends = 0.0, start.speed  # a motor may give nothing at its idle speed
    torques = [sum(float(load(0.0, start.angle, v)) for load in always) for v in ends]
    if max(torque * start.speed for torque in torques) <= 0.0:
        return
    for number, force in enumerate(scene.force, start=1):
        (forward, back), cylinder = force.law[:2], force.cylinder or 1
        if forward is None or back is None or force.has_window:
            continue
        travel = np.linspace(0.0, scene.running_gear[cylinder - 1].stroke, 3601)
        work = float(np.trapezoid(forward(travel) - back(travel), travel))
        if work > 0.0:
            yield (
                f"force[{number}]: the {force.called} does {work:.4g} J of work on the crank in a "
                "turn, which the loads drive, too; a force that resists is negative while the "
                "piston moves towards the crank and positive on the way back"
            )


def _gas_work(scene: Scene) -> float:
    """Work of the gas over one period of the engine in the sense of +theta [J]."""
    work, gears = 0.0, scene.running_gear
    heads, ends = pressures_of(scene) or (), crank_ends_of(scene) or ()
    pushing = [
        *(
            (gear, gear.piston.gas_area or 0.0, each)
            for gear, each in zip(gears, heads, strict=False)
        ),
        *(
            (gear, -gear.piston.crank_end_area, each)
            for gear, each in zip(gears, ends, strict=False)
        ),
    ]
    for gear, area, pressure in pushing:
        count = 1440 * round(pressure.period / scene.period)
        angle = (np.arange(count) + 0.5) * pressure.period / count
        loop = close_loop(angle, *gear.shape)
        torque = -pressure(angle) * area * loop.x_1
        work += float(np.mean(torque)) * scene.period
    return work
