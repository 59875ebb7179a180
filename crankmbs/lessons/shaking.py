"""The force of the moving pistons on the engine's frame, and its orders."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from crankmbs import lecture
from crankmbs.lessons.runs import changed
from crankmbs.measures import Estimate, orders
from crankmbs.result import Result
from crankmbs.scene.parts import Cylinder, Layout
from crankmbs.scene.scene import Scene

__all__ = ["amplitude", "reciprocating", "twin"]


def reciprocating(scene: Scene) -> Scene:
    """The machine without gas, its rotating masses balanced, m_A with the piston."""
    rod = {"mass": 0.0, "inertia": 0.0}
    crank = {"mass": 0.0, "center_of_mass": 0.0, "inertia": None}
    lumped = changed(scene, crank=crank, rod=rod, piston={"mass": _moving_mass(scene)})
    return dataclasses.replace(lumped, gas=None)


def twin(scene: Scene, angle: float) -> Scene:
    """Two cylinders this many degrees apart, both rods on the pin at the crank's reference line."""
    half = math.radians(0.5 * angle)
    pair = (Cylinder(phase=half, bank=-half), Cylinder(phase=-half, bank=half))
    return dataclasses.replace(reciprocating(scene), layout=Layout(cylinders=pair))


def amplitude(result: Result, name: str, order: float) -> Estimate:
    """Amplitude of one order of a variable."""
    split = orders(result, name)
    at = int(np.argmin(np.abs(split.order - order)))
    return Estimate(float(split.amplitude[at]), split.error)


def _moving_mass(scene: Scene) -> float:
    """The lectures' reciprocating mass m_A [kg]."""
    rod = scene.rod
    share = lecture.two_mass_rod(
        rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
    ).piston_pin
    return float(
        lecture.reciprocating_mass(piston_mass=scene.piston.mass, rod_piston_pin_mass=share)
    )
