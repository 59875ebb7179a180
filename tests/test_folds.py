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


@pytest.mark.parametrize("rod", [COASTING.rod, Rod(length=1.0)])
@pytest.mark.parametrize("gap", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_a_rod_that_just_escapes_the_fold_keeps_its_energy(formulation, gap, rod):
    """Within sqrt(2 gap) of the fold the rod swings over, and the inertia falls by as much."""
    at = 0.03 if rod.mass else 0.0
    rod = dataclasses.replace(rod, length=RADIUS * (1.0 + gap), center_of_mass=at)
    scene = COASTING.with_(rod=rod, gravity=None, run__until="2 rev", run__every="7 deg")
    data = simulate(scene, formulation=formulation).data
    speed = data["crank_speed"]
    with mpmath.workdps(40):
        of = [inertia(scene, angle) for angle in data["crank_angle"].values]
        exact = [float(speed.values[0] * mpmath.sqrt(of[0] / each)) for each in of]
    assert np.abs(speed.values - exact).max() <= 2.0 * speed.attrs["error_estimate"]
    assert speed.attrs["error_estimate"] < 1e-6


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_the_mean_force_of_a_driven_crank_is_that_across_the_fold(gap):
    """Of a rod without mass: piston's mass times acceleration over the cosine of the rod angle."""
    ratio, speed = 1.0 / (1.0 + gap), 100.0
    rod, motion = Rod(length=RADIUS / ratio), Motion(speed=speed, angle=0.3)
    scene = COASTING.with_(rod=rod, gravity=None, start=None, motion=motion, run__until="4 rev")
    mean = simulate(scene).measures().joints[0].mean

    def force(angle):
        sine, cosine = mpmath.sin(angle), mpmath.cos(angle)
        of_rod = 1 - (ratio * sine) ** 2
        bend = ratio * (1 - 2 * sine**2) / mpmath.sqrt(of_rod)
        bend += ratio**3 * (sine * cosine) ** 2 / of_rod ** mpmath.mpf("1.5")
        return -scene.piston.mass * RADIUS * speed**2 * (cosine + bend) / mpmath.sqrt(of_rod)

    with mpmath.workdps(30):
        fold = mpmath.pi / 2
        beside = [mpmath.sqrt(2 * gap) * 4**k for k in range(-4, 40)]
        angles = [fold - x for x in beside] + [fold + x for x in beside] + [0, fold, mpmath.pi]
        angles = sorted(angle for angle in angles if 0 <= angle <= mpmath.pi)
        signs = [mpmath.sign(force(angle)) for angle in angles]
        pairs = list(zip(angles, angles[1:], signs, signs[1:], strict=False))
        turns = [
            mpmath.findroot(force, (a, b), solver="anderson") for a, b, s, t in pairs if s != t
        ]
        total = mpmath.quad(lambda angle: abs(force(angle)), sorted(angles + turns))
        exact = float(total / mpmath.pi)
    assert abs(mean.value - exact) <= 2.0 * mean.error
    assert mean.error < 1e-6 * exact
