"""The page under hands: dragging, keys, playing, pinning, and how it stands on every screen."""

import math
import re

import numpy as np
import pytest
from browser import STILL, drawn, resize
from page_visit import opened

from crankmbs import load_scene

pytestmark = pytest.mark.slow

SCENE = load_scene("propeller")
LAPTOP, PHONE, LARGE = (1366, 641), (390, 844), (1920, 1080)


@pytest.fixture
def page(browser, tmp_path):
    with opened(browser, tmp_path, SCENE, size=LAPTOP) as visited:
        yield visited.settle()


def centre(page, what):
    box = page.settle().page.locator(what).first.bounding_box()
    return box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]


def drag(page, begin, *places):
    mouse = page.page.mouse
    mouse.move(*begin)
    mouse.down()
    for place in places:
        mouse.move(*place)
    mouse.up()


def test_a_dragged_crank_pin_follows_the_pointer_around_the_axis(page):
    axle, pin = centre(page, ".axle"), centre(page, ".chosen [data-grip=pin]")
    begin = page.degrees
    assert begin == pytest.approx(390.0)
    long = math.dist(axle, pin)
    at = [
        (axle[0] - long * math.sin(a), axle[1] - long * math.cos(a))
        for a in np.radians(np.linspace(30.0, 150.0, 7))
    ]
    drag(page, pin, *at)
    assert page.degrees == pytest.approx(510.0, abs=2.0)
    assert centre(page, ".chosen [data-grip=pin]") == pytest.approx(at[-1], abs=2.0)
    assert "angle=5" in page.address


def test_a_dragged_piston_takes_the_crank_along(page):
    x, y = centre(page, ".chosen .piston")
    drag(page, (x, y), (x, y + 15), (x, y + 40))
    assert centre(page, ".chosen .piston") == pytest.approx((x, y + 40), abs=2.0)
    assert 400.0 < page.degrees < 540.0  # on its way down


def test_a_dragged_rim_makes_the_flywheel_heavier(page):
    axle = centre(page, ".axle")
    radius = 0.5 * page.page.locator(".disc").bounding_box()["width"]
    speed = page.curve()
    drag(page, (axle[0] + radius, axle[1]), (axle[0] + 1.15 * radius, axle[1]))
    inertia = float(page.page.locator("#knob-flywheel").input_value())
    assert inertia == pytest.approx(1.15**4 * SCENE.crank.inertia, rel=0.06)
    assert page.curve() != speed
    assert f"flywheel={inertia!r}"[:14] in page.address


def test_a_dragged_cursor_turns_the_crank_and_hovering_reads_values(page):
    box = page.page.locator("#upper svg").bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"]
    before = page.text("#upper .legend")
    page.page.mouse.move(x, y)
    assert page.degrees == pytest.approx(390.0)
    hovered = page.text("#upper .legend")
    assert hovered != before
    assert "at 1" in hovered
    drag(page, (x, y), (x + 30, y), (x + 60, y))
    assert 150.0 < page.degrees < 300.0


def test_arrow_keys_turn_and_space_plays(page):
    keyboard = page.page.keyboard
    keyboard.press("ArrowRight")
    assert page.degrees == pytest.approx(391.0)
    keyboard.press("Shift+ArrowLeft")
    assert page.degrees == pytest.approx(381.0)
    keyboard.press("Space")
    page.page.wait_for_function("() => Number(document.getElementById('angle').value) > 384")
    keyboard.press("Space")
    held = page.degrees
    drawn(page.page, STILL)
    assert page.degrees == held
    assert "pause" not in page.text("#play")


def test_keys_in_a_knob_do_not_turn_the_crank(page):
    page.page.focus("#knob-load")
    page.page.keyboard.press("ArrowRight")
    assert page.degrees == pytest.approx(390.0)
    assert float(page.page.input_value("#knob-load")) > 100.0


def test_the_page_plays_from_a_telling_pose_unless_motion_is_to_be_reduced(browser, tmp_path, page):
    drawn(page.page, STILL)
    assert page.degrees == pytest.approx(390.0)
    with opened(browser, tmp_path, SCENE, motion="no-preference") as playing:
        playing.page.wait_for_function("() => Number(document.getElementById('angle').value) > 400")
        assert "pause" in playing.text("#play")


def test_the_drawn_crank_stands_at_its_angle(page):
    for degrees in (17.0, 275.0, 611.0):
        page.go(f"#angle={degrees}")
        page.page.wait_for_function(f"() => document.getElementById('angle').value == {degrees}")
        axle, pin = centre(page, ".axle"), centre(page, ".chosen [data-grip=pin]")
        drawn = math.degrees(math.atan2(axle[0] - pin[0], axle[1] - pin[1]))
        assert (drawn - degrees + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1.0)


def test_a_pinned_curve_stays_as_it_was(page):
    assert page.page.query_selector("#lower path.ghost") is None
    page.page.click("#lower .pin")
    page.type("offset", 12)
    ghost, now = page.curve("lower", "ghost"), page.curve("lower")
    assert ghost != now
    assert "pinned" in page.text("#lower .legend")
    page.page.click("#lower .pin")
    assert page.page.query_selector("#lower path.ghost") is None


def test_the_strip_shows_simulated_less_exact_less_lecture(page):
    page.page.select_option("[data-state=lower]", "piston acceleration")
    words = page.text("#lower .legend").replace("\u2212", "-").replace("\n", " ")
    for difference in ("simulated - untruncated", "untruncated - lecture"):
        assert difference in words
    number = r"(-?[\d.]+)"
    found = re.search(
        rf"simulated {number}.*untruncated {number}.*lecture {number}.*"
        rf"simulated - untruncated {number}.*untruncated - lecture {number}",
        words,
    )
    run, exact, lecture, first, second = map(float, found.groups())
    assert first == pytest.approx(run - exact, abs=1.5)
    assert second == pytest.approx(exact - lecture, abs=1.5)


def test_the_ring_says_by_how_much_it_is_magnified(page):
    assert "(drawn 2×)" in page.text("#lead")
    page.type("flywheel", 0.08)
    assert "(drawn 5×)" in page.settle().text("#lead")


def test_the_first_pass_comes_at_once_and_its_error_after_the_second(page):
    at_once = page.page.locator("#knob-flywheel").evaluate(
        """(each) => {
          each.value = 0.05;
          each.dispatchEvent(new Event("input"));
          return document.getElementById("numbers").textContent;
        }"""
    )
    assert "indicated power…" in at_once
    drawn(page.page, 30)  # far longer than the second pass comes after a knob that is let go
    assert "…" in page.text("#trust")  # the knob is still held
    page.page.locator("#knob-flywheel").dispatch_event("change")
    assert "…" not in page.settle().text("#numbers")
    assert re.search(r"e-\d+ of its mean", page.text("#trust"))
    page.page.select_option("[data-state=speed_is]", "prescribed")
    assert page.settle().text("#trust").startswith("The speed is prescribed: ")


@pytest.mark.parametrize("name", ["propeller", "yi_diesel_free"])
def test_nothing_scrolls_sideways_and_no_plot_is_empty(browser, tmp_path, name):
    with opened(browser, tmp_path, name, size=PHONE) as visited:
        visited.settle()
        for large in (False, True):
            if large:
                visited.page.click("#large")
            for size in (PHONE, LAPTOP, LARGE):
                resize(visited.page, size)
                assert visited.page.evaluate("document.documentElement.scrollWidth") <= size[0]
                for plot in ("#upper svg", "#lower svg", "#stage"):
                    box = visited.page.locator(plot).bounding_box()
                    assert box["width"] > 250.0
                    assert box["height"] > 120.0
                    assert box["x"] >= 0.0
                    assert box["x"] + box["width"] <= size[0]


def test_every_axis_says_its_scale_and_its_numbers_do_not_touch(page):
    """Two ticks at least, also in the strip of a low plot, and in large letters."""
    page.page.select_option("[data-state=upper]", "piston velocity")
    for large in (False, True):
        if large:
            page.page.click("#large")
            drawn(page.page)
        for plot in ("upper", "lower"):
            for axes in page.page.locator(f"#{plot} svg > g:nth-child(-n + 2)").all():
                boxes = [each.bounding_box() for each in axes.locator("text.end").all()]
                assert len(boxes) >= 2
                middles = sorted(box["y"] + 0.5 * box["height"] for box in boxes)
                assert np.diff(middles).min() > 0.7 * boxes[0]["height"]


def test_on_a_laptop_all_knobs_stand_above_the_fold(page):
    assert page.page.evaluate("document.documentElement.scrollHeight") <= LAPTOP[1]
    knobs = page.page.locator(".knob").all()
    assert len(knobs) == 8
    for knob in knobs:
        box = knob.bounding_box()
        assert box["y"] + box["height"] <= LAPTOP[1]


def test_every_control_has_a_name(page):
    unnamed = page.page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, svg[role=img]")].filter(
          (each) => !(each.getAttribute("aria-label") || each.labels?.length || each.innerText)
        ).map((each) => each.outerHTML)"""
    )
    assert unnamed == []


LUMINANCE = """([ink, ground]) => {
  const canvas = document.createElement("canvas").getContext("2d");
  const of = (name) => {
    canvas.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const [r, g, b] = [1, 3, 5].map((k) => parseInt(canvas.fillStyle.slice(k, k + 2), 16) / 255)
      .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [a, b] = [of(ink), of(ground)].sort((x, y) => y - x);
  return (a + 0.05) / (b + 0.05);
}"""
TEXT = (
    *("--text", "--soft", "--accent", "--good", "--bad"),
    *("--gasarrow", "--wallarrow", "--pinarrow", "--bearing"),
)
LINES = ("--line", "--run", "--exact", "--lecture", "--ghost", "--edge", "--web")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_colours_stand_out_from_their_ground(browser, tmp_path, scheme):
    with opened(browser, tmp_path, SCENE, color_scheme=scheme) as visited:
        for names, least in ((TEXT, 4.5), (LINES, 3.0)):
            for name in names:
                found = visited.page.evaluate(LUMINANCE, [name, "--ground"])
                assert found >= least, (name, found)
