"""The motion of a multibody run, between its samples and saved: that of the exact one."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from crankmbs.result import Result
from crankmbs.scene.read import load_scene
from crankmbs.scene.scene import Scene
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


@pytest.mark.parametrize("name", LENGTHS)
def test_between_samples_it_errs_by_no_more_than_it_states(name: str) -> None:
    exact = simulate(scene(name)).passes.answer
    passes = simulate(scene(name), formulation="multibody").passes
    time = np.linspace(exact.begin, exact.end, 2345)[1:-1]
    answer, *checks = (each.at(time, in_time=True) for each in (passes.answer, *passes.checks))
    true = exact.at(time, in_time=True)
    for name in ("theta", "omega"):
        found = getattr(answer, name)
        stated = passes.share * max(np.abs(getattr(each, name) - found).max() for each in checks)
        rounding = 1e-12 * np.abs(found).max()
        assert np.abs(found - getattr(true, name)).max() < stated + rounding
        assert stated < 1e-5 * np.abs(found).max()


@pytest.mark.parametrize("name", LENGTHS)
def test_its_measures_and_cycles_are_those_of_the_exact_run(name: str) -> None:
    exact, result = (simulate(scene(name), formulation=each) for each in (None, "multibody"))
    for found, true in (
        (result.measures().mean_speed, exact.measures().mean_speed),
        (result.measures().fluctuation, exact.measures().fluctuation),
    ):
        assert abs(found.value - true.value) <= found.error + true.error
        assert found.error < 1e-5 * abs(result.measures().mean_speed.value)
    assert result.cycles.sizes == exact.cycles.sizes
    for column in ("time", "duration", "mean_speed", "kinetic_energy_gained"):
        found, true = result.cycles[column], exact.cycles[column]
        allowed = found.attrs["error_estimate"] + true.attrs["error_estimate"]
        np.testing.assert_allclose(found.values, true.values, rtol=0.0, atol=allowed)


@pytest.mark.parametrize("name", ["misfire", "compressor"])
def test_saved_and_sent_it_is_the_same(name: str, tmp_path: Path) -> None:
    result = simulate(scene(name), formulation="multibody")
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
