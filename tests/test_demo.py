"""What the page is given: columns from a run, answers, files to take away."""

import dataclasses
import io
import json
import socket
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from bokeh.document import Document
from bokeh.models import Div
from bokeh.server.util import match_host

from crankmbs import InputError, OutputError, Rod, budget, compare, load_scene, simulate
from crankmbs.compare import CAUSES
from crankmbs.demo import columns
from crankmbs.demo.answer import unpacked
from crankmbs.demo.export import data_file, scene_file
from crankmbs.demo.file import save_page
from crankmbs.demo.knobs import FIRING_ORDERS, turned
from crankmbs.demo.live import Live
from crankmbs.demo.outcome import prepared, run
from crankmbs.demo.state import state_of
from crankmbs.demo.views import STORES
from crankmbs.measures import fluctuation, last_span, measure

SINGLE, DIESEL = load_scene("propeller"), load_scene("yi_diesel_free")
RPM = np.pi / 30.0


@pytest.fixture(scope="module")
def diesel():
    return run(prepared(DIESEL))


def test_a_run_over_time_becomes_one_over_whole_cycles():
    assert prepared(SINGLE).run.until.unit == "cycle"
    assert prepared(SINGLE).run.until.value == 19.0
    assert prepared(DIESEL).run.until == DIESEL.run.until
    assert len(run(prepared(SINGLE)).result.data["time"]) == 721


def test_a_run_that_stops_is_an_error_with_its_sentence():
    scene = turned(prepared(SINGLE), {"flywheel": 8e-4})
    message = simulate(scene).message
    with pytest.raises(InputError) as caught:
        run(scene)
    assert str(caught.value) == message


def test_the_same_scene_is_not_run_again(diesel):
    scene = diesel.result.scene
    assert diesel.followed_by(scene, 1) is diesel
    third = diesel.followed_by(scene, 3)
    assert third.result is diesel.result
    assert third.cylinder == 3
    assert third.followed_by(turned(scene, {"cylinders": "2"}), 3).cylinder == 2


def test_columns_are_those_of_simulate_compare_and_budget(diesel):
    result = diesel.result
    shown = state_of(diesel, 1e3)
    measured = measure(result)
    assert shown["speed"]["speed, simulated"] == pytest.approx(
        result.data["crank_speed"].values / RPM, rel=1e-14
    )
    assert shown["speed"]["speed, constant"][0] * RPM == pytest.approx(measured.mean_speed.value)
    swing = fluctuation(result, last_span(result))  # the page's is that of the samples
    assert f"{100.0 * swing.value:.3f} %" in shown["numbers"]["text"][0]
    rows = compare(result)
    for quantity, store, scale in (
        ("piston displacement", "motion", 1e-3),
        ("torque", "thrust", 1.0),
        ("side thrust", "thrust", 1e3),
        ("crank pin force x", "bearing", 1e3),
    ):
        lecture = rows.row(quantity, rows.references[-1])
        at = f"{quantity}, "
        assert shown[store][f"{at}lecture"] * scale == pytest.approx(lecture.values)
        assert shown[store][f"{at}simulated"] * scale == pytest.approx(rows.simulated[quantity])
    split = budget(result).split("side thrust")
    causes = [shown["budget"][f"side thrust: {cause}"] for cause in CAUSES]
    assert sum(causes) * 1e3 == pytest.approx(split.total.curve)
    assert "two-mass rod is worth up to" in shown["words"]["side thrust"][0]


def test_a_quantity_that_vanishes_has_an_empty_budget():
    scene = load_scene("coasting")
    outcome = run(prepared(dataclasses.replace(scene, rod=Rod(length=0.15), gravity=None)))
    massless = dataclasses.replace(scene.piston, mass=0.0)
    outcome = outcome.followed_by(
        dataclasses.replace(outcome.result.scene, piston=massless), cylinder=1
    )
    shown = columns.budgets(outcome, 1.0)
    assert not np.any(shown["side thrust: lecture minus run"])
    assert not np.any(columns.thrusts(outcome, 1.0)["side thrust, simulated"])


def test_forces_on_the_mechanism_balance_the_piston():
    outcome = run(prepared(load_scene("v_twin"))).followed_by(prepared(load_scene("v_twin")), 2)
    frames = columns.frames(outcome, 1.0)
    data, scene = outcome.result.data, outcome.result.scene
    push = scene.piston.mass * data["piston_acceleration"].values[:, 1]  # towards the crank
    bank = scene.cylinders[1].bank
    for axis, along in (("x", np.cos(bank)), ("y", np.sin(bank))):
        forces = sum(frames[f"{name} {axis}"] for name in ("piston pin", "cylinder wall", "gas"))
        assert forces == pytest.approx(-push * along, abs=1e-6)


def test_every_column_has_a_unit(diesel):
    assert columns.unit_of("degrees", "kN") == "deg"
    assert columns.unit_of("speed, simulated", "kN") == "rpm"
    assert columns.unit_of("piston displacement: datum", "kN") == "mm"
    assert columns.unit_of("main bearing force x, lecture", "kN") == "kN"


def test_the_scene_is_packed_with_its_tables(diesel):
    name, content = scene_file(diesel.result.scene, "mine")
    with zipfile.ZipFile(io.BytesIO(content)) as packed:
        assert packed.namelist() == ["mine.toml", "mine_pressure.csv"]
    assert name == "mine.zip"
    assert scene_file(load_scene("coasting"), "free")[0] == "free.toml"
    name, content = data_file(diesel.result, "mine")
    assert name == "mine.csv"
    assert content.startswith(b"time [s],crank_angle [rad],crank_speed [rad/s]")


def ask(document, number, values, *, cylinder=1, tab=0):
    """Error and state that the page is answered."""
    request = document.get_model_by_name("request")
    asked = {"number": number, "values": values, "cylinder": cylinder, "tab": tab}
    request.data = {"json": [json.dumps(asked)]}
    answered, error, state = unpacked(document.get_model_by_name("answer").data)
    assert answered == number
    return error, state


def swing(state):
    return np.ptp(state["speed"]["speed, simulated"])


def test_the_live_page_answers_and_says_what_cannot_run():
    document, outcome = Document(), run(prepared(SINGLE))
    Live(outcome.result.scene, outcome, "mine").add_to(document)
    error, before = ask(document, 1, {})
    assert error == ""
    error, state = ask(document, 2, {"flywheel": 0.04})
    assert (error, swing(state)) == ("", pytest.approx(0.52 * swing(before), rel=0.1))
    good = swing(state)
    error, state = ask(document, 3, {"rod_ratio": 0.9, "offset": 23.0})
    assert error.startswith("error: rod.length must be at least")
    assert swing(state) == good  # the last good one
    error, state = ask(document, 4, {"flywheel": 8e-4}, tab=2)
    assert error.startswith("error: swings without reaching the end")
    assert set(state) & set(STORES) == {"thrust"}
    error, state = ask(document, 5, {"cylinders": "2"}, cylinder=2, tab=3)
    assert error == ""
    assert state["chosen"]["cylinder"] == [2]
    assert len(state["shapes"]["liner x"]) == 2
    assert "speed" not in state
    assert len(state["words"]["torque"]) == 1


def test_the_server_takes_no_other_host_for_its_own():
    """Of bokeh before 3.8.2 a longer name that begins like an allowed one was allowed."""
    assert match_host("localhost:5006", "localhost:5006")
    assert not match_host("localhost.evil.example:5006", "localhost:5006")


def test_a_title_of_the_page_is_no_formula(diesel):
    """bokeh would fetch what sets formulas, from elsewhere."""
    outcome = dataclasses.replace(
        diesel, result=dataclasses.replace(diesel.result, scene=titled(diesel.result.scene))
    )
    document = Document()
    Live(outcome.result.scene, outcome, "mine").add_to(document)
    (title,) = (div for div in document.select({"type": Div}) if div.text == "<b>$$</b>")
    assert title.disable_math


def titled(scene):
    return dataclasses.replace(scene, title="$$")


def test_two_visitors_have_a_page_each(diesel):
    documents = [Document(), Document()]
    for document in documents:
        Live(diesel.result.scene, diesel, "mine").add_to(document)
    _, first = ask(documents[0], 1, {"flywheel": 0.3})
    _, second = ask(documents[1], 1, {})
    assert swing(first) < 0.6 * swing(second)


@pytest.mark.parametrize(
    ("varied", "message"),
    [
        (["flywhel"], '--vary: this scene has rod_ratio, .*cylinders; "flywhel" came'),
        (["load", "load"], "--vary: one knob or two different ones; load, load came"),
        (["load", "rod", "offset"], "--vary: one knob or two different ones"),
    ],
)
def test_what_a_page_cannot_vary_is_refused(varied, message, tmp_path):
    with pytest.raises(InputError, match=message):
        save_page(SINGLE, "mine", varied, tmp_path / "page.html")


def test_a_page_holds_every_state_of_its_grid(tmp_path):
    scene = load_scene("compressor")
    target = tmp_path / "page.html"
    assert save_page(scene, "mine", ["rod", "cylinders"], target) == 2 * len(FIRING_ORDERS)
    assert target.stat().st_size > 1e6
    (tmp_path / "taken").write_text("")
    with pytest.raises(OutputError):
        save_page(scene, "mine", ["rod"], tmp_path / "taken" / "page.html")


def test_a_taken_port_is_refused():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        command = [sys.executable, "-c", "from crankmbs.cli import main; main()", "demo"]
        command += ["coasting", "--no-browser", "--port", port]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert f"error: --port {port}: cannot be used" in ended.stderr


def test_an_interrupt_ends_the_server_whatever_it_is_doing():
    """Also where an exception would be lost: while an object that nobody holds is taken away."""
    code = """
import os, signal
from crankmbs import load_scene
from crankmbs.demo.serve import serve

class Left:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)

def ready(address, server):
    server.io_loop.call_later(0.1, Left)

serve(load_scene("propeller"), "propeller", 0, ready)
print("ended")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr, done.returncode) == ("ended\n", "", 0)
