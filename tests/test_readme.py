"""What README prints runs as printed: its Python, its scene, its commands."""

import re
import runpy
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from crankmbs import compare, load_scene, simulate
from crankmbs.cli import app
from crankmbs.compare import WORDS
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


def test_the_formula_of_one_s_own_says_what_is_printed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(block("py"), encoding="utf-8")
    ((command, printed),) = re.findall(
        r"^`crankmbs (validate [^`]*)`:\n\n((?:> piston acc.*\n)(?:> .*\n)*)", README, re.MULTILINE
    )
    options = ["--formulation", "auto", "--no-figures"]
    outcome = CliRunner().invoke(app, [*shlex.split(command), *options])
    assert outcome.exit_code == 0, outcome.output
    said = outcome.stdout.splitlines()[0].replace(" by piston_acceleration_series of mine.py", "")
    assert said == " ".join(printed.replace("> ", "").split())


def test_the_perturbation_is_off_by_what_is_printed():
    own: dict[str, Any] = {}
    exec(block("py"), own)
    (shares,) = re.findall(r"it is off by ([\d., and]+) % of the fluctuation", README)
    (inertias,) = re.findall(r"the flywheel\ngoes from ([\d., overandto]+) kg m\^2", README)
    pairs = zip(re.findall(r"[\d.]+", shares), re.findall(r"[\d.]+", inertias), strict=True)
    for share, inertia in pairs:
        scene = load_scene("yi_diesel_free").with_(
            run__until="settled", crank__inertia=inertia + " kg m^2"
        )
        (row,) = compare(simulate(scene), {"mine": own["fluctuation_first_order"]}).numbers
        assert f"{row.percent:.2g}" == share


def test_every_word_of_a_formula_is_listed_with_its_unit():
    (listed,) = re.findall(r"- \*\*The words\*\*, in SI units: (.*?\[1\])\.", README, re.DOTALL)
    found = {
        name: unit
        for names, unit in re.findall(r"((?:`\w+`,?\s+)+)\[([^]]+)\]", listed)
        for name in re.findall(r"`(\w+)`", names)
    }
    assert found == {name: word.units for name, word in WORDS.items()}


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
