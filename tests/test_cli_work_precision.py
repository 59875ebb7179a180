"""The command ``work-precision``: what it prints and writes, and its exit status."""

import pytest
from PIL import Image
from typer.testing import CliRunner

from crankmbs.cli import app
from crankmbs.work_precision import END, MOTION, formulations, rounds
from validation.speed.__main__ import main as beside_others

pytestmark = pytest.mark.slow

REACTIONS = ("main bearing", "crank pin", "piston pin", "side force")

SCENE = """
[crank]
radius = "46 mm"
inertia = "0.02 kg m^2"

[rod]
length = "150 mm"

[piston]
mass = "1.1 kg"

[start]
angle = "0 deg"
speed = "{speed}"

[run]
until = "0.75 rev"
"""


def measured(*arguments):
    return CliRunner().invoke(app, ["work-precision", *map(str, arguments)])


@pytest.fixture
def one_round(monkeypatch):
    monkeypatch.setattr(rounds, "_ROUNDS", 1)
    monkeypatch.setattr(formulations, "_LADDER", (1e-3, 1e-5))


@pytest.mark.usefixtures("one_round")
def test_the_command_prints_tables_and_writes_a_file_and_a_figure(tmp_path):
    scene = tmp_path / "short.toml"
    scene.write_text(SCENE.format(speed="1000 rpm"))
    outcome = measured(scene, "--out", tmp_path / "out")
    assert outcome.exit_code == 0, outcome.output
    text = outcome.stdout.splitlines()
    for name in (
        "crank_angle",
        "crank_angle, end only",
        "minimal",
        "multibody",
    ):
        assert len([line for line in text if line.startswith(f"{name} ")]) >= 2
    (heading,) = (line for line in text if line.startswith("relative error "))
    for name in ("stated", END, MOTION, *REACTIONS, "time [ms]", "runs", "evaluations"):
        assert f"  {name}" in heading
    assert any(line.startswith("reference itself ") for line in text)
    (times,) = (line for line in text if line.startswith("time [ms] to an end within "))
    assert times.split()[-4:] == ["0.001", "1e-06", "1e-09", "1e-12"]
    assert any(line.startswith("Python 3.") and "numpy" in line for line in text)
    assert not any("peers" in line or "MuJoCo" in line for line in text)
    files = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert files == ["work_precision.csv", "work_precision.png"]
    with Image.open(tmp_path / "out" / "work_precision.png") as picture:
        assert picture.width == 2400


@pytest.mark.usefixtures("one_round")
def test_with_a_prescribed_speed_only_the_reactions_have_errors_to_compare(tmp_path, capsys):
    scene = tmp_path / "prescribed.toml"
    start = '[start]\nangle = "0 deg"'
    scene.write_text(SCENE.format(speed="1000 rpm").replace(start, "[motion]"))
    assert beside_others([str(scene), "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "no peers: a prescribed speed leaves the peers nothing to integrate" in out
    assert "  drive torque" in out
    assert "to an end within" not in out


@pytest.mark.usefixtures("one_round")
def test_a_scene_that_ends_early_is_compared_and_exits_with_3(tmp_path, capsys):
    scene = tmp_path / "resting.toml"
    scene.write_text(SCENE.format(speed="0 rpm"))
    assert beside_others([str(scene), "--out", str(tmp_path)]) == 3
    out = capsys.readouterr().out
    assert "no peers: the run does not reach its end (at rest at 0 degrees" in out
    assert "crank_angle " in out


def test_beside_others_a_scene_that_is_none_exits_with_2(capsys):
    assert beside_others(["no_such_scene"]) == 2
    assert capsys.readouterr().err.startswith("error: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no_such_scene"], "no_such_scene"),
        (["coasting", "--out", "/dev/null/here"], "cannot be written"),
    ],
)
def test_bad_input_is_refused_before_anything_runs(arguments, message):
    outcome = measured(*arguments)
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("error: ")
    assert message in outcome.stderr
