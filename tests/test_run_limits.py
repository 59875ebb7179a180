"""A run that no memory or no double precision could hold is refused before it starts."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from command_line import SCENE, names, refused

from crankmbs import InputError, Layout, Motion, Run, Start, Table, load_scene, simulate
from crankmbs.scene.drives import Oscillation, Ramp, SpeedFile


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (Run(until="1e300 cycles"), "run.until: beyond 1.6e"),
        (Run(until="1e30 s"), "run.until: beyond 1e\\+09 s a time has too few digits left"),
        (Run(until="1e30 s", every="none"), "give a nearer end; 1e\\+30 s came"),
        (Run(until="1e8 s", every="none"), "give a nearer end; 1.59e\\+09 rev at its speed came"),
        (Run(until="1 rev", every="1e-9 deg"), "run.every: 3.6e\\+11 samples came"),
        (Run(until="1 s", every="1e-9 s"), "run.every: 1e\\+09 samples came"),
    ],
)
def test_an_impossible_size_is_no_scene(run, message):
    scene = load_scene("coasting")
    with pytest.raises(InputError, match=message):
        dataclasses.replace(scene, run=run)


@pytest.mark.parametrize(
    "speed",
    [
        250.0,
        -250.0,
        Oscillation(mean=250.0, amplitude=10.0, order=2.0),
        Ramp(start=0.0, to=250.0, over=1.0),
        SpeedFile(file=Table([0.0, 2.0, 4.0], [240.0, 250.0, 240.0]), kind="angle_table"),
    ],
)
def test_a_prescribed_speed_turns_too_far_in_too_long_a_time(speed):
    scene = dataclasses.replace(
        load_scene("coasting"), start=None, motion=Motion(speed=speed), run=Run(until="1 s")
    )
    assert dataclasses.replace(scene, run=Run(until="3e6 s", every="none")).end == (3e6, True)
    for until in ("1e7 s", "1e30 s"):
        with pytest.raises(InputError, match=r"run\.until: beyond .* give a nearer end; .* came"):
            dataclasses.replace(scene, run=Run(until=until, every="none"))


@pytest.mark.parametrize("every", ["none", "1 deg", "1e29 s"])
def test_a_crank_that_starts_at_rest_has_an_end_in_time_too(every):
    still = dataclasses.replace(load_scene("coasting"), start=Start(angle=0.3, speed=0.0))
    with pytest.raises(InputError, match=r"run\.until: beyond 1e\+09 s"):
        dataclasses.replace(still, run=Run(until="1e30 s", every=every))


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
        monkeypatch.setattr("crankmbs.motion.plan._LITTLE", 0.0)

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
