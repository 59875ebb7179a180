"""The moving picture: its frames in time, what moves in it, its files, and what it refuses."""

import dataclasses
import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import crankmbs.figures.frames
from crankmbs import Cylinder, Layout, Motion, Oscillation, Ramp, Run, load_scene, simulate
from crankmbs.cli import app
from crankmbs.errors import InputError, OutputError
from crankmbs.figures.animation import Filming, check_format, save_animation
from crankmbs.figures.frames import frames_of
from crankmbs.figures.mechanism import Drawing, slices
from crankmbs.figures.outline import mechanism
from crankmbs.figures.style import panels

pytestmark = pytest.mark.slow

SWINGING = dataclasses.replace(
    load_scene("compressor"),
    motion=Motion(speed=Oscillation(mean=150.0, amplitude=60.0, order=1.0)),
    run=Run(until="2 cycles"),
)
# omega = m + a cos(theta) turns once in 2 pi / sqrt(m^2 - a^2)
PERIOD = 2.0 * math.pi / math.sqrt(150.0**2 - 60.0**2)


def swinging_angle(time):
    """Crank angle of SWINGING a time after it passed 0, in closed form."""
    half = math.tan(0.5 * math.sqrt(150.0**2 - 60.0**2) * time)
    return 2.0 * math.atan(math.sqrt((150.0 + 60.0) / (150.0 - 60.0)) * half)


@pytest.fixture(scope="module")
def swinging():
    return simulate(SWINGING)


@pytest.fixture
def short(monkeypatch):
    """Films of a quarter of a second, so that a test is quick."""
    monkeypatch.setattr(crankmbs.figures.frames, "_LASTS", 0.25)


def test_frames_are_even_in_time_and_lie_on_the_motion(swinging):
    frames = frames_of(swinging, 20.0)
    count = len(frames.time)
    assert np.diff(frames.time) == pytest.approx(PERIOD / count)
    assert frames.time[-1] + PERIOD / count == pytest.approx(PERIOD)
    assert frames.mean == pytest.approx(2.0 * math.pi / PERIOD)
    for k in range(1, count // 2):  # up to half a turn, where the tangent jumps
        turned = frames.angle[k] - frames.angle[0]
        assert turned == pytest.approx(swinging_angle(frames.time[k]), abs=1e-7)
        assert frames.speed[k] == pytest.approx(150.0 + 60.0 * math.cos(turned), rel=1e-5)


def test_the_slow_motion_is_what_makes_a_cycle_last_its_time(swinging):
    frames = frames_of(swinging, 20.0)
    seconds = len(frames.time) / 20.0
    assert seconds == pytest.approx(PERIOD * frames.slower, abs=0.05)
    assert seconds == pytest.approx(6.0, rel=0.1)
    assert frames.pace == "130 times slower than the machine"  # 6 s for 46 ms


def test_a_slow_machine_is_filmed_faster():
    run, motion = Run(until="1 rev", every="5 deg"), Motion(speed="1 rpm")
    slow = dataclasses.replace(SWINGING, motion=motion, run=run)
    assert frames_of(simulate(slow), 20.0).pace == "10 times faster than the machine"


def test_gif_has_its_frames_and_they_move(tmp_path, swinging, short):
    file = save_animation(swinging, tmp_path / "new" / "swing.gif")
    count = len(frames_of(swinging, 20.0).time)
    with Image.open(file) as film:
        assert film.size == (800, 450)
        assert film.n_frames == count
        assert film.info["duration"] == 50
        shown = []
        for k in range(count):
            film.seek(k)
            shown.append(np.asarray(film.convert("L"), dtype=float))
    assert all(np.abs(a - b).max() > 100.0 for a, b in zip(shown[1:], shown[:-1], strict=True))
    assert [path.name for path in file.parent.iterdir()] == ["swing.gif"]


def test_drawing_puts_the_pins_where_the_mechanism_has_them():
    scene = load_scene("v_twin")
    angle = np.radians([0.0, 100.0, 290.0])
    parts = mechanism(scene, angle)
    _, (ax,) = panels(1, 1, 5.0, 5.0)
    drawing = Drawing(ax, parts, [0, 1])
    for k, theta in enumerate(angle):
        drawing.move(k)
        rods = [line.get_xydata() for line in ax.lines if line.get_marker() == "o"][:2]
        for rod, bank in zip(rods, (-30.0, 30.0), strict=True):
            pin = math.degrees(theta) - 30.0  # the throw both rods share, from the engine's X
            crank_pin = 36.0 * np.array([-math.sin(math.radians(pin)), math.cos(math.radians(pin))])
            assert rod[0] == pytest.approx(crank_pin)
            assert math.hypot(*(rod[1] - rod[0])) == pytest.approx(125.0)
            along = math.degrees(math.atan2(-rod[1][0], rod[1][1]))
            assert along == pytest.approx(bank)  # Y is to the left


@pytest.mark.parametrize(
    ("name", "cuts"),
    [("yi_diesel", [[0]]), ("v_twin", [[0, 1]]), ("yi_diesel_free", [[0], [1], [2], [3]])],
)
def test_one_cut_shows_one_cylinder_of_each_bank(name, cuts):
    assert slices(load_scene(name)) == cuts


def test_cuts_of_banks_of_different_length():
    banks = (0.5, -0.5, 0.5)
    layout = Layout(cylinders=tuple(Cylinder(bank=bank) for bank in banks))
    assert slices(dataclasses.replace(SWINGING, layout=layout)) == [[0, 1], [2]]


def test_every_cylinder_of_an_engine_in_line_is_drawn(tmp_path, short):
    scene = dataclasses.replace(SWINGING, layout=Layout(firing_order=(1, 3, 2)))
    file = save_animation(simulate(scene), tmp_path / "three.gif")
    with Image.open(file) as film:
        pixels = np.asarray(film.convert("RGB"), dtype=int)
    for colour in ((0, 114, 178), (213, 94, 0), (0, 158, 115)):  # of their rods
        near = np.abs(pixels[:250] - colour).sum(axis=-1) < 40
        assert near.sum() > 50


@pytest.mark.parametrize(
    ("speed", "until"), [(Ramp(start=80.0, to=-300.0, over=0.2), "0.2 s"), (0.0, "0.1 s")]
)
def test_a_reversal_and_a_machine_at_rest_are_filmed_too(tmp_path, short, speed, until):
    run = Run(until=until, every="5 ms")
    scene = dataclasses.replace(SWINGING, motion=Motion(speed=speed), run=run)
    file = save_animation(simulate(scene), tmp_path / "unusual.gif")
    with Image.open(file) as film:
        assert film.n_frames == 5


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not on this machine")
def test_mp4_is_a_film_of_slide_size(tmp_path, swinging, short):
    file = save_animation(swinging, tmp_path / "swing.mp4")
    about = subprocess.run(
        ["ffmpeg", "-i", str(file), "-f", "null", "-"], capture_output=True, text=True, check=True
    ).stderr
    assert "1280x720" in about
    assert "25 fps" in about
    assert f"frame= {len(frames_of(swinging, 25.0).time):4d}".replace(" ", "") in about.replace(
        " ", ""
    )


def test_without_ffmpeg_an_mp4_is_refused_and_a_gif_offered(monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InputError, match=r"film\.mp4: .* ffmpeg, which is not on .* film\.gif"):
        check_format(Path("film.mp4"))


@pytest.mark.parametrize("name", ["film.avi", "film"])
def test_other_endings_are_refused(name):
    with pytest.raises(InputError, match=r"must end with \.gif or \.mp4"):
        check_format(Path(name))


def test_a_film_that_fails_leaves_the_old_file_alone(tmp_path, swinging, short, monkeypatch):
    broken = tmp_path / "bin" / "ffmpeg"
    broken.parent.mkdir()
    broken.write_text("#!/bin/sh\nexit 1\n")
    broken.chmod(0o755)
    monkeypatch.setenv("PATH", str(broken.parent))
    old = tmp_path / "film" / "swing.mp4"
    old.parent.mkdir()
    old.write_text("old")
    with pytest.raises(OutputError, match=r"ffmpeg failed .*; write a \.gif"):
        save_animation(swinging, old)
    assert old.read_text() == "old"
    assert [path.name for path in old.parent.iterdir()] == ["swing.mp4"]


def test_command_writes_the_film_of_its_scene_and_says_so(tmp_path, monkeypatch, short):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["animate", "yi_diesel"])
    assert result.exit_code == 0, result.output
    assert "wrote yi_diesel.gif, 0." in result.stdout
    assert Path("yi_diesel.gif").stat().st_size > 1000


def test_command_refuses_a_wrong_ending_before_it_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["animate", "yi_diesel", "-o", "here/film.mov"])
    assert result.exit_code == 2
    assert ".mov came" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_film_of_another_length_width_and_one_cylinder(tmp_path):
    scene = dataclasses.replace(SWINGING, layout=Layout(firing_order=(1, 3, 2)))
    filming = Filming(length=1.5, width=640, cylinder=2)
    file = save_animation(simulate(scene), tmp_path / "two.gif", filming)
    with Image.open(file) as film:
        assert film.size == (640, 360)
        assert film.n_frames / 20.0 == pytest.approx(1.5, rel=0.1)
        pixels = np.asarray(film.convert("RGB"), dtype=int)
    near = {
        name: (np.abs(pixels - colour).sum(axis=-1) < 40)[:, :240].sum()
        for name, colour in {"1": (0, 114, 178), "2": (213, 94, 0), "3": (0, 158, 115)}.items()
    }
    assert near["2"] > 50 > near["1"] + near["3"]


@pytest.mark.parametrize(
    ("option", "value", "rule"),
    [
        ("--length", "0.1", "length must be from 0.5 to 120 s; 0.1 came"),
        ("--width", "1000", "width must be a multiple of 32 from 320 to 3840; 1000 came"),
        ("--cylinder", "5", "cylinder: the scene has 1 cylinder; 5 came"),
        (
            "--forces",
            "pistn",
            'forces: must be those on the piston, rod or crank; "pistn" came; did',
        ),
    ],
)
def test_command_refuses_a_film_that_cannot_be(tmp_path, monkeypatch, option, value, rule):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["animate", "yi_diesel", option, value])
    assert result.exit_code == 2
    assert rule in " ".join(result.stderr.split())
    assert list(tmp_path.iterdir()) == []
