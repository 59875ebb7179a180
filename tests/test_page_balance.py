"""Loads rebalanced to a mean speed in the page, and what has no settled motion."""

from dataclasses import replace

import pytest
from page_scenes import settled

from crankmbs import load_scene, simulate
from crankmbs.measures import last_span, mean_speed
from crankmbs.page import exported
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import Constant, Quadratic, Viscous

pytestmark = pytest.mark.slow


def taking(torque):
    return Constant(torque=torque), Viscous(coefficient=0.02), Quadratic(coefficient=1e-5)


BALANCED = {
    "quadratic": settled("propeller"),
    "constant": replace(settled("yi_diesel_free"), torque=(Constant(torque=-20.0),)),
    "driven": replace(settled("yi_diesel_free"), gas=None, torque=taking(9.0)),
    "backwards": replace(
        settled("coasting"), start=Start(angle=0.0, speed=-300.0), torque=taking(-9.0)
    ),
}


@pytest.mark.parametrize("name", BALANCED)
def test_loads_are_rebalanced_to_the_mean_speed(page, name):
    scene = BALANCED[name]
    speed = 1.05 * scene.start.speed
    rough, fine = page.ask("balancing", scene=exported(scene), speed=speed)
    assert rough["ending"] == fine["ending"] == "complete"
    assert rough["share"] == pytest.approx(fine["share"], rel=3e-3)
    takes = [load for load in scene.torque if load(0.0, 0.0, speed) * speed < 0.0]
    loads = tuple(
        load.scaled(fine["share"], 1.0) if load in takes else load for load in scene.torque
    )
    start = replace(scene.start, speed=speed)
    if name == "constant":
        page_mean = page.answer(replace(scene, torque=loads, start=start), [0.0, scene.period])
        assert page_mean["balanced"]
        assert page_mean["measures"]["mean_speed"] == pytest.approx(speed, rel=1e-12)
        return
    result = simulate(replace(scene, torque=loads, start=start), rtol=1e-12)
    found = mean_speed(result, last_span(result))
    assert found.value == pytest.approx(speed, rel=1e-9)


def test_what_no_share_of_a_load_balances_is_named(page):
    lifted = replace(settled("coasting"), torque=(Viscous(coefficient=0.1),))
    for found in page.ask("balancing", scene=exported(lifted), speed=100.0):
        assert found["ending"] == "unbalanced"


def test_what_does_not_settle_is_named(page):
    base = replace(settled("coasting"), gravity=None)
    for torque, ending in ((5.0, "runs_away"), (-5.0, "decays")):
        scene = replace(base, torque=(Constant(torque=torque),))
        assert page.answer(scene, [0.0])["ending"] == ending


def test_a_crank_that_comes_to_rest_is_named(page):
    scene = replace(load_scene("coasting"), torque=(Constant(torque=-40.0),))
    assert simulate(scene).status in (0, 1)
    assert page.answer(scene, [0.3])["ending"] == "slow"
