"""The command line: what it prints, what it writes, and its exit status."""

import dataclasses
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import RUNNING, SCENE, crankmbs_, names, refused

import crankmbs.figures.run
import crankmbs.result.record
from crankmbs import Result, simulate
from crankmbs.scene.shipped import models_folder

COMES_TO_REST = SCENE.replace('"3000 rpm"', '{ from = "900 rpm", to = "0 rpm", over = "0.1 s" }')
DRAWN = ["speed", "piston_motion", "gas_and_side_force", "main_bearing", "crank_pin", "piston_pin"]
FIGURES = {f"{name}.png" for name in [*DRAWN, "torque", "pressure"]}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Run in an empty folder with one scene in it."""
    monkeypatch.chdir(tmp_path)
    Path("engine.toml").write_text(SCENE)
    return tmp_path


@pytest.mark.slow
def test_run_writes_into_results_by_name_and_reports():
    result = crankmbs_("run", "engine.toml")
    assert result.exit_code == 0, result.output
    assert names("results/engine") == {"result.nc", "motion.csv", "cycles.csv"} | FIGURES
    for words in (
        "driven [red] engine",
        "kinetostatic",
        "the speed is prescribed",
        "over the last cycle",
        "mean speed [rpm]",
        "coefficient of fluctuation",
        "drift of the speed over the last cycle [rpm]",
        "mean piston speed [m/s]",
        "brake power [kW]",
        "indicated power [kW]",
        "mean load torque (drive, where positive) [N m]",
        "peak kinetic energy",
        "asked for",
        "evaluations",
        "wrote results/engine: result.nc, motion.csv",
    ):
        assert words in result.stdout
    assert result.stderr == ""
    assert result.stdout.isascii()


@pytest.mark.slow
def test_report_carries_the_numbers_of_the_result():
    out = crankmbs_("run", "engine.toml", "--no-figures").stdout
    data = Result.load("results/engine").data
    (row,) = re.findall(r"^\|side force\| \[N\] +(.*)$", out, re.MULTILINE)
    peak, error, crank_angle, cycle_angle, *_ = map(float, row.split())
    side = np.abs(data["side_force"].values[720:, 0])
    assert side.max() <= peak + error
    assert peak == pytest.approx(side.max(), rel=1e-4)
    assert crank_angle == cycle_angle == pytest.approx(np.argmax(side), abs=0.5)
    (speed,) = re.findall(r"^mean speed \[rpm\] +(\S+)", out, re.MULTILINE)
    assert float(speed) == 3000.0


@pytest.mark.parametrize("option", ["-o", "--out"])
def test_no_figures_draws_none_and_out_says_where(option):
    result = crankmbs_("run", "engine.toml", "--no-figures", option, "here/there")
    assert result.exit_code == 0
    assert names("here/there") == {"result.nc", "motion.csv", "cycles.csv"}
    assert not Path("results").exists()


@pytest.mark.slow
def test_figures_of_another_run_are_not_taken_for_those_of_this():
    crankmbs_("run", "engine.toml", "--out", "both")
    Path("both/notes.txt").write_text("mine")
    out = crankmbs_("run", "engine.toml", "--rtol", "1e-6", "--no-figures", "--out", "both").stdout
    listed = ", ".join(sorted(FIGURES))
    assert out.endswith(f"\nalso there, but not of this command: {listed}\n")
    assert "also there" not in crankmbs_("run", "engine.toml", "--out", "both").stdout


def test_options_override_the_scene():
    words = ["--until", "0.02 s", "--every", "1 ms", "--rtol", "1e-6", "--formulation", "auto"]
    assert crankmbs_("run", "engine.toml", "--no-figures", *words).exit_code == 0
    result = Result.load("results/engine")
    assert result.data["time"].values == pytest.approx(np.arange(21) * 1e-3)
    assert result.error.asked == 1e-6


def test_every_none_keeps_the_last_cycle_only():
    out = crankmbs_("run", "engine.toml", "--no-figures", "--every", "none").stdout
    assert "only the last cycle is kept" in out
    assert Result.load("results/engine").data.sizes["time"] == 721


@pytest.mark.slow
def test_a_run_cut_short_writes_its_results_and_exits_with_3():
    Path("stops.toml").write_text(COMES_TO_REST)
    result = crankmbs_("run", "stops.toml", "--no-figures")
    assert result.exit_code == 3
    assert "comes to rest" in result.stdout
    assert Result.load("results/stops").status == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--rtol", "1"], "--rtol: "),
        (["--rtol", "nan"], "--rtol: "),
        (["--until", "3 cyclos"], "--until: "),
        (["--until", "0 s"], "--until: "),
        (["--every", "-1 deg"], "--every: "),
        (
            ["--formulation", "minmal"],
            "no such formulation; choose auto, kinetostatic or multibody",
        ),
        (["--formulation", "minimal"], "cannot serve this scene"),
        (["--formulation", "multibody", "--confirm"], "--confirm"),
    ],
)
def test_bad_options_are_refused_by_name_before_anything_is_written(words, message):
    assert re.search(message, refused("run", "engine.toml", *words))
    assert not Path("results").exists()


def test_an_option_that_does_not_fit_the_scene_is_named():
    Path("speed.csv").write_text("time_s,speed_rpm\n0,800\n1,3000\n")
    Path("table.toml").write_text(SCENE.replace('"3000 rpm"', '{ file = "speed.csv" }'))
    assert refused("run", "table.toml", "--until", "2 s").startswith("--until 2 s: ")


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SCENE.replace("radius", "radus"), 'did you mean "radius"'),
        (SCENE.replace('"46 mm"', '"3200 kg"'), "crank.radius"),
        (SCENE.replace("[crank]", "[[["), "not valid TOML"),
    ],
)
def test_a_bad_scene_is_one_message_with_its_file(command, text, message):
    Path("bad[red].toml").write_text(text)
    found = refused(command, "bad[red].toml")
    assert found.startswith("bad[red].toml: ")
    assert message in found


@pytest.mark.parametrize("command", ["run", "check"])
def test_a_scene_that_is_not_there_is_refused_with_the_nearest_name(command):
    assert 'did you mean "propeller"' in refused(command, "propelle")


@pytest.mark.parametrize("words", [["run"], ["run", "engine.toml", "--fast"], ["fly"]])
def test_wrong_usage_exits_with_2(words):
    assert crankmbs_(*words).exit_code == 2


def test_a_folder_that_cannot_be_written_is_refused_before_the_run(monkeypatch):
    monkeypatch.setattr(RUNNING, "simulate", lambda *_, **__: pytest.fail("it ran"))
    Path("taken").write_text("")
    assert "cannot be written" in refused("run", "engine.toml", "--out", "taken/here")
    assert "cannot be written" in refused("run", "engine.toml", "--out", "taken")
    assert "cannot be written" in refused("run", "engine.toml", "--out", f"made/{'x' * 300}")
    assert names(".") == {"engine.toml", "taken"}


def test_a_run_that_is_refused_leaves_no_folder_but_those_that_were_there():
    Path("speed.csv").write_text("time_s,speed_rpm\n0,800\n0.01,3000\n")
    Path("table.toml").write_text(SCENE.replace('"3000 rpm"', '{ file = "speed.csv" }'))
    Path("there").mkdir()
    assert "the speed table ends at 0.01 s" in refused("run", "table.toml", "--out", "there/a/b")
    assert names(".") == {"engine.toml", "speed.csv", "table.toml", "there"}
    assert names("there") == set()


@pytest.mark.slow
@pytest.mark.parametrize("where", ["simulate", "write_saved", "write_csv", "torque_figure"])
def test_an_interrupt_exits_with_130_and_leaves_no_file_of_the_run(where, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    owner = RUNNING if where == "simulate" else crankmbs.result.record
    if where == "torque_figure":
        monkeypatch.setitem(crankmbs.figures.run._FIGURES, "torque", interrupt)
    else:
        monkeypatch.setattr(owner, where, interrupt)
    result = crankmbs_("run", "engine.toml")
    assert result.exit_code == 130
    assert result.stderr.strip() == "interrupted"
    assert names(".") == {"engine.toml"}


@pytest.mark.slow
def test_confirm_answers_in_a_sentence_and_draws_the_difference():
    result = crankmbs_("run", "engine.toml", "--confirm")
    assert result.exit_code == 0
    (agree, stated) = re.findall(
        r"^exudyn's rigid bodies agree to (\S+) of the peak in motion and every joint force over "
        r"the last cycle, with a stated error of (\S+)$",
        result.stdout,
        re.MULTILINE,
    )[0]
    assert float(agree) <= float(stated) < 1e-5
    assert re.search(r"^side force \[N\] +\S+ +\S+ +\S+ +\S+$", result.stdout, re.MULTILINE)
    assert "run with --formulation minimal to check them" in " ".join(result.stdout.split())
    assert (
        names("results/engine")
        == {"result.nc", "motion.csv", "cycles.csv", "difference.png"} | FIGURES
    )


def test_confirm_says_when_the_stated_errors_do_not_cover_the_difference(monkeypatch):
    def wrong(scene, **options):
        result = simulate(scene, **options)
        return dataclasses.replace(result, scene=scene.with_(piston__mass=1.01 * scene.piston.mass))

    monkeypatch.setattr(RUNNING, "simulate", wrong)
    result = crankmbs_("run", "engine.toml", "--confirm", "--no-figures")
    assert "exudyn's rigid bodies differ by" in result.stdout
    assert names("results/engine") == {"result.nc", "motion.csv", "cycles.csv"}


@pytest.mark.slow
def test_a_small_run_loads_neither_matplotlib_nor_exudyn():
    code = (
        "import sys; from crankmbs.cli import app;"
        "app(['run', 'engine.toml', '--no-figures'], standalone_mode=False);"
        "print(sorted({'matplotlib', 'exudyn', 'rich', 'numba'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.splitlines()[-1] == "[]"


def test_the_report_names_the_last_sample_and_a_crank_that_turns_backwards():
    text = (models_folder() / "coasting.toml").read_text()
    Path("back.toml").write_text(re.sub(r'(?m)^speed = ".*"', 'speed = "-100 rad/s"', text))
    stdout = crankmbs_("run", "back.toml", "--until", "1 rev", "--no-figures").stdout
    assert "-1 rev, backwards" in stdout
    assert re.search(r"^last sample +-?[\d.]+ deg, -[\d.]+ rpm$", stdout, re.MULTILINE)


def test_a_cost_cap_that_cannot_be_is_refused():
    message = refused("run", "coasting", "--cost-cap", "0")
    assert message == "cost_cap must be a time above 0 s; 0.0 came"


def test_demo_writes_its_page_beneath_the_working_folder_and_says_where():
    stdout = crankmbs_("demo", "coasting", "--no-browser").stdout
    (written,) = Path("results").glob("*.html")
    assert stdout == f"coasting: {written.absolute()}\n"
    assert written.read_text().startswith("<!DOCTYPE html>")


def test_page_writes_one_file():
    assert crankmbs_("page", "coasting", "-o", "mine.html").stdout.startswith("wrote mine.html")
    assert "<svg" in Path("mine.html").read_text()


def test_page_replays_a_run_that_it_cannot_compute_and_refuses_one_that_does_not_move():
    assert crankmbs_("page", "torque_driven").stdout.startswith("wrote torque_driven.html")
    assert "This page replays one run" in Path("torque_driven.html").read_text()
    text = (models_folder() / "torque_driven.toml").read_text()
    Path("still.toml").write_text(text.replace('"0.1 N m"', '"0 N m"'))
    assert refused("page", "still.toml") == (
        "the page cannot replay this run: at rest at 0 degrees: no torque moves the crank from here"
    )
    assert not Path("still.html").exists()
