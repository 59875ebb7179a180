"""What happens on the way of a run: the same in every formulation, and by closed forms."""

import csv
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from command_line import crankmbs_
from test_fuel import FOUR, FUELS, THIN_GAS, exact, fuelled
from test_windows import FREE, wheel

from crankmbs import (
    Constant,
    Extent,
    Fuel,
    InputError,
    Motion,
    OutputError,
    Piston,
    Ramp,
    Result,
    Rod,
    SpeedTable,
    Table,
    load_scene,
    simulate,
)
from crankmbs.choose import choose
from crankmbs.mechanics.train import crank_train
from crankmbs.motion import events as kept
from crankmbs.motion.account import Rows, beside
from crankmbs.motion.base import State
from crankmbs.report.machine import describe
from crankmbs.result.event_words import marks
from crankmbs.scene.parts import Friction
from crankmbs.scene.write import scene_files

HEAVY = {"piston": Piston(mass=2.0), "rod": Rod(length=0.14, mass=1.0)}


def kinds(events):
    return events["kind"].values.tolist()


def assert_same(ours, theirs):
    """The same events, within twice what both state."""
    for name in ("kind", "cylinder", "load", "text" if "fuel" not in kinds(ours) else "kind"):
        assert ours[name].values.tolist() == theirs[name].values.tolist()
    for name in ("time", "crank_angle", "crank_speed", "share"):
        apart = np.abs(ours[name].values - theirs[name].values)
        stated = ours[name].error_estimate + theirs[name].error_estimate
        assert np.max(apart, initial=0.0, where=np.isfinite(apart)) <= 2.0 * stated, name


STARTER = wheel(
    Constant(torque=10.0, until_speed=20.0),
    Constant(torque=-5.0, after=1.55, until=2.64),
    speed=2.0,
    until=3.0,
)


@pytest.mark.parametrize("formulation", FREE)
def test_loads_on_and_off_by_closed_form(formulation):
    """The bare wheel turns at 2 + 20 t, then at 20, then slower by 10 each second."""
    events = simulate(STARTER, formulation=formulation).events
    assert kinds(events) == ["load on", "load off", "load on", "load off"]
    assert events["load"].values.tolist() == [1, 1, 2, 2]
    np.testing.assert_allclose(events["time"], [0.0, 0.9, 1.55, 2.64], rtol=1e-12)
    speed = [2.0, 20.0, 20.0, 20.0 - 10.9]
    np.testing.assert_allclose(events["crank_speed"], speed, rtol=1e-10)
    turned = [0.0, 9.9, 22.9, 22.9 + 1.09 * (20.0 + 9.1) / 2.0]
    np.testing.assert_allclose(events["crank_angle"], 0.3 + np.array(turned), rtol=1e-10)
    assert events["text"].values[1] == "torque[1], constant, ends at 190.986 rpm"
    assert events["text"].values[2] == "torque[2], constant, sets in at 1.55 s"
    assert max(events[name].error_estimate for name in ("time", "crank_angle")) < 1e-9


def test_a_load_is_called_by_its_name(tmp_path):
    """In the file, a saved result, the events, what `check` prints and the figure's words."""
    scene = STARTER.with_(torque__1__name="starter", run__until="1 s")
    for name, text in scene_files(scene, "named").items():
        (tmp_path / name).write_text(text)
    written = load_scene(tmp_path / "named.toml")
    assert written.torque[0].name == "starter"
    assert "starter, constant, +10 N m" in describe("named", written, choose(written))
    result = simulate(written)
    for each in (result, Result.load(result.save(tmp_path))):
        assert each.events["text"].values[1] == "torque[1], starter, ends at 190.986 rpm"
        assert [mark.words for mark in marks(each)] == ["starter on", "starter off"]
    with pytest.raises(InputError, match="torque__1__name: must be a str"):
        STARTER.with_(torque__1__name=3)


@pytest.mark.parametrize("formulation", FREE)
def test_rest_start_and_reversal_by_closed_form(formulation):
    """At rest until 1.3 s; then 10 t; from 2.3 s on 10 less each second."""
    scene = wheel(Constant(torque=5.0, after=1.3), Constant(torque=-10.0, after=2.3), until=4.5)
    events = simulate(scene, formulation=formulation).events
    expected = ["rest", "load on", "start", "load on", "reversal"]
    assert kinds(events) == expected
    np.testing.assert_allclose(events["time"], [0.0, 1.3, 1.3, 2.3, 3.3], rtol=1e-10)
    np.testing.assert_allclose(events["crank_angle"], [0.3, 0.3, 0.3, 5.3, 10.3], rtol=1e-10)
    np.testing.assert_array_equal(events["crank_speed"].values[[0, 1, 2, 4]], 0.0)
    assert [str(text) for text in events["text"].values[[0, 2, 4]]] == [
        "stands at rest",
        "moves off forwards",
        "turns back, backwards from here",
    ]


def test_the_command_names_the_first_and_the_last_firing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, until, event in (
        ("run_up", "0.15 s", ["first firing", "0.131349", "360", "244.219"]),
        ("run_down", "0.3 s", ["last firing", "0.219431", "1620", "1413.55"]),
    ):
        said = crankmbs_("run", name, "--until", until, "--no-figures").stdout
        rows = [re.split(" {2,}", line.strip()) for line in said.splitlines()]
        headings = ["event", "time [s]", "crank angle [deg]", "crank speed [rpm]"]
        assert rows.index(headings) < rows.index(event)
        assert "decides q" not in said


@pytest.mark.slow
def test_the_command_says_where_the_rest_of_the_events_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = crankmbs_("run", "run_down", "--no-figures").stdout
    assert "             ... the others are in events.csv\n" in said
    rows = (tmp_path / "results" / "run_down" / "events.csv").read_text(encoding="utf-8")
    assert rows.count("turns back") == 6


def test_a_run_that_ends_at_rest_ends_with_it():
    brake = SpeedTable(file=Table((-9.0, 0.0, 0.0, 9.0), (4.0, 4.0, -4.0, -4.0)))
    result = simulate(wheel(brake, speed=8.0))
    assert result.status == 1
    assert kinds(result.events) == ["rest"]
    assert float(result.events["time"][0]) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("formulation", FREE)
def test_a_crank_that_rubs_to_rest_rests(formulation):
    """At a stop; and where it never leaves its start."""
    scene = load_scene("coasting").with_(friction=Friction(ring_force=300.0), run__until="20 s")
    stopped = simulate(scene, formulation=formulation)
    assert "holds the crank there" in stopped.message
    assert kinds(stopped.events) == ["rest"]
    assert float(stopped.events["time"][0]) == float(stopped.data["time"][-1])
    held = scene.with_(start__speed="0 rpm", start__angle="10 deg")
    assert kinds(simulate(held, formulation=formulation).events) == ["rest"]


def test_multibody_has_the_same_loads_and_reversals():
    scene = replace(STARTER, **HEAVY)
    back = replace(wheel(Constant(torque=-5.0), speed=8.0, until=2.0), **HEAVY)
    for one in (scene, back):
        ours, theirs = (simulate(one, formulation=f).events for f in ("crank_angle", "multibody"))
        assert_same(ours, theirs)
        assert theirs["time"].error_estimate < 1e-4
    assert kinds(theirs) == ["reversal"]


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["minimal", "multibody"])
@pytest.mark.parametrize("name", ["governor", "all at once"])
def test_the_formulations_decide_alike(name, formulation):
    scene = fuelled(FUELS[name], cycles=1.2)
    ours, theirs = (simulate(scene, formulation=f).events for f in ("crank_angle", formulation))
    assert_same(ours, theirs)
    assert ours["cylinder"].values.tolist() == [1, 2, 3, 4, 1, 3, 4, 2]
    assert theirs["share"].error_estimate < 1e-4


@pytest.mark.slow
def test_the_oracle_decides_alike():
    """Just beyond each decision the oracle has the share that the event says."""
    scene = fuelled(FUELS["all at once"], cycles=0.8, gas=THIN_GAS)
    events = simulate(scene).events
    later = events.isel(event=events["time"].values > 0.0)
    motion, shares = exact(scene, later["crank_angle"].values + 1e-6)
    decided = shares[np.arange(len(shares)), later["cylinder"].values - 1].astype(float)
    np.testing.assert_allclose(later["share"], decided, rtol=1e-10)
    times = motion.time.astype(float) - 1e-6 / later["crank_speed"].values
    np.testing.assert_allclose(later["time"], times, rtol=1e-10)


def test_a_prescribed_speed_decides_at_the_same_angles_as_a_free_crank():
    motion = Motion(speed=FOUR.start.speed, angle=FOUR.start.angle)
    changes = {"start": None, "torque": (), "motion": motion}
    scene = fuelled(FUELS["misfire"], cycles=2.2, **changes)
    free = simulate(fuelled(FUELS["misfire"], cycles=2.2)).events
    driven = simulate(scene).events
    for name in ("kind", "cylinder", "crank_angle", "share"):
        np.testing.assert_array_equal(driven[name], free[name])
    np.testing.assert_allclose(driven["time"], driven["crank_angle"] / FOUR.start.speed, rtol=1e-12)
    short = replace(scene, run=replace(scene.run, until=Extent(value=3.5, unit="rad")))
    assert_same(simulate(short).events, simulate(short, formulation="multibody").events)


def test_a_prescribed_speed_turns_back_and_comes_to_rest():
    scene = load_scene("coasting")
    ramp = Motion(speed=Ramp(start=4.0, to=-4.0, over=2.0), angle=0.0)
    run = replace(scene.run, until=Extent(value=2.0, unit="s"))
    scene = replace(scene, start=None, torque=(), motion=ramp, run=run)
    events = simulate(scene).events
    assert kinds(events) == ["reversal"]
    assert float(events["time"][0]) == pytest.approx(1.0)
    still = Motion(speed=Ramp(start=4.0, to=0.0, over=2.0), angle=0.0)
    result = simulate(
        replace(scene, motion=still, run=replace(run, until=Extent(value=50.0, unit="rad")))
    )
    assert result.status == 1
    assert kinds(result.events) == ["rest"]
    assert float(result.events["time"][0]) == pytest.approx(2.0)


def test_the_samples_do_not_matter():
    scene = fuelled(FUELS["all at once"], cycles=3.0)
    bare = replace(scene, run=replace(scene.run, every=None))
    ours, theirs = (simulate(one).events for one in (scene, bare))
    assert ours.identical(theirs)


def test_of_too_many_decisions_none_is_kept_and_it_is_said(monkeypatch):
    monkeypatch.setattr(kept, "MOST_EVENTS", 10)
    events = simulate(fuelled(Fuel(scatter=0.1), cycles=3.0)).events
    assert events.sizes["event"] == 0
    assert str(events.attrs["left_out"]).startswith("16 events are left out: ")


def test_existing_scenes_have_none():
    for name in ("propeller", "yi_diesel", "v_twin"):
        assert simulate(load_scene(name)).events.sizes["event"] == 0


@pytest.mark.slow
def test_saved_and_loaded_they_are_the_same(tmp_path):
    result = simulate(STARTER)
    result.save(tmp_path)
    again = Result.load(tmp_path)
    assert again.events.identical(result.events)
    assert again.data.identical(result.data)
    with (tmp_path / "events.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["kind"] for row in rows] == kinds(result.events)
    assert [float(row["time [s]"]) for row in rows] == pytest.approx([0.0, 0.9, 1.55, 2.64])
    again.save(tmp_path / "twice")
    assert Result.load(tmp_path / "twice").events.identical(result.events)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("column", "value"), [("event_kind", 9.0), ("event_number", 3.0), ("event_number", 1.5)]
)
def test_a_file_whose_events_cannot_be_is_refused(column, value, tmp_path):
    file = simulate(STARTER).save(tmp_path) / "result.nc"
    with h5py.File(file, "a") as raw:
        raw[column][0] = value
    with pytest.raises(OutputError, match="no readable result"):
        Result.load(file)


def test_without_an_account_it_is_said():
    result = replace(simulate(STARTER), keep=None)
    with pytest.raises(InputError, match="run the scene again"):
        _ = result.events


def test_the_error_is_the_largest_difference_and_unknown_of_one_alone():
    rows = [Rows({"x": np.array([1.0, math.nan])}, {}), Rows({"x": np.array([1.5, 2.0])}, {})]
    assert beside(rows, 2.0).errors["x"] == pytest.approx(1.0)
    assert beside(rows[:1], 1.0).errors["x"] == math.inf


def test_a_piece_too_short_to_turn_the_crank_does_not_hide_a_reversal():
    """Just before it turns back, a crank may slow down to nothing within a digit of its angle."""
    turning = [
        (State(0.0, -7.0, -1.0, 0.0), State(1.0, -7.2, -1e-8, 0.0)),
        (State(1.0, -7.2, -1e-8, 0.0), State(1.1, -7.2, 0.0, 0.0)),
        (State(1.1, -7.2, 0.0, 0.0), State(2.0, -7.1, 1.0, 0.0)),
    ]
    log = kept.Log(crank_train(load_scene("coasting")))
    for begin, end in turning:
        log.add(SimpleNamespace(begin=begin, end=end, decisions=()))
    (event,) = log.events
    assert (event.kind, event.number, event.time) == (kept.Kind.REVERSAL, 1, 1.1)
