"""The engine of the page against Python: every shipped scene, its settled motion, the lecture's
formulas and pressures carried over, in a real browser."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_engine import differences, engine, sizes, unlike

from crankmbs import load_scene, simulate
from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.measures import last_span, mean_speed, measure
from crankmbs.mechanics.carried import carried_over
from crankmbs.mechanics.train import crank_train
from crankmbs.page import exported, joined, refusals
from crankmbs.page.export import encoded
from crankmbs.page.script import FOLDER
from crankmbs.scene.drives import Motion, SpeedFile, Start
from crankmbs.scene.fuel import Fuel, Governor, Misfire
from crankmbs.scene.gas import Polytrope
from crankmbs.scene.loads import Constant, Quadratic, Viscous
from crankmbs.scene.parts import Friction, Gravity, Layout
from crankmbs.scene.python_load import Load
from crankmbs.scene.scene import Extent
from crankmbs.scene.tables import Table

FREE = ("coasting", "propeller", "v_twin", "yi_diesel_free")
DRIVEN = ("compressor", "grega_lecture", "yi_diesel")
SETTLING = ("propeller", "v_twin", "yi_diesel_free")


@pytest.fixture(scope="module")
def page():
    with engine() as opened:
        yield opened


def shortened(scene, cycles=3.0):
    """A run that shows all of it in a fraction of the time."""
    until = Extent(value=cycles, unit="cycle")
    return replace(scene, run=replace(scene.run, until=until))


def sampled(scene, degrees):
    every = Extent(value=math.radians(degrees), unit="rad")
    return replace(scene, run=replace(scene.run, every=every))


def settled(name):
    scene = load_scene(name)
    return replace(scene, run=replace(scene.run, until="settled"))


SCENES = [
    *(pytest.param(load_scene(name), id=name) for name in DRIVEN),
    *(pytest.param(shortened(load_scene(name)), id=name) for name in FREE),
    *(pytest.param(settled(name), id=f"{name} settled") for name in SETTLING),
]


@pytest.mark.parametrize("scene", SCENES)
def test_motion_and_every_reaction_are_those_of_python(page, scene):
    assert refusals(scene) == ()
    result = simulate(scene, rtol=1e-12)
    found = page.answer(scene, result.data["crank_angle"].values)
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])
    if scene.settles:
        assert found["factor"] == pytest.approx(result.decay.factor, abs=1e-12)


@pytest.mark.parametrize("scene", SCENES)
def test_measures_are_those_of_python(page, scene):
    fine = sampled(scene, 0.25)
    result = simulate(fine, rtol=1e-12)
    measures = measure(result)
    found = page.answer(fine, result.data["crank_angle"].values)["measures"]
    assert unlike(measures, found, sizes(result, measures)) == {}


@pytest.mark.parametrize("name", ["propeller", "yi_diesel_free"])
def test_the_work_of_a_settled_cycle_is_nothing(page, name):
    scene = replace(settled(name), gravity=None)
    found = page.answer(scene, [0.0, scene.period])["measures"]
    gas = found["indicated_power"] / found["mean_speed"]
    assert gas == pytest.approx(-found["external_torque"], rel=1e-11)
    assert abs(found["speed_gain"]) < 1e-11 * found["mean_speed"]


@pytest.mark.parametrize("lecture", LECTURES)
@pytest.mark.parametrize("name", ["yi_diesel", "v_twin", "grega_lecture"])
def test_the_lectures_formulas_are_those_of_python(page, name, lecture):
    scene = load_scene(name)
    theta = np.linspace(0.0, 4.0 * math.pi, 73)
    omega, alpha = 300.0 + 10.0 * np.cos(theta), -3e3 * np.sin(theta)
    expected = lectured(LECTURES[lecture], crank_train(scene), theta, omega, alpha)
    names = ("theta", "omega", "alpha")
    rows = np.column_stack([theta, omega, alpha]).tolist()
    samples = [{**dict(zip(names, row, strict=True)), "shares": []} for row in rows]
    found = page.ask("lectured", scene=exported(scene), lecture=lecture, samples=samples)
    assert found.keys() == expected.keys()
    for quantity, values in expected.items():
        np.testing.assert_allclose(
            found[quantity], values, rtol=0.0, atol=1e-13 * np.abs(values).max(), err_msg=quantity
        )


def altered(scene, length=1.0, offset=0.0, radius=1.0):
    crank = replace(scene.crank, radius=scene.crank.radius * radius)
    piston = replace(scene.piston, offset=scene.piston.offset + offset)
    rod = replace(scene.rod, length=scene.rod.length * length)
    return replace(scene, crank=crank, rod=rod, piston=piston)


def fuelled(name, **gas):
    scene = load_scene(name)
    return replace(scene, gas=replace(scene.gas, **gas), fuel=Fuel(misfire=(MISFIRE,)))


MISFIRE = Misfire(cylinder=1, cycles="every 3")
POLYTROPE = Polytrope(polytrope=1.32, closes=math.radians(-20.0), compression_ratio=18.0)


@pytest.mark.parametrize(
    "change", [{"length": 0.75}, {"offset": 0.011}, {"offset": -0.007, "radius": 0.9}], ids=str
)
@pytest.mark.parametrize("interpolation", ["step", "linear", "pchip", "cubic"])
def test_pressures_are_carried_over_as_in_python(page, interpolation, change):
    for name in ("propeller", "yi_diesel"):
        scene = load_scene(name)
        scene = replace(scene, gas=replace(scene.gas, interpolation=interpolation))
        assert_carried(page, scene, altered(scene, **change))


@pytest.mark.parametrize("change", [{"length": 0.75}, {"offset": 0.011}], ids=str)
def test_diagrams_and_combustion_are_carried_over_too(page, change):
    diagram = load_scene("v_twin")
    late = replace(diagram.gas.indicator, pre_expansion=1.3)
    fired = replace(
        diagram, gas=replace(diagram.gas, indicator=late), fuel=Fuel(misfire=(MISFIRE,))
    )
    for scene in (diagram, fired, fuelled("yi_diesel_free", motored=POLYTROPE)):
        assert_carried(page, scene, altered(scene, **change))


def assert_carried(page, before, scene):
    train = crank_train(carried_over(scene, before))
    shape = {
        "radius": scene.crank.radius,
        "length": scene.rod.length,
        "offset": scene.piston.offset,
    }
    found = page.ask("carried", scene=exported(before), shape=shape)
    for name, expected in (("pressure", train.pressure), ("combustion", train.combustion or ())):
        assert len(found[name]) == len(expected)
        for (knots, coefficients), one in zip(found[name], expected, strict=True):
            phi = 0.5 * (one.knots[1:] + one.knots[:-1])
            cubics = np.reshape(coefficients, (4, -1))
            size = np.abs(train.pressure[0].coefficients[3]).max()
            np.testing.assert_allclose(knots, one.knots, rtol=0.0, atol=1e-11)
            moved = type(one)(np.array(knots), cubics)
            np.testing.assert_allclose(moved(phi), one(phi), rtol=0.0, atol=1e-11 * size)


@pytest.mark.parametrize("change", [{}, {"length": 1.08, "offset": 0.004}], ids=["", "geometry"])
@pytest.mark.parametrize("name", SETTLING)
def test_what_is_shown_while_a_knob_moves_is_right_to_less_than_a_pixel(page, name, change):
    before = settled(name)
    scene = altered(before, **change)
    result = simulate(carried_over(scene, before), rtol=1e-10)
    moved = {**exported(scene), "gas": exported(before)["gas"]}
    found = page.ask("dragged", scene=moved, angles=result.data["crank_angle"].values)
    worst = differences(result, found)
    assert max(worst.values()) < 1e-3, max(worst.items(), key=lambda one: one[1])


RUBBING = Friction(ring_force=30.0, ring_pressure=0.03, viscous=20.0)
RINGS = replace(RUBBING, viscous=0.0)
RUBBED = {
    "settled": replace(settled("v_twin"), friction=RINGS),
    "settled with drag": replace(settled("propeller"), friction=RUBBING),
    "run": replace(shortened(load_scene("yi_diesel_free"), 1.5), friction=RUBBING),
    "driven": replace(load_scene("yi_diesel"), friction=RUBBING),
    "misfiring": replace(
        shortened(fuelled("yi_diesel_free", motored=POLYTROPE)),
        friction=RUBBING,
        fuel=Fuel(misfire=(Misfire(cylinder=2, cycles="1-2"),)),
    ),
    "backwards": replace(
        shortened(load_scene("coasting"), 2.0),
        friction=replace(RUBBING, ring_pressure=0.0),
        start=Start(angle=0.3, speed=-150.0),
    ),
}


@pytest.mark.parametrize("name", RUBBED)
def test_friction_of_the_pistons_is_that_of_python(page, name):
    scene = RUBBED[name]
    assert refusals(scene) == ()
    result = simulate(scene, rtol=1e-12)
    found = page.answer(scene, result.data["crank_angle"].values)
    assert "friction_force" in found["variables"]
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])


def measured(rows, *, sense=1.0, **speed):
    """A speed in rows, none of which is where a sample is."""
    scene = load_scene("yi_diesel")
    run = replace(scene.run, until=Extent(value=1.2, unit="cycle"))
    file = Table(rows[0], tuple(sense * each for each in rows[1]))
    return replace(scene, run=run, motion=Motion(speed=SpeedFile(file=file, **speed), angle=0.2))


PERIOD = ((0.013, 2.0, 3.3, 5.1, 0.013 + 2.0 * math.pi), (300.0, 310.0, 280.0, 270.0, 300.0))
WHOLE = ((-16.013, -7.0, 0.1, 5.0, 11.0, 17.017), (150.0, 310.0, 280.0, 90.0, 250.0, 300.0))
MEASURED = {
    "over time, cubic": measured(
        ((0.0, 0.02, 0.05, 0.2), (280.0, 300.0, 260.0, 300.0)), interpolation="cubic"
    ),
    "one period": measured(PERIOD, kind="angle_table"),
    "one period, cubic": measured(PERIOD, kind="angle_table", interpolation="cubic"),
    "the run": measured(WHOLE, kind="angle_table"),
    "the run, cubic": measured(WHOLE, kind="angle_table", interpolation="cubic"),
    "backwards": measured(WHOLE, kind="angle_table", sense=-1.0),
}


@pytest.mark.parametrize("name", MEASURED)
def test_measured_speeds_are_those_of_python(page, name):
    scene = MEASURED[name]
    assert refusals(scene) == ()
    result = simulate(scene, rtol=1e-12)
    found = page.answer(scene, result.data["crank_angle"].values)
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])


def test_misfires_and_late_fuel_are_those_of_python(page):
    base = fuelled("yi_diesel_free", motored=POLYTROPE)
    lists = (Misfire(cylinder=2, cycles="2-3"), Misfire(cylinder=4, cycles="every 2"))
    for fuel in (
        Fuel(misfire=lists),
        Fuel(after=0.04, until=0.09),
        Fuel(from_speed=310.0, until_speed=300.0),
    ):
        scene = shortened(replace(base, fuel=fuel), 4.0)
        result = simulate(scene, rtol=1e-12)
        found = page.answer(scene, result.data["crank_angle"].values)
        assert max(differences(result, found["variables"]).values()) < 1e-9
        assert np.ptp(result.data["fuel"].values) == 1.0


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_where_every_speed_is_periodic_the_starts_mean_is_kept(page, sense):
    base = replace(settled("yi_diesel_free"), gas=None, torque=(Constant(torque=0.0),))
    scene = replace(base, start=replace(base.start, speed=sense * 300.0))
    assert "balance" in simulate(scene).message
    found = page.answer(scene, [0.0, sense * scene.period])
    assert found["balanced"]
    assert found["factor"] == pytest.approx(1.0, abs=1e-13)
    assert found["measures"]["mean_speed"] == pytest.approx(sense * 300.0, rel=1e-13)
    assert found["measures"]["fluctuation"] > 0.01


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


CACHED = """(text) => {
  const scene = answers.decoded(JSON.parse(text));
  const tables = (each) => engine.run(each).grid.tables;
  const crank = { ...scene.crank, inertia: 3 * scene.crank.inertia };
  const loads = scene.loads.map((load) => ({ ...load, over_speed: {
    ...load.over_speed, pieces: load.over_speed.pieces.map((each) => 2 * each) } }));
  const heavier = { ...scene.rod, mass: 2 * scene.rod.mass };
  const longer = { ...scene.rod, length: 1.1 * scene.rod.length };
  const kept = (change) => {
    const [before, after] = [tables(scene), tables({ ...scene, ...change })];
    return ["angles", "inertia", "torque"].filter((name) => before[name] === after[name]);
  };
  return [{ crank }, { loads }, { rod: heavier }, { rod: longer }].map(kept);
}"""


def test_flywheel_and_load_rebuild_no_table(page):
    scene = replace(settled("yi_diesel_free"), gravity=Gravity(acceleration=9.81))
    flywheel, loads, heavier, longer = page.page.evaluate(CACHED, encoded(exported(scene)))
    assert flywheel == loads == ["angles", "inertia", "torque"]
    assert heavier == ["angles"]
    assert longer == []


def fold(scene):
    radius = scene.crank.radius
    piston = replace(scene.piston, offset=0.0)
    return replace(scene, rod=replace(scene.rod, length=radius), piston=piston)


def test_every_refusal_has_its_reason_and_the_command_that_can():
    free, driven = load_scene("yi_diesel_free"), load_scene("yi_diesel")
    governor = Governor(speed=300.0, kp=0.01, ki=0.01)
    burning = fuelled("yi_diesel_free", motored=POLYTROPE)
    speed = {"from": 100.0, "to": -50.0, "over": 0.01}
    refused = {
        "multibody": replace(free, run=replace(free.run, formulation="multibody")),
        "function": replace(free, torque=(Load(lambda t, theta, omega: 0.0),)),
        "governor": replace(burning, fuel=Fuel(governor=governor)),
        "random firing": replace(burning, fuel=Fuel(scatter=0.1)),
        "settled fuel": replace(burning, run=replace(burning.run, until="settled")),
        "fold": fold(free),
        "rest": load_scene("torque_driven"),
        "reversal": replace(driven, motion=replace(driven.motion, speed=speed)),
    }
    for reason, scene in refused.items():
        (said,) = refusals(scene)
        assert said.startswith(f"{reason}: ")
        assert said.endswith("; run it with crankmbs run")


def test_a_script_holds_no_markup_and_modules_that_cannot_be_joined_are_named(
    tmp_path, monkeypatch
):
    assert "<" not in encoded({"title": "</script><script>alert(1)", "x": np.array([1.0])})
    with pytest.raises(ValueError, match="not JSON compliant"):
        encoded({"x": math.nan})
    (tmp_path / "odd.js").write_text('import * as all from "./other.js";\n')
    monkeypatch.setattr("crankmbs.page.script.FOLDER", tmp_path)
    with pytest.raises(ValueError, match=r"odd\.js"):
        joined("odd")


def test_the_modules_are_held_to_the_length_of_the_others():
    for path in FOLDER.glob("*.js"):
        lines = path.read_text(encoding="utf-8").splitlines()
        assert len(lines) <= 300, path.name
        assert max(map(len, lines)) <= 100, path.name
        assert lines[0].startswith("/** "), path.name


def test_a_firing_order_and_the_mean_speed_are_passed_on(page):
    scene = replace(settled("v_twin"), layout=Layout(firing_order=(1, 3, 2), spacing=0.1))
    result = simulate(scene, rtol=1e-12)
    found = page.answer(scene, result.data["crank_angle"].values)
    assert max(differences(result, found["variables"]).values()) < 1e-9
    assert "rocking_moment_x" in found["variables"]
    expected = mean_speed(result, last_span(result)).value
    assert found["measures"]["mean_speed"] == pytest.approx(expected, rel=1e-12)
