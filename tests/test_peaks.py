"""Peaks of whole runs: where they are, their errors, and how they are put together."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import Run, load_scene, simulate
from crankmbs.measures import peaks
from crankmbs.measures.peaks import run_peaks

ENGINE = load_scene("torque_driven")  # from rest, faster and faster


@pytest.fixture(scope="module")
def result():
    return simulate(ENGINE)


def test_no_reading_of_the_run_lies_beyond_a_peak(result):
    data = result.interp(time=np.linspace(0.0, 1.0, 20001))
    force = np.hypot(data["crank_pin_force_x"], data["crank_pin_force_y"]).values[:, 0]
    torque, speed = data["crank_torque"].values[:, 0], data["crank_speed"].values
    series = {
        "highest speed": (speed, 1.0),
        "crank pin": (force, 1.0),
        "torque of the rods, max": (torque, 1.0),
        "torque of the rods, min": (torque, -1.0),
    }
    found = {one.name: one for one in run_peaks(result)}
    for name, (values, sign) in series.items():
        k = int(np.argmax(sign * values))
        assert sign * found[name].value.value >= sign * values[k] - found[name].value.error, name
        assert found[name].value.value == pytest.approx(values[k], rel=1e-5), name
        assert found[name].time == pytest.approx(data["time"].values[k], abs=1e-4), name
        there = result.interp(time=found[name].time)["crank_angle"].values[0]
        assert found[name].crank_angle == pytest.approx(there, abs=1e-6)


@pytest.mark.parametrize("rtol", [1e-3, 1e-6])
def test_the_error_holds(rtol):
    rough = run_peaks(simulate(replace(ENGINE, run=replace(ENGINE.run, rtol=rtol))))
    fine = run_peaks(simulate(replace(ENGINE, run=replace(ENGINE.run, rtol=1e-12))))
    for one, true in zip(rough, fine, strict=True):
        stated = one.value.error + true.value.error
        assert 0.0 < stated < 1e-2 * abs(true.value.value) + 1e-9
        assert abs(one.value.value - true.value.value) <= 2.0 * stated, one.name


def test_it_does_not_matter_in_which_blocks_they_are_sought(result, monkeypatch):
    whole = run_peaks(result)
    monkeypatch.setattr(peaks, "_BLOCK", 7)
    for one, other in zip(whole, run_peaks(result), strict=True):
        assert other.value.value == pytest.approx(one.value.value, rel=1e-12, abs=1e-12)
        assert other.time == pytest.approx(one.time, abs=1e-9)


def test_what_is_not_checked_has_no_known_error(result):
    alone = replace(result, motion=lambda: result.passes._replace(checks=()))
    assert all(one.value.error == np.inf for one in run_peaks(alone))


def test_the_peak_of_a_cylinder_is_where_its_cycle_says():
    scene = load_scene("yi_diesel_free")
    result = simulate(replace(scene, run=Run(until="2 cycles")))
    for one in run_peaks(result):
        if one.name == "gauge pressure":
            assert np.degrees(one.cycle_angle) == pytest.approx(373.62, abs=0.01)
