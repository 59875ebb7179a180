"""A rod as long as crank radius and offset together folds: every formulation stops there."""

import dataclasses
import math

import mpmath
import numpy as np
import pytest

from crankmbs import Motion, Piston, Rod, Run, load_scene, simulate

COASTING = load_scene("coasting")
RADIUS = COASTING.crank.radius


def folding(offset, until):
    return dataclasses.replace(
        COASTING,
        rod=Rod(length=RADIUS + abs(offset), mass=1.0, center_of_mass=0.02, inertia=1e-3),
        piston=Piston(mass=1.0, offset=offset),
        run=Run(until=until),
    )


@pytest.mark.parametrize("until", ["1 rev", "0.5 s"])
@pytest.mark.parametrize(("offset", "fold"), [(0.0, 90.0), (-0.01, 90.0), (0.01, 270.0)])
@pytest.mark.parametrize("formulation", ["kinetostatic", "crank_angle", "minimal"])
def test_the_run_stops_at_the_fold_with_a_sentence(formulation, offset, fold, until):
    scene = folding(offset, until)
    if formulation == "kinetostatic":
        scene = dataclasses.replace(scene, start=None, motion=Motion(speed=100.0, angle=0.3))
    result = simulate(scene, formulation=formulation)
    assert result.status == 1
    assert "the rod folds onto the crank" in result.message
    assert math.degrees(float(result.data["crank_angle"][-1])) == pytest.approx(fold, abs=1e-3)


def inertia(scene, angle):
    """J [kg m2] at a crank angle, from the velocities of rod and piston per speed, in 40 digits."""
    rod, radius = scene.rod, mpmath.mpf(scene.crank.radius)
    length, at = mpmath.mpf(rod.length), mpmath.mpf(rod.center_of_mass)
    sine, cosine = mpmath.sin(mpmath.mpf(angle)), mpmath.cos(mpmath.mpf(angle))
    sin_beta = radius * sine / length
    turns = radius * cosine / (length * mpmath.sqrt(1 - sin_beta**2))
    piston = -radius * sine - length * sin_beta * turns
    along, across = -radius * sine - at * sin_beta * turns, radius * cosine * (1 - at / length)
    moving = rod.mass * (along**2 + across**2) + rod.inertia * turns**2
    return scene.crank.inertia + moving + scene.piston.mass * piston**2


@pytest.mark.parametrize("gap", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_a_rod_that_just_escapes_the_fold_keeps_its_energy(formulation, gap):
    """Within sqrt(2 gap) of the fold the rod swings over, and the inertia nearly halves."""
    rod = dataclasses.replace(COASTING.rod, length=RADIUS * (1.0 + gap), center_of_mass=0.03)
    scene = COASTING.with_(rod=rod, gravity=None, run__until="2 rev", run__every="7 deg")
    data = simulate(scene, formulation=formulation).data
    speed = data["crank_speed"]
    with mpmath.workdps(40):
        of = [inertia(scene, angle) for angle in data["crank_angle"].values]
        exact = [float(speed.values[0] * mpmath.sqrt(of[0] / each)) for each in of]
    assert np.abs(speed.values - exact).max() <= 2.0 * speed.attrs["error_estimate"]
    assert speed.attrs["error_estimate"] < 1e-6
