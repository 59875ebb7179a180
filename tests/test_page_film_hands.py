"""The film under hands: it plays, pauses and is dragged; how it stands on every screen."""

import re
from contextlib import contextmanager

import numpy as np
import pytest
from browser import STILL, drawn, visiting
from page_visit import Opened
from test_page_begins import boxes, finger
from test_page_hands import drag

from crankmbs import load_scene
from crankmbs.page import page_of

pytestmark = pytest.mark.slow

LAPTOP, PHONE, LARGE = (1366, 641), (390, 844), (1920, 1080)
FILMS = ("run_up", "run_down", "torque_driven")
CLOCK = "requestAnimationFrame = (next) => { globalThis.next = next; return 1; };"
UNNAMED = """() => [...document.querySelectorAll("button, select, input, svg[role=img]")].filter(
  (each) => !(each.getAttribute("aria-label") || each.labels?.length || each.innerText)
).map((each) => each.outerHTML)"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("films")
    found = {name: folder / f"{name}.html" for name in FILMS}
    for name, file in found.items():
        file.write_text(page_of(load_scene(name), name), encoding="utf-8")
    return found


@contextmanager
def film(browser, file, *, clock=False, **options):
    """A film, opened; clock : its frames come when a test says so."""
    with visiting(browser, offline=True, **options) as visit:
        if clock:
            visit.page.add_init_script(CLOCK)
        visit.page.goto(file.as_uri())
        visit.page.wait_for_selector("#upper path.simulated[d]")
        yield Opened(visit, file)


@pytest.fixture
def page(browser, files):
    with film(browser, files["run_down"], size=LAPTOP) as visited:
        yield visited


@pytest.fixture
def phone(browser, files):
    with film(browser, files["run_down"], size=PHONE, has_touch=True, is_mobile=True) as visited:
        yield visited


def time(visited):
    return float(visited.page.input_value("#time"))


def end(visited):
    return float(visited.page.get_attribute("#time", "max"))


def playing(visited):
    pressed = visited.page.get_attribute("#play", "aria-pressed") == "true"
    assert ("pause" in visited.text("#play")) == pressed
    return pressed


def slide(visited, to):
    visited.page.locator("#time").evaluate(
        "(each, to) => { each.value = to; each.dispatchEvent(new Event('input')) }", to
    )


def tick(visited, *milliseconds):
    """Frames at times of the clock."""
    for each in milliseconds:
        visited.page.evaluate("(now) => next(now)", each)


@pytest.mark.parametrize("name", FILMS)
def test_a_film_is_a_small_file_that_asks_for_nothing_and_teaches_one_idea(browser, files, name):
    assert files[name].stat().st_size < 1e6
    with film(browser, files[name]) as visited:
        assert visited.visit.requests == [files[name].as_uri()]
        assert visited.text("#idea h2").endswith("?")
        assert visited.text("#idea p").endswith(".")
        assert re.search(r"numerical error of the run: \de-\d+ rpm", visited.text("#trust"))
        assert visited.text("#badge").startswith("The run ")
        assert visited.page.evaluate(UNNAMED) == []


def test_it_plays_at_the_rate_that_is_chosen_pauses_and_stops_at_its_end(browser, files):
    with film(browser, files["run_down"], clock=True, motion="no-preference") as visited:
        assert playing(visited)
        slower = float(visited.page.input_value("#slower"))
        tick(visited, 1000, 1020, 1060)
        assert time(visited) == pytest.approx(0.06 / slower, rel=1e-9)
        visited.page.select_option("#slower", str(round(10 * slower)))
        tick(visited, 1100)
        assert time(visited) == pytest.approx(0.06 / slower + 0.004 / slower, rel=1e-9)
        visited.page.click("#play")
        assert not playing(visited)
        held = time(visited)
        tick(visited, 1120)
        assert time(visited) == held
        slide(visited, end(visited) - 1e-4)
        visited.page.click("#play")
        tick(visited, 2000, 2090)
        assert time(visited) == pytest.approx(end(visited))
        assert not playing(visited)
        assert visited.text("#now-speed") == "0.0 rpm"
        visited.page.click("#play")
        tick(visited, 3000, 3010)
        assert 0.0 < time(visited) < 0.01


def test_played_slower_the_plot_shows_a_part_of_the_run(page):
    """The first tenth, then that of the cursor; its speed is that of the whole run."""

    def ticks():
        texts = page.page.locator("#upper svg g:nth-of-type(2) text.tick:not(.end)")
        return [float(text) for text in texts.all_text_contents()]

    whole, slowest = end(page), page.page.locator("#slower option").last.get_attribute("value")
    before, first = ticks(), float(page.page.input_value("#slower"))
    assert 0.8 * whole < max(before) <= whole
    page.page.select_option("#slower", str(round(10 * first)))
    assert 0.05 * whole < max(ticks()) <= 0.1 * whole
    slide(page, 0.45 * whole)
    assert 0.4 * whole <= min(ticks()) < max(ticks()) <= 0.5 * whole
    dot, speed = page.page.locator("#upper .cursor circle"), page.text("#now-speed")
    line = page.page.locator("#upper path.simulated")
    near = "(each, [x, y]) => each.isPointInStroke(new DOMPoint(10 * x, 10 * y))"
    place = [float(dot.get_attribute(name)) for name in ("cx", "cy")]
    assert line.evaluate(near, place)
    page.page.select_option("#slower", slowest)
    assert page.text("#now-speed") == speed
    drag(page, centre_of(page, "#upper svg"), (1e4, 300.0))
    at = time(page)
    assert 0.45 * whole * (1.0 - 1e-6) <= at <= 0.46 * whole  # the slider's place has its digits
    page.page.select_option("#slower", str(round(first)))
    assert ticks() == before


def centre_of(visited, what):
    box = visited.page.locator(what).bounding_box()
    return box["x"] + 0.5 * box["width"], box["y"] + 0.3 * box["height"]


def test_it_stands_still_where_motion_is_to_be_reduced(page):
    drawn(page.page, STILL)
    assert time(page) == 0.0
    assert not playing(page)


def test_keys_step_through_the_run_and_space_plays(page):
    keyboard, whole = page.page.keyboard, end(page)
    keyboard.press("ArrowRight")
    keyboard.press("ArrowUp")
    assert time(page) == pytest.approx(0.02 * whole)
    keyboard.press("Shift+ArrowLeft")
    assert time(page) == pytest.approx(0.019 * whole)
    keyboard.press("End")
    assert time(page) == pytest.approx(whole)
    keyboard.press("Home")
    assert time(page) == 0.0
    keyboard.press("Space")
    page.page.wait_for_function("() => Number(document.getElementById('time').value) > 0.001")
    assert playing(page)
    keyboard.press("Space")
    assert not playing(page)
    page.page.focus("#time")
    keyboard.press("End")
    assert time(page) == pytest.approx(whole)
    assert page.page.get_attribute("#time", "aria-valuetext") == page.text("#now-time")


def test_a_dragged_cursor_and_the_slider_move_crank_time_and_speed(page):
    box = page.page.locator("#upper svg").bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"]
    drag(page, (x, y), (x + 40, y), (x + 80, y))
    dot = page.page.locator("#upper .cursor circle").bounding_box()
    assert dot["x"] + 0.5 * dot["width"] == pytest.approx(x + 80, abs=1.0)
    first = page.text(".now"), page.page.get_attribute("#stage .piston", "transform")
    page.page.mouse.move(x, y)  # no button is held
    assert page.text(".now") == first[0]
    drag(page, (x, y), (x - 5000, y))
    assert time(page) == 0.0
    drag(page, (x, y), (x + 5000, y))
    assert time(page) == pytest.approx(end(page))
    slide(page, 0.5)
    second = page.text(".now"), page.page.get_attribute("#stage .piston", "transform")
    assert page.text("#now-time") == "0.5000 s"
    assert all(one != other for one, other in zip(first, second, strict=True))


def test_a_swipe_scrolls_a_finger_across_moves_the_cursor_and_a_tap_does(phone):
    slide(phone, 0.5)
    (box,) = boxes(phone, "#upper svg")
    x, y = box["x"] + 0.4 * box["width"], box["y"] + 0.6 * box["height"]
    finger(phone, (x, y), *((x, y - step) for step in range(10, 180, 10)))
    phone.page.wait_for_function("() => scrollY > 60")
    assert time(phone) == 0.5
    phone.page.evaluate("scrollTo(0, 0)")
    finger(phone, (x, y), *((x + step, y) for step in range(10, 100, 10)))
    dragged = time(phone)
    assert dragged > 0.5
    phone.page.touchscreen.tap(x, y)
    assert time(phone) < dragged
    for each in phone.page.locator("button:visible, select:visible, input:visible").all():
        assert each.bounding_box()["height"] >= 44.0


@pytest.mark.parametrize("size", [PHONE, LAPTOP, LARGE], ids=str)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_moves_its_place_and_nothing_leaves_the_screen(browser, files, size, scheme):
    places = ("header", "#idea", "#stage", ".now", "#now-speed", "#now-fuel", "#upper svg", "#play")
    with film(browser, files["run_up"], size=size, color_scheme=scheme) as visited:
        before = boxes(visited, *places)
        visited.page.click("#play")
        visited.page.evaluate("document.getElementById('now-speed').textContent = '1088.8 rpm'")
        assert boxes(visited, *places) == before
        for share in (0.013, 0.3, 0.71, 1.0):
            slide(visited, share * end(visited))
            assert boxes(visited, *places) == before
        assert visited.page.evaluate("document.documentElement.scrollWidth") <= size[0]
        seen = boxes(visited, "#idea", "#stage", "#time", *(["#knobs"] if size != PHONE else []))
        assert max(box["y"] + box["height"] for box in seen) <= size[1]
        ground = visited.page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert (ground == "rgb(255, 255, 255)") == (scheme == "light")


@pytest.mark.parametrize("size", [PHONE, LAPTOP], ids=str)
def test_events_stand_at_their_times_with_words_that_do_not_touch(browser, files, size):
    with film(browser, files["run_up"], size=size) as visited:
        events = visited.page.locator("#upper .events")
        assert events.locator("text").all_text_contents() == [
            "starter on", "starter off", "first firing", "driven machine on",
        ]  # fmt: skip
        found = [each.bounding_box() for each in events.locator("text").all()]
        for k, one in enumerate(found):
            for other in found[:k]:
                across = (
                    one["x"] < other["x"] + other["width"] and other["x"] < one["x"] + one["width"]
                )
                assert not across or abs(one["y"] - other["y"]) >= 0.7 * one["height"]
        lines = {float(each.get_attribute("x1")) for each in events.locator("line").all()}
        slide(visited, 3.0)
        at = float(visited.page.get_attribute("#upper .cursor line", "x1"))
        assert min(abs(at - line) for line in lines) < 0.01
        assert "first firing at 0.131 s" in visited.page.get_attribute("#upper svg", "aria-label")


def test_the_plot_leaves_room_for_words_and_says_its_scales(browser, files):
    with film(browser, files["run_up"], size=PHONE) as visited:
        words = [each.bounding_box() for each in visited.page.locator(".events text").all()]
        curve = visited.page.locator("#upper path.simulated").bounding_box()
        assert max(box["y"] + 0.8 * box["height"] for box in words) < curve["y"] + 8.0
        for axes in visited.page.locator("#upper svg > g:nth-child(-n + 2)").all():
            ticks = [each.bounding_box() for each in axes.locator("text.end").all()]
            assert len(ticks) >= 2
            assert np.diff(sorted(box["y"] for box in ticks)).min() > 0.7 * ticks[0]["height"]
        assert "share of the fuel" in visited.page.text_content("#upper svg")
        assert "crank speed [rpm]" in visited.page.text_content("#upper svg")


def test_an_axis_of_a_crank_at_rest_can_be_read(page):
    page.page.select_option("#slower", index=8)
    slide(page, end(page))
    svg = page.page.locator("#upper svg").bounding_box()
    ticks = page.page.locator("#upper svg g:nth-of-type(1) text.end").all()
    assert len(ticks) >= 2
    for tick in ticks:
        assert len(tick.text_content()) <= 6
        assert tick.bounding_box()["x"] >= svg["x"]


def test_large_type_leaves_the_plot_readable(page):
    page.page.click("#large")
    drawn(page.page)
    assert page.page.evaluate("document.documentElement.scrollWidth") <= LAPTOP[0]
    assert page.page.locator("#upper svg").bounding_box()["height"] > 150.0
