"""The engine of the page against Python: every shipped scene, its settled motion and the lecture's
formulas."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_engine import differences, sizes, unlike
from page_scenes import SETTLING, sampled, settled, shortened

from crankmbs import load_scene, simulate
from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.measures import last_span, mean_speed, measure
from crankmbs.mechanics.train import crank_train
from crankmbs.page import exported, refusals
from crankmbs.page.export import encoded
from crankmbs.scene.bearings import Bearings
from crankmbs.scene.parts import Gravity, Layout

pytestmark = pytest.mark.slow

SHOWN_LECTURES = ("untruncated lecture", "S1 (motion and forces truncated)")
FREE = ("coasting", "propeller", "v_twin", "yi_diesel_free")
DRIVEN = ("compressor", "grega_lecture", "yi_diesel")

SCENES = [
    *(pytest.param(load_scene(name), id=name) for name in DRIVEN),
    *(pytest.param(shortened(load_scene(name)), id=name) for name in FREE),
    *(pytest.param(settled(name), id=f"{name} settled") for name in SETTLING),
]


@pytest.mark.parametrize("scene", SCENES)
def test_motion_every_reaction_and_measure_are_those_of_python(engine, scene):
    assert refusals(scene) == ()
    fine = sampled(scene, 0.25)
    result = simulate(fine, rtol=1e-12)
    found = engine.answer(fine, result.data["crank_angle"].values)
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])
    measures = measure(result)
    assert unlike(measures, found["measures"], sizes(result, measures)) == {}
    if scene.settles:
        assert found["factor"] == pytest.approx(result.decay.factor, abs=1e-12)


@pytest.mark.parametrize("name", ["propeller", "yi_diesel_free"])
def test_the_work_of_a_settled_cycle_is_nothing(engine, name):
    scene = replace(settled(name), gravity=None)
    found = engine.answer(scene, [0.0, scene.period])["measures"]
    gas = found["indicated_power"] / found["mean_speed"]
    assert gas == pytest.approx(-found["external_torque"], rel=1e-11)
    assert abs(found["speed_gain"]) < 1e-11 * found["mean_speed"]


@pytest.mark.parametrize("lecture", SHOWN_LECTURES)
@pytest.mark.parametrize("name", ["yi_diesel", "v_twin", "grega_lecture"])
def test_the_lectures_formulas_are_those_of_python(engine, name, lecture):
    scene = load_scene(name)
    theta = np.linspace(0.0, 4.0 * math.pi, 73)
    omega, alpha = 300.0 + 10.0 * np.cos(theta), -3e3 * np.sin(theta)
    expected = lectured(LECTURES[lecture], crank_train(scene), theta, omega, alpha)
    names = ("theta", "omega", "alpha")
    rows = np.column_stack([theta, omega, alpha]).tolist()
    samples = [{**dict(zip(names, row, strict=True)), "shares": []} for row in rows]
    found = engine.ask("lectured", scene=exported(scene), lecture=lecture, samples=samples)
    assert found.keys() >= {"side thrust", "torque", "crank pin force x", "main bearing force y"}
    for quantity in found:
        values = expected[quantity]
        np.testing.assert_allclose(
            found[quantity], values, rtol=0.0, atol=1e-13 * np.abs(values).max(), err_msg=quantity
        )


def test_a_firing_order_and_the_mean_speed_are_passed_on(engine):
    scene = replace(settled("v_twin"), layout=Layout(firing_order=(1, 3, 2), spacing=0.1))
    result = simulate(scene, rtol=1e-12)
    found = engine.answer(scene, result.data["crank_angle"].values)
    assert max(differences(result, found["variables"]).values()) < 1e-9
    assert "rocking_moment_x" in found["variables"]
    expected = mean_speed(result, last_span(result)).value
    assert found["measures"]["mean_speed"] == pytest.approx(expected, rel=1e-12)


def test_unbalanced_throws_rock_as_in_python(engine):
    """Also those that stand aside from the middle, with what the crank weighs."""
    places = ("0 mm", "100 mm", "260 mm", "300 mm")
    cylinders = tuple(
        replace(each, position=place)
        for each, place in zip(load_scene("yi_diesel_free").cylinders, places, strict=True)
    )
    unbalances = ("-20 kg mm", "5 kg mm", "-10 kg mm", "-25 kg mm")
    scene = settled("yi_diesel_free").with_(
        layout=Layout(cylinders=cylinders),
        gravity=Gravity(acceleration=300.0, angle=1.0),
        crank__mass="20 kg",
        crank__center_of_mass="-2 mm",
        bearings=Bearings(throw_unbalance=unbalances),
    )
    result = simulate(scene, rtol=1e-12)
    found = engine.answer(scene, result.data["crank_angle"].values)
    for axis in "xy":
        rocks = result.data[f"rocking_moment_{axis}"].values
        ours = np.ravel(found["variables"][f"rocking_moment_{axis}"])
        np.testing.assert_allclose(ours, rocks, rtol=0.0, atol=1e-9 * np.abs(rocks).max())


CACHED = """(text) => {
  const scene = answers.decoded(JSON.parse(text));
  const nodes = (each) => engine.run(each).grid.nodes;
  const crank = { ...scene.crank, inertia: 3 * scene.crank.inertia };
  const loads = scene.loads.map((load) => ({ ...load, over_speed: {
    ...load.over_speed, pieces: load.over_speed.pieces.map((each) => 2 * each) } }));
  const heavier = { ...scene.rod, mass: 2 * scene.rod.mass };
  const longer = { ...scene.rod, length: 1.1 * scene.rod.length };
  const kept = (change) => nodes(scene) === nodes({ ...scene, ...change });
  return [{ crank }, { loads }, { rod: heavier }, { rod: longer }].map(kept);
}"""


def test_flywheel_and_load_rebuild_no_table(engine):
    scene = replace(settled("yi_diesel_free"), gravity=Gravity(acceleration=9.81))
    flywheel, loads, heavier, longer = engine.v8.call(f"({CACHED})", encoded(exported(scene)))
    assert flywheel
    assert loads
    assert not heavier
    assert not longer
