"""Which formulation serves a scene, and why not another."""

from dataclasses import replace

import pytest

from crankmbs import FormulationError, Run, Start, load_scene, simulate
from crankmbs.choose import choose

PRESCRIBED, FREE = load_scene("yi_diesel"), load_scene("propeller")


@pytest.mark.parametrize(
    ("scene", "formulation", "reason"),
    [
        (PRESCRIBED, "kinetostatic", "the speed is prescribed"),
        (FREE, "crank_angle", "no step crosses a knot of the pressure table"),
        (load_scene("coasting"), "crank_angle", "one free rotation describes them exactly"),
        (replace(FREE, start=Start(angle=0.0, speed=0.0)), "crank_angle", "starts from rest"),
    ],
)
def test_auto_chooses_the_smallest_and_says_why(scene, formulation, reason):
    choice = choose(scene)
    assert choice.formulation == formulation
    assert reason in " ".join(choice.reasons)


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal", "multibody"])
def test_asked_for(formulation):
    reason = "asked for; auto would choose crank_angle"
    assert choose(FREE, formulation) == (formulation, (reason,))


@pytest.mark.parametrize(
    ("scene", "formulation", "sentence"),
    [
        (PRESCRIBED, "minimal", "the speed is prescribed; choose auto, kinetostatic or multibody"),
        (FREE, "kinetostatic", "is free; choose auto, crank_angle, minimal or multibody"),
        (FREE, "lagrange", "no such formulation; choose auto, crank_angle, minimal or multibody"),
    ],
)
def test_one_that_cannot_serve_says_which_can(scene, formulation, sentence):
    with pytest.raises(FormulationError, match=f"formulation {formulation!r} cannot serve") as got:
        choose(scene, formulation)
    assert sentence in str(got.value)


def test_the_scene_itself_may_ask():
    scene = replace(FREE, run=Run(until="10 deg", formulation="minimal"))
    assert simulate(scene).formulation == "minimal"
    assert simulate(scene, formulation="crank_angle").formulation == "crank_angle"
