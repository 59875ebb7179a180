"""Loads over the crank angle of any period: tables and functions, in runs, settled motions, the
flywheel and the oracle."""

import math
from dataclasses import replace

import numpy as np
import pytest
from page_engine import differences, sizes, unlike

from crankmbs import (
    AngleTable,
    Constant,
    Crank,
    InputError,
    Load,
    Piston,
    Quadratic,
    Rod,
    Run,
    Scene,
    Start,
    Table,
    Viscous,
    flywheel,
    load_scene,
    orders,
    simulate,
)
from crankmbs.measures import measure
from crankmbs.mechanics.train import crank_train, knots_over_angle
from crankmbs.page import refusals
from crankmbs.scene.read import parse_scene
from crankmbs.scene.units import DEGREE
from crankmbs.scene.write import scene_files
from validation.checks.drawn import stated_ratio
from validation.random_periods import random_periods

TURN = 2.0 * math.pi
INERTIA = 180.0
# a machine that takes 3000 N m for a while every third revolution, and 750 N m else
ROWS = Table(
    tuple(x * DEGREE for x in (0.0, 180.0, 540.0, 720.0, 1080.0)),
    (-750.0, -3000.0, -3000.0, -750.0, -750.0),
)
PRESS = AngleTable(file=ROWS, period=3.0 * TURN)


def wheel(*torque, speed=250.0 * TURN / 60.0, until="6 rev", inertia=INERTIA):
    return Scene(
        crank=Crank(radius=0.3, inertia=inertia),
        rod=Rod(length=1.2),
        piston=Piston(mass=0.0),
        start=Start(angle=0.0, speed=speed),
        torque=torque,
        run=Run(until=until, every="1 deg"),
    )


def taken(t, theta, omega):
    """The same machine as a function."""
    x = theta / DEGREE % 1080.0
    if x < 720.0:
        return max(-3000.0, -750.0 - 12.5 * min(x, 720.0 - x))
    return -750.0


BY_FUNCTION = Load(taken, kink_angles=ROWS.x[:-1], period=3.0 * TURN)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("halves", [1, 3, 6, 7])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_energy_is_the_work_of_a_sine_of_that_period(halves, formulation, sense):
    period = halves * math.pi
    angles = np.linspace(0.0, period, 181)
    rows = Table(tuple(angles), tuple(400.0 * np.cos(TURN * angles / period)))
    load = AngleTable(file=rows, interpolation="cubic", period=period)
    data = simulate(wheel(load, speed=sense * 20.0), formulation=formulation).data
    theta, omega = data["crank_angle"].values, data["crank_speed"].values
    work = 400.0 * period / TURN * np.sin(TURN * theta / period)
    np.testing.assert_allclose(0.5 * INERTIA * omega**2, 0.5 * INERTIA * 400.0 + work, rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("load", [PRESS, BY_FUNCTION], ids=["table", "function"])
def test_its_settled_motion_is_the_limit_of_its_run(load):
    scene = wheel(load, Viscous(coefficient=200.0), Constant(torque=7100.0), inertia=60.0)
    settled = simulate(scene.with_(run__until="settled"))
    assert settled.status == 0, settled.message
    angle = settled.data["crank_angle"].values
    assert angle[-1] - angle[0] == pytest.approx(6.0 * TURN, abs=1e-9)
    long = simulate(scene.with_(run__until="36 rev"))
    period = settled.data["crank_speed"].values
    np.testing.assert_allclose(long.data["crank_speed"].values[-len(period) :], period, rtol=1e-8)
    assert measure(settled).window.kind == "last period"
    assert measure(settled).speed_gain.value == pytest.approx(0.0, abs=1e-8)


@pytest.mark.slow
def test_a_function_settles_as_the_table_that_it_is():
    loads = Quadratic(coefficient=0.6), Constant(torque=2500.0)
    one, other = (
        simulate(wheel(load, *loads, inertia=20.0).with_(run__until="settled"))
        for load in (PRESS, BY_FUNCTION)
    )
    np.testing.assert_allclose(one.data["crank_speed"], other.data["crank_speed"], rtol=1e-9)
    apart = abs(one.decay.factor - other.decay.factor)
    assert apart <= one.decay.error + other.decay.error


@pytest.mark.slow
def test_a_load_that_depends_on_angle_and_speed_together_settles():
    def load(t, theta, omega):
        return -omega * (30.0 + 20.0 * math.sin(theta / 1.5))

    scene = wheel(Load(load, period=3.0 * TURN), Constant(torque=900.0), inertia=4.0)
    settled = simulate(scene.with_(run__until="settled"))
    assert settled.status == 0, settled.message
    period = settled.data["crank_speed"].values
    again = simulate(scene.with_(start__speed=float(period[0]), run__until="3 rev"))
    speed = again.data["crank_speed"].values
    np.testing.assert_allclose(speed, period[: len(speed)], rtol=1e-8)
    assert speed[-1] == pytest.approx(period[0], rel=1e-8)


def test_the_flywheel_of_a_machine_of_three_revolutions():
    """Khurmi's Example 16.6: 1125 N m above the mean over 2.5 pi at 250 rpm, with 180 kg m2."""
    excess, speed = 1125.0 * 2.5 * math.pi, 250.0 * TURN / 60.0
    wanted = excess / (INERTIA * speed**2)
    assert wanted == pytest.approx(0.0716, abs=5e-5)
    found = flywheel(wheel(PRESS), wanted)
    assert found.status == 0, found.message
    assert found.work.value == pytest.approx(excess, rel=1e-6)
    assert found.lecture.value == pytest.approx(INERTIA, rel=1e-6)
    assert found.inertia.value == pytest.approx(INERTIA, rel=wanted**2)
    assert found.mean_speed.value == pytest.approx(speed, rel=1e-6)


@pytest.mark.slow
def test_a_function_has_the_flywheel_of_its_table():
    loads = Viscous(coefficient=200.0), Constant(torque=7100.0)
    one, other = (flywheel(wheel(load, *loads), 0.05) for load in (PRESS, BY_FUNCTION))
    assert (one.status, other.status) == (0, 0)
    apart = abs(one.inertia.value - other.inertia.value)
    assert apart <= one.inertia.error + other.inertia.error
    assert other.work.value == pytest.approx(one.work.value, rel=1e-4)


def test_a_run_is_summed_up_over_the_common_period():
    window = measure(simulate(wheel(PRESS, Constant(torque=1875.0), until="13 rev"))).window
    assert window.kind == "last period"
    assert window.angle == pytest.approx(6.0 * TURN)


def test_orders_count_from_the_common_period():
    scene = wheel(PRESS, Quadratic(coefficient=0.6), Constant(torque=2300.0))
    found = orders(simulate(scene.with_(run__until="settled")), "external_torque", 2.0)
    assert found.order[0] == pytest.approx(1.0 / 6.0)
    largest = found.order[np.argmax(found.amplitude)]
    assert largest == pytest.approx(1.0 / 3.0)


def test_kinks_of_a_function_are_known_in_every_period():
    compressor = load_scene("compressor")
    free = replace(
        wheel(BY_FUNCTION),
        gas=compressor.gas,
        piston=compressor.piston,
        rod=Rod(length=1.2, mass=1.0),
    )
    for scene, period in ((wheel(BY_FUNCTION), 6.0), (free, 3.0)):
        train = crank_train(scene)
        assert train.period == pytest.approx(period * TURN)
        repeats = round(period / 3.0)
        expected = [x + 3.0 * TURN * k for k in range(repeats) for x in ROWS.x[:-1]]
        np.testing.assert_allclose(knots_over_angle(train), expected, atol=1e-12)


TEXT = """
[crank]
radius = "0.3 m"
inertia = "180 kg m^2"
[rod]
length = "1.2 m"
[piston]
mass = "0 kg"
[start]
angle = "0 deg"
speed = "250 rpm"
[[torque]]
kind = "angle_table"
file = "press.csv"
period = "{period}"
[run]
until = "3 rev"
"""
CSV = "crank_angle_deg,torque_Nm\n0,-750\n180,-3000\n540,-3000\n720,-750\n1080,-750\n"


def test_it_is_read_and_written(tmp_path):
    (tmp_path / "press.csv").write_text(CSV)
    (tmp_path / "press.toml").write_text(TEXT.format(period="3 rev"))
    scene = load_scene(tmp_path / "press.toml")
    (load,) = scene.torque
    assert load.period == pytest.approx(3.0 * TURN)
    assert load.words.endswith("linear, every 1080 degrees")
    for name, text in scene_files(scene, "again").items():
        (tmp_path / name).write_text(text)
    assert load_scene(tmp_path / "again.toml").torque[0].period == load.period
    assert (
        parse_scene(TEXT.format(period="1080 deg"), tmp_path / "x.toml").torque[0].period
        == load.period
    )


@pytest.mark.parametrize(
    ("period", "said"),
    [
        ("500 deg", r"period: must be a multiple of 180 degrees, .*; 500 degrees came"),
        ("2 rev", r"span 1080 degrees, more than the period of 720 degrees, .*longer period"),
        ("20 rev", r"a gap of 6120 degrees without a row; .* the 7200 degrees after which"),
        ("0 deg", "period: must be above 0"),
    ],
)
def test_a_period_that_cannot_be_is_refused(tmp_path, period, said):
    (tmp_path / "press.csv").write_text(CSV)
    with pytest.raises(InputError, match=said):
        parse_scene(TEXT.format(period=period), tmp_path / "x.toml")


def test_periods_that_come_together_too_late_are_refused():
    def of(halves):
        x = tuple(np.linspace(0.0, halves * math.pi, 9))
        return AngleTable(file=Table(x, (1.0,) * 9), period=halves * math.pi)

    with pytest.raises(InputError, match="together after 9797 cycles, and 1000 are the most"):
        wheel(of(97), of(101))
    assert wheel(of(97), of(3)).load_period == pytest.approx(4.0 * 291 * math.pi)


def test_a_function_without_a_period_does_not_settle():
    said = r"torque\[1\], a function depends on time; where it does not, say so by its period"
    with pytest.raises(InputError, match=said):
        wheel(Load(taken)).with_(run__until="settled")


def test_a_table_under_a_crank_that_turns_back_is_warned_of():
    falls = AngleTable(file=Table((0.0, 1.0, 2.0, math.pi), (-900.0,) * 4), period=math.pi)
    scene = wheel(falls, speed=3.0, inertia=40.0)
    result = simulate(scene.with_(run__until="2 s", run__every="0.01 s"))
    assert "torque[1]: the crank turned back, and the angle table is the same" in result.message
    forwards = simulate(scene.with_(run__until="0.05 s", run__every="0.01 s"))
    assert forwards.message == "reached the end of the run"


@pytest.mark.slow
def test_multibody_confirms_a_period_that_is_not_the_engine_s():
    scene = wheel(PRESS, Constant(torque=1875.0), until="3.5 rev").with_(rod__mass=1.0)
    answer, check = simulate(scene), simulate(scene, formulation="multibody")
    for name in ("crank_speed", "crank_pin_force_x", "main_bearing_force_y"):
        a, b = answer.data[name], check.data[name]
        apart = np.max(np.abs(a.values - b.values))
        assert apart <= a.error_estimate + b.error_estimate, name
    assert check.error.estimated < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("seed", range(1000, 1008))
def test_random_periods_against_the_oracle(seed, formulation):
    scene = random_periods(seed)
    result = simulate(scene, formulation=formulation)
    if result.status == 0:  # else it swings without end
        ratio, said, _ = stated_ratio(result, scene)
        assert ratio <= 1.0, said


@pytest.mark.slow
@pytest.mark.parametrize("until", ["settled", "7 rev"])
def test_the_page_runs_and_measures_it_as_python_does(engine, until):
    scene = load_scene("propeller")
    strikes = AngleTable(file=Table(ROWS.x, tuple(0.002 * y for y in ROWS.y)), period=3.0 * TURN)
    scene = replace(scene, torque=(*scene.torque, strikes)).with_(run__until=until)
    assert refusals(scene) == ()
    scene = scene.with_(run__every="0.5 deg")
    result = simulate(scene, rtol=1e-12)
    assert result.status == 0, result.message
    found = engine.answer(scene, result.data["crank_angle"].values)
    worst = differences(result, found["variables"])
    assert max(worst.values()) < 1e-9, max(worst.items(), key=lambda one: one[1])
    measures = measure(result)
    assert unlike(measures, found["measures"], sizes(result, measures)) == {}
