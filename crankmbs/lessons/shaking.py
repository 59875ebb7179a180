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
from crankmbs.simulate import simulate

__all__ = ["FRAME", "amplitude", "reciprocating", "shaking", "twin"]

FRAME = ("frame_force_x", "frame_force_y")
"""The variables that `shaking` adds to the data of a run."""


def reciprocating(scene: Scene) -> Scene:
    """The machine without gas, its rotating masses balanced, m_A with the piston."""
    rod = {"mass": 0.0, "inertia": 0.0}
    lumped = changed(scene, rod=rod, piston={"mass": _moving_mass(scene)})
    return dataclasses.replace(lumped, gas=None)


def twin(scene: Scene, angle: float) -> Scene:
    """Two cylinders this many degrees apart, both rods on the pin at the crank's reference line."""
    half = math.radians(0.5 * angle)
    pair = (Cylinder(phase=half, bank=-half), Cylinder(phase=-half, bank=half))
    return dataclasses.replace(reciprocating(scene), layout=Layout(cylinders=pair))


def shaking(scene: Scene) -> Result:
    """Run the scene; its data get the force on the frame, of main bearings and cylinder walls."""
    result = simulate(scene)
    data, bank = result.data, np.array([cylinder.bank for cylinder in scene.cylinders])
    wall = data["side_force"]
    walls = (-wall.values * np.sin(bank)).sum(axis=1), (wall.values * np.cos(bank)).sum(axis=1)
    forces = {}
    for name, axis, on_pistons in zip(FRAME, "xy", walls, strict=True):
        bearing = data[f"main_bearing_force_{axis}"]
        error = bearing.attrs["error_estimate"] + len(bank) * wall.attrs["error_estimate"]
        about = {"units": "N", "error_estimate": error}
        forces[name] = ("time", -(bearing.values + on_pistons), about)
    return dataclasses.replace(result, data=data.assign(forces))


def amplitude(result: Result, name: str, order: float) -> Estimate:
    """Amplitude of one order of a variable; the error of the variable adds at most twice to it."""
    split = orders(result, name)
    at = int(np.argmin(np.abs(split.order - order)))
    return Estimate(
        float(split.amplitude[at]), 2.0 * float(result.data[name].attrs["error_estimate"])
    )


def _moving_mass(scene: Scene) -> float:
    """The lectures' reciprocating mass m_A [kg]."""
    rod = scene.rod
    share = lecture.two_mass_rod(
        rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
    ).piston_pin
    return float(
        lecture.reciprocating_mass(piston_mass=scene.piston.mass, rod_piston_pin_mass=share)
    )
