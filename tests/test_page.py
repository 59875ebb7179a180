"""The page: one file that computes in the browser, shows what Python has, and refuses what cannot
be in Python's words.

Over 300 lines, as its tests share the pages and the browser that they open.
"""

import base64
import dataclasses
import hashlib
import math
import re

import numpy as np
import pytest
from browser import visiting
from page_cases import press
from page_scenes import SHOWN
from page_visit import assert_same, expected, opened
from turned import turned

from crankmbs import Fuel, InputError, Misfire, load_scene, simulate
from crankmbs.page import page_of
from crankmbs.page.knobs import knobs_of
from crankmbs.scene.run import Extent

pytestmark = pytest.mark.slow


@pytest.fixture
def page(browser, tmp_path):
    with opened(browser, tmp_path, "propeller") as visited:
        yield visited.settle()


@pytest.fixture(scope="module")
def kept(browser, tmp_path_factory):
    """A page for tests that leave it as it was."""
    with opened(browser, tmp_path_factory.mktemp("kept"), "propeller") as visited:
        yield visited.settle()


@pytest.mark.parametrize("name", SHOWN)
def test_a_shown_scene_is_a_small_file_that_asks_for_nothing_and_shows_what_simulate_gives(
    browser, tmp_path, name
):
    with opened(browser, tmp_path, name) as visited:
        visited.settle()
        assert visited.file.stat().st_size < 1e6
        assert visited.visit.requests == [visited.file.as_uri()]
        assert visited.message == ""
        assert visited.curve()
        assert visited.curve("lower")
        if name not in {"coasting", "turning_moment"}:  # which repeat themselves at any speed
            assert_same(visited.data(), expected(load_scene(name)))


def test_a_load_that_balances_at_every_speed_keeps_the_mean_of_the_start(browser, tmp_path):
    scene = load_scene("turning_moment")
    with opened(browser, tmp_path, "turning_moment") as visited:
        data = visited.data()
        period = data["time [s]"][-1] - data["time [s]"][0]
        assert scene.period / period == pytest.approx(scene.start.speed, rel=1e-9)
        assert_same(data, expected(scene, speed=data["crank_speed [rad/s]"][0]))


TURNED = [
    ("propeller", {"rod_ratio": 0.45, "offset": -4.0}),
    ("propeller", {"offset": 22.0}),
    ("propeller", {"flywheel": 0.05, "load": 150.0, "counterweight": -20.0}),
    ("propeller", {"cylinders": "3", "rod": "two-mass", "pressure": 130.0}),
    ("propeller", {"speed_is": "prescribed", "speed": 2500.0, "rod_mass": 2.0}),
    ("yi_diesel_free", {"speed": 2500.0, "pressure": 70.0, "offset": 8.0}),
    ("yi_diesel", {"rod_ratio": 0.2, "cylinders": "6", "speed": 4000.0}),
    ("v_twin", {"rod_ratio": 0.4, "offset": 5.0, "pressure": 80.0}),
    ("v_twin", {"rod_mass": 0.0, "cylinders": "2"}),
    ("grega_lecture", {"rod": "rigid", "rod_mass": 0.5}),
    (
        "two_stage_compressor",
        {"speed": 950.0, "pressure": 90.0, "flywheel": 0.5, "counterweight": 4.0},
    ),
]


def address_of(values):
    return "#" + "&".join(f"{name}={value}" for name, value in values.items())


@pytest.mark.parametrize(("name", "values"), TURNED, ids=str)
def test_a_turned_knob_shows_what_simulate_gives_and_hands_its_scene_out(
    browser, tmp_path, name, values
):
    scene = load_scene(name)
    with opened(browser, tmp_path, name) as visited:
        before = visited.settle().curve("lower")
        visited.go(address_of(values))
        visited.page.wait_for_function(
            "(d) => document.querySelector('#lower path.simulated').getAttribute('d') !== d",
            arg=before,
        )
        assert visited.message == ""
        assert_same(visited.data(), expected(turned(scene, values)))


def test_the_offset_leaves_the_engine_running(page):
    """The pressure moves with the dead centres: else 22 mm would turn this engine backwards."""
    page.type("offset", "22")
    data = page.data()
    assert page.page.is_visible("#carried")
    assert np.all(data["crank_speed [rad/s]"] > 250.0)


@pytest.mark.always
def test_a_load_that_settles_nothing_is_said_to_drift(page):
    page.type("load", "0")
    data = page.data()
    speed = data["crank_speed [rad/s]"]
    gain = (speed[-1] - speed[0]) * 30.0 / math.pi
    assert gain > 50.0
    assert page.text("#badge") == (
        f"not settled: the first cycle gains {gain:.0f} rpm; "
        "the loads take too little even at high speed"
    )
    scene = turned(load_scene("propeller"), {"load": 0.0})
    np.testing.assert_allclose(speed, one_cycle(scene), rtol=1e-9)


def test_misfires_that_come_again_are_not_called_a_drift(browser, tmp_path):
    fuel = Fuel(misfire=(Misfire(cylinder=3, cycles="every 2"),))
    scene = dataclasses.replace(load_scene("misfire"), fuel=fuel)
    with opened(browser, tmp_path, scene) as visited:
        badge = visited.settle().text("#badge")
    assert badge.startswith("one of several cycles, of which the last ")
    assert "crankmbs run --until settled" in badge


def test_a_coasting_crank_keeps_its_mean_speed_and_says_that_any_would_do(browser, tmp_path):
    scene = load_scene("coasting")
    with opened(browser, tmp_path, scene) as visited:
        data = visited.data()
        assert "any speed" in visited.text("#badge")
    speed = data["crank_speed [rad/s]"]
    turned_in = data["time [s]"][-1] - data["time [s]"][0]
    assert scene.period / turned_in == pytest.approx(scene.start.speed, rel=1e-9)
    start = dataclasses.replace(scene.start, speed=float(speed[0]))
    np.testing.assert_allclose(speed, one_cycle(dataclasses.replace(scene, start=start)), rtol=1e-9)


def one_cycle(scene):
    """The speed over the first cycle."""
    run = dataclasses.replace(scene.run, until=Extent(value=1.0, unit="cycle"), rtol=1e-11)
    run = dataclasses.replace(run, every=Extent(value=math.radians(2.0), unit="rad"))
    return simulate(dataclasses.replace(scene, run=run)).data["crank_speed"].values


def rod_ratios():
    return [
        {"rod_ratio": 0.9, "offset": offset} for offset in (-20.0, -12.0, -5.2, 5.2, 12.0, 20.0)
    ]


CLOSED = [
    *(("propeller", each) for each in rod_ratios()),
    *(("propeller", {"rod_ratio": ratio, "offset": 23.0}) for ratio in (0.7, 0.75, 0.8, 0.85)),
    *(("yi_diesel_free", each) for each in rod_ratios()),
    *(("v_twin", {"flywheel": 0.002, "counterweight": far}) for far in (-36.0, -25.0, 20.0, 36.0)),
]


def test_rows_that_no_longer_cover_the_stroke_are_refused_in_pythons_words(browser, tmp_path):
    scene = press()
    with opened(browser, tmp_path, scene) as visited:
        good = visited.settle().curve()
        with pytest.raises(InputError, match="the rows must cover the stroke") as caught:
            turned(scene, {"offset": 12.0})
        visited.type("offset", "12")
        assert visited.message == str(caught.value)
        assert visited.draws(good)
        visited.type("offset", "0")
        assert visited.message == ""


@pytest.mark.parametrize("name", ["propeller", "yi_diesel_free", "v_twin"])
def test_states_that_cannot_be_are_refused_in_pythons_words(browser, tmp_path, name):
    scene = load_scene(name)
    with opened(browser, tmp_path, name) as visited:
        good = visited.settle().curve()
        for values in [each for of, each in CLOSED if of == name]:
            with pytest.raises(InputError) as caught:
                turned(scene, values)
            visited.go(address_of(values))
            visited.page.wait_for_function("() => !document.getElementById('message').hidden")
            assert visited.message == str(caught.value).removeprefix("crank: ")
            assert visited.draws(good)
            visited.go("#")
            visited.page.wait_for_function("() => document.getElementById('message').hidden")
        assert visited.settle().draws(good)


NUMBERS = [
    ("rod_ratio", "abc"), ("rod_ratio", ""), ("rod_ratio", "1e"), ("rod_ratio", "nan"),
    ("rod_ratio", "inf"), ("offset", "-inf"), ("rod_ratio", "0.05"), ("rod_ratio", "0.95"),
    ("flywheel", "-1"), ("flywheel", "1000"), ("load", "200.5"), ("pressure", "19"),
    ("speed", "1e9"), ("rod_mass", "-0.1"), ("offset", "0x10"), ("load", "1,500"),
    ("load", "1,5,0"), ("load", ","),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text"), NUMBERS)
def test_a_number_that_cannot_be_is_refused_as_a_key_of_a_scene_would_be(kept, name, text):
    """Against pydantic's own problem with a number between the knob's ends."""
    good = kept.curve()
    (knob,) = (each for each in knobs_of(load_scene("propeller")) if each.name == name)
    sentence = refused_number(knob, text)
    kept.type(name, text)
    unit = f", in {knob.unit}" if knob.unit else ""
    labelled = knob.label + sentence.removeprefix(name)
    assert kept.message == f"{labelled}; type for example {knob.value:.{knob.decimals}f}{unit}"
    kept.type(name, f"{knob.value!r}")
    assert kept.message == ""
    kept.go(f"#{name}={text}")
    kept.page.wait_for_function("() => !document.getElementById('message').hidden")
    assert kept.message == sentence
    assert kept.draws(good)
    kept.go("#")
    kept.page.wait_for_function("() => document.getElementById('message').hidden")
    assert kept.settle().curve() == good


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("load", "62,5", 62.5),
        ("rod_ratio", " 0,300 ", 0.3),
        ("rod_mass", ",25", 0.25),
        ("offset", "\u22121,25", -1.25),
    ],
)
def test_a_decimal_comma_is_a_decimal_point_in_a_field(kept, name, text, value):
    kept.type(name, text)
    assert kept.message == ""
    assert float(kept.page.input_value(f"#knob-{name}")) == value
    assert f"{name}={value}" in kept.address
    kept.go("#")
    kept.settle()


def refused_number(knob, text):
    from typing import Annotated

    from annotated_types import Ge, Le
    from pydantic import ConfigDict, ValidationError, create_model

    from crankmbs.scene.schema import Float
    from crankmbs.scene.sentences import sentence

    bounded = Annotated[Float, Ge(knob.low), Le(knob.high)]
    finite = ConfigDict(allow_inf_nan=False)
    root = create_model("Knobs", __config__=finite, **{knob.name: (bounded, ...)})
    try:
        value = float(text) if not text.startswith("0x") else text
    except ValueError:
        value = text
    with pytest.raises(ValidationError) as caught:
        root(**{knob.name: value})
    said = sentence(caught.value, root, {knob.name: value})
    return (
        said
        if isinstance(value, str) or not math.isfinite(value)
        else said.replace(f"; {value!r} came", f"; {text} came")
    )


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("#flywhel=0.1", "flywhel: unknown key; known keys are speed, load"),
        ("#load=50&load=60", "load: came twice; give it once"),
        ("#rod=soft", 'rod: must be "rigid" or "two-mass"; "soft" came'),
        ("#cylinders=7", '"5" or "6"; "7" came'),
        ("#upper=%3Cimg%20src%3Dx%3E", '"<img src=x>" came'),
        ("#forces", 'forces: must be "piston", "rod", "crank" or "none"; "" came'),
    ],
)
def test_an_address_is_read_strictly(browser, tmp_path, address, words):
    with opened(browser, tmp_path, "propeller", address) as visited:
        assert words in visited.settle().message
        assert visited.curve()
        assert visited.page.query_selector("img") is None


def test_the_state_lives_in_the_address(browser, tmp_path, page):
    page.type("flywheel", "0.0314")
    page.page.select_option("[data-state=rod]", "two-mass")
    page.page.select_option("[data-state=upper]", "p-V diagram")
    page.page.select_option("[data-state=forces]", "crank")
    page.page.focus("body")
    page.page.keyboard.press("ArrowRight")
    before, degrees, address = page.data(), page.degrees, page.address
    for part in ("flywheel=0.0314", "rod=two-mass", "forces=crank", f"angle={degrees:g}"):
        assert part in address
    with opened(browser, tmp_path, "propeller", address) as again:
        after = again.data()
        assert after.keys() == before.keys()
        for name, column in before.items():
            np.testing.assert_allclose(after[name], column, rtol=1e-10, atol=1e-9, err_msg=name)
        assert again.degrees == degrees
        assert again.page.input_value("[data-state=upper]") == "p-V diagram"
        assert again.curve() == page.curve()


def test_nothing_is_written_into_the_address_while_a_slider_is_held(page):
    slider = page.page.locator("#knob-flywheel")
    slider.evaluate("(each) => { each.value = 0.06; each.dispatchEvent(new Event('input')) }")
    assert page.address == ""
    assert page.page.locator(".knob:has(#knob-flywheel) input.entry").input_value() == "0.0600"
    slider.evaluate("(each) => each.dispatchEvent(new Event('change'))")
    assert "flywheel=0.06" in page.address


HOSTILE = '</script><script>window.hacked = 1</script><img src=x onerror="window.hacked = 2">${7*7}'


def test_a_title_is_never_markup_or_script(browser, tmp_path):
    scene = dataclasses.replace(load_scene("coasting"), title=HOSTILE, source=f"{HOSTILE}\u2028")
    with opened(browser, tmp_path, scene) as visited:
        assert visited.settle().text("h1") == HOSTILE
        assert visited.page.title().startswith(HOSTILE)
        assert visited.page.evaluate("window.hacked") is None
        assert visited.page.query_selector("img") is None


def test_the_policy_lets_the_pages_own_script_run_and_no_other(browser, tmp_path):
    text = page_of(load_scene("coasting"), "mine")
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]+)"', text)
    (script,) = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src &#39;sha256-{digest}&#39;;" in policy
    assert "default-src &#39;none&#39;" in policy
    file = tmp_path / "page.html"
    file.write_text(text.replace("</main>", "<script>window.hacked = 1</script></main>"))
    with visiting(browser) as visit:
        visit.page.goto(file.as_uri())
        visit.page.wait_for_selector("#upper path.simulated")
        assert visit.page.evaluate("window.hacked") is None
        assert len(visit.errors) == 1
        assert "Content Security Policy" in visit.errors.pop()
