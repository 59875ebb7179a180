"""A prescribed speed set free by the page's engine: load, mean speed, motion and every reaction are
those of `crankmbs.freed`, of shipped scenes and random ones."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_engine import differences, sizes, unlike
from page_guards import DRAGS, PUSHES, driven, uneven
from page_scenes import refused

from crankmbs import freed, load_scene, shipped_scenes, simulate
from crankmbs.design.freed import mean_prescribed
from crankmbs.measures import measure
from crankmbs.page import exported
from crankmbs.scene.run import Extent
from validation.random_page import random_page

pytestmark = pytest.mark.slow

DRIVEN = [name for name in shipped_scenes() if load_scene(name).motion is not None]
RANDOM = range(2003, 2200, 4)  # of random_page every fourth scene is driven
HEAVIER = {"friction": 0.02}  # kg m2, the scene has none


def heavier(name):
    scene = load_scene(name)
    inertia = HEAVIER.get(name, scene.crank.inertia)
    return replace(scene, crank=replace(scene.crank, inertia=inertia))


def freed_in(engine, scene, every):
    """The motion of Python and the answer of the page at its angles."""
    found = freed(scene)
    run = replace(found.run, every=Extent(value=every, unit="rad"))
    result = simulate(replace(found, run=run), rtol=1e-12)
    assert result.status == 0, result.message
    angles = result.data["crank_angle"].values
    return result, engine.ask("freeing", scene=exported(scene), angles=angles)


def assert_freed(engine, scene, every):
    result, found = freed_in(engine, scene, every)
    assert found["ending"] == "complete"
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])
    assert found["speed"] == pytest.approx(mean_prescribed(scene), rel=1e-13)
    drags = [force.law.viscous for force in scene.force]
    drags.append(0.0 if scene.friction is None else scene.friction.viscous)
    assert found["balanced"] == (not any(drags))
    (load,) = result.scene.torque
    kinetic = result.data["kinetic_energy"].values
    size = max(abs(load.torque), kinetic.max() / result.scene.settled_period)
    assert found["torque"] == pytest.approx(load.torque, abs=1e-11 * size)
    return result, found


@pytest.mark.parametrize("name", DRIVEN)
def test_a_shipped_scene_is_set_free_as_in_python(engine, name):
    result, found = assert_freed(engine, heavier(name), math.radians(0.25))
    measures = measure(result)
    assert unlike(measures, found["measures"], sizes(result, measures)) == {}


@pytest.mark.parametrize("force", [PUSHES, DRAGS], ids=["pushed", "dragged"])
def test_unlike_cylinders_with_forces_on_the_pistons_are_set_free_as_in_python(engine, force):
    assert_freed(engine, replace(uneven(driven(300.0)), force=force), 0.1)


@pytest.mark.parametrize("seed", RANDOM)
def test_a_random_scene_is_set_free_as_in_python(engine, seed):
    assert_freed(engine, random_page(seed), 0.1)


def lightened(seed):
    """With so little inertia that the speed swings widely, or the crank comes to rest."""
    scene = random_page(seed)
    light = max(1e-3 * scene.crank.inertia, scene.crank.mass * scene.crank.center_of_mass**2)
    return replace(scene, crank=replace(scene.crank, inertia=light), friction=None)


def test_light_cranks_are_set_free_as_in_python_or_come_near_rest(engine):
    """Near rest is where the energy would be gone within half a degree."""
    swings = []
    for seed in RANDOM[::2]:
        scene = lightened(seed)
        if sentence := refused(freed, scene):
            assert "comes near rest in every cycle" in sentence
            asked = engine.ask("freeing", scene=exported(scene), angles=np.array([0.0, 1.0]))
            assert asked["ending"] == "light"
            continue
        result, found = freed_in(engine, scene, 0.1)
        assert max(differences(result, found["variables"]).values()) < 1e-9
        swings.append(np.ptp(result.data["crank_speed"].values) / abs(mean_prescribed(scene)))
    assert len(swings) > 10
    assert max(swings) > 0.5
