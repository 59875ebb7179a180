"""What README prints runs as printed: its Python, its scene, its commands."""

import re
import runpy
import shutil
from pathlib import Path

import pytest
from typer.main import get_command

from crankmbs import load_scene
from crankmbs.cli import app
from crankmbs.scene.read import models_folder

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language):
    """The code blocks in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def run_python(number, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "readme.py"
    script.write_text(blocks("python")[number], encoding="utf-8")
    return runpy.run_path(str(script))


def test_the_python_block_runs(tmp_path, monkeypatch, capsys):
    run_python(0, tmp_path, monkeypatch)
    assert "four-cylinder diesel engine" in capsys.readouterr().out
    assert (tmp_path / "results" / "from_python" / "result.nc").is_file()


def test_the_coupled_model_runs(tmp_path, monkeypatch, capsys):
    left = run_python(1, tmp_path, monkeypatch)
    assert left["state"].status == 0
    assert 0.0 < left["car"] < left["state"].crank_speed
    assert left["engine"].state.time == 0.0
    assert "bearing on crank, engine's X" in capsys.readouterr().out


def test_every_python_block_has_its_test():
    assert len(blocks("python")) == 2


def test_the_scene_is_one(tmp_path):
    shutil.copytree(models_folder() / "pressure", tmp_path / "pressure")
    shutil.copy(tmp_path / "pressure" / "yi_diesel.csv", tmp_path / "pressure" / "diesel.csv")
    scene = tmp_path / "scene.toml"
    scene.write_text(blocks("toml")[0], encoding="utf-8")
    assert len(load_scene(scene).cylinders) == 4


def test_the_table_has_every_command_and_no_other():
    shown = re.findall(r"^\| `crankmbs ([a-z-]+)", README, re.MULTILINE)
    commands = set(get_command(app).commands)
    assert {"lessons"} == commands - set(shown)  # in the row of lesson
    assert set(shown) <= commands
    assert "`crankmbs lessons`" in README


@pytest.mark.parametrize("option", sorted(set(re.findall(r"(?<![-|])(--[a-z][a-z-]*)", README))))
def test_an_option_that_is_named_is_there(option):
    theirs = {"--no-project", "--quick", "--long"}  # of uv, and of python -m validation
    group = get_command(app)
    ours = {name for command in group.commands.values() for p in command.params for name in p.opts}
    assert option in ours | theirs
