"""How many steps exudyn takes, as far as that is known before a run."""

from __future__ import annotations

import math

from crankmbs.scene.scene import Scene

__all__ = ["STEPS_A_SECOND", "STEPS_A_TURN", "sentence"]

STEPS_A_SECOND = 20_000
"""Steps of one cylinder that a second of a cost cap stands for."""

STEPS_A_TURN = 70
"""Of the coarsest run, at the speed at the start; and in all, at least."""

_RUNS = 16  # coarsest runs that the first five are worth: it, it from beside, 2, 4 and 8 of it


def sentence(scene: Scene) -> str:
    """What a run of a scene takes at least; nothing of a prescribed speed, which is sampled.

    >>> sentence(load_scene("coasting"))
    'exudyn takes 8,900 steps or more, some 0.45 s'
    """
    if scene.start is None:
        return ""
    until, in_time = scene.end
    turned = until * abs(scene.start.speed) if in_time else until
    if turned == 0.0:
        return "exudyn takes 1,100 steps a turn or more; how many turns shows on the way"
    steps = float(f"{_RUNS * STEPS_A_TURN * max(turned / (2.0 * math.pi), 1.0):.2g}")
    seconds = steps * len(scene.cylinders) / STEPS_A_SECOND
    return f"exudyn takes {steps:,.0f} steps or more, some {seconds:.2g} s"
