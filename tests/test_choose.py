"""Which formulation serves a scene, and why not another."""

from dataclasses import replace

import pytest

from crankmbs import FormulationError, Layout, Motion, Run, Start, load_scene, simulate
from crankmbs.choose import choose
from crankmbs.motion import formulations, kinetostatic
from crankmbs.motion.assemble import assemble
from crankmbs.work_precision.formulations import formulations_of
from crankmbs.work_precision.reference import reference_of

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
    chosen, (reason, *cost) = choose(FREE, formulation)
    assert (chosen, reason) == (formulation, "asked for; auto would choose crank_angle")
    assert bool(cost) == (formulation == "multibody")


@pytest.mark.parametrize(
    ("changes", "cost"),
    [
        ({"run__until": "10 rev"}, ["exudyn takes 11,000 steps or more, some 0.55 s"]),
        ({"run__until": "5 ms"}, ["exudyn takes 1,100 steps or more, some 0.055 s"]),
    ],
)
def test_what_exudyn_takes_is_said_beforehand(changes, cost):
    assert list(choose(FREE.with_(**changes), "multibody").reasons[1:]) == cost
    three = replace(FREE.with_(run__until="10 rev"), layout=Layout(firing_order=(1, 3, 2)))
    assert choose(three, "multibody").reasons[1].endswith("11,000 steps or more, some 1.6 s")


def test_how_far_a_crank_from_rest_turns_is_not_known_beforehand():
    scene = load_scene("torque_driven")
    assert "how many turns shows on the way" in choose(scene, "multibody").reasons[1]
    assert choose(load_scene("yi_diesel"), "multibody").reasons[1:] == ()


@pytest.mark.parametrize(
    ("scene", "formulation", "sentence"),
    [
        (PRESCRIBED, "minimal", "the speed is prescribed; choose auto, kinetostatic or multibody"),
        (FREE, "kinetostatic", "is free; choose auto, crank_angle, minimal or multibody"),
        (FREE, "lagrange", "no such formulation; choose auto, crank_angle, minimal or multibody"),
        (FREE, "multi-body", 'minimal or multibody; did you mean "multibody"?'),
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


def test_a_formulation_is_one_record(monkeypatch):
    """Even a toy, which turns at the speed of the start and forgets the torques."""
    steady = replace(FREE, start=None, torque=(), motion=Motion(speed=FREE.start.speed))

    def run(train, rtol, cost_cap):
        toy = replace(train, scene=steady)
        return assemble(toy, kinetostatic.run(toy))

    toy = formulations.Formulation("toy", lambda scene: "it has gas" if scene.gas else "", run)
    monkeypatch.setattr(formulations, "FORMULATIONS", (*formulations.FORMULATIONS, toy))
    coasting = load_scene("coasting")
    assert "choose auto, crank_angle, minimal, multibody or toy" in refusal(coasting, "lagrange")
    assert "it has gas; choose" in refusal(FREE, "toy")
    scene = replace(FREE, gas=None)
    result = simulate(scene, formulation="toy")
    assert result.formulation == "toy"
    assert float(result.data["crank_speed"].max()) == FREE.start.speed
    assert "toy" in [one.name for one in formulations_of(scene, reference_of(scene))]


def refusal(scene, formulation):
    with pytest.raises(FormulationError) as got:
        choose(scene, formulation)
    return str(got.value)
