"""What the page begins with and how it behaves under a student's hands: one question, nothing that
moves its place, a refused knob that does not lie, a finger that scrolls, a link that keeps a pose.
"""

import pytest
from browser import STILL, drawn, resize
from page_scenes import SHOWN
from page_visit import opened

pytestmark = pytest.mark.slow

PHONE, LAPTOP = (390, 844), (1366, 641)
ENDS = """what => [...document.querySelectorAll(what)].map((each) => {
    const { left, right } = each.getBoundingClientRect();
    return [left, right];
})"""


@pytest.fixture
def page(browser, tmp_path):
    with opened(browser, tmp_path, "propeller", size=LAPTOP, everything=False) as visited:
        yield visited.settle()


def on_screens(page, sizes=(PHONE, LAPTOP)):
    """Each size of a screen, the open page laid out in it: styles and observers alone do that."""
    for size in sizes:
        resize(page.page, size)
        yield size


def boxes(page, *places):
    """Where things stand on the page, however far it is scrolled."""
    found = [page.page.locator(place).first.bounding_box() for place in places]
    scrolled = page.page.evaluate("scrollY")
    return [{**box, "y": box["y"] + scrolled} for box in found]


@pytest.mark.parametrize("name", SHOWN)
def test_it_begins_with_a_question_the_mechanism_a_plot_and_three_knobs(browser, tmp_path, name):
    with opened(browser, tmp_path, name, size=PHONE, everything=False) as visited:
        assert visited.settle().text("#idea h2").endswith("?")
        assert not visited.page.is_visible("#lower")
        knobs = visited.page.locator(".knob:visible").all()
        for wide, high in on_screens(visited):
            assert len(visited.page.locator("#numbers div:visible").all()) <= 4
            assert len(visited.page.locator(".knob:visible").all()) == len(knobs) <= 3
            parts = boxes(visited, "#idea", "#stage", "#upper svg", "#angle")
            for box in [*parts, *(knob.bounding_box() for knob in knobs)]:
                assert box["x"] >= 0.0
                assert box["x"] + box["width"] <= wide
                assert box["y"] >= 0.0
                assert box["y"] + box["height"] <= high
        visited.page.click("#more")
        for _ in on_screens(visited):
            assert visited.page.is_visible("#lower")
            assert len(visited.page.locator(".knob:visible").all()) >= len(knobs)
        assert_no_knob_and_no_hint_is_cut_off(visited)


def assert_no_knob_and_no_hint_is_cut_off(visited):
    """On the laptop, with every knob on the page."""
    wanted, seen = visited.page.evaluate(
        "() => { const { scrollHeight, clientHeight } = document.getElementById('knobs');"
        " return [scrollHeight, clientHeight] }"
    )
    assert wanted <= seen + 1
    (foot,) = boxes(visited, "footer")
    assert foot["y"] + foot["height"] <= LAPTOP[1] + 1.0
    assert "Space plays" in visited.text("footer")


@pytest.mark.parametrize("name", ["v_twin", "two_stage_compressor"])
def test_names_of_forces_stand_beside_a_cylinder_that_leans(browser, tmp_path, name):
    with opened(browser, tmp_path, name, size=PHONE, everything=False) as visited:
        for _ in on_screens(visited.settle()):
            walls, names, (stage,) = (
                visited.page.evaluate(ENDS, what)
                for what in ("#stage .cylinder .wall", "#stage .arrows text", "#stage")
            )
            assert len(names) >= 2
            for left, right in names:
                assert left >= max(end for _, end in walls)
                assert right <= stage[1] + 1.0


def test_names_of_a_crank_s_forces_stand_on_the_side_that_has_room(browser, tmp_path):
    with opened(browser, tmp_path, "v_twin", "#forces=crank", size=PHONE) as visited:
        for _ in on_screens(visited.settle()):
            walls, names = (
                visited.page.evaluate(ENDS, what)
                for what in ("#stage .cylinder .wall", "#stage .arrows text")
            )
            assert len(names) >= 3
            low, high = min(begin for begin, _ in walls), max(end for _, end in walls)
            assert all(right <= low + 2.0 or left >= high - 2.0 for left, right in names)


def test_what_changes_comes_first_among_the_numbers(browser, tmp_path):
    for name, second in (("propeller", "fluctuation"), ("grega_lecture", "side force, peak")):
        with opened(browser, tmp_path, name, size=PHONE, everything=False) as visited:
            shown = visited.settle().page.locator("#numbers dt:visible").all_inner_texts()
            assert shown == ["mean speed", second]


@pytest.mark.parametrize("everything", [False, True])
def test_the_number_of_a_knob_is_seen_whole(browser, tmp_path, everything):
    with opened(browser, tmp_path, "propeller", size=PHONE, everything=everything) as visited:
        for _ in on_screens(visited.settle()):
            for entry in visited.page.locator(".knob:visible input.entry").all():
                wide, seen = entry.evaluate("(each) => [each.scrollWidth, each.clientWidth]")
                assert wide <= seen, entry.input_value()


@pytest.mark.parametrize("name", ["propeller", "two_stage_compressor"])
def test_the_scale_of_the_forces_leaves_the_ring_free(browser, tmp_path, name):
    with opened(browser, tmp_path, name, size=PHONE, everything=False) as visited:
        for _ in on_screens(visited.settle()):
            places = ("#stage .ring .track", "#stage .scale path", "#stage .scale text")
            ring, bar, text = boxes(visited, *places)
            assert min(bar["y"], text["y"]) >= ring["y"] + ring["height"]


@pytest.mark.parametrize("name", ["compressor", "propeller"])
def test_a_long_legend_takes_nothing_from_the_plot_of_a_phone(browser, tmp_path, name):
    """That of the compressor has five entries, the other two."""
    with opened(browser, tmp_path, name, size=PHONE, everything=False) as visited:
        entries = len(visited.settle().page.locator("#upper .entry").all())
        assert entries == {"compressor": 5, "propeller": 2}[name]
        (plot,) = boxes(visited, "#upper svg")
        assert plot["height"] > 110.0


def test_the_mechanism_is_larger_than_the_plot(page):
    stage, plot = boxes(page, "#stage", "#upper svg")
    assert stage["width"] * stage["height"] > 2.0 * plot["width"] * plot["height"]


def test_a_knob_that_cannot_be_greys_the_picture_and_covers_nothing(page):
    before = boxes(page, "h1", "#stage", "#upper svg", "#numbers")
    slider = page.page.locator("#knob-flywheel")
    turn = "(each, share) => { each.value = +each.min + share * (each.max - each.min);"
    turn += " each.dispatchEvent(new Event('input')); each.dispatchEvent(new Event('change')) }"
    numbers, good = page.text("#numbers"), page.curve()
    slider.evaluate(turn, 0.0)
    assert page.message.startswith("too light or too slow: the engine would stall")
    assert page.page.locator("#stage").evaluate("(e) => getComputedStyle(e).opacity") == "0.3"
    assert (page.text("#numbers"), page.curve()) == (numbers, good)
    assert boxes(page, "h1", "#stage", "#upper svg", "#numbers") == before
    assert "flywheel" not in page.address
    slider.evaluate(turn, 0.5)
    assert not page.page.is_visible("#message")
    assert page.page.locator("#stage").evaluate("(e) => getComputedStyle(e).opacity") == "1"
    assert page.settle().text("#numbers") != numbers


@pytest.mark.parametrize("size", [PHONE, LAPTOP], ids=str)
def test_nothing_moves_its_place_as_knobs_and_crank_turn(browser, tmp_path, size):
    places = ("header", "#stage", "#upper svg", "#upper .legend", "#lower svg", "#sliders")
    with opened(browser, tmp_path, "propeller", size=size) as visited:
        before = boxes(visited.settle(), *places)
        visited.type("load", 0)
        for degrees in range(0, 720, 45):
            visited.page.locator("#angle").evaluate(
                "(e, at) => { e.value = at; e.dispatchEvent(new Event('input')) }", degrees
            )
            assert boxes(visited, *places) == before
        assert boxes(visited.settle(), *places) == before


def test_an_address_of_200_kb_makes_a_short_message(page):
    for text in ("#" + "x" * 200_000 + "=1", "#load=" + "9" * 200_000, "#rod=" + "y" * 200_000):
        page.go("#")
        page.page.wait_for_function("() => document.getElementById('message').hidden")
        page.go(text)
        page.page.wait_for_function("() => !document.getElementById('message').hidden")
        assert len(page.message) < 400
        assert page.page.evaluate("document.documentElement.scrollHeight") <= LAPTOP[1]


def test_a_link_with_an_angle_keeps_its_pose_and_does_not_play(browser, tmp_path):
    options = {"motion": "no-preference", "everything": False}
    with opened(browser, tmp_path, "propeller", "#angle=100", **options) as visited:
        drawn(visited.page, STILL)
        assert visited.degrees == 100.0
        assert "pause" not in visited.text("#play")
        assert visited.page.get_attribute("#more", "aria-expanded") == "false"


def test_a_link_to_what_is_folded_unfolds_it(browser, tmp_path):
    with opened(browser, tmp_path, "propeller", "#offset=5", everything=False) as visited:
        assert visited.page.is_visible("#knob-offset")


def test_the_page_says_that_it_shows_the_settled_motion(browser, tmp_path, page):
    said = "(docs/validation). Shown is the motion that the machine settles to, if it does;"
    assert said in " ".join(page.text("footer").split())
    with opened(browser, tmp_path, "grega_lecture") as driven:
        assert "settle" not in driven.text("footer")


def test_cycles_that_differ_and_repeat_together_are_counted(browser, tmp_path):
    with opened(browser, tmp_path, "indicated") as visited:
        assert visited.text("#badge") == "settled motion: these 6 cycles repeat"


def test_two_curves_of_a_legend_have_two_colours(browser, tmp_path):
    with opened(browser, tmp_path, "propeller") as visited:
        visited.settle()
        assert "constant speed" in visited.text("#upper .legend")
        assert "\u2212 constant" not in visited.text("#upper .legend")  # the curve once more
        colours = visited.page.locator("#lower .legend i").evaluate_all(
            "(all) => all.map((each) => getComputedStyle(each).color)"
        )
        assert len(colours) == len(set(colours)) == 5


@pytest.fixture
def phone(browser, tmp_path):
    touch = {"has_touch": True, "is_mobile": True, "everything": False}
    with opened(browser, tmp_path, "propeller", size=PHONE, **touch) as visited:
        yield visited.settle()


def finger(page, begin, *places):
    """A finger goes from one place to others, as the browser hears it."""
    devtools = page.page.context.new_cdp_session(page.page)

    def send(kind, *points):
        touches = [{"x": x, "y": y} for x, y in points]
        devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})

    send("touchStart", begin)
    for place in places:
        send("touchMove", place)
        drawn(page.page)
    send("touchEnd")
    drawn(page.page)


def middle(box):
    return box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"]


def test_a_swipe_over_a_plot_or_the_drawing_scrolls_and_does_not_turn(phone):
    phone.page.click("#more")
    for place in ("#upper svg", "#stage"):
        phone.page.evaluate("scrollTo(0, 0)")
        degrees, (box,) = phone.degrees, boxes(phone, place)
        x, y = middle(box)
        x = box["x"] + 8.0 if place == "#stage" else x
        finger(phone, (x, y), *((x, y - step) for step in range(10, 180, 10)))
        phone.page.wait_for_function("() => scrollY > 60")
        assert phone.degrees == degrees


def test_a_finger_across_a_plot_turns_the_crank_and_a_tap_does(phone):
    (box,) = boxes(phone, "#upper svg")
    x, y = middle(box)
    degrees = phone.degrees
    finger(phone, (x, y), *((x + step, y) for step in range(10, 100, 10)))
    dragged = phone.degrees
    assert dragged != degrees
    phone.page.touchscreen.tap(x, y)
    assert phone.degrees < dragged


def test_targets_are_large_enough_for_a_finger(phone):
    phone.page.click("#more")
    for each in phone.page.locator("button:visible, select:visible, input:visible").all():
        assert each.bounding_box()["height"] >= 44.0


@pytest.mark.parametrize(
    ("name", "label", "which"),
    [
        ("yi_diesel_free", "rated speed of load", "cylinder 1 of 4; pale: the others"),
        ("v_twin", "rated speed of load", "cylinder 1 of 2"),
        ("two_stage_compressor", "rated speed of drive", "cylinder 1 of 2"),
        ("compressor", "speed", ""),
    ],
)
def test_it_says_what_the_speed_is_which_cylinder_is_shown_and_whence_the_scene_is(
    browser, tmp_path, name, label, which
):
    with opened(browser, tmp_path, name) as visited:
        assert visited.settle().text("label[for=knob-speed]") == label
        assert visited.page.text_content("#stage .which") == which
        rated = visited.page.locator("#rated").all_inner_texts()
        assert [label.split()[-1] in said and "mean speed" in said for said in rated] == (
            [True] if label != "speed" else []
        )
        assert "Source: " in visited.text("footer")
