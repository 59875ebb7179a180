"""What is marked of a run: where a cylinder fires, not where its share is decided half a turn
before."""

import math
from dataclasses import replace

import numpy as np
import pytest
from command_line import crankmbs_
from test_fuel import fuelled

from crankmbs import Fuel, Motion, Result, load_scene, simulate
from crankmbs.cli.report import report
from crankmbs.motion.firings import firings
from crankmbs.result.event_words import did_not_fire, marks
from crankmbs.scene.write import scene_files

ANGLE, SPEED = 0.3, 100.0  # rad, rad/s


def driven(fuel, speed=SPEED):
    motion = Motion(speed=speed, angle=ANGLE)
    return fuelled(fuel, cycles=3.0, start=None, torque=(), motion=motion)


@pytest.fixture(scope="module")
def weak():
    """A load that comes too early, just after the first share is decided."""
    load = {"torque__3__after": "0.07 s", "torque__3__torque": "-200 N m"}
    return load_scene("run_up").with_(run__until="0.2 s", **load)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_dead_centres_are_passed_at_their_angles_and_the_times_of_a_constant_speed(sense):
    """Each cylinder's cycle angle of 360 degrees, once in every cycle."""
    scene = driven(Fuel(scatter=0.1), sense * SPEED)
    found = firings(simulate(scene).passes.answer)
    begin, period = scene.motion.angle, scene.period
    passed = np.sort(
        [
            sense * (2.0 * math.pi - cylinder.phase - begin) % period + n * period
            for cylinder in scene.cylinders
            for n in range(3)
        ]
    )
    np.testing.assert_allclose(found.time, passed / SPEED, rtol=1e-9)
    np.testing.assert_allclose(found.crank_angle, begin + sense * passed, rtol=1e-12)
    np.testing.assert_allclose(found.crank_speed, sense * SPEED, rtol=1e-12)


def test_the_first_and_the_last_firing_are_half_a_turn_after_their_decisions():
    result = simulate(driven(Fuel(after=0.03, until=0.2)))
    table = result.event_table
    angle, share = table.values("crank_angle"), table.values("share")
    decided = angle[(share > 0.0) & (angle > ANGLE)]
    first, last = marks(result)
    assert (first.words, last.words) == ("first firing", "last firing")
    assert first.crank_angle == pytest.approx(decided[0] + math.pi, abs=1e-9)
    assert last.crank_angle == pytest.approx(decided[-1] + math.pi, abs=1e-9)
    assert first.time == pytest.approx((first.crank_angle - ANGLE) / SPEED, rel=1e-9)


def test_a_crank_that_turns_back_before_the_dead_centre_has_not_fired(weak, tmp_path, monkeypatch):
    result = simulate(weak)
    table = result.event_table
    assert np.any(table.values("share") > 0.0)
    assert "reversal" in table.values("kind").tolist()
    assert not {"first firing", "last firing"} & {mark.words for mark in marks(result)}
    assert did_not_fire(result)
    monkeypatch.chdir(tmp_path)
    for name, text in scene_files(weak, "weak").items():
        (tmp_path / name).write_text(text)
    said = crankmbs_("run", "weak.toml", "--no-figures").stdout
    assert "first firing" not in said
    assert "the engine did not fire: the crank reached no firing dead centre with fuel" in said


@pytest.mark.slow
def test_what_is_said_of_the_whole_run_is_not_read_from_its_end(tmp_path):
    """With every = "none" the last cycle alone is kept; a first firing before it is not known."""
    scene = load_scene("run_up").with_(run__until="0.6 s")
    whole, end = simulate(scene), simulate(replace(scene, run=replace(scene.run, every=None)))
    assert [mark.words for mark in marks(whole)][1:] == ["starter off", "first firing"]
    assert [mark.words for mark in marks(end)][1:] == ["starter off"]
    assert not did_not_fire(end)
    assert marks(Result.load(whole.save(tmp_path))) == marks(whole)


@pytest.mark.parametrize(
    ("share", "words"), [(1e-18, "rounding"), (3.2e-10, "3.2e-10 of the peak")]
)
def test_an_energy_that_closes_below_rounding_is_said_to_close_to_it(share, words):
    result = simulate(load_scene("coasting").with_(run__until="1 rev"))
    found = replace(result.measures(), energy_closure=share)
    assert f"energy       closes to {words}" in report("coasting", result, found)
