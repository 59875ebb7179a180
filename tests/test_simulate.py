"""The one verb: what it takes, what it refuses, what it hands back."""

import copy
from dataclasses import replace

import pytest

from crankmbs import InputError, OutputError, Result, Run, load_scene, simulate

SHORT = replace(load_scene("coasting"), run=Run(until="0.5 rev", every="30 deg", rtol=1e-5))


@pytest.mark.parametrize("rtol", [1e-15, 0.0, -1.0, 0.1, float("nan")])
def test_a_tolerance_out_of_range(rtol):
    with pytest.raises(InputError, match="rtol must be from 1e-13 to 1e-2"):
        simulate(SHORT, rtol=rtol)


@pytest.mark.parametrize("cap", [0.0, -1.0, float("nan")])
def test_a_cost_cap_out_of_range(cap):
    with pytest.raises(InputError, match="cost_cap must be a time above 0 s"):
        simulate(SHORT, cost_cap=cap)


@pytest.mark.parametrize(("rtol", "asked"), [(None, 1e-5), (1e-9, 1e-9)])
def test_the_scenes_tolerance_unless_told_otherwise(rtol, asked):
    result = simulate(SHORT, rtol=rtol)
    assert result.error.asked == asked
    assert result.error.estimated <= asked


def test_what_comes_back():
    result = simulate(SHORT)
    assert result.scene is SHORT
    assert (result.formulation, result.status) == ("crank_angle", 0)
    assert result.message == "reached the end of the run"
    assert result.cost.evaluations > 0
    assert result.cost.steps > 0
    assert result.cost.wall_time > 0.0
    assert result.reasons


def test_equal_runs_are_equal():
    assert simulate(SHORT).data.identical(simulate(SHORT).data)


@pytest.mark.parametrize(("scene", "came"), [("yi_diesel", '"yi_diesel"'), (None, "None")])
def test_what_is_no_scene(scene, came):
    with pytest.raises(InputError) as caught:
        simulate(scene)
    said = f"scene must be a Scene, such as load_scene reads; {came} came"
    assert str(caught.value) == said


def test_what_cannot_be_loaded(tmp_path):
    with pytest.raises(OutputError) as caught:
        Result.load(tmp_path)
    assert str(caught.value) == (
        f"{tmp_path}/result.nc: no such result; save writes one, and so does crankmbs run"
    )
    file = tmp_path / "text.nc"
    file.write_text("text")
    with pytest.raises(OutputError) as caught:
        Result.load(file)
    assert str(caught.value) == (
        f"{file}: no readable result of crankmbs; give the result.nc that save wrote"
    )


def test_a_result_says_whether_it_is_of_the_whole_run():
    run = Run(until="3 cycles", rtol=1e-5)
    whole, last = (simulate(replace(SHORT, run=replace(run, every=e))) for e in ("1 deg", "none"))
    end = f"{whole.data['time'].values[-1]:.6g} s"
    assert f"\n  {end}, 6 rev, " in str(whole)
    assert f"\n  last 2 rev of {end}, " in str(last)


def test_data_are_labelled_when_they_are_first_asked_for():
    result = simulate(load_scene("torque_driven"))
    assert "data" not in vars(result)
    again = copy.copy(result)
    data = result.data
    assert data is result.data
    assert vars(result).keys() >= {"data"}
    assert again.data.identical(data)
    assert replace(result, status=1).data is data
    with pytest.raises(AttributeError, match="'Result' object has no attribute 'date'"):
        _ = result.date
