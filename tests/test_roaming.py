"""Steps over time across the knots of a pressure table with more rows than the motion needs."""

import math

import numpy as np
import pytest

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
from crankmbs.compare.confirm import differences
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.system import Knots, Machine

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


@pytest.mark.parametrize(
    ("interpolation", "rtol", "evaluations"),
    [("cubic", 1e-4, 6e3), ("cubic", 1e-6, 3e4), ("pchip", 1e-4, 3e4)],
)
def test_a_fine_table_takes_fewer_steps_than_it_has_knots(interpolation, rtol, evaluations):
    result = simulate(engine(2880, interpolation, rtol), formulation="minimal")
    assert result.status == 0
    assert result.cost.evaluations < evaluations


@pytest.mark.parametrize("interpolation", ["pchip", "linear", "step"])
def test_a_knot_that_bends_takes_steps_of_few_stages(interpolation):
    """Of order 8, cut at each of 2880 knots a period, they take 2.2e5 evaluations."""
    result = simulate(engine(2880, interpolation, 1e-7), formulation="minimal")
    assert result.status == 0
    assert result.cost.evaluations < 7e4


@pytest.mark.parametrize("interpolation", ["cubic", "pchip", "linear", "step"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7, 1e-9])
def test_what_it_states_holds(interpolation, rtol):
    scene = engine(1440, interpolation, rtol)
    result = simulate(scene, formulation="minimal")
    exact = simulate(scene, formulation="crank_angle", rtol=1e-12)
    assert max(each.share for each in differences(result, exact)) <= 2.0


@pytest.mark.parametrize(
    ("interpolation", "order", "least"),
    [("cubic", 4, 0.2), ("pchip", 3, 10.0), ("linear", 2, 200.0)],
)
def test_twice_the_rows_bend_so_much_less(interpolation, order, least):
    coarse = pressures_of(engine(720, interpolation, 1e-6))[0].bends(least)
    fine = pressures_of(engine(1440, interpolation, 1e-6))[0].bends(least / 2**order)
    assert len(fine) / 1440 == pytest.approx(len(coarse) / 720, rel=0.2)
    assert 20 < len(coarse) < 700


def test_knots_of_all_cylinders_bend_where_one_does():
    scene = engine(720, "linear", 1e-6)
    pressure = pressures_of(scene)
    machines = [Reduced(CrankTrain(scene, pressure), missed).machine for missed in (0.0, 1e-4)]
    knots, bends = (Knots(*Machine(*machine).knots).bends for machine in machines)
    assert len(knots) == 720
    assert 0 < len(bends) < 720
    assert set(np.round(bends, 9)) <= set(np.round(knots, 9))
