"""Lessons in a real browser, from disk and with the network off: figures, words, typed answers.

Over 300 lines, as its tests share the browser and the lessons opened in it.
"""

import math
import re
from dataclasses import replace
from functools import cache
from importlib import import_module

import numpy as np
import pytest
from browser import visiting
from lesson_visit import LAPTOP, Opened

from crankmbs import load_scene, simulate
from crankmbs.lessons import LESSONS, write_lesson
from crankmbs.lessons.balance import reciprocating
from crankmbs.scene.parts import Layout

pytestmark = pytest.mark.slow

PHONE, LARGE = (390, 844), (1920, 1080)


@pytest.mark.parametrize("size", [PHONE, LAPTOP, LARGE], ids=str)
@pytest.mark.parametrize("name", LESSONS)
def test_a_lesson_fits_every_screen(kept, name, size):
    opened = kept(name, size)
    wide = "[document.documentElement.scrollWidth, document.documentElement.clientWidth]"
    scrolled, width = opened.page.evaluate(wide)
    assert scrolled <= width
    for one in opened.page.locator(".plot:visible").all():
        svg, plot = one.locator("svg").bounding_box(), one.bounding_box()
        assert svg["y"] + svg["height"] >= plot["y"] + plot["height"] - 1.0  # no gap below
        for box in (text.bounding_box() for text in one.locator("svg text.name").all()):
            assert svg["x"] <= box["x"]
            assert box["x"] + box["width"] <= svg["x"] + svg["width"]
    for one in opened.page.locator(".knob label").all():
        broad, high = one.evaluate(
            "(each) => [each.scrollWidth - each.clientWidth,"
            " each.clientHeight / parseFloat(getComputedStyle(each).fontSize)]"
        )
        assert broad <= 0, one.text_content()
        assert high < 4.0, one.text_content()  # two lines at most
    for one in opened.page.locator(".idea, footer p").all():
        letter = one.evaluate("(each) => parseFloat(getComputedStyle(each).fontSize)")
        assert size == LAPTOP or one.bounding_box()["width"] <= 75.0 * letter
    for one in opened.page.locator(".formula").all():
        inner, outer = one.locator("math").bounding_box(), one.bounding_box()
        assert inner["x"] + inner["width"] <= outer["x"] + outer["width"] + 1.0
        assert 10.0 < inner["height"] < 110.0  # built up, and not one line of letters


@pytest.mark.parametrize("name", LESSONS)
def test_on_a_laptop_the_first_figure_and_its_words_stand_in_view(kept, name):
    page = kept(name, LAPTOP).page
    for each in (page.locator(".board").first, controls(page)):
        box = each.bounding_box()
        assert box["y"] + box["height"] <= LAPTOP[1]
    assert page.locator(".words").first.bounding_box()["y"] < 0.5 * LAPTOP[1]


@pytest.mark.parametrize("name", LESSONS)
def test_on_a_phone_the_first_figure_begins_in_view_with_all_that_can_be_turned(kept, name):
    page = kept(name, PHONE).page
    machine, plot, turned = (
        each.bounding_box()
        for each in (page.locator(".machine").first, page.locator(".plot").first, controls(page))
    )
    assert machine["y"] + machine["height"] <= turned["y"]
    assert turned["y"] + turned["height"] <= plot["y"] <= PHONE[1] - 120.0
    assert plot["y"] + plot["height"] - machine["y"] <= PHONE[1]  # a turn and what it does


def controls(page):
    """What of the first figure is turned: its sliders and choices, else the crank's angle."""
    figure = page.locator("figure").first
    turns = figure.locator(".turns:visible")
    return turns if turns.count() else figure.locator(".player")


@pytest.mark.parametrize("name", LESSONS)
def test_no_word_that_follows_a_figure_is_left_out(kept, name):
    places = kept(name).page.locator("[data-say]")
    assert all(text.strip() for text in places.all_inner_texts())


@pytest.mark.parametrize(("name", "figure"), [("forces", "along"), ("polar", "pin")])
def test_names_of_arrows_stand_within_their_drawing(kept, name, figure):
    opened = kept(name, PHONE)
    stage = opened.page.locator(f"#{figure} .stage").bounding_box()
    names = opened.page.locator(f"#{figure} .arrows text").all()
    assert names
    for each in names:
        box = each.bounding_box()
        for along, size in (("x", "width"), ("y", "height")):
            assert box[along] >= stage[along] - 2.0
            assert box[along] + box[size] <= stage[along] + stage[size] + 2.0


@pytest.mark.parametrize(
    ("name", "figure"), [("forces", "side"), ("polar", "pin"), ("polar", "turning")]
)
def test_names_of_arrows_cover_nothing_of_an_upright_engine(kept, name, figure):
    opened = kept(name, LAPTOP)
    engine = [
        opened.page.locator(f"#{figure} .stage {part}").first.bounding_box()
        for part in (".chosen .wall", ".rim")
    ]
    low = min(box["x"] for box in engine)
    high = max(box["x"] + box["width"] for box in engine)
    names = opened.page.locator(f"#{figure} .arrows text").all()
    assert names
    for box in (each.bounding_box() for each in names):
        assert box["x"] + box["width"] <= low + 2.0 or box["x"] >= high - 2.0


@pytest.mark.parametrize("size", [PHONE, LAPTOP], ids=str)
@pytest.mark.parametrize(
    ("name", "figures"), [("forces", ("along", "side")), ("polar", ("pin", "bearing", "turning"))]
)
def test_the_scale_of_the_forces_stands_whole_below_the_drawing(kept, name, figures, size):
    opened = kept(name, size)
    for figure in figures:
        stage, flywheel, bar, text = (
            opened.page.locator(f"#{figure} .stage{what}").bounding_box()
            for what in ("", " .flywheel", " .scale path", " .scale text")
        )
        for box in (bar, text):
            assert box["x"] >= stage["x"] - 1.0
            assert box["x"] + box["width"] <= stage["x"] + stage["width"] + 1.0
            assert box["y"] >= flywheel["y"] + flywheel["height"]
            assert box["y"] + box["height"] <= stage["y"] + stage["height"] + 1.0
        assert bar["x"] + bar["width"] < text["x"]


@pytest.mark.parametrize("name", LESSONS)
def test_formulas_are_set_in_the_font_that_is_embedded(kept, name):
    opened = kept(name)
    devtools = opened.page.context.new_cdp_session(opened.page)
    devtools.send("DOM.enable")
    devtools.send("CSS.enable")
    root = devtools.send("DOM.getDocument")["root"]["nodeId"]
    found = devtools.send("DOM.querySelectorAll", {"nodeId": root, "selector": "math"})["nodeIds"]
    assert found
    for node in found:
        fonts = devtools.send("CSS.getPlatformFontsForNode", {"nodeId": node})["fonts"]
        assert all(font["isCustomFont"] for font in fonts), fonts


KNOBS = [
    ("displacement", "half", "rod_ratio", 0.5),
    ("displacement", "series", "rod_ratio", 0.5),
    ("acceleration", "motion", "rod_ratio", 0.4),
    ("acceleration", "valley", "rod_ratio", 0.2),
    ("forces", "along", "speed", 5000),
    ("forces", "side", "share", 1.0),
    ("forces", "worth", "rod_ratio", 0.5),
    ("fluctuation", "swing", "flywheel", 0.05),
    ("fluctuation", "cost", "flywheel", 0.05),
    ("balance", "twin", "bank", 90),
    ("omega", "moment", "speed", 3600),
    ("omega", "energy", "flywheel", 0.3),
    ("omega", "speed", "flywheel", 0.3),
    ("polar", "pin", "speed", 5000),
    ("polar", "turning", "speed", 5000),
]


@pytest.mark.parametrize(("name", "figure", "knob", "value"), KNOBS, ids=str)
def test_a_slider_moves_the_curve(kept, name, figure, knob, value):
    opened = kept(name)
    before = opened.curve(figure)
    opened.type(figure, knob, value)
    assert opened.curve(figure) != before
    opened.page.locator(f"#{figure}-knob-{knob}").dispatch_event("dblclick")
    opened.settle()
    assert opened.curve(figure) == before


def test_the_crank_can_be_dragged_and_the_cursor_follows(lesson):
    opened = lesson("displacement")
    pin = opened.page.locator("#half .stage [data-grip=pin]").bounding_box()
    axle = opened.page.locator("#half .stage .axle").bounding_box()
    x, y = (axle[a] + 0.5 * axle[b] for a, b in (("x", "width"), ("y", "height")))
    begin = pin["x"] + 0.5 * pin["width"], pin["y"] + 0.5 * pin["height"]
    opened.page.mouse.move(*begin)
    opened.page.mouse.down()
    opened.page.mouse.move(x, y + math.dist(begin, (x, y)))
    opened.page.mouse.up()
    assert float(opened.page.locator("#half .angle").input_value()) == pytest.approx(180.0, abs=2.0)


def test_a_figure_plays_while_it_is_seen_but_not_with_reduced_motion(lesson):
    angle = "() => document.querySelector('#half .angle').value"
    moving = lesson("displacement", motion="no-preference")
    moving.page.wait_for_function("() => document.querySelector('#half .angle').value > 100")
    assert moving.page.locator("#half .play").get_attribute("aria-pressed") == "true"
    moving.page.locator("footer").scroll_into_view_if_needed()
    pressed = "() => document.querySelector('#half .play').getAttribute('aria-pressed') === 'false'"
    moving.page.wait_for_function(pressed)
    still = lesson("displacement")
    assert still.page.evaluate(angle) == "90"


def test_displacement_says_what_python_has(lesson):
    opened, r, l = lesson("displacement"), 40.0, 140.0
    lead = l - math.sqrt(l * l - r * r)
    assert opened.said("half.lead") == pytest.approx(lead, abs=0.006)
    assert opened.said("half.angle") == pytest.approx(math.degrees(math.acos(r / l / 2)), abs=0.006)
    assert opened.said("series.short") == pytest.approx(1e3 * (lead - r * r / l / 2), abs=0.06)
    opened.type("half", "rod_ratio", 0.5)
    assert opened.said("half.lead") == pytest.approx(80.0 - math.sqrt(80.0**2 - r * r), abs=0.006)


@cache
def numbers_of(name):
    """The numbers that Python computes for a lesson, by their ids."""
    module = import_module(f"crankmbs.lessons.{name}")
    texts = module.lesson(load_scene(module.SCENE)).texts
    data = re.compile(r'<data id="(\w+)" value="([^"]+)"')
    return {key: float(value) for text in texts for key, value in data.findall(text)}


SAID = [
    ("forces", "side.off", "missing", 0.6),
    ("forces", "worth.masses", "missing_share", 0.02),
    ("fluctuation", "swing.delta", "fluctuation", 0.006),
    ("fluctuation", "swing.mean", "mean_speed", 0.06),
    ("fluctuation", "fall.delta", "fluctuation", 0.006),
    ("balance", "shake.second", "second", 0.006),
    ("omega", "energy.swing", "swing", 0.6),
    ("omega", "speed.delta", "fluctuation", 0.006),
    ("polar", "bearing.peak", "bearing_peak", 0.006),
    ("polar", "pin.peak", "pin_peak", 0.006),
    ("polar", "pin.angle", "pin_angle", 0.6),
]


@pytest.mark.parametrize(("name", "place", "number", "close"), SAID, ids=str)
def test_words_that_follow_a_figure_say_what_python_has(kept, name, place, number, close):
    assert kept(name).said(place) == pytest.approx(numbers_of(name)[number], abs=close)


def test_cylinders_in_a_row_rock_as_python_has_it(lesson):
    opened = lesson("balance")
    bare = reciprocating(load_scene("grega_lecture"))
    for word, order in (("3", (1, 3, 2)), ("2", (1, 2)), ("4", (1, 3, 4, 2))):
        scene = replace(bare, layout=Layout(firing_order=order, spacing=0.088))
        most = np.abs(simulate(scene).data["rocking_moment_y"].values).max()
        opened.choose("couple", "cylinders", word)
        assert opened.said("couple.most") == pytest.approx(most, abs=0.6)
        words = opened.page.locator('[data-say="couple.words"]').inner_text()
        assert f"{word} cylinders" in words
        rocks = "sum to nothing" in words
        assert rocks == (most > 1.0)


def test_a_weight_balances_the_v_twin_at_90_degrees_only(lesson):
    opened = lesson("balance")
    opened.type("twin", "weight", 100)
    assert opened.said("twin.first") > 0.5
    opened.type("twin", "bank", 90)
    assert opened.said("twin.first") == pytest.approx(0.0, abs=0.005)


@pytest.mark.parametrize(("method", "order"), [("Euler", 1), ("Heun", 2), ("Runge-Kutta", 4)])
def test_half_the_step_is_worth_the_order(kept, method, order):
    opened = kept("trust")
    opened.choose("order", "method", method)
    opened.type("order", "size", 0.5)
    assert math.log2(opened.said("order.times")) == pytest.approx(order, abs=0.35)
    opened.choose("stated", "method", method)
    opened.type("stated", "size", 0.5)
    assert opened.said("stated.ratio") == pytest.approx(1.0, abs=0.4)


def test_steps_feel_friction_as_the_exact_run_does(browser, tmp_path):
    rings = load_scene("friction").friction
    rubbed = replace(load_scene("yi_diesel_free"), friction=rings)
    file = write_lesson("trust", tmp_path, rubbed)
    with visiting(browser, size=LAPTOP, offline=True) as visit:
        opened = Opened(visit, file)
        opened.choose("order", "method", "Runge-Kutta")
        opened.type("order", "size", 0.5)
        assert opened.said("order.digits") > 4.0


ANSWERS = [
    ("5.84 mm", "right", "Right"),
    ("0,584 cm", "right", "Right"),
    ("5.3 mm", "wrong", "Close"),
    ("40 mm", "wrong", "Half of r"),
    ("5.84", "right", "Right"),
    ("40", "wrong", "Half of r"),
    ("5.84 kN", "unclear", "“kN” does not fit here: answer in mm."),
    ("some", "unclear", "A number, please, such as 1.5\u00a0mm."),
]


@pytest.mark.parametrize(("typed", "verdict", "text"), ANSWERS, ids=str)
def test_a_typed_answer_is_checked_with_its_unit(kept, typed, verdict, text):
    opened = kept("displacement")
    opened.page.locator("#ask_lead details").evaluate("(each) => { each.open = false }")
    reply = opened.answer("ask_lead", typed)
    assert verdict in reply.get_attribute("class")
    assert text in reply.inner_text()
    shown = opened.page.locator("#ask_lead details p").is_visible()
    assert shown == (verdict == "right")


@pytest.mark.parametrize("name", LESSONS)
def test_every_answer_of_python_is_right_and_its_double_is_wrong(kept, name):
    module = import_module(f"crankmbs.lessons.{name}")
    opened = kept(name)
    for question in module.lesson(load_scene(module.SCENE)).questions:
        solution = question.solution
        for factor, verdict in ((1.0, "right"), (2.0, "wrong")):
            reply = opened.answer(question.name, f"{factor * solution.value:.9g} {solution.unit}")
            assert verdict in reply.get_attribute("class"), (question.name, reply.inner_text())


def test_a_share_in_place_of_percent_is_told_its_unit(kept):
    share = numbers_of("fluctuation")["fluctuation"] / 100.0
    opened = kept("fluctuation")
    for typed, verdict in ((f"{share:.6g}", "unclear"), (f"{share:.6g} %", "wrong")):
        reply = opened.answer("ask_own", typed)
        assert verdict in reply.get_attribute("class")
        assert ("In %, please." in reply.inner_text()) == (verdict == "unclear")


def test_a_number_that_cannot_be_keeps_the_picture_and_says_why(lesson):
    opened = lesson("displacement")
    before = opened.curve("half")
    opened.type("half", "rod_ratio", "7")
    assert "less than or equal" in opened.page.inner_text("#half .message") or "at most" in (
        opened.page.inner_text("#half .message")
    )
    assert opened.curve("half") == before


def test_print_shows_figures_and_answers_and_no_controls(lesson):
    opened = lesson("displacement")
    opened.page.emulate_media(media="print")
    assert opened.page.locator("#half .stage").is_visible()
    assert opened.page.locator("#ask_lead details p").bounding_box()["height"] > 10.0
    assert not opened.page.locator("#half .player").is_visible()
    assert not opened.page.locator("#ask_lead .typed").is_visible()


def contrast(one, other):
    """The ratio of two colours' luminance, as the accessibility guidelines count it."""

    def luminance(text):
        parts = [int(text[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_and_lines_stand_out(lesson, scheme):
    opened = lesson("forces", color_scheme=scheme)
    value = "(name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim()"
    ground = opened.page.evaluate(value, "--ground")
    for name in ("text", "soft", "accent", "run", "good", "bad"):
        assert contrast(opened.page.evaluate(value, f"--{name}"), ground) >= 4.5, name
    for name in ("line", "exact", "lecture", "wallarrow", "bearing", "gasarrow", "web"):
        assert contrast(opened.page.evaluate(value, f"--{name}"), ground) >= 3.0, name
