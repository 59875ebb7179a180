"""The runs behind a lesson, and what is read from them with its error."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from crankmbs.errors import InputError
from crankmbs.measures import Estimate, JointForce, measure
from crankmbs.measures.summary import largest
from crankmbs.numerics.arrays import Array
from crankmbs.page.knobs import Knob
from crankmbs.result import Result
from crankmbs.scene.drives import Motion, Oscillation
from crankmbs.scene.parts import Cylinder, Layout
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.units import RPM
from crankmbs.simulate import simulate

__all__ = [
    "changed",
    "even",
    "finely",
    "held",
    "joint",
    "named",
    "one_cylinder",
    "peak",
    "peak_angle",
    "ratio_knob",
    "rod_ratio",
    "sample",
    "speed_knob",
    "speed_of",
]


def changed(scene: Scene, **parts: dict[str, Any]) -> Scene:
    """The scene with some keys of some parts replaced.

    >>> changed(load_scene("yi_diesel"), rod={"length": "200 mm"}).rod.length
    0.2
    """
    new = {name: dataclasses.replace(getattr(scene, name), **keys) for name, keys in parts.items()}
    return dataclasses.replace(scene, **new)


def named(scene: Scene) -> str:
    """What a scene is called on the pages.

    >>> named(load_scene("propeller"))
    'benchmark B: fired four-stroke cylinder against a propeller load'
    """
    return scene.title or "the scene"


def speed_of(scene: Scene) -> float:
    """The speed [rad/s] that a scene starts with, or its mean.

    Raises
    ------
    InputError : a speed that is 0 or has no mean
    """
    speed = scene.start.speed if scene.start is not None else scene.motion and scene.motion.speed
    mean = speed.mean if isinstance(speed, Oscillation) else speed
    if not isinstance(mean, float) or mean == 0.0:
        raise InputError(
            "speed: a lesson needs a start.speed, or a constant or oscillating motion.speed, that "
            f"is not 0; {'0' if mean == 0.0 else type(speed).__name__} came"
        )
    return mean


def one_cylinder(scene: Scene) -> Scene:
    """One cylinder without gas, weight and offset at constant speed for one revolution.

    >>> len(one_cylinder(load_scene("v_twin")).cylinders)
    1
    """
    return dataclasses.replace(
        scene,
        layout=Layout(cylinders=(Cylinder(),)),
        piston=dataclasses.replace(scene.piston, offset=0.0),
        gas=None,
        fuel=None,
        friction=None,
        gravity=None,
        torque=(),
        start=None,
        motion=Motion(speed=abs(speed_of(scene))),
        run=Run(until=Extent(value=2.0 * math.pi, unit="rad")),
    )


def held(scene: Scene, lesson: str) -> Scene:
    """One cycle of a scene with gas at constant speed, without loads.

    Raises
    ------
    InputError : no gas, or no speed

    >>> held(load_scene("propeller"), "forces").settles
    False
    """
    if scene.gas is None:
        raise InputError(f"gas: the lesson {lesson} is about a machine with [gas]; none came")
    return even(scene)


def even(scene: Scene) -> Scene:
    """One cycle of a scene at constant speed, without loads.

    >>> even(load_scene("coasting")).start is None
    True
    """
    return dataclasses.replace(
        scene,
        friction=None,
        torque=(),
        start=None,
        motion=Motion(speed=abs(speed_of(scene))),
        run=Run(until=Extent(value=1.0, unit="cycle")),
    )


def ratio_knob(
    scene: Scene, low: float = 0.1, high: float = 0.6, first: float | None = None
) -> Knob:
    """A slider of the rod ratio in which that of the scene lies; it begins there, or at first."""
    ratio = rod_ratio(scene)
    begin = ratio if first is None else first
    return Knob("rod_ratio", "rod ratio r/l", "", min(low, ratio), max(high, ratio), begin, 3)


def speed_knob(scene: Scene) -> Knob:
    """A slider of the speed."""
    speed = abs(speed_of(scene)) / RPM
    return Knob("speed", "speed", "rpm", 0.25 * speed, 2.0 * speed, speed, 0)


def finely(scene: Scene, degrees: float = 0.01) -> Result:
    """Run the scene with its samples so many degrees apart."""
    every = Extent(value=math.radians(degrees), unit="rad")
    return simulate(changed(scene, run={"every": every}))


def rod_ratio(scene: Scene) -> float:
    """The rod ratio of the first cylinder."""
    return scene.crank.radius / scene.rod.length


def joint(result: Result, name: str) -> JointForce:
    """The force of a joint over the run, by its name."""
    return next(each for each in measure(result).joints if each.joint == name)


def peak(result: Result, name: str, sign: float = 1.0) -> Estimate:
    """Largest value of sign times a variable of the first cylinder over the run, with its error."""

    def quantity(variables: Mapping[str, Array]) -> Array:
        values = variables[name]
        return sign * values.reshape(len(values), -1)[:, 0]

    value, error = largest(result, quantity)
    return Estimate(sign * value, error)


def peak_angle(result: Result, name: str, begin: float, end: float, sign: float = 1.0) -> Estimate:
    """Crank angle [deg] of the largest sign times a variable between two crank angles [deg].

    The largest sample: its error is the spacing of the samples.
    """
    degrees = np.degrees(result.data["crank_angle"].values)
    inside = np.flatnonzero((degrees >= begin - 1e-9) & (degrees <= end + 1e-9))
    values = sign * result.data[name].values.reshape(len(degrees), -1)[inside, 0]
    at = inside[int(np.argmax(values))]
    return Estimate(float(degrees[at]), float(np.max(np.diff(degrees))))


def sample(result: Result, name: str, k: int) -> Estimate:
    """One sample of a variable of the first cylinder, with its error."""
    data = result.data[name]
    return Estimate(float(np.ravel(data.values[k])[0]), float(data.attrs["error_estimate"]))
