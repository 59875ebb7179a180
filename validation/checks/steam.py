"""A steam engine of a textbook, with gas on both sides of its piston."""

from __future__ import annotations

import math

import numpy as np

from crankmbs import lecture
from crankmbs.mechanics.train import crank_train
from crankmbs.simulate import simulate
from validation.case import Case
from validation.judge import Outcome

__all__ = ["by_series", "in_full"]


def by_series(case: Case) -> Outcome:
    """The turning moment by the book's way: weight, inertia by the acceleration's series, gas of
    both ends, the rod at its exact angle; against the printed one in halves of its last digit."""
    scene, angle = case.ours(), math.radians(case.number("crank_angle"))
    pressures, area, motion = crank_train(scene).pressure, scene.piston.gas_area, scene.motion
    assert pressures is not None
    assert area is not None
    assert motion is not None
    assert isinstance(motion.speed, float)
    assert scene.gravity is not None
    mass = scene.piston.mass
    geometry = {"crank_radius": scene.crank.radius, "rod_length": scene.rod.length}
    inertia = lecture.inertia_force_series(
        angle, reciprocating_mass=mass, omega=motion.speed, **geometry
    )
    gas = float(pressures[0](angle)) * area + mass * scene.gravity.acceleration
    net = lecture.net_force(gas_force=gas, inertia_force=inertia)
    thrust = lecture.rod_force(angle, net_force=net, **geometry)
    across = lecture.tangential_force(angle, rod_force=thrust, **geometry)
    moment = float(across) * scene.crank.radius
    printed, digit = case.number("printed"), case.number("last_digit")
    return Outcome(
        abs(moment - printed) / (0.5 * digit),
        f"{moment:.6g} N m by the series, {printed:g} printed",
    )


def in_full(case: Case) -> Outcome:
    """The moment of the rod on the crank in the run, against what is computed here."""
    data = simulate(case.ours()).data
    at = int(np.argmin(np.abs(np.degrees(data["crank_angle"].values) - case.number("crank_angle"))))
    moment, exact = float(data["crank_torque"].values[at, 0]), case.number("exact")
    return Outcome(abs(moment / exact - 1.0), f"{moment:.12g} N m")
