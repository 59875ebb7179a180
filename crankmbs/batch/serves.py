"""Which scenes are solved together with others of their machine."""

from __future__ import annotations

import math

from crankmbs.mechanics.torque import branch_of
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene

__all__ = ["Loads", "loads_of"]

Loads = tuple[float, float, float]
"""c0, c1 and c2 of c0 + c1 omega + c2 omega^2 [N m]."""

_SAME = 1e-9  # rad: periods as long are the same
_FASTER = 2.0  # times as fast as at the start: few runs are on average


@once
def loads_of(scene: Scene) -> Loads | None:
    """The loads of a scene whose motion is found together with others; None of another.

    It starts turning, and is to settle or to turn through a period at least, in a given time at
    twice the speed of the start; its cycles are all alike, its friction, if any, does not depend on
    the speed; no forces act on its pistons; its cylinders are alike; its loads are
    c0 + c1 omega + c2 omega^2 at every speed in its sense and at any time. Where no such load rises
    with the speed there is one periodic motion at most.

    >>> loads_of(load_scene("propeller"))
    (0.0, 0.0, -9.5e-05)
    """
    start, (end, in_time) = scene.start, scene.end
    if start is None or start.speed == 0.0:
        return None
    if (end * _FASTER * abs(start.speed) if in_time else end + _SAME) < scene.period:
        return None
    if scene.fuel is not None or (scene.friction is not None and scene.friction.viscous > 0.0):
        return None
    if scene.force or scene.unlike:
        return None
    if scene.run.formulation not in ("auto", "crank_angle"):
        return None
    if abs(scene.settled_period - scene.period) > _SAME:
        return None
    if any(load.lacks or load.parts.period or not load.is_steady for load in scene.torque):
        return None
    sense = math.copysign(1.0, start.speed)
    branch = branch_of(scene.torque, 0.0, 0.0, rising=sense > 0.0)
    if any(0.0 < sense * end < math.inf for end in (branch.omega_low, branch.omega_high)):
        return None
    c0, _, c1, c2 = branch.coefficients
    return c0, c1, c2
