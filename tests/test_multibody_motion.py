"""The motion of a multibody run, between its samples and saved: that of the exact one."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from crankmbs.result import Result
from crankmbs.scene.loads import TimeTable
from crankmbs.scene.read import load_scene
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.simulate import simulate

pytestmark = pytest.mark.slow

LENGTHS = {
    "propeller": "2 cycles",
    "misfire": "3 cycles",
    "torque_driven": "0.5 s",
    "compressor": "1 cycles",
}


def scene(name: str) -> Scene:
    return load_scene(name).with_(run__until=LENGTHS[name], run__every="90 deg")


@cache
def solved(name: str, formulation: str | None = None) -> Result:
    return simulate(scene(name), formulation=formulation)


@pytest.mark.parametrize("name", LENGTHS)
def test_between_samples_it_errs_by_no_more_than_it_states(name: str) -> None:
    exact, passes = solved(name).passes.answer, solved(name, "multibody").passes
    time = np.linspace(exact.begin, exact.end, 2345)[1:-1]
    answer, *checks = (each.at(time, in_time=True) for each in (passes.answer, *passes.checks))
    true = exact.at(time, in_time=True)
    for row in ("theta", "omega"):
        found = getattr(answer, row)
        stated = passes.share * max(np.abs(getattr(each, row) - found).max() for each in checks)
        rounding = 1e-12 * np.abs(found).max()
        assert np.abs(found - getattr(true, row)).max() < stated + rounding
        assert stated < 1e-5 * np.abs(found).max()


@pytest.mark.parametrize("name", LENGTHS)
def test_its_measures_and_cycles_are_those_of_the_exact_run(name: str) -> None:
    exact, result = solved(name), solved(name, "multibody")
    for found, true in (
        (result.measures().mean_speed, exact.measures().mean_speed),
        (result.measures().fluctuation, exact.measures().fluctuation),
    ):
        assert abs(found.value - true.value) <= found.error + true.error
        assert found.error < 1e-5 * abs(result.measures().mean_speed.value)
    assert result.cycles.sizes == exact.cycles.sizes
    for column in ("time", "duration", "mean_speed", "kinetic_energy_gained"):
        ours, theirs = result.cycles[column], exact.cycles[column]
        allowed = ours.attrs["error_estimate"] + theirs.attrs["error_estimate"]
        np.testing.assert_allclose(ours.values, theirs.values, rtol=0.0, atol=allowed)


@pytest.mark.parametrize("jump", [0.0123, 0.03])
def test_beside_a_jump_of_a_load_its_torque_is_that_of_its_side(jump: float) -> None:
    rows = Table((0.0, jump, jump, 0.1), (5.0, 8.0, -30.0, -10.0))
    coasting = load_scene("coasting").with_(run__until="0.05 s", run__every="0.005 s")
    loaded = replace(coasting, torque=(TimeTable(file=rows),))
    exact, result = (simulate(loaded, formulation=each) for each in (None, "multibody"))
    time = jump + np.array([-1e-3, -2e-5, -1e-7, 1e-7, 2e-5, 1e-3])
    found, true = (each.interp(time=time)["external_torque"].values for each in (result, exact))
    np.testing.assert_allclose(found, true, rtol=1e-6)


@pytest.mark.parametrize("name", ["misfire", "compressor"])
def test_saved_and_sent_it_is_the_same(name: str, tmp_path: Path) -> None:
    result = solved(name, "multibody")
    time = np.linspace(0.0, result.passes.answer.end, 99)[1:]
    there = result.passes.answer.at(time, in_time=True)
    for again in (Result.load(result.save(tmp_path)), pickle.loads(pickle.dumps(result))):
        here = again.passes.answer.at(time, in_time=True)
        np.testing.assert_array_equal(here.theta, there.theta)
        np.testing.assert_allclose(here.alpha, there.alpha, rtol=1e-12, atol=1e-9)
        assert again.measures().mean_speed == result.measures().mean_speed


def test_a_crank_that_stays_at_rest_has_one() -> None:
    rest = load_scene("coasting").with_(start__speed=0.0, start__angle="90 deg")
    rest = rest.with_(gravity__acceleration=0.0)
    result = simulate(rest, formulation="multibody")
    assert "did not move" in result.message
    motion = result.passes.answer
    assert (motion.begin, motion.end, motion.turned) == (0.0, 0.0, 0.0)
    assert result.events["kind"].values.tolist() == ["rest"]
    assert result.cycles.sizes["cycle"] == 0
