"""A run that no memory or no double precision could hold is refused before it starts."""

import dataclasses
from pathlib import Path

import pytest
from command_line import SCENE, names, refused

from crankmbs import InputError, Run, load_scene


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (Run(until="1e300 cycles"), "run.until: beyond 1.6e"),
        (Run(until="1 rev", every="1e-9 deg"), "run.every: 3.6e\\+11 samples came"),
        (Run(until="1 s", every="1e-9 s"), "run.every: 1e\\+09 samples came"),
    ],
)
def test_an_impossible_size_is_no_scene(run, message):
    scene = load_scene("coasting")
    with pytest.raises(InputError, match=message):
        dataclasses.replace(scene, run=run)


@pytest.mark.parametrize("command", ["run", "check", "validate"])
def test_an_impossible_size_names_its_file_and_leaves_nothing(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("fine.toml").write_text(SCENE + 'every = "1e-9 deg"\n')
    assert refused(command, "fine.toml").startswith("fine.toml: run.every: 1.44e+12 samples came")
    assert names(".") == {"fine.toml"}


def test_an_impossible_size_names_its_options():
    message = refused("run", "coasting", "--every", "1e-9 deg", "--until", "1 rev")
    assert message.startswith("--until 1 rev --every 1e-9 deg: run.every: 3.6e+11 samples came")
