"""The free machine of a lesson, settled, and what the textbook says of its flywheel."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from crankmbs.design.flywheel import excess
from crankmbs.errors import InputError
from crankmbs.lessons.runs import changed, held, speed_of
from crankmbs.measures import measure
from crankmbs.page.knobs import Knob
from crankmbs.result import Result
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import Quadratic
from crankmbs.scene.run import SETTLED
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["Textbook", "flywheel_knob", "free", "settled", "textbook"]


def free(scene: Scene, lesson: str) -> Scene:
    """The settled motion of a free machine with gas: a prescribed speed becomes that at which a
    quadratic load takes what the gas gives.

    Raises
    ------
    InputError : no gas, no speed, or a gas that does not drive the crank

    >>> free(load_scene("yi_diesel"), "omega").settles
    True
    """
    even = held(scene, lesson)
    run = dataclasses.replace(scene.run, until=SETTLED)
    if scene.start is not None:
        return dataclasses.replace(scene, run=run)
    speed = speed_of(even)
    torque = measure(simulate(even)).crank_torque.value
    if not torque > 0.0:
        raise InputError(
            f"gas: the lesson {lesson} needs a gas that drives the crank; it gives a mean torque "
            f"of {torque:.4g} N m"
        )
    crank = scene.crank
    if not crank.moment_of_inertia:
        raise InputError(
            f"crank.inertia: the lesson {lesson} lets the crank run freely, which takes an inertia "
            "above 0; 0 came"
        )
    load = Quadratic(coefficient=torque / speed**2)
    start = Start(angle=0.0, speed=speed)
    return dataclasses.replace(scene, run=run, motion=None, start=start, torque=(load,))


def settled(scene: Scene) -> Result:
    """Run a free machine, which must settle.

    Raises
    ------
    InputError : one that does not, with the reason
    """
    result = simulate(scene)
    if result.status != 0:
        raise InputError(f"the lesson needs a machine that settles: {result.message}")
    return result


def flywheel_knob(scene: Scene) -> Knob:
    """A slider of the flywheel in which that of the scene lies."""
    inertia = scene.crank.moment_of_inertia
    least = max(inertia / 6.0, 1.001 * scene.crank.mass * scene.crank.center_of_mass**2)
    digits = max(1, 2 - math.floor(math.log10(inertia)))
    return Knob("flywheel", "flywheel", "kg m²", least, 6.0 * inertia, inertia, digits)


@dataclasses.dataclass(frozen=True)
class Textbook:
    """What the formula of the flywheel takes: the excess of work in a cycle at constant speed [J],
    the mean inertia of rods and pistons [kg m2], the mean speed [rad/s]; and its even run."""

    work: float
    moving: float
    speed: float
    even: Result

    def fluctuation(self, inertia: float) -> float:
        """W / (J omega^2) with an inertia of crank and flywheel [kg m2]."""
        return self.work / ((inertia + self.moving) * self.speed**2)


def textbook(result: Result) -> Textbook:
    """The textbook's numbers for the machine of a settled run."""
    speed = measure(result).mean_speed.value
    even = simulate(changed(held(result.scene, "fluctuation"), motion={"speed": abs(speed)}))
    work, doubled = excess(even, result.scene)
    moving = doubled / speed**2 - result.scene.crank.moment_of_inertia
    return Textbook(work=work.value, moving=float(np.abs(moving)), speed=abs(speed), even=even)
