"""The speed that a wheel shows: where its crank angle begins, and what its stated error covers."""

import numpy as np
import pytest
from exports import FIRED
from records import SENSOR, Record, text_of, written

from crankmbs import read_pressure, read_speed

RPM = np.pi / 30.0


def of_teeth(tmp_path, record, digits=9):
    return written(tmp_path, "".join(f"{t:.{digits}f}\n" for t in record.edges))


@pytest.mark.parametrize("centre", [25.0, 385.0])
def test_the_firing_dead_centre_is_where_a_scene_has_it(tmp_path, centre):
    record = Record(engine=FIRED, dead_centre=centre, uneven=0.0, gap=(0.0, 0.0))
    given = f"{centre} deg"
    found = read_speed(of_teeth(tmp_path, record), "60-2", firing_tdc=given)
    exact = record.speed(np.degrees(found.table.x) - 360.0 + centre) / 6.0
    apart = np.abs(np.array(found.table.y) / RPM - exact)
    assert apart.max() <= found.error / RPM < 1.0  # the half orders swing by over 100 rpm
    assert "crank angle 360 is the firing dead centre" in str(found)
    assert f'firing_tdc="{(centre + 360.0) % 720.0:g} deg"' in str(found)


def test_both_commands_have_one_crank_angle(tmp_path):
    record = Record(engine=FIRED, dead_centre=700.0)
    path = written(tmp_path, text_of(dead_centre=700.0))
    given = f"{700.0 - record.errors[0]} deg"
    by_teeth = read_speed(path, "60-2", firing_tdc=given)
    whole = read_pressure(path, wheel="60-2", sensor=SENSOR, reference="absolute", firing_tdc=given)
    assert whole.speed.table.x == by_teeth.table.x
    np.testing.assert_allclose(whole.speed.table.y, by_teeth.table.y, rtol=1e-9)
    fastest = np.argmax(whole.speed.table.y), np.argmax(by_teeth.table.y)
    assert fastest[0] == fastest[1]


def test_a_two_stroke_cycle_begins_at_its_dead_centre(tmp_path):
    times = "".join(f"{t:.9f}\n" for t in fastest_at_the_first_edge())
    found = read_speed(written(tmp_path, times), "36-1", stroke=2, firing_tdc="120 deg")
    assert np.degrees(found.table.x[np.argmax(found.table.y)]) == pytest.approx(240.0, abs=3.0)
    assert "crank angle 0 is the firing dead centre, 120 degrees after" in str(found)


def fastest_at_the_first_edge():
    """Times of the teeth of a 36-1 wheel at 1000 rpm that swings by 2 % in the first order."""
    places = [10.0 * k for k in range(36 * 9) if k % 36 < 35]
    fine = np.arange(0.0, 3300.0, 0.01)
    slow = 1.0 / (6000.0 * (1.0 + 0.02 * np.cos(np.radians(fine))))
    passed = np.concatenate([[0.0], np.cumsum(0.005 * (slow[1:] + slow[:-1]))])
    return np.interp(places, fine, passed)


def pulses(drift=0.0, flank=0.0, pulses_of=360, step=1e-5, cycles=5):
    """Time [s], an encoder's pulses and its mark, at 900 rpm that swings and rises by a share a
    cycle; each pulse has flanks of some degrees."""
    fine = np.arange(-130.0, 720.0 * cycles, 0.02)
    speed = exact_of(fine) * 6.0 * (1.0 + drift * fine / 720.0)
    passed = np.concatenate([[0.0], np.cumsum(0.01 * (1.0 / speed[1:] + 1.0 / speed[:-1]))])
    time = np.arange(0.0, passed[-1], step)
    angle = np.interp(time, passed, fine)
    pitch = 360.0 / pulses_of
    within = np.mod(angle + 0.25 * pitch, pitch) - 0.5 * pitch  # the high half about 0
    edge = 0.25 * pitch - np.abs(within)
    high = edge >= 0.0 if not flank else np.clip(0.5 + edge / flank, 0.0, 1.0)
    return time, 5.0 * high, np.mod(angle + 0.4 * pitch, 360.0) < 0.8 * pitch


def exact_of(angle):
    """The steady speed [rpm] over the angle from the mark."""
    swing = 0.02 * np.cos(np.radians(0.5 * angle)) + 0.01 * np.cos(np.radians(2.0 * angle + 40.0))
    return 900.0 * (1.0 + swing)


def read_pulses(tmp_path, pulses_of=360, **options):
    time, signal, mark = pulses(pulses_of=pulses_of, **options)
    rows = (f"{t:.6f};{s:.4f};{m:.0f}" for t, s, m in zip(time, signal, mark, strict=True))
    path = written(tmp_path, "t [s];A [V];Z [V]\n" + "\n".join(rows))
    return read_speed(path, str(pulses_of), index="Z", columns="A", firing_tdc="360 deg")


def error_of(found):
    """Largest error of the speed, and the one that is stated [rpm]."""
    exact = exact_of(np.degrees(found.table.x))
    return np.max(np.abs(np.array(found.table.y) / RPM - exact)), found.error / RPM


@pytest.mark.parametrize("pulses_of", [180, 360, 720])
def test_the_samples_of_a_digital_signal_are_in_the_error(tmp_path, pulses_of):
    found = read_pulses(tmp_path, pulses_of)
    apart, stated = error_of(found)
    assert 0.2 < apart <= stated < 5.0
    assert "and of a clock in steps of 10 us" in str(found)


def test_a_signal_with_flanks_has_its_edges_between_samples(tmp_path):
    found = read_pulses(tmp_path, 60, flank=0.5)
    apart, stated = error_of(found)
    assert apart <= stated < 0.5
    assert "clock in steps" not in str(found)


def test_a_clock_that_times_of_teeth_were_read_from(tmp_path):
    record = Record(engine=FIRED, uneven=0.0, gap=(0.0, 0.0))
    found = read_speed(of_teeth(tmp_path, record, digits=5), "60-2", firing_tdc="385 deg")
    exact = record.speed(np.degrees(found.table.x) + 25.0) / 6.0
    assert np.abs(np.array(found.table.y) / RPM - exact).max() <= found.error / RPM
    assert "and of a clock in steps of 10 us" in str(found)


@pytest.mark.parametrize("drift", [0.004, 0.0125, 0.1])
def test_cycles_of_a_run_up_have_no_mean(tmp_path, drift):
    record = read_pulses(tmp_path, 360, drift=drift)
    (said,) = [each for each in record.sentences if each.startswith("warning:")]
    assert "differ by up to" in said
    assert "cut the record to cycles of one speed" in said
    mean = np.mean(record.table.y[:-1]) / np.mean(exact_of(np.degrees(record.table.x[:-1])))
    steady = mean * exact_of(np.degrees(record.table.x))
    assert np.abs(record.table.y - steady).max() <= record.error
    assert np.abs(record.table.y - steady).max() / RPM > 0.4 * drift * 900.0


def test_steady_cycles_are_not_warned_of(tmp_path):
    assert not any(each.startswith("warning:") for each in read_pulses(tmp_path).sentences)
