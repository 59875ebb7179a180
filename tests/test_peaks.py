"""Peaks of whole runs: where they are, their errors, and how they are put together."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import Constant, Run, SpeedTable, Table, load_scene, simulate
from crankmbs.measures import peaks
from crankmbs.measures.names import values_of
from crankmbs.measures.peaks import quantities_of, run_peaks
from crankmbs.report.rows import peak_rows

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


def test_the_motor_and_the_work_of_a_press_have_peaks():
    """The motor's torque falls with the speed; the work is largest at a row of its table."""
    motor = SpeedTable(file=Table((0.0, 12.0), (3000.0, 0.0)))
    press = load_scene("validation/scenes/press.toml")
    result = simulate(press.with_(torque=(motor,), run__until="settled"))
    values = {name: each[0].value for name, each in values_of(result.measures()).items()}
    slow, fast = (250.0 * (12.0 - values[f"{word}_speed"]) for word in ("lowest", "highest"))
    assert values["external_torque_max"] == pytest.approx(slow, rel=1e-7)
    assert values["external_torque_min"] == pytest.approx(fast, rel=1e-7)
    force = np.abs(result.data["applied_force"].values)
    assert force.max() <= values["applied_force"] <= 1.01 * force.max()
    words = {row[0]: row[1] for row in peak_rows(result.measures())}
    assert float(words["torque of loads and drive, max [N m]"]) == pytest.approx(slow, rel=1e-5)
    assert float(words["|applied force| [N]"]) == pytest.approx(values["applied_force"], rel=1e-5)


def test_a_load_that_never_changes_has_no_peak():
    braked = load_scene("propeller").with_(torque=(Constant(torque=-20.0),))
    names = [quantity.name for quantity in quantities_of(braked)]
    assert not [name for name in names if "drive" in name]
    starter = Constant(torque=30.0, until="0.2 s")
    names = [each.name for each in quantities_of(braked.with_(torque=(starter,)))]
    assert "torque of loads and drive, max" in names


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
