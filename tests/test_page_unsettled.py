"""What has no settled motion in the page's engine."""

from dataclasses import replace

from page_scenes import settled

from crankmbs import load_scene, simulate
from crankmbs.scene.loads import Constant


def test_what_does_not_settle_is_named(engine):
    base = replace(settled("coasting"), gravity=None)
    for torque, ending in ((5.0, "runs_away"), (-5.0, "decays")):
        scene = replace(base, torque=(Constant(torque=torque),))
        assert engine.answer(scene, [0.0])["ending"] == ending


def test_a_crank_that_comes_to_rest_is_named(engine):
    scene = replace(load_scene("coasting"), torque=(Constant(torque=-40.0),))
    assert simulate(scene).status in (0, 1)
    assert engine.answer(scene, [0.3])["ending"] == "slow"
