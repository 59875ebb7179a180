"""What follows from a frozen object is made once, and stays with that very object."""

import copy
import pickle
from dataclasses import replace

import pytest

from crankmbs import load_scene
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.free.passes import first_grid
from crankmbs.numerics.once import once


def test_a_scene_has_one_crank_train_and_that_one_grid_for_each_order():
    scene = load_scene("coasting")
    train = crank_train(scene)
    assert crank_train(scene) is train
    assert first_grid(train, 1e-9) is first_grid(train, 1e-9)
    assert len(first_grid(train, 1e-3).rule.nodes) < len(first_grid(train, 1e-9).rule.nodes)


@pytest.mark.parametrize(
    "again", [replace, copy.deepcopy, lambda scene: pickle.loads(pickle.dumps(scene))]
)
def test_another_scene_begins_anew_though_it_is_equal(again):
    """Functions among its loads are its own, and remember how they failed."""
    scene = load_scene("coasting")
    train, other = crank_train(scene), again(scene)
    assert other == scene
    assert crank_train(other) is not train
    assert crank_train(other).scene is other


def test_what_fails_is_asked_again():
    asked = []

    @once
    def never(train):
        asked.append(train)
        raise ValueError("no")

    train = crank_train(load_scene("coasting"))
    for _ in range(2):
        with pytest.raises(ValueError, match="no"):
            never(train)
    assert len(asked) == 2
