"""Torques over the crank angle: their rows, and their motion against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    AngleTable,
    Constant,
    Crank,
    InputError,
    Piston,
    Quadratic,
    Rod,
    Run,
    Scene,
    Start,
    Table,
    load_scene,
    simulate,
)
from crankmbs.mechanics.torque import over_angle
from crankmbs.mechanics.train import crank_train
from crankmbs.scene.read import parse_scene
from crankmbs.scene.units import DEGREE
from crankmbs.scene.write import scene_files
from validation.checks.drawn import stated_ratio
from validation.random_turning import random_turning

FREE = ["crank_angle", "minimal"]
ROWS = ((0.0, 90.0, 90.0, 200.0, 300.0), (5.0, -20.0, 40.0, 8.0, -30.0))
LONG = ((-60.0, 100.0, 400.0, 660.0), (10.0, -20.0, 15.0, 60.0))  # 720 degrees, a jump at its end


def table(angles, torques):
    return Table(tuple(a * DEGREE for a in angles), torques)


def wheel(*torque, speed=12.0, until="3 rev", rod=0.0, piston=0.0, rtol=1e-10):
    return Scene(
        crank=Crank(radius=0.04, inertia=0.5),
        rod=Rod(length=0.14, mass=rod),
        piston=Piston(mass=piston),
        start=Start(angle=0.4, speed=speed),
        torque=torque,
        run=Run(until=until, every="7 deg", rtol=rtol),
    )


def work(angles, torques, period, begin, end):
    """Work of a linear table from an angle to angles, by the area of its trapezia [J]."""
    x = np.array([*angles, angles[0] + period]) * DEGREE
    y = np.array([*torques, torques[0] if angles[-1] - angles[0] < period - 1e-9 else torques[-1]])
    area = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(x))])

    def integral(theta):
        turns, ahead = np.divmod(theta - x[0], period * DEGREE)
        k = np.clip(np.searchsorted(x - x[0], ahead, side="right") - 1, 0, len(x) - 2)
        d = ahead - (x[k] - x[0])
        slope = (y[k + 1] - y[k]) / np.where(x[k + 1] > x[k], x[k + 1] - x[k], 1.0)
        return turns * area[-1] + area[k] + d * (y[k] + 0.5 * d * slope)

    return integral(np.asarray(end)) - integral(np.asarray(begin))


@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("speed", [12.0, -40.0])
@pytest.mark.parametrize(("rows", "period"), [(ROWS, 360.0), (LONG, 720.0)])
def test_energy_is_the_area_under_the_table(formulation, speed, rows, period):
    scene = wheel(AngleTable(file=table(*rows)), Constant(torque=math.copysign(9.0, speed)))
    scene = replace(scene, start=Start(angle=0.4, speed=speed))
    result = simulate(scene, formulation=formulation)
    assert result.status == 0, result.message
    theta, omega = (result.data[n].values for n in ("crank_angle", "crank_speed"))
    gained = work(*rows, period, 0.4, theta) + math.copysign(9.0, speed) * (theta - 0.4)
    np.testing.assert_allclose(0.25 * omega**2, 0.25 * speed**2 + gained, rtol=1e-9, atol=1e-9)
    assert np.max(np.abs(result.data["energy_residual"])) < 1e-10 * np.max(omega**2)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
def test_it_is_an_external_torque(formulation):
    load = AngleTable(file=table(*LONG))
    scene = wheel(load, Quadratic(coefficient=0.01), speed=20.0, rod=0.5, piston=0.8)
    data = simulate(scene, formulation=formulation).data
    theta, omega = data["crank_angle"].values, data["crank_speed"].values
    exact = load(0.0, theta, omega) - 0.01 * omega * np.abs(omega)
    np.testing.assert_allclose(data["external_torque"], exact, atol=1e-6)


@pytest.mark.parametrize("interpolation", ["linear", "pchip", "cubic"])
def test_formulations_agree(interpolation):
    load = AngleTable(file=table(*LONG), interpolation=interpolation)
    scene = wheel(load, Quadratic(coefficient=0.01), speed=20.0, rod=0.5, piston=0.8)
    a, b = (simulate(scene, formulation=name).data for name in FREE)
    np.testing.assert_allclose(a["time"], b["time"], rtol=1e-9)
    np.testing.assert_allclose(a["crank_acceleration"], b["crank_acceleration"], atol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("rows", [LONG, ((0.0, 120.0, 300.0), (9.0, -6.0, 4.0))])
def test_multibody_confirms(rows):
    load = AngleTable(file=table(*rows))
    scene = wheel(load, speed=20.0, rod=0.5, piston=0.8, until="1.5 rev")
    answer, check = simulate(scene), simulate(scene, formulation="multibody")
    for name in ("crank_speed", "crank_acceleration", "external_torque"):
        a, b = answer.data[name], check.data[name]
        inside = slice(0, -1)
        apart = np.max(np.abs(a.values[inside] - b.values[inside]))
        assert apart <= a.error_estimate + b.error_estimate
    assert check.data["crank_speed"].error_estimate < 1e-2


def test_windows_open_and_close_it():
    load = AngleTable(file=table(*ROWS), after=0.5, until=1.0)
    scene = replace(wheel(load), run=Run(until="1.6 s", every="0.0137 s", rtol=1e-10))
    for name in FREE:
        data = simulate(scene, formulation=name).data
        t, theta, omega = (data[n].values for n in ("time", "crank_angle", "crank_speed"))
        begin, end = 0.4 + 12.0 * 0.5, np.interp(1.0, t, theta)
        np.testing.assert_allclose(omega[t < 0.5], 12.0, rtol=1e-10)
        open_ = (t > 0.5) & (t < 1.0)
        energy = 36.0 + work(*ROWS, 360.0, begin, theta[open_])
        np.testing.assert_allclose(0.25 * omega[open_] ** 2, energy, rtol=1e-9)
        last = 36.0 + work(*ROWS, 360.0, begin, end)
        np.testing.assert_allclose(0.25 * omega[t > 1.0] ** 2, last, rtol=1e-4)
        np.testing.assert_allclose(omega[t > 1.0], omega[-1], rtol=1e-10)


def test_the_grid_repeats_after_the_common_period():
    two_stroke = load_scene("compressor")
    assert crank_train(wheel(AngleTable(file=table(*ROWS)))).period == 4.0 * math.pi
    free = replace(
        two_stroke,
        motion=None,
        start=Start(angle=0.0, speed=50.0),
        torque=(),
        crank=Crank(radius=two_stroke.crank.radius, inertia=1.0),
    )
    assert crank_train(free).period == 2.0 * math.pi
    assert (
        crank_train(replace(free, torque=(AngleTable(file=table(*LONG)),))).period == 4.0 * math.pi
    )


@pytest.mark.parametrize("kind", ["linear", "pchip", "cubic"])
@pytest.mark.parametrize("rows", [ROWS, LONG])
def test_the_sum_of_tables_is_the_sum_of_their_values(kind, rows):
    loads = [AngleTable(file=table(*some), interpolation=kind) for some in (rows, ROWS, LONG)]
    scene = wheel(*loads)
    theta = np.linspace(-20.0, 20.0, 4001)
    exact = sum(load(0.0, theta, 0.0) for load in loads)
    np.testing.assert_allclose(over_angle(crank_train(scene))(theta), exact, rtol=1e-10, atol=1e-10)


def test_a_closing_row_unlike_the_first_is_a_jump():
    saw = AngleTable(file=table((0.0, 180.0, 360.0), (0.0, 1.0, 2.0)))
    degrees = np.array([0.0, 359.0, 360.0, 540.0, -1.0])
    exact = np.array([0.0, 359 / 180, 0.0, 1.0, 359 / 180])
    np.testing.assert_allclose(saw(0.0, degrees * DEGREE, 0.0), exact, atol=1e-12)


def test_between_samples_it_counts():
    scene = wheel(AngleTable(file=table(*ROWS)), speed=20.0, rod=0.5, piston=0.8, until="1 rev")
    coarse = simulate(replace(scene, run=Run(until="1 rev", every="90 deg")))
    exact = simulate(replace(scene, run=Run(until="1 rev", every="0.5 deg"))).data
    found = coarse.interp(crank_angle=exact["crank_angle"].values[1:-1])
    for name in ("crank_speed", "crank_acceleration", "external_torque"):
        size = float(np.max(np.abs(exact[name].values)))
        np.testing.assert_allclose(found[name], exact[name][1:-1], atol=1e-9 * size)


@pytest.mark.parametrize(
    ("angles", "rule"),
    [
        ((0.0, 90.0, 800.0), "the rows span 800 degrees, more than two revolutions"),
        ((0.0, 90.0), "a gap of 270 degrees without a row; the table must span the 360 degrees"),
        ((0.0, 90.0, 80.0), "crank angles must not decrease"),
        ((0.0, 180.0, 180.0 + 1e-8, 300.0), "too near to be told apart"),
    ],
)
def test_bad_rows(angles, rule):
    with pytest.raises(InputError, match=rule):
        AngleTable(file=table(angles, tuple(1.0 for _ in angles)))


def test_it_is_read_and_written(tmp_path):
    (tmp_path / "turns.csv").write_text("crank_angle_deg,torque_Nm\n0,5\n90,-7\n180,3\n270,1\n")
    text = """
    [crank]
    radius = "40 mm"
    inertia = "0.12 kg m^2"
    [rod]
    length = "140 mm"
    [piston]
    mass = "0.42 kg"
    [start]
    angle = "0 deg"
    speed = "300 rpm"
    [[torque]]
    kind = "angle_table"
    file = "turns.csv"
    interpolation = "cubic"
    until = "2 s"
    [run]
    until = "2 rev"
    """
    scene = parse_scene(text, tmp_path / "turns.toml")
    (load,) = scene.torque
    assert load.file.x == pytest.approx([0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi], abs=1e-15)
    files = scene_files(scene, "again")
    for name, content in files.items():
        (tmp_path / name).write_text(content)
    again = parse_scene(files["again.toml"], tmp_path / "again.toml")
    assert again.torque[0].file.x == load.file.x
    assert again.torque[0].interpolation == "cubic"


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("seed", range(4))
def test_random_tables_against_the_oracle(seed, formulation):
    scene = random_turning(seed)
    result = simulate(scene, formulation=formulation)
    assert result.status == 0
    assert stated_ratio(result, scene)[0] <= 1.0


@pytest.mark.slow
def test_multibody_states_which_side_of_a_jump_a_sample_may_be_on():
    rows = ((0.0, 120.0, 120.0, 300.0, 300.0), (8.0, 8.0, -4.0, 2.0, 8.0))
    loaded = {"start__angle": 0.0, "torque": (AngleTable(file=table(*rows)),)}
    scene = load_scene("coasting").with_(**loaded)
    passed = simulate(replace(scene, run=Run(until="1920 deg", every="10 deg")))
    time = float(passed.data.time.values[-1])
    for end, low, high in ((time, 11.9, 12.1), (0.99 * time, 0.0, 0.1)):
        run = Run(until=f"{end!r} s", every=f"{0.3 * end!r} s")
        found = simulate(replace(scene, run=run), formulation="multibody", cost_cap=0.7)
        assert low <= found.data.external_torque.attrs["error_estimate"] <= high
