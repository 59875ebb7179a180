"""A prescribed speed set free in the page: it is what `crankmbs.freed` gives, at the ends of every
knob too, or what cannot be is said in its words."""

import math
from dataclasses import replace

import pytest
from page_scenes import refused
from page_visit import assert_same, expected, opened
from turned import turned

from crankmbs import (
    Fuel,
    InputError,
    Motion,
    Ramp,
    Run,
    SpeedFile,
    Table,
    freed,
    load_scene,
    shipped_scenes,
    simulate,
)
from crankmbs.design.freed import mean_prescribed
from crankmbs.measures import measure
from crankmbs.page import page_of
from crankmbs.page.knobs import choices_of, knobs_of
from crankmbs.scene.gas import Polytrope

pytestmark = pytest.mark.slow

DRIVEN = [name for name in shipped_scenes() if load_scene(name).motion is not None]


def shown(values):
    return "#" + "&".join(f"{name}={value}" for name, value in values.items())


def free(scene, **values):
    """A scene's knobs with the crank free, with a flywheel where the scene has none."""
    light = {} if scene.crank.moment_of_inertia else {"flywheel": 0.02}
    return {"speed_is": "free", **light, **values}


def of_python(scene, values):
    found = turned(scene, values)
    return expected(found, speed=found.start.speed)


@pytest.mark.parametrize("name", DRIVEN)
def test_the_switch_frees_the_crank(browser, tmp_path, name):
    scene = load_scene(name)
    with opened(browser, tmp_path, name, shown(free(scene))) as visited:
        assert visited.message == ""
        data = visited.data()
        assert_same(data, of_python(scene, free(scene)))
        mean = mean_prescribed(scene) * 30.0 / math.pi
        assert f"mean speed\n{mean:.1f} rpm" in visited.text("#numbers")
        assert visited.text("#badge").startswith("settled under the constant torque that balances")
        visited.page.select_option("[data-state=speed_is]", "prescribed")
        assert visited.settle().text("#badge").startswith("prescribed speed")
        assert "speed_is" not in visited.address


def ends(scene):
    """Every knob at both ends, the last other word of a choice."""
    for knob in knobs_of(scene):
        yield from ({knob.name: knob.low}, {knob.name: knob.high})
    for choice in choices_of(scene):
        if choice.name != "speed_is":
            yield {choice.name: [word for word in choice.words if word != choice.value][-1]}


@pytest.mark.parametrize("name", DRIVEN)
def test_at_the_ends_of_every_knob_it_is_that_of_python_or_refused_as_there(
    browser, tmp_path, name
):
    scene, given, said = load_scene(name), 0, set()
    with opened(browser, tmp_path, name, shown(free(scene))) as visited:
        good = visited.settle().curve()
        for end in ends(scene):
            values = free(scene, **end)
            try:
                found, sentence = turned(scene, values), ""
            except InputError as error:
                found, sentence = scene, str(error)
            visited.go(shown(values))
            if sentence:
                visited.page.wait_for_function(f"(text) => {SAYS} === text", arg=own(sentence))
                assert visited.draws(good)
                said.add(sentence.partition(":")[0])
                continue
            visited.page.wait_for_function(f"() => {SAYS} === ''")
            assert_same(visited.data(), expected(found, speed=found.start.speed))
            good, given = visited.curve(), given + 1
    assert given > 10
    assert said <= {"crank", "crank.inertia", "rod"}, said


SAYS = "document.getElementById('message').textContent"


def own(sentence):
    """As the page says it, without the part that has the key, and with the label of the knob."""
    return sentence.removeprefix("crank: ").replace("crank.inertia:", "flywheel:")


def test_a_crank_near_rest_keeps_the_picture_until_the_flywheel_is_turned_up(browser, tmp_path):
    scene = load_scene("friction")
    scene = replace(scene, friction=replace(scene.friction, viscous=0.0))
    with opened(browser, tmp_path, scene) as visited:
        good = visited.settle().curve()
        visited.page.select_option("[data-state=speed_is]", "free")
        assert visited.message == own(refused(freed, scene))
        assert "comes near rest in every cycle; give it a heavier flywheel; 0 kg" in visited.message
        assert visited.draws(good)
        assert "free" not in visited.address
        visited.type("flywheel", 0.02)
        assert visited.message == ""
        assert "speed_is=free" in visited.address
        assert_same(visited.data(), of_python(scene, free(scene)))


def test_friction_beyond_all_measure_is_not_called_a_light_crank(browser, tmp_path):
    scene = load_scene("friction")
    scene = replace(scene, friction=replace(scene.friction, viscous=1e4))
    with opened(browser, tmp_path, scene) as visited:
        visited.settle().page.select_option("[data-state=speed_is]", "free")
        assert visited.message.startswith(
            "the search for the motion that repeats itself finds none"
        )
        visited.type("flywheel", 0.1)
        assert visited.message == ""


def test_without_any_inertia_it_is_refused_in_pythons_words(browser, tmp_path):
    scene = load_scene("grega_lecture")
    bare = replace(scene.rod, mass=0.0, inertia=0.0, center_of_mass=0.0)
    scene = replace(scene, crank=replace(scene.crank, inertia=None), rod=bare)
    with opened(browser, tmp_path, scene) as visited:
        visited.settle().page.select_option("[data-state=speed_is]", "free")
        assert visited.message == own(refused(freed, scene))
        assert "needs an inertia above 0" in visited.message
        visited.type("flywheel", 0.05)
        assert visited.message == ""
        assert_same(visited.data(), of_python(scene, {"speed_is": "free", "flywheel": 0.05}))


ROWS = Table((0.0, 2.0, 4.0, 2.0 * math.pi), (300.0, 340.0, 280.0, 300.0))
CHANGING = {
    "over the angle": SpeedFile(file=ROWS, kind="angle_table", interpolation="cubic"),
    "over time": SpeedFile(file=Table((0.0, 0.02, 0.2), (280.0, 300.0, 260.0))),
    "rising": Ramp(start=250.0, to=330.0, over=0.02),
}


@pytest.mark.parametrize("name", CHANGING)
def test_a_speed_without_a_knob_is_set_free_too(browser, tmp_path, name):
    scene = load_scene("yi_diesel")
    motion = Motion(speed=CHANGING[name], angle=0.2)
    run = Run(until="1.6 cycles", formulation="kinetostatic")
    scene = replace(scene, motion=motion, run=run)
    with opened(browser, tmp_path, scene, "#speed_is=free&flywheel=0.1") as visited:
        data = visited.data()
    assert_same(data, of_python(scene, {"speed_is": "free", "flywheel": 0.1}))


def test_what_no_one_load_balances_has_no_switch_and_says_why(browser, tmp_path):
    scene = load_scene("yi_diesel")
    motored = Polytrope(polytrope=1.32, closes=math.radians(-20.0), compression_ratio=18.0)
    burning = replace(scene, gas=replace(scene.gas, motored=motored), fuel=Fuel())
    assert "speed_is" not in {choice.name for choice in choices_of(burning)}
    with opened(browser, tmp_path, burning) as visited:
        assert refused(freed, burning) in visited.settle().text("#driven")
    assert "Free, one constant torque balances the cycle" in page_of(scene, "mine")
    assert 'id="driven"' not in page_of(load_scene("propeller"), "mine")


def test_the_heaviest_flywheel_of_a_prescribed_speed_evens_it_to_a_hundredth():
    """Also where the scene has hardly any."""
    for name in DRIVEN:
        scene = load_scene(name)
        (knob,) = (each for each in knobs_of(scene) if each.name == "flywheel")
        heavy = freed(replace(scene, crank=replace(scene.crank, inertia=knob.high)))
        assert measure(simulate(heavy)).fluctuation.value < 0.0101
