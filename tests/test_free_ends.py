"""Runs of a free crank that end before their end, and what is then still stated."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import psutil
import pytest

from crankmbs import (
    Bearings,
    Cylinder,
    Friction,
    InputError,
    Layout,
    Run,
    Start,
    Table,
    TimeTable,
    load_scene,
    simulate,
)
from crankmbs.mechanics.variables import variables_of

COASTING = load_scene("coasting")
PER_SECOND = 50_000  # evaluations over time that a second of the cost cap allows


def stated(result, name):
    return float(result.data[name].attrs["error_estimate"])


@pytest.mark.slow
def test_too_many_evaluations_stop_the_run_with_the_samples_of_both_passes():
    whole = simulate(COASTING, formulation="minimal")
    result = simulate(COASTING, formulation="minimal", cost_cap=2000 / PER_SECOND)
    assert result.status == -1
    assert "takes more than" in result.message
    n = result.data.sizes["time"]
    assert 10 < n < whole.data.sizes["time"]
    difference = np.abs(result.data["time"].values - whole.data["time"].values[:n])
    assert difference.max() <= stated(result, "time") + stated(whole, "time")
    last = math.degrees(float(result.data["crank_angle"][-1]))
    assert f"stopped at {last:.6g} degrees" in result.message


@pytest.mark.slow
def test_a_second_pass_that_takes_too_much_says_so():
    whole = simulate(COASTING, formulation="minimal")
    cap = whole.cost.evaluations // 2 / PER_SECOND
    result = simulate(COASTING, formulation="minimal", cost_cap=cap)
    assert result.status == -1
    assert "takes more than" in result.message
    n = result.data.sizes["time"]
    difference = np.abs(result.data["time"].values - whole.data["time"].values[:n])
    assert difference.max() <= stated(result, "time") + stated(whole, "time")


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("every", ["1 us", "0.1 ms"], ids=["within one piece", "over many"])
def test_more_samples_than_memory_holds_are_refused_where_they_come(
    formulation, every, monkeypatch
):
    """An end at an angle does not say how many samples in time there will be."""
    scene = dataclasses.replace(COASTING, run=Run(until="30 rev", every=every))
    free = SimpleNamespace(available=2000 * 10 * 8 * 29)  # bytes
    monkeypatch.setattr(psutil, "virtual_memory", lambda: free)
    with pytest.raises(InputError, match=r"run\.every: .* samples of 29 numbers each came"):
        simulate(scene, formulation=formulation)


ONE = Layout(cylinders=(Cylinder(phase=0.0, bank=0.0, position=0.0),))


@pytest.mark.parametrize("more", [{}, {"layout": ONE, "bearings": Bearings()}], ids=list)
def test_an_error_that_cannot_be_known_is_infinite(more):
    scene = dataclasses.replace(COASTING, run=Run(until="1000 rev", every="none"), **more)
    result = simulate(scene, formulation="minimal", cost_cap=5000 / PER_SECOND)
    assert result.status == -1
    assert all(stated(result, name) == math.inf for name in variables_of(scene))


@pytest.mark.parametrize(
    ("cap", "status", "said"),
    [(5, -1, "takes more than the 5 evaluations"), (50, 1, "it comes to a stop")],
)
def test_what_a_motion_settles_to_is_sought_as_long_as_the_cost_cap_allows(cap, status, said):
    """So is where it stops that does not settle: without that it is said in general."""
    run = Run(until="settled", every="1 deg")
    rings, start = Friction(ring_force=300.0), Start(angle=0.3, speed=100.0)
    scene = dataclasses.replace(COASTING, friction=rings, start=start, run=run)
    result = simulate(scene, cost_cap=cap / PER_SECOND)
    assert result.status == status
    assert said in result.message


def test_a_swing_under_a_load_over_time_goes_on_as_long_as_the_cost_cap_allows():
    """What the table holds for later may still drive it to its end."""
    load = TimeTable(file=Table((0.0, 60.0), (0.0, 0.0)))
    start, run = Start(angle=1.0, speed=0.0), Run(until="3 rev", every="1 deg")
    scene = dataclasses.replace(COASTING, start=start, torque=(load,), run=run)
    result = simulate(scene, cost_cap=100_000 / PER_SECOND)
    assert result.status == -1
    assert "takes more than the 100000 evaluations that the cost cap allows" in result.message
    assert 2000 < result.data.sizes["time"] < 9000


@pytest.mark.slow
def test_a_stop_says_what_was_reached():
    start = Start(angle=1.0, speed=0.0)
    scene = dataclasses.replace(COASTING, start=start, run=Run(until="3 rev", rtol=1e-13))
    result = simulate(scene)
    assert result.status == 1
    assert "swings without reaching the end" in result.message
    assert "asked for 1e-13, reached" in result.message


@pytest.mark.parametrize("turns", [1, 1000])
def test_the_acceleration_is_stated_no_closer_than_its_angle_has_digits(turns):
    run = Run(until=f"{turns} rev", every="none")
    data = simulate(dataclasses.replace(COASTING, gravity=None, run=run)).data
    angle, alpha = data["crank_angle"].values, data["crank_acceleration"]
    steepest = np.max(np.abs(np.diff(alpha.values) / np.diff(angle)))
    assert alpha.attrs["error_estimate"] > 0.9 * steepest * np.spacing(angle[-1])
