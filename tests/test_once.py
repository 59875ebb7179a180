"""What follows from a frozen object is made once, and stays with that very object."""

import copy
import gc
import pickle
import weakref
from dataclasses import replace

import pytest

from crankmbs import load_scene, simulate
from crankmbs.measures.span import measured_span, passes_over
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.free.passes import first_grid
from crankmbs.numerics.once import once
from crankmbs.sweep import block


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


@pytest.fixture
def no_collector():
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def test_a_result_leaves_the_memory_with_its_name(no_collector):
    """What measures are read from is large, and a circle of it would stay."""
    result = simulate(load_scene("propeller"))
    result.measures()
    passes = passes_over(result, measured_span(result))
    motions = [weakref.ref(motion) for motion in (passes.answer, *passes.checks)]
    del result, passes
    assert [motion() for motion in motions] == [None, None]


def test_a_case_of_a_sweep_leaves_the_memory_when_it_is_done(no_collector, monkeypatch):
    seen = []

    def watched(scene):
        seen.append(weakref.ref(first_grid(crank_train(scene), scene.run.rtol)))
        return simulate(scene)

    monkeypatch.setattr(block, "simulate", watched)
    scene = load_scene("v_twin")
    solved = block.solved(block.Job(scene, ("crank.inertia",), ((0.1,), (0.2,)), True))
    assert solved["status"].tolist() == [0, 0]
    assert [grid() for grid in seen] == [None, None]
