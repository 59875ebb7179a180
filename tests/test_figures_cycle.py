"""Where the figures over a cycle begin, and what they show of a run that ends elsewhere."""

import dataclasses
import math

import numpy as np
import pytest

from crankmbs import Cylinder, Layout, Motion, Ramp, Run, load_scene, simulate
from crankmbs.figures import last_view, speed_figure, torque_figure

pytestmark = pytest.mark.slow


def driven(speed=300.0, *, until="2 cycles", **parts):
    run, motion = Run(until=until), Motion(speed=speed)
    base = load_scene("propeller")
    return dataclasses.replace(base, start=None, torque=(), motion=motion, run=run, **parts)


def test_ticks_beyond_a_cycle_start_again():
    layout = Layout(cylinders=(Cylinder(phase=math.radians(180.0)),))
    (ax,) = torque_figure(last_view(simulate(driven(layout=layout)))).axes
    assert ax.get_xlim() == pytest.approx((540.0, 1260.0))
    shown = [text.get_text() for text in ax.get_xticklabels()]
    labels = dict(zip(ax.get_xticks(), shown, strict=True))
    assert labels[540.0] == "540"
    assert labels[720.0] == "0"
    assert labels[810.0] == "90"


@pytest.mark.parametrize(
    ("speed", "until", "begun"),
    [(300.0, "1000.5 deg", 280.5), (-300.0, "1000.5 deg", 439.5), (300.0, "1440 deg", None)],
)
def test_a_cycle_is_shown_from_the_gas_exchange_wherever_the_run_ends(speed, until, begun):
    view = last_view(simulate(driven(speed, until=until)))
    (ax,) = torque_figure(view).axes
    assert ax.get_xlim() == pytest.approx((0.0, 720.0))
    degrees, torque = ax.lines[0].get_xydata().T
    full = last_view(simulate(driven(speed, until="720 deg")))
    expected = np.interp(degrees, full.degrees, full.values("crank_torque")[:, 0], period=720.0)
    assert np.nanmin(degrees) <= 0.0
    assert np.nanmax(degrees) >= 720.0
    assert torque == pytest.approx(expected, abs=0.5, nan_ok=True)  # of 300 N m, between samples
    assert view.begun == (None if begun is None else pytest.approx(begun))
    words = "" if begun is None else f", which began at {begun:g} deg"
    assert ax.get_xlabel() == f"crank angle [deg], last cycle{words}"


def test_a_cycle_that_ends_unlike_it_began_has_a_gap_there():
    ramp = Ramp(start=300.0, to=200.0, over=0.2)
    view = last_view(simulate(driven(ramp, until="1000 deg")))
    degrees, speed = speed_figure(view).axes[-1].lines[0].get_xydata().T
    (gap,) = np.flatnonzero(np.isnan(degrees))
    assert degrees[gap - 1] == pytest.approx(degrees[gap + 1]) == 280.0
    assert speed[gap + 1] - speed[gap - 1] > 200.0  # rpm
    assert np.all(np.diff(speed[:gap]) < 0.0)
    assert np.all(np.diff(speed[gap + 1 :]) < 0.0)


def test_a_short_run_that_turns_back_is_drawn_over_time():
    view = last_view(simulate(driven(Ramp(start=20.0, to=-20.0, over=0.2), until="0.2 s")))
    assert view.window.kind == "whole run"
    for draw in (speed_figure, torque_figure):
        (ax,) = draw(view).axes
        assert np.all(np.diff(ax.lines[0].get_xdata()) > 0.0)
        assert ax.get_xlabel().startswith("time [s]")


def test_a_crank_that_swings_at_the_end_is_shown_as_far_as_it_came():
    view = last_view(simulate(driven(Ramp(start=200.0, to=-100.0, over=0.3), until="0.25 s")))
    assert view.window.kind == "last swings"
    for draw in (speed_figure, torque_figure):
        ax = draw(view).axes[-1]
        time = ax.lines[0].get_xdata()
        assert np.all(np.diff(time) > 0.0)  # over its angle the curve would come back
        assert time[-1] == pytest.approx(0.25)
        assert ax.get_xlabel() == "time [s], last swings"
