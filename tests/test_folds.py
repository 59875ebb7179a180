"""A rod as long as crank radius and offset together folds: every formulation stops there."""

import dataclasses
import math

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
