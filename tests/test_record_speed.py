"""The speed that a wheel shows: where its crank angle begins, and what its stated error covers."""

from functools import cache

import numpy as np
import pytest
from exports import FIRED
from records import SENSOR, Record

from crankmbs import read_pressure, read_speed

RPM = np.pi / 30.0


@cache
def text_of(**options):
    return Record(**{"engine": FIRED, **options}).text()


def written(tmp_path, text):
    path = tmp_path / "record.txt"
    path.write_text(text)
    return path


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
