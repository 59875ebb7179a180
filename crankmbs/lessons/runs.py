"""The runs behind a lesson, and what is read from them with its error."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from crankmbs.measures import Estimate
from crankmbs.measures.peak import rise
from crankmbs.result import Result
from crankmbs.scene.parts import Cylinder, Layout
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate

__all__ = ["changed", "finely", "one_cylinder", "peak", "peak_angle", "sample", "turn"]


def changed(scene: Scene, **parts: dict[str, Any]) -> Scene:
    """The scene with some keys of some parts replaced.

    >>> changed(load_scene("yi_diesel"), rod={"length": "200 mm"}).rod.length
    0.2
    """
    new = {name: dataclasses.replace(getattr(scene, name), **keys) for name, keys in parts.items()}
    return dataclasses.replace(scene, **new)


def one_cylinder(name: str) -> Scene:
    """One cylinder of a shipped scene without gas, for one revolution: its motion alone."""
    layout = Layout(cylinders=(Cylinder(),))
    run = Run(until=Extent(value=2.0 * math.pi, unit="rad"))
    return dataclasses.replace(load_scene(name), layout=layout, gas=None, run=run)


def turn(scene: Scene, rod_ratio: float) -> Result:
    """Run the scene with a rod of this ratio of crank radius to rod length."""
    return simulate(changed(scene, rod={"length": scene.crank.radius / rod_ratio}))


def finely(scene: Scene, degrees: float = 0.01) -> Result:
    """Run the scene with its samples so many degrees apart."""
    every = Extent(value=math.radians(degrees), unit="rad")
    return simulate(changed(scene, run={"every": every}))


def peak(result: Result, name: str, cylinder: int = 0, sign: float = 1.0) -> Estimate:
    """Largest value of sign times a variable over the run, with its error."""
    values = sign * result.data[name].values
    values = values[:, cylinder] if values.ndim > 1 else values
    at = int(np.argmax(values))
    stated = float(result.data[name].attrs["error_estimate"])
    return Estimate(sign * float(values[at]), stated + rise(values, at))


def peak_angle(result: Result, name: str, begin: float, end: float, sign: float = 1.0) -> Estimate:
    """Crank angle [deg] of the largest sign times a variable between two crank angles [deg].

    The largest sample: its error is the spacing of the samples.
    """
    degrees = np.degrees(result.data["crank_angle"].values)
    inside = np.flatnonzero((degrees >= begin - 1e-9) & (degrees <= end + 1e-9))
    values = sign * result.data[name].values.reshape(len(degrees), -1)[inside, 0]
    at = inside[int(np.argmax(values))]
    return Estimate(float(degrees[at]), float(np.max(np.diff(degrees))))


def sample(result: Result, name: str, k: int, cylinder: int = 0) -> Estimate:
    """One sample of a variable, with its error."""
    values = result.data[name].values
    value = values[k, cylinder] if values.ndim > 1 else values[k]
    return Estimate(float(value), float(result.data[name].attrs["error_estimate"]))
