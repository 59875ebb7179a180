"""Figures of runs at rest, of runs sampled in time, and of runs with a long title."""

import dataclasses
import math
import re

import numpy as np
import pytest

from crankmbs import Motion, Ramp, Run, Start, load_scene, simulate
from crankmbs.figures import (
    crank_pin_figure,
    forces_figure,
    last_view,
    machine_figure,
    main_bearing_figure,
    piston_motion_figure,
    piston_pin_figure,
    speed_figure,
    torque_figure,
)
from crankmbs.figures.view import exactness

pytestmark = pytest.mark.slow

BARE = dataclasses.replace(load_scene("coasting"), gravity=None, torque=())
STRIPS = [speed_figure, piston_motion_figure, forces_figure, torque_figure]
POLAR = [main_bearing_figure, crank_pin_figure, piston_pin_figure]


@pytest.mark.parametrize("degrees", [0.0, 367.5, -100.0])
@pytest.mark.parametrize("draw", [*STRIPS, *POLAR])
def test_a_crank_at_rest_is_a_visible_point(draw, degrees):
    scene = dataclasses.replace(BARE, start=Start(angle=math.radians(degrees), speed=0.0))
    result = simulate(scene)
    assert result.data.sizes["time"] == 1
    figure = draw(last_view(result))
    assert all(any(line.get_marker() == "o" for line in ax.lines) for ax in figure.axes)
    if draw in STRIPS:
        at = degrees % 720.0
        assert figure.axes[-1].get_xlim() == pytest.approx((at - 1.0, at + 1.0))
        near = [float(text.get_text()) for text in figure.axes[-1].get_xticklabels()]
        assert near == [math.ceil(at - 1.0) + k for k in range(len(near))]
        assert len(near) > 1


def run_up(until, every):
    speed = Ramp(start=100.0, to=300.0, over=0.2)
    run = Run(until=until, every=every)
    return last_view(
        simulate(dataclasses.replace(BARE, start=None, motion=Motion(speed=speed), run=run))
    )


@pytest.mark.parametrize("until", ["0.3 s", "0.05 s"])  # some cycles, and less than one turn
def test_a_run_sampled_in_time_shows_its_speed_over_time(until):
    view = run_up(until, "1 ms")
    whole, last = speed_figure(view).axes
    time = whole.lines[0].get_xdata()
    assert whole.get_xlabel() == "time [s], whole run"
    assert set(view.result.data["time"].values) <= set(time)
    assert whole.lines[0].get_ydata() == pytest.approx(
        np.minimum(100.0 + 1000.0 * time, 300.0) * 30.0 / math.pi
    )
    assert last.get_xlabel().startswith("crank angle [deg], ")


def test_a_run_sampled_in_angle_shows_its_speed_over_the_angle():
    whole, _ = speed_figure(run_up("0.3 s", "1 deg")).axes
    assert whole.get_xlabel() == "crank angle [rev], whole run"


@pytest.mark.parametrize("draw", POLAR)
def test_a_caption_of_several_lines_keeps_clear_of_the_axes(draw):
    scene = load_scene("v_twin")
    figure = draw(last_view(simulate(dataclasses.replace(scene, title=2 * scene.title))))
    assert figure.get_supxlabel().count("\n") >= 2
    figure.draw_without_rendering()
    point = figure.dpi / 72.0
    caption = figure.texts[-1].get_window_extent()
    assert 0.0 < caption.x0 < caption.x1 < figure.bbox.width
    lowest = min(ax.get_tightbbox().y0 for ax in figure.axes)
    assert lowest - caption.y1 > 5.0 * point
    for legend in figure.legends:
        highest = max(ax.get_tightbbox().y1 for ax in figure.axes)
        assert legend.get_window_extent().y0 - highest > 2.0 * point


@pytest.mark.parametrize("title", ["$$", "$x^{$", "5 $ and 6 $", r"\frac"])
def test_a_title_is_written_as_it_is(title):
    view = last_view(simulate(dataclasses.replace(BARE, title=title)))
    figure = speed_figure(view)
    figure.draw_without_rendering()
    assert figure.get_supxlabel().startswith(f"{title}\ncrank speed over the last cycle, above")
    assert not figure.texts[-1].get_parse_math()


@pytest.mark.parametrize(
    ("title", "above"),
    [("", []), ("word " * 30, [74, 74]), ("word " * 100, [119, 119, 118])],
)
def test_a_title_is_written_on_lines_of_about_one_length(title, above):
    figure = speed_figure(last_view(simulate(dataclasses.replace(BARE, title=title))))
    *lines, last = figure.get_supxlabel().split("\n")
    assert last.startswith("crank speed over")
    assert list(map(len, lines)) == above


@pytest.mark.parametrize("draw", [*STRIPS, *POLAR])
def test_a_caption_states_the_window_and_the_largest_relative_error(draw):
    view = last_view(simulate(BARE))
    lines = draw(view).get_supxlabel().replace("\n", " ")
    assert re.search(r" over the last cycle.*; numerical error at most \S+ % of the peak$", lines)


def test_the_error_of_a_caption_is_that_of_the_worst_variable_where_it_is_drawn():
    def of(values, error):
        return ("time",), np.array(values), {"error_estimate": error}

    variables = {"speed": of([100.0, 4.0, -5.0], 1e-3), "pin_x": of([0.0, 2.0, 0.0], 1e-3)}
    variables |= {"pin_y": of([0.0, 0.0, 0.0], 2e-3), "none": of([0.0, 0.0, 0.0], 1.0)}
    assert exactness(variables, "speed").endswith("at most 0.0010 % of the peak")
    assert exactness(variables, "speed", first=1).endswith("at most 0.020 % of the peak")
    assert exactness(variables, "speed", "pin", "none").endswith("at most 0.10 % of the peak")
    variables["alone"] = of([1.0], math.inf)
    assert exactness(variables, "speed", "alone") == "numerical error unknown"


@pytest.mark.parametrize("name", ["coasting", "v_twin", "yi_diesel_free"])
def test_the_caption_of_a_machine_is_within_its_figure_and_every_cut_says_whose_it_is(name):
    figure = machine_figure(load_scene(name))
    figure.draw_without_rendering()
    caption = figure.texts[-1].get_window_extent()
    assert 0.0 < caption.x0 < caption.x1 < figure.bbox.width
    titles = [ax.get_title() for ax in figure.axes]
    assert (
        titles
        == {
            "coasting": [""],
            "v_twin": ["cylinders 1, 2"],
            "yi_diesel_free": [f"cylinder {number}" for number in range(1, 5)],
        }[name]
    )


def test_a_legend_is_no_wider_than_its_figure():
    figure = torque_figure(last_view(simulate(load_scene("run_down"))))
    figure.draw_without_rendering()
    (box,) = (legend.get_window_extent() for legend in figure.legends)
    assert 0.0 < box.x0 < box.x1 < figure.bbox.width


def test_a_run_without_any_order_has_one_panel():
    figure = simulate(load_scene("turning_moment")).plot("orders")
    (ax,) = figure.axes
    assert not any(bar.get_height() for bar in ax.patches)
    assert "torque" in figure.get_supxlabel()
