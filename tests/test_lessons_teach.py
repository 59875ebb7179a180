"""What the lessons teach: figures begin where their words hold, and a student's answers count."""

from dataclasses import replace

import numpy as np
import pytest
from test_lessons_browser import numbers_of

from crankmbs import load_scene, simulate

pytestmark = pytest.mark.slow


def test_the_valley_begins_with_one_floor_and_splits(lesson):
    opened = lesson("acceleration")
    assert opened.said("valley.least") == 180.0
    assert opened.said("valley.ratio") == 0.22
    opened.type("valley", "rod_ratio", 40.0 / 140.0)
    wanted = numbers_of("acceleration")["minimum_exact"]
    assert opened.said("valley.least") == pytest.approx(wanted, abs=0.006)


def test_the_crank_follows_the_gas_at_low_speed_and_not_at_high(lesson):
    opened = lesson("omega")
    text = opened.page.locator('[data-say="moment.verdict"]')
    assert opened.said("moment.mean") < 1000.0
    assert opened.said("moment.share") > 80.0
    assert "follows the gas" in text.inner_text()
    opened.type("moment", "speed", 3200)
    scene = load_scene("yi_diesel_free")
    settled = replace(scene, run=replace(scene.run, until="settled"))
    v = {name: each.values[-721:] for name, each in simulate(settled).data.items()}
    gas = (v["gas_force"] * v["piston_velocity"]).sum(axis=1) / v["crank_speed"]
    share = 100.0 * np.mean(v["crank_acceleration"][gas > -v["external_torque"]] > 0.0)
    assert opened.said("moment.share") == pytest.approx(share, abs=1.0)
    assert "slows down" in text.inner_text()


def test_a_polar_is_drawn_in_a_square_with_its_ray_and_dots(lesson):
    opened = lesson("polar")
    for figure in ("pin", "turning"):
        box = opened.page.locator(f"#{figure} .plot .paper").bounding_box()
        assert box["width"] / box["height"] == pytest.approx(1.0, abs=0.25)
        assert opened.page.locator(f"#{figure} .cursor line").count() == 1
        assert opened.page.locator(f"#{figure} path.curve.dots").count() == 1


def test_an_angle_at_which_it_is_also_so_is_right(lesson):
    opened = lesson("displacement")
    for typed, verdict in (("81.79", "right"), ("278.21 °", "right"), ("98", "wrong")):
        assert verdict in opened.answer("ask_middle", typed).get_attribute("class")


def test_a_number_without_a_unit_is_asked_for_as_such(lesson):
    opened = lesson("trust")
    assert opened.answer("ask_halved", "some").inner_text() == "A number, please, such as 1.5."
    reply = opened.answer("ask_halved", "16 mm").inner_text()
    assert reply == "“mm” does not fit here: answer by a number without a unit."
    assert "right" in opened.answer("ask_halved", "16").get_attribute("class")


@pytest.mark.parametrize(
    ("name", "figure", "knob", "values"),
    [("displacement", "series", "rod_ratio", (0.1, 0.25)), ("forces", "side", "share", (1.2, 0.6))],
)
def test_the_strip_of_a_difference_keeps_its_scale_so_that_one_sees_it_grow(
    lesson, name, figure, knob, values
):
    opened = lesson(name)
    seen = []
    for value in values:
        opened.type(figure, knob, value)
        opened.settle()
        ticks = opened.page.locator(f"#{figure} .plot svg > g").nth(1).locator("text.tick.end")
        seen.append((ticks.all_inner_texts(), opened.curve(figure, "difference0")))
    (scale, small), (same, large) = seen
    assert scale == same
    assert len(scale) > 1
    assert small != large
