"""The commands that run nothing: check, scenes, new, and the version."""

from importlib import metadata
from pathlib import Path

import pytest
from command_line import SCENE, crankmbs_, names, refused

import crankmbs.cli.run
from crankmbs.scene_io import models_folder


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """An empty folder with one scene in it."""
    monkeypatch.chdir(tmp_path)
    Path("engine.toml").write_text(SCENE)


def test_check_explains_and_runs_nothing(monkeypatch):
    monkeypatch.setattr(crankmbs.cli.run, "simulate", lambda *_, **__: pytest.fail("it ran"))
    result = crankmbs_("check", "engine.toml")
    assert result.exit_code == 0
    assert "kinetostatic" in result.stdout
    assert "stroke 92 mm" in result.stdout
    assert "until 2 cycles, every 1 deg" in result.stdout
    assert names(".") == {"engine.toml"}


def test_scenes_lists_what_ships_and_every_one_can_be_checked():
    lines = crankmbs_("scenes").stdout.splitlines()
    shipped = sorted(path.stem for path in models_folder().glob("*.toml"))
    assert [line.split()[0] for line in lines] == shipped
    assert all(len(line.split()) > 1 for line in lines)
    for name in shipped:
        assert crankmbs_("check", name).exit_code == 0


def test_new_writes_a_scene_that_checks_and_overwrites_nothing():
    assert crankmbs_("new", "my.engine").exit_code == 0
    assert crankmbs_("check", "my.engine.toml").exit_code == 0
    assert "exists already" in refused("new", "my.engine.toml")
    assert "needs a name" in refused("new", "")


def test_check_says_where_throws_stand_and_when_cylinders_fire():
    stdout = crankmbs_("check", "v_twin").stdout
    assert "phase 300 deg, bank 30 deg, throw at 330 deg, fires at 60 deg" in stdout


def test_a_scene_named_without_its_suffix_is_pointed_to():
    assert refused("run", "engine") == 'engine: no such scene file; did you mean "engine.toml"?'


def test_version_is_that_of_the_package():
    assert crankmbs_("--version").output.strip() == metadata.version("crankmbs")
