"""The one verb: what it takes, what it refuses, what it hands back."""

from dataclasses import replace

import pytest

from crankmbs import InputError, Run, load_scene, simulate

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
