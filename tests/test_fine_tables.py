"""Steps over time from row to row of a fine pressure table, of six cylinders that fire unevenly."""

import math

import numpy as np
import pytest
from two_runs import differences

from crankmbs import (
    Crank,
    Cylinder,
    Gas,
    Layout,
    Piston,
    Quadratic,
    Rod,
    Run,
    Scene,
    Start,
    Table,
    simulate,
)

THROWS = ((0, -30), (300, 30), (240, -30), (540, 30), (480, -30), (60, 30))  # phase, bank


def engine(rows, interpolation, rtol):
    """A 60 degree V6 under a smooth pressure of so many rows."""
    angle = np.arange(rows) * 4.0 * math.pi / rows
    burnt = angle - 2.0 * math.pi
    pressure = 1e5 + 12e5 * np.exp(-((burnt / 0.5) ** 2))
    pressure += 45e5 * np.exp(-(((burnt - 0.25) / 0.28) ** 2))
    cylinders = tuple(Cylinder(phase=math.radians(p), bank=math.radians(b)) for p, b in THROWS)
    table = Table(angle.tolist(), pressure.tolist())
    return Scene(
        crank=Crank(radius=0.05, inertia=0.2),
        rod=Rod(length=0.2, mass=0.6, center_of_mass=0.06, inertia=2.5e-3),
        piston=Piston(mass=0.5, bore=0.1),
        layout=Layout(cylinders=cylinders),
        gas=Gas(pressure=table, ambient=1e5, interpolation=interpolation),
        start=Start(angle=0.1, speed=200.0),
        torque=(Quadratic(coefficient=2.5e-3),),
        run=Run(until="2 rev", every="5 deg", rtol=rtol),
    )


@pytest.mark.slow
@pytest.mark.parametrize("interpolation", ["cubic", "pchip", "linear", "step"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-8])
def test_what_it_states_holds(interpolation, rtol):
    scene = engine(720, interpolation, rtol)
    result = simulate(scene, formulation="minimal")
    exact = simulate(scene, formulation="crank_angle", rtol=1e-12)
    assert max(each.share for each in differences(result, exact)) <= 2.0
