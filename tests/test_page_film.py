"""The film of a run that the page cannot compute anew: it shows what the run has, at every time."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_scenes import FILMS, POLYTROPE, fuelled
from test_page_script import fold

from crankmbs import InputError, load_scene, shipped_scenes, simulate
from crankmbs.page import page_of, refusals
from crankmbs.page.film import film_of
from crankmbs.page.refusals import early_end
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.loads import Constant as ConstantTorque
from crankmbs.scene.python_load import Load
from crankmbs.scene.run import Extent

pytestmark = pytest.mark.slow

RPM = math.pi / 30.0


@pytest.fixture(scope="module")
def films():
    return {name: film_of(load_scene(name)).given for name in FILMS}


@pytest.fixture(scope="module")
def runs():
    """Each run, with samples over all of it."""
    every = Extent(value=math.radians(2.0), unit="rad")
    scenes = {name: load_scene(name) for name in FILMS}
    return {
        name: simulate(replace(scene, run=replace(scene.run, every=every)))
        for name, scene in scenes.items()
    }


@pytest.fixture(scope="module")
def replayed(engine, films):
    """What the page has of a film at times [s], by its own script."""
    return lambda name, times: engine.ask("replayed", film=films[name], times=times)


def times_of(result, count=3000):
    """Random times of a run, and such as lie close to its events."""
    end = result.passes.answer.end
    events = result.event_table.values("time")
    near = np.concatenate([events + shift for shift in (-1e-4, -1e-6, 1e-6, 1e-4)])
    random = np.random.default_rng(3).uniform(0.0, end, count)
    return np.clip(np.concatenate([random, near, [0.0, end]]), 0.0, end)


@pytest.mark.parametrize("name", FILMS)
def test_every_digit_shown_is_the_runs_at_the_time_shown(films, runs, replayed, name):
    times, decimals = times_of(runs[name]), films[name]["decimals"]
    shown = replayed(name, times)
    at = np.array(shown["time"])
    np.testing.assert_array_equal(at, np.round(at, decimals["time"]))
    assert np.all((at <= times + 1e-12) & (times - at < 10.0 ** -decimals["time"]))
    true = runs[name].interp(time=at)
    for of, variable, unit in (
        ("speed", "crank_speed", RPM),
        ("angle", "crank_angle", math.radians(1.0)),
    ):
        assert decimals[of] >= 1
        found = np.array(shown[of]) / unit
        digit = 10.0 ** -decimals[of]
        assert np.abs(found - true[variable].values / unit).max() < 0.1 * digit


@pytest.mark.parametrize("name", ["run_up", "run_down"])
def test_pistons_fuel_and_the_colour_of_the_gas_are_the_runs(runs, replayed, name):
    times = np.sort(times_of(runs[name], 400))
    shown = replayed(name, times)
    true = runs[name].interp(time=np.array(shown["time"]))
    places = true["piston_position"].transpose("time", "cylinder").values
    np.testing.assert_allclose(shown["piston_position"], places, atol=1e-7)
    pressure = true["gas_pressure"].transpose("time", "cylinder").values
    np.testing.assert_allclose(
        shown["gas_pressure"], pressure, rtol=0.0, atol=0.05 * pressure.max()
    )
    table = runs[name].event_table
    decided = table.values("kind") == "fuel"
    last = np.searchsorted(table.values("time")[decided], shown["time"], side="right") - 1
    np.testing.assert_array_equal(shown["fuel"], table.values("share")[decided][last])


def test_marks_are_the_events_that_figures_name(films, runs):
    marks = [(each["words"], each["time"]) for each in films["run_up"]["marks"]]
    words = ["starter on", "starter off", "first firing", "driven machine on"]
    assert [name for name, _ in marks] == words
    table = runs["run_up"].event_table
    kinds, times = table.values("kind"), table.values("time")
    (off,) = times[kinds == "load off"]
    fired = marks[2][1]
    np.testing.assert_allclose([each for _, each in marks], [0.0, off, fired, 3.0], rtol=1e-9)
    passed = float(runs["run_up"].interp(time=[fired]).crank_angle.values[0])
    assert passed == pytest.approx(2.0 * math.pi, abs=1e-6)


def test_what_the_page_cannot_compute_is_a_film_and_nothing_else_is():
    free, driven = load_scene("yi_diesel_free"), load_scene("yi_diesel")
    free = replace(free, run=replace(free.run, until=Extent(value=1.0, unit="cycle")))
    burning = fuelled("yi_diesel_free", motored=POLYTROPE)
    speed = {"from": 100.0, "to": -50.0, "over": 0.01}
    filmed = {
        "multibody": replace(free, run=replace(free.run, formulation="multibody")),
        "function": replace(free, torque=(Load(lambda t, theta, omega: 0.0),)),
        "random firing": replace(burning, run=free.run, fuel=Fuel(scatter=0.1)),
        "settled fuel": replace(burning, run=replace(burning.run, until="settled")),
        "fold": fold(free),
        "rest": load_scene("torque_driven"),
        "reversal": replace(driven, motion=replace(driven.motion, speed=speed)),
        "end": load_scene("run_down"),
    }
    for reason, scene in filmed.items():
        (said,) = refusals(scene) or early_end(scene)
        assert said.startswith(f"{reason}: ")
        page = page_of(scene, "mine")
        assert 'id="time"' in page
        assert said.partition(": ")[2].partition("'")[0] in page
        assert len(page) < 1e6
    assert 'id="time"' not in page_of(free, "mine")
    shipped = {name: load_scene(name) for name in shipped_scenes()}
    assert {name for name, one in shipped.items() if refusals(one) or early_end(one)} == set(FILMS)


def test_each_film_asks_about_what_its_run_shows():
    free, driven = load_scene("yi_diesel_free"), load_scene("yi_diesel")
    run = replace(free.run, until=Extent(value=2.0, unit="cycle"))
    burning = replace(fuelled("yi_diesel_free", motored=POLYTROPE), run=run)
    speed = {"from": 100.0, "to": -50.0, "over": 0.01}
    down, up = load_scene("run_down"), load_scene("run_up")
    governor = replace(up.fuel.governor, ki=0.0)
    up = replace(up, run=replace(up.run, until=Extent(value=0.3, unit="s")))
    proportional = replace(up, fuel=replace(up.fuel, governor=governor))
    step = replace(free, run=run, torque=(ConstantTorque(torque=-20.0, after=0.01),))
    rings = replace(down.friction, ring_pressure=0.0)
    dry = replace(down, gas=None, fuel=None, friction=rings)
    asked = {
        "How does the governor catch the engine?": (up, "mean speed is and has been from 900 rpm"),
        "How does the governor catch the engine? ": (proportional, "mean speed is from 900 rpm"),
        "Why does the crank stop where it does?": (down, "until friction holds it"),
        "Why does the crank come to rest?": (dry, "friction take"),
        "Why does the speed not rise evenly": (load_scene("torque_driven"), "mid-stroke"),
        "Where does the crank turn back?": (
            replace(driven, motion=replace(driven.motion, speed=speed)),
            "retraces its stroke",
        ),
        "What does uneven firing do": (replace(burning, fuel=Fuel(scatter=0.1)), "the steps below"),
        "How does the fuel start and": (
            replace(burning, fuel=Fuel(until=0.03)),
            "each firing lifts",
        ),
        "How does the speed change": (step, "A dashed line"),
        "How does the speed change ": (fold(free), "where the pistons stand"),
    }
    for question, (scene, words) in asked.items():
        idea = film_of(scene).idea
        assert idea.question.startswith(question.strip())
        assert words in idea.sentence


def refused(scene):
    with pytest.raises(InputError) as caught:
        page_of(scene, "mine")
    return str(caught.value)


def test_what_does_not_move_or_ends_for_a_numerical_cause_is_refused(monkeypatch):
    scene = load_scene("torque_driven")
    assert refused(replace(scene, torque=())) == (
        "the page cannot replay this run: at rest at 0 degrees: no torque moves the crank from here"
    )
    lost = replace(simulate(scene), status=-1, message="stopped at 3 degrees")
    monkeypatch.setattr("crankmbs.page.film.simulate", lambda scene: lost)
    assert refused(scene) == "the page cannot replay this run: stopped at 3 degrees"


def test_a_run_of_more_turns_than_frames_can_follow_is_refused_with_the_way_out(monkeypatch):
    monkeypatch.setattr("crankmbs.page.film._MOST", 400)
    assert refused(load_scene("torque_driven")) == (
        "the page cannot replay this run: its 2.24852 turns take more than 400 frames; end it "
        "earlier by run.until, or see it with crankmbs run"
    )


def test_fewer_digits_are_shown_where_frames_or_the_run_are_less_exact(monkeypatch):
    scene = load_scene("torque_driven")
    monkeypatch.setattr("crankmbs.page.film._MOST", 420)
    assert film_of(scene).given["decimals"]["speed"] == 0
    monkeypatch.undo()
    coarse = simulate(scene)
    coarse.data["crank_speed"].attrs["error_estimate"] = 0.2 * RPM
    coarse.data["crank_angle"].attrs["error_estimate"] = math.inf
    monkeypatch.setattr("crankmbs.page.film.simulate", lambda scene: coarse)
    film = film_of(scene)
    assert film.given["decimals"] == {"time": 4, "speed": 0, "angle": 0}
    assert "error of the run: 0.2 rpm, inf" in film.error
