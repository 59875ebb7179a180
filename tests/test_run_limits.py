"""A run that no memory or no double precision could hold is refused before it starts."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from command_line import SCENE, names, refused

from crankmbs import InputError, Layout, Run, load_scene, simulate


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


@pytest.fixture
def free(monkeypatch):
    """Make the machine have so many bytes free."""

    def only(count):
        memory = SimpleNamespace(available=count)
        monkeypatch.setattr(psutil, "virtual_memory", lambda: memory)
        monkeypatch.setattr("crankmbs.motion.memory._LITTLE", 0.0)

    return only


REVOLUTION = dataclasses.replace(load_scene("coasting"), run=Run(until="1 rev", rtol=1e-4))
OF_ONE = 10 * 8 * 365 * 29  # bytes: at most ten times what is stored, of 29 variables


def test_a_run_that_fits_into_memory_runs_and_a_longer_one_does_not(free):
    free(OF_ONE)
    assert simulate(REVOLUTION).status == 0
    longer = dataclasses.replace(REVOLUTION, run=Run(until="2 rev", rtol=1e-4))
    with pytest.raises(InputError) as caught:
        simulate(longer)
    assert str(caught.value) == (
        "run.every: 720 samples of 29 numbers each came, which take up to 0.00167 GB, and "
        '0.000847 GB are free; give a wider spacing, or every = "none" to keep the last cycle alone'
    )


def test_the_system_is_not_asked_for_a_megabyte(monkeypatch):
    monkeypatch.setattr(psutil, "virtual_memory", None)
    assert simulate(REVOLUTION).status == 0
    longer = dataclasses.replace(REVOLUTION, run=Run(until="40 rev", rtol=1e-4))
    with pytest.raises(TypeError):
        simulate(longer)


def test_every_cylinder_takes_its_memory(free):
    four = dataclasses.replace(REVOLUTION, layout=Layout(firing_order=(1, 3, 4, 2)))
    free(3 * OF_ONE)  # 80 numbers: 2.8 times as many
    assert simulate(four).status == 0
    free(2 * OF_ONE)
    with pytest.raises(InputError, match="360 samples of 80 numbers each came"):
        simulate(four)


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_samples_whose_number_is_not_known_before_are_counted(free, formulation):
    scene = dataclasses.replace(REVOLUTION, run=Run(until="0.5 s", rtol=1e-4))
    free(OF_ONE)
    with pytest.raises(InputError, match=r"run\.every: \S+ samples of 29 numbers each came"):
        simulate(scene, formulation=formulation)
    last = dataclasses.replace(scene, run=Run(until="0.5 s", every="none", rtol=1e-4))
    free(20 * OF_ONE)  # a piece of the motion is sampled whole
    assert simulate(last, formulation=formulation).status == 0


def test_too_little_memory_is_said_before_the_run_and_leaves_nothing(free, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    free(1)
    message = refused("run", "coasting", "--until", "1 rev")
    assert message.startswith("run.every: 360 samples of 29 numbers each came")
    assert names(".") == set()
