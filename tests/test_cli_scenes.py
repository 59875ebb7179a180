"""The commands that run nothing: check, scenes, new, and the version."""

import re
from importlib import metadata
from pathlib import Path

import pytest
from command_line import RUNNING, SCENE, crankmbs_, names, refused

from crankmbs.scene.shipped import models_folder


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """An empty folder with one scene in it."""
    monkeypatch.chdir(tmp_path)
    Path("engine.toml").write_text(SCENE)


def test_check_explains_and_runs_nothing(monkeypatch):
    monkeypatch.setattr(RUNNING, "simulate", lambda *_, **__: pytest.fail("it ran"))
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


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        (
            "yi_diesel_free",
            [
                "crank        radius 46 mm, mass 0 kg, inertia 0.15 kg m^2 about its axis",
                "rod          length 153.333 mm, ratio 0.3, mass 1.60285 kg, centre of mass at "
                "38.3333 mm, inertia 0.00584222 kg m^2 about its centre of mass",
                "piston       mass 1.14158 kg, bore 85.2498 mm, area 57.079 cm^2, offset 1.2972 mm",
                "pressure     absolute, ambient 0.980665 bar subtracted; at most 63.6757 bar "
                "across the piston, at a cycle angle of 373.62 deg",
                "motion       free, from 3200 rpm at 0 deg, counter-clockwise (+theta)",
                "torque[1]    quadratic, -c omega |omega| with c = 0.0007775 N m s^2; -87.3087 N m "
                "at the start, brakes",
            ],
        ),
        (
            "compressor",
            [
                "crank        radius 25 mm, mass 2.2 kg, centre of mass at -5 mm, inertia 0.01 kg "
                "m^2 about its axis",
                "motion       prescribed, 1450 rpm on average over the angle, +-30 rpm, 1 times a "
                "turn, counter-clockwise (+theta), from 0 deg",
            ],
        ),
        (
            "propeller",
            [
                "pressure     gauge; at most 65.7287 bar across the piston, at a cycle angle of "
                "361.468 deg",
            ],
        ),
        ("torque_driven", ["torque[1]    constant, +0.1 N m"]),
    ],
)
def test_check_shows_what_the_machine_is_made_of_and_warns_of_nothing_shipped(name, lines):
    stdout = crankmbs_("check", name).stdout
    assert set(lines) <= set(stdout.splitlines())
    assert "warning" not in stdout


@pytest.mark.parametrize(
    ("crank", "said"),
    [
        ('radius = "46 mm"', "radius 46 mm, mass 0 kg, inertia 0 kg m^2 about its axis, left out"),
        (
            'radius = "46 mm"\nmass = "2 kg"\ncenter_of_mass = "-10 mm"',
            "radius 46 mm, mass 2 kg, centre of mass at -10 mm, "
            "inertia 0.0002 kg m^2 about its axis, left out",
        ),
    ],
)
def test_check_says_what_a_crank_without_inertia_counts_as(crank, said):
    text = re.sub(r"\[crank\][^\[]*", f"[crank]\n{crank}\n\n", SCENE)
    Path("engine.toml").write_text(text)
    assert f"crank        {said}\n" in crankmbs_("check", "engine.toml").stdout


@pytest.mark.parametrize(
    ("speed", "said"),
    [
        ('"-900 rpm"', "-900 rpm, clockwise (-theta), from 0 deg"),
        ('{ from = "800 rpm", to = "3e3 rpm", over = "2 s" }', "from 800 rpm to 3000 rpm in 2 s, "),
        (
            '{ file = "speed.csv" }',
            "800 rpm to 3000 rpm over time in 2 rows of speed.csv, pchip, from 0 deg",
        ),
        (
            '{ file = "cycle.csv", interpolation = "cubic" }',
            "800 rpm to 900 rpm over the crank angle in 3 rows of cycle.csv, cubic, again every "
            "360 deg, from 0 deg",
        ),
    ],
)
def test_check_shows_every_prescribed_speed(speed, said):
    Path("speed.csv").write_text("time_s,speed_rpm\n0,800\n1,3000\n")
    Path("cycle.csv").write_text("crank_angle_deg,speed_rpm\n0,800\n90,900\n360,800\n")
    Path("other.toml").write_text(SCENE.replace('"3000 rpm"', speed))
    assert f"motion       prescribed, {said}" in crankmbs_("check", "other.toml").stdout


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ('"constant"\ntorque = "-9 N m"', "constant, -9 N m; -9 N m at the start, brakes"),
        (
            '"viscous"\ncoefficient = "0.1 N m s"',
            "viscous, -c omega with c = 0.1 N m s; -31.4159 N m at the start, brakes",
        ),
        (
            '"speed_table"\nfile = "load.csv"',
            "speed table, -20 to +10 N m in 2 rows of load.csv; -20 N m at the start, brakes",
        ),
        (
            '"constant"\ntorque = "-9 N m"\nafter = "1 s"',
            "constant, -9 N m, after 1 s; none at the start",
        ),
    ],
)
def test_check_shows_every_load_with_its_sign(load, said):
    Path("load.csv").write_text("speed_rpm,torque_Nm\n0,10\n3000,-20\n")
    free = SCENE.replace("[motion]", '[start]\nangle = "0 deg"')
    Path("free.toml").write_text(f"{free}\n[[torque]]\nkind = {load}\n")
    assert f"torque[1]    {said}\n" in crankmbs_("check", "free.toml").stdout


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_number_no_machine_has_is_warned_of_and_accepted(command):
    Path("odd.toml").write_text(SCENE.replace('"85 mm"', '"850 mm"'))
    result = crankmbs_(command, "odd.toml", *(["--no-figures"] if command == "run" else []))
    assert result.exit_code == 0
    assert "\nwarning      piston.bore: a piston 850 mm wide" in result.stdout


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_closing_row_dropped_and_a_spline_that_overshoots_are_said(command):
    rows = "0,1\n180,1\n350,30\n350.001,31\n400,10\n540,2\n720,1.2\n"
    Path("gas.csv").write_text(f"crank_angle_deg,pressure_bar\n{rows}")
    text = re.sub('pressure = ".*"', 'pressure = "gas.csv"\ninterpolation = "cubic"', SCENE)
    Path("odd.toml").write_text(text)
    result = crankmbs_(command, "odd.toml", *(["--no-figures"] if command == "run" else []))
    assert result.exit_code == 0
    assert "gas.csv: the closing row, 0.2 bar from the first one, is dropped\n" in result.stdout
    assert "warning: gas.csv: between the rows at " in result.stdout


def test_a_scene_named_without_its_suffix_is_pointed_to():
    assert refused("run", "engine") == 'engine: no such scene file; did you mean "engine.toml"?'


def test_version_is_that_of_the_package():
    assert crankmbs_("--version").output.strip() == metadata.version("crankmbs")
