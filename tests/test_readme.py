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


def block(language):
    """The one code block in a language."""
    (code,) = re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)
    return code


def test_the_python_block_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "readme.py"
    script.write_text(block("python"), encoding="utf-8")
    runpy.run_path(str(script))
    assert "four-cylinder diesel engine" in capsys.readouterr().out
    assert (tmp_path / "results" / "from_python" / "result.nc").is_file()


def test_the_scene_is_one(tmp_path):
    shutil.copytree(models_folder() / "pressure", tmp_path / "pressure")
    shutil.copy(tmp_path / "pressure" / "yi_diesel.csv", tmp_path / "pressure" / "diesel.csv")
    scene = tmp_path / "scene.toml"
    scene.write_text(block("toml"), encoding="utf-8")
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
