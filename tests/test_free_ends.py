"""Runs of a free crank that end before their end, and what is then still stated."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import psutil
import pytest

from crankmbs import InputError, Run, Start, load_scene, simulate
from crankmbs.formulations import minimal
from crankmbs.result import VARIABLES

COASTING = load_scene("coasting")


def stated(result, name):
    return float(result.data[name].attrs["error_estimate"])


def test_too_many_evaluations_stop_the_run_with_the_samples_of_both_passes(monkeypatch):
    whole = simulate(COASTING, formulation="minimal")
    monkeypatch.setattr(minimal, "_MOST_EVALUATIONS", 2000)
    result = simulate(COASTING, formulation="minimal")
    assert result.status == -1
    assert "takes more than" in result.message
    n = result.data.sizes["time"]
    assert 10 < n < whole.data.sizes["time"]
    difference = np.abs(result.data["time"].values - whole.data["time"].values[:n])
    assert difference.max() <= stated(result, "time") + stated(whole, "time")
    last = math.degrees(float(result.data["crank_angle"][-1]))
    assert f"stopped at {last:.6g} degrees" in result.message


def test_a_second_pass_that_takes_too_much_says_so(monkeypatch):
    whole = simulate(COASTING, formulation="minimal")
    monkeypatch.setattr(minimal, "_MOST_EVALUATIONS", whole.cost.evaluations // 2)
    result = simulate(COASTING, formulation="minimal")
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
    free = SimpleNamespace(available=2000 * 10 * 8 * 22)  # bytes
    monkeypatch.setattr(psutil, "virtual_memory", lambda: free)
    with pytest.raises(InputError, match=r"run\.every: .* samples of 22 numbers each came"):
        simulate(scene, formulation=formulation)


def test_an_error_that_cannot_be_known_is_infinite(monkeypatch):
    monkeypatch.setattr(minimal, "_MOST_EVALUATIONS", 2000)
    scene = dataclasses.replace(COASTING, run=Run(until="1000 rev", every="none"))
    result = simulate(scene, formulation="minimal")
    assert result.status == -1
    assert all(stated(result, name) == math.inf for name in VARIABLES)


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
