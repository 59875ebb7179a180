"""The figure of a whole run over time: what varies strongly, and what is marked in it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import Constant, InputError, Run, load_scene, simulate
from crankmbs.figures import plot, save_figures
from crankmbs.figures.cycles import varies_strongly
from crankmbs.measures.peaks import run_peaks
from crankmbs.result.event_words import marks

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def start():
    scene = load_scene("run_up")
    fuel = replace(scene.fuel, until=0.5)
    return simulate(replace(scene, fuel=fuel, run=Run(until="0.8 s", every="2 deg")))


@pytest.fixture(scope="module")
def stop():
    return simulate(load_scene("run_down"))


def words(ax):
    return [text.get_text() for text in ax.texts]


def test_a_start_is_marked_where_it_happens(start):
    speed, torque, _ = plot(start, "transient").axes
    assert words(speed) == ["starter on", "starter off", "first firing", "last firing"]
    at = {text.get_text(): text.xy[0] for text in speed.texts}
    first, last = at["first firing"], at["last firing"]
    passed = start.interp(time=[first, last]).crank_angle.values
    assert np.cos(2.0 * passed) == pytest.approx([1.0, 1.0], abs=1e-9)
    assert passed[0] == pytest.approx(2.0 * math.pi)
    assert 0.5 < last < 0.6
    gas, loads = torque.lines[:2]
    sampled = np.isin(gas.get_xdata(), start.sampled("time"))
    assert np.array_equal(gas.get_xdata()[sampled], start.sampled("time"))
    assert np.array_equal(gas.get_ydata()[sampled], start.sampled("crank_torque").sum(axis=1))
    assert np.array_equal(loads.get_ydata()[sampled], start.sampled("external_torque"))


def test_a_crank_that_turns_back_is_drawn_between_its_samples(stop):
    """Samples one degree apart lie up to 26 ms apart, and pass over the peak of the pressure."""
    reversal = stop.event_table.values("time")[-5]
    peak = float(stop.interp(time=[reversal]).gas_pressure.values[0].max()) * 1e-5
    over_time, _ = plot(stop, "pressure").axes
    drawn = [line.get_xydata() for line in over_time.lines]
    near = [xy[np.abs(xy[:, 0] - reversal) < 0.01, 1] for xy in drawn]
    assert max(values.max() for values in near) == pytest.approx(peak, rel=2e-3)
    for axes in (over_time, *plot(stop, "speed").axes, *plot(stop, "transient").axes):
        time = axes.lines[0].get_xdata()
        assert np.max(np.diff(time)) <= np.ptp(time) / 500.0 * (1.0 + 1e-9)
        assert set(stop.sampled("time")[-100:]) <= set(time)


def test_an_event_at_the_begin_of_the_first_cycle_is_in_it(start):
    speeds, _ = plot(start, "cycles").axes
    assert words(speeds) == ["starter on", "starter off", "first firing", "last firing"]
    assert speeds.texts[0].xy[0] == pytest.approx(0.5)
    assert speeds.get_xlim() == (0.5, start.cycle_table.length + 0.5)


def test_what_happens_after_many_reversals_is_marked():
    """The crank swings under its weight, and is then driven."""
    scene = load_scene("coasting")
    late = replace(
        scene,
        start=replace(scene.start, speed=1.0),
        torque=(Constant(torque=0.5, after=10.0),),
        run=Run(until="10.2 s", every="10 deg"),
    )
    result = simulate(late)
    assert np.count_nonzero(result.event_table.values("kind") == "reversal") > 8
    speed, *_ = plot(result, "transient").axes
    assert "constant on" in words(speed)
    assert len(speed.lines) == 2 + min(len(marks(result)), 24)  # the speed, its zero, the marks


def test_a_crank_that_turns_back_has_its_last_firing_and_its_rest_marked(stop):
    speed, *_ = plot(stop, "transient").axes
    assert {"last firing", "reversal, 6 times", "rest"} == set(words(speed))
    times = [line.get_xdata()[0] for line in speed.lines[2:]]
    assert times == [mark.time for mark in marks(stop)]


def test_the_largest_loads_of_the_whole_run_are_marked(start):
    *_, loads = plot(start, "transient").axes
    peaks = {peak.name: peak for peak in reversed(run_peaks(start))}
    largest = max(p.value.value for p in run_peaks(start) if p.name == "crank pin")
    dots = np.array([line.get_xydata()[0] for line in loads.lines if line.get_marker() == "o"])
    tops = np.array([peaks["main bearing"].value.value, largest]) / 1e3
    assert dots[:, 1] == pytest.approx(tops)
    assert dots[0, 0] == peaks["main bearing"].time
    bearing, _, pin, _ = loads.lines[:4]
    for line, top in zip((bearing, pin), dots[:, 1], strict=True):
        assert line.get_xdata()[0] == 0.0
        assert 0.9 * top < line.get_ydata().max() <= top * (1.0 + 1e-9)
    assert loads.texts[0].get_text().startswith("main bearing: ")


def test_loads_of_a_speed_that_drifts_are_drawn_over_the_whole_run(tmp_path):
    scene = load_scene("yi_diesel_free").with_(run__until="3 cycles", torque=())
    result = simulate(scene)
    assert not result.measures().steady
    assert not varies_strongly(result)
    assert "transient.png" in [file.name for file in save_figures(result, tmp_path)]


def test_cycles_are_steps_and_events_stand_in_the_cycle_that_holds_them(stop):
    speeds, pressures = plot(stop, "cycles").axes
    cycles = stop.cycle_table
    count = cycles.length
    imep = cycles.values("imep")[:, 0]
    number, drawn = pressures.lines[0].get_xydata().T
    assert np.array_equal(number[::2], np.arange(count) + 0.5)
    assert np.array_equal(number[1::2], np.arange(count) + 1.5)
    assert drawn == pytest.approx(np.repeat(imep * 1e-5, 2))
    (last,) = speeds.texts  # no cycle holds the reversals and the rest
    assert last.get_text() == "last firing"
    (time,) = (mark.time for mark in marks(stop) if mark.words == "last firing")
    begin, duration = cycles.values("time")[2], cycles.values("duration")[2]
    assert last.xy[0] == 2.5 + (time - begin) / duration
    assert speeds.lines[0].get_color() not in [line.get_color() for line in pressures.lines]


def test_it_is_drawn_where_the_speed_varies_strongly(start, tmp_path):
    steady = simulate(load_scene("coasting"))
    assert varies_strongly(start)
    assert not varies_strongly(steady)
    assert "transient.png" in [file.name for file in save_figures(start, tmp_path / "start")]
    assert "transient.png" not in [file.name for file in save_figures(steady, tmp_path / "steady")]


def test_misfires_are_no_fuel_cut():
    speed, *_ = plot(simulate(load_scene("misfire")), "transient").axes
    assert words(speed) == []


def test_two_loads_of_one_kind_have_their_numbers():
    scene = load_scene("coasting")
    loads = (Constant(torque=0.1, until=0.2), Constant(torque=-0.1, after=0.3))
    speed, *_ = plot(simulate(replace(scene, torque=loads)), "transient").axes
    assert words(speed) == ["constant 1 on", "constant 1 off", "constant 2 on"]


def test_the_indicator_diagram_encloses_the_work_of_the_gas():
    result = simulate(replace(load_scene("propeller"), run=Run(until="2 cycles")))
    _, diagram = plot(result, "pressure").axes
    volume, pressure = diagram.lines[0].get_xydata().T
    work = np.trapezoid(pressure, volume) * 0.1  # bar cm^3 in J
    assert work == pytest.approx(float(result.cycles["gas_work"].values[-1, 0]), rel=1e-3)


def test_cylinders_of_one_indicator_diagram_share_a_loop():
    result = simulate(load_scene("yi_diesel_free").with_(run__until="2 cycles"))
    over_angle, over_volume = plot(result, "pressure").axes
    names = [line.get_label() for line in over_angle.lines]
    assert names[:4] == [f"cylinder {k}" for k in range(1, 5)]
    (loop,) = over_volume.lines
    assert loop.get_label() == "cylinders 1, 2, 3, 4"
    assert [text.get_text() for text in over_volume.get_legend().texts] == [loop.get_label()]


def test_without_gas_there_is_no_indicator_diagram():
    with pytest.raises(InputError, match=r"this one has none"):
        plot(simulate(load_scene("coasting")), "pressure")
