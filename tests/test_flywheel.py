"""The flywheel for a fluctuation: met on the settled cycle, or the sentence why not."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from command_line import crankmbs_, refused
from scipy.optimize import brentq

from crankmbs import (
    AngleTable,
    Constant,
    Crank,
    Gravity,
    InputError,
    Motion,
    Oscillation,
    Piston,
    Quadratic,
    Ramp,
    Rod,
    Run,
    Start,
    Table,
    flywheel,
    load_scene,
    simulate,
)
from crankmbs.measures import measure
from crankmbs.scene.parts import Friction

DIESEL, ONE = load_scene("yi_diesel_free"), load_scene("yi_diesel")


@pytest.mark.parametrize("wanted", [0.002, 0.01, 0.08])
def test_the_settled_cycle_with_it_fluctuates_as_wanted(wanted):
    found = flywheel(DIESEL, wanted)
    assert found.status == 0
    crank = replace(DIESEL.crank, inertia=found.inertia.value)
    result = simulate(replace(DIESEL, crank=crank, run=Run(until="settled", every="0.25 deg")))
    speed = result.data.crank_speed.values
    mean = 4.0 * np.pi / float(result.data.time[-1])
    assert np.ptp(speed) / mean == pytest.approx(wanted, rel=1e-5)
    assert found.added == found.inertia.value - 0.15
    assert abs(found.lecture_error.value) < 0.01
    mean = found.mean_speed.value
    assert found.lecture.value == pytest.approx(found.work.value / (wanted * mean**2), rel=1e-12)
    whole = found.inertia.value + found.moving
    assert found.lecture.value == pytest.approx(whole, rel=0.01)
    crank = replace(DIESEL.crank, inertia=0.0)
    motion, run = Motion(speed=mean), Run(until="1 cycle")
    even = simulate(replace(DIESEL, crank=crank, start=None, motion=motion, run=run, torque=()))
    energy = even.data.kinetic_energy.values[:-1].mean()
    assert found.moving == pytest.approx(2.0 * energy / mean**2, rel=1e-9)


def test_its_error_is_honest():
    rough, fine = (flywheel(replace(DIESEL, run=Run(until="1 s", rtol=r))) for r in (1e-5, 1e-11))
    apart = abs(rough.inertia.value - fine.inertia.value)
    assert apart <= 2.0 * (rough.inertia.error + fine.inertia.error)


def test_its_error_counts_the_inertia_of_the_rods():
    """A crank that is lighter than what hangs on it, against a search by halves."""
    found = flywheel(DIESEL, 0.25)

    def off(inertia):
        crank, run = replace(DIESEL.crank, inertia=inertia), Run(until="settled", rtol=1e-12)
        return measure(simulate(replace(DIESEL, crank=crank, run=run))).fluctuation.value - 0.25

    value, error = found.inertia
    exact = brentq(off, 0.999 * value, 1.001 * value, xtol=1e-16, rtol=1e-14)
    assert abs(value - exact) <= 2.0 * error < 1e-5 * value


TURNS = AngleTable(file=Table(np.radians([0, 60, 60, 200, 300]), (-30.0, 80.0, 10.0, -60.0, -9.0)))


@pytest.mark.parametrize("balance", [(), (Constant(torque=3.0),)], ids=["alone", "and a constant"])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_turning_moment_alone_is_balanced(balance, sense):
    """A bare wheel: E = E_0 + int (T - mean), W its range, by the exact parabolas of the table."""
    bare = replace(
        DIESEL, gas=None, rod=Rod(length=0.2), piston=Piston(mass=0.0), torque=(TURNS, *balance)
    )
    scene = replace(bare, start=Start(angle=0.3, speed=sense * 40.0))
    found = flywheel(scene, 0.02)
    assert found.status == 0
    fine = np.linspace(0.0, 2.0 * np.pi, 360_001)
    rows = np.radians([0.0, 60.0, 200.0, 300.0, 360.0])
    torque = [(-30.0, 80.0), (10.0, -60.0), (-60.0, -9.0), (-9.0, -30.0)]
    gained, work = [], 0.0
    for (a, b), (low, high) in zip(torque, pairwise(rows), strict=True):
        x = fine[(fine >= low) & (fine < high)] - low
        gained.append(work + a * x + (b - a) / (high - low) * x**2 / 2.0)
        work += (a + b) / 2.0 * (high - low)
    beyond = np.concatenate(gained)
    beyond -= work * fine[: len(beyond)] / (2.0 * np.pi)
    mean, total, ends = work / (2.0 * np.pi), 0.0, [0.0]  # at the corners, and tops between
    for (a, b), width in zip(torque, np.diff(rows), strict=True):
        x = np.array([width * np.clip((mean - a) / (b - a), 0.0, 1.0), width])
        ends.extend(total + (a - mean + 0.5 * (b - a) * x / width) * x)
        total = ends[-1]
    assert abs(found.work.value - np.ptp(ends)) <= found.work.error < 1e-12 * np.ptp(ends)
    energy, inertia = beyond - beyond.min(), found.inertia.value

    def late(least):
        return np.mean(1.0 / np.sqrt(2.0 * (energy + least) / inertia)) - 1.0 / 40.0

    speeds = np.sqrt(2.0 * (energy + brentq(late, 1.0, 1e6)) / inertia)
    assert np.ptp(speeds) / 40.0 == pytest.approx(0.02, rel=1e-5)
    assert found.mean_speed.value == pytest.approx(sense * 40.0, rel=1e-9)


def test_a_turning_moment_is_in_the_lectures_work():
    found, alone = (
        flywheel(replace(DIESEL, torque=loads), 0.01)
        for loads in ((*DIESEL.torque, TURNS), DIESEL.torque)
    )
    assert found.status == 0
    assert abs(found.lecture_error.value) < 0.03
    assert abs(found.work.value / alone.work.value - 1.0) > 0.01


def test_the_weight_of_the_crank_is_in_the_lectures_work():
    """Of an even crank whose wheel is off centre: W is the range of m g s cos(theta), 2 m g s."""
    crank = Crank(radius=0.04, inertia=1.0, mass=9.0, center_of_mass=-0.02)
    scene = replace(
        load_scene("coasting"),
        crank=crank,
        rod=Rod(length=0.2),
        piston=Piston(mass=0.0),
        friction=None,
        torque=(),
        gravity=Gravity(acceleration=9.81, angle="180 deg"),
        start=Start(angle=0.3, speed=40.0),
    )
    found = flywheel(scene, 0.001)
    assert found.work.value == pytest.approx(2.0 * 9.0 * 9.81 * 0.02, rel=1e-4)
    assert abs(found.lecture_error.value) < 1e-4


def test_settled_under_a_turning_moment_is_the_run_of_many_cycles():
    scene = replace(DIESEL, torque=(*DIESEL.torque, TURNS))
    limit, late = (
        simulate(replace(scene, run=Run(until=until, every=every))).data["crank_speed"].values[-1]
        for until, every in (("settled", "10 deg"), ("600 cycles", "none"))
    )
    assert limit == pytest.approx(late, rel=1e-10)


RINGS = Friction(ring_force=60.0, ring_pressure=0.02)
EVEN = 3200.0 * np.pi / 30.0
SWINGS = Oscillation(mean="3200 rpm", amplitude=5.0, order=2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "mean"),
    [
        (ONE, EVEN),
        (replace(ONE, motion=Motion(speed=SWINGS)), np.sqrt(EVEN**2 - 5.0**2)),
        (replace(DIESEL, torque=(), start=Start(angle=1.0, speed="-3200 rpm")), EVEN),
        (replace(ONE, friction=RINGS), EVEN),
        (
            replace(DIESEL, torque=(), start=Start(angle=1.0, speed="-3200 rpm"), friction=RINGS),
            EVEN,
        ),
        (replace(ONE, friction=replace(RINGS, viscous=30.0)), EVEN),
    ],
    ids=["motion", "oscillation", "free", "rings", "rings backwards", "viscous"],
)
def test_without_a_load_the_mean_is_the_one_given(scene, mean):
    """Angle over time, also of a speed that swings over the angle."""
    found = flywheel(scene, 0.01)
    assert found.status == 0
    (balance,) = found.result.scene.torque
    assert balance.torque != 0.0
    assert abs(found.mean_speed.value) == pytest.approx(mean, rel=1e-9)
    gain = measure(found.result).speed_gain
    assert abs(gain.value) <= gain.error


def test_what_no_inertia_gives_is_said():
    light = flywheel(DIESEL, 1.5)
    assert light.status == 1
    assert "near the least that the crank can have" in light.message
    assert np.isnan(light.inertia.value)
    away = flywheel(replace(DIESEL, torque=(Quadratic(coefficient=0.0),)), 0.01)
    assert away.status == 1
    assert "speed grows without bound" in away.message


@pytest.mark.parametrize("wanted", [0.0, 2.0, -1.0, True, "1 %", float("nan")])
def test_a_fluctuation_that_cannot_be_is_refused(wanted):
    with pytest.raises(InputError, match="fluctuation must be a number above 0 and below 2"):
        flywheel(DIESEL, wanted)


def test_a_scene_that_cannot_be_is_refused():
    with pytest.raises(InputError, match="scene must be a Scene"):
        flywheel("yi_diesel_free", 0.01)
    ramp = Motion(speed=Ramp(start=0.0, to=9.0, over=1.0))
    with pytest.raises(InputError, match="leaves a free crank no mean speed to keep"):
        flywheel(replace(ONE, motion=ramp), 0.01)


def test_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shown = crankmbs_("flywheel", "yi_diesel_free", "--fluctuation", "1 %", "-o", "heavy.toml")
    assert shown.exit_code == 0, shown.output
    assert "over the last cycle" in shown.output
    (peak,) = re.findall(r"^crank pin \[N\] +(\S+) +\S+ +(\S+) ", shown.output, re.MULTILINE)
    assert [float(part) for part in peak] == pytest.approx([20289.4, 20516.4], abs=0.1)
    assert (tmp_path / "results" / "yi_diesel_free" / "flywheel.png").exists()
    heavy = (tmp_path / "heavy.toml").read_text(encoding="utf-8")
    assert 'inertia = "0.439724 kg m^2"    # the speed fluctuates by 1 %' in heavy
    written = simulate(load_scene("heavy.toml").with_(run__until="settled"))
    assert measure(written).fluctuation.value == pytest.approx(0.01, rel=1e-5)
    assert re.search(r"inertia of crank and flywheel \[kg m\^2\] +0\.439724", shown.output)
    present = r"the same with the scene's 0\.15 kg m\^2 \[1\] +0\.0273589"
    assert re.search(present, shown.output)
    assert re.search(r"the formula is off by \[%\] +0\.0879", shown.output)
    balanced = crankmbs_("flywheel", "yi_diesel", "--no-figures", "-o", "free.toml")
    free = (tmp_path / "free.toml").read_text(encoding="utf-8")
    for line in ('radius = "46 mm"', 'ambient = "1 kgf/cm^2"', 'torque = "-21.8274261 N m"'):
        assert line in free.splitlines()
    assert ("[motion]" in free, 'until = "1 cycle"' in free) == (False, True)
    run = simulate(load_scene("free.toml"))
    assert measure(run).fluctuation.value == pytest.approx(0.01, rel=1e-5)
    assert (
        "none in the scene; a constant -21.8274 N m, which balances gas, gravity and friction"
        in balanced.output
    )
    constant = '\n[[torque]]\nkind = "constant"\ntorque = "-30 N m"\n'
    (tmp_path / "braked.toml").write_text(free.split("[[torque]]")[0] + constant)
    braked = crankmbs_("flywheel", "braked.toml", "--no-figures").output
    assert "the scene's, with a constant 8.17257 N m, which balances gas, gravity" in braked
    far = crankmbs_("flywheel", "yi_diesel_free", "--fluctuation", "150 %")
    assert far.exit_code == 3
    assert "out of reach" in far.output
    for wanted in ("much", "-1 %", "300 %"):
        said = refused("flywheel", "yi_diesel_free", "--fluctuation", wanted)
        assert said.startswith("--fluctuation: must be a share of the mean speed")
    assert refused("flywheel", "yi_diesel_free", "--fluctuation", "1") == (
        "--fluctuation: 1 without a unit is 100 % of the mean speed; "
        'write "1 %", or "100 %" if that is meant'
    )


def test_a_settled_run_is_confirmed(tmp_path):
    shown = crankmbs_(
        "run", "propeller", "--until", "settled", "--confirm", "--every", "10 deg",
        "--no-figures", "--out", str(tmp_path),
    )  # fmt: skip
    assert shown.exit_code == 0, shown.output
    assert "settled: a disturbance decays to 90.42 % per period" in shown.output
    assert "exudyn's rigid bodies agree to" in shown.output


def test_a_crank_whose_speed_nothing_makes_fluctuate_needs_no_flywheel():
    light = {"rod__mass": 0.0, "rod__inertia": 0.0, "rod__center_of_mass": 0.0, "piston__mass": 0.0}
    scene = load_scene("coasting").with_(gravity=None, **light)
    with pytest.raises(InputError, match="does not fluctuate, whatever"):
        flywheel(scene, 0.01)
