"""Speeds measured over the crank angle: time from angle and back, rows that repeat, refusals."""

import dataclasses
import math
from itertools import pairwise

import numpy as np
import pytest
from scene_texts import DRIVEN, edited, refusal
from scipy.integrate import quad
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from crankmbs import (
    InputError,
    Motion,
    Result,
    Run,
    SpeedFile,
    Table,
    load_scene,
    orders,
    simulate,
)
from crankmbs.mechanics.speed import speed_law
from crankmbs.scene.units import DEGREE, RPM
from validation.checks.drawn import stated_ratio
from validation.checks.honest import true_errors
from validation.random_speeds import random_speeds

EVEN = np.linspace(0.0, 4.0 * math.pi, 49)
CYCLE = 150.0 + 12.0 * np.cos(2.0 * EVEN) + 3.0 * np.sin(0.5 * EVEN)
BASE = load_scene("yi_diesel")
KINDS = pytest.mark.parametrize("kind", ["pchip", "cubic"])
SENSES = pytest.mark.parametrize("sense", [1.0, -1.0])


def measured(angle=EVEN, speed=CYCLE, kind="cubic"):
    return SpeedFile(file=Table(angle, speed), interpolation=kind, kind="angle_table")


def driven(speed, until="1 cycle", every="10 deg", begin=0.7):
    return dataclasses.replace(
        BASE, motion=Motion(speed=speed, angle=begin), run=Run(until=until, every=every)
    )


@KINDS
@SENSES
def test_time_is_the_integral_of_one_over_the_speed(kind, sense):
    law = speed_law(Motion(speed=measured(speed=sense * CYCLE, kind=kind), angle=0.7))

    curve: PPoly = CubicSpline(EVEN, CYCLE, bc_type="periodic")
    if kind == "pchip":
        wide = np.concatenate([EVEN - EVEN[-1], EVEN[1:], EVEN[1:] + EVEN[-1]])
        curve = PchipInterpolator(wide, np.concatenate([CYCLE, CYCLE[1:], CYCLE[1:]]))
    for theta in 0.7 + sense * np.array([0.01, 3.0, 10.0]):
        low, high = sorted((0.7, theta))
        inside = np.concatenate([EVEN[:-1] - EVEN[-1], EVEN])
        edges = [low, *inside[(inside > low) & (inside < high)], high]
        exact = sum(
            quad(lambda x: 1.0 / float(curve(x % EVEN[-1])), a, b)[0] for a, b in pairwise(edges)
        )
        assert law.time_at(theta, 0.0, math.inf)[0] == pytest.approx(exact, rel=1e-12)


@KINDS
@SENSES
def test_speed_and_acceleration_are_derivatives_and_times_are_found_again(kind, sense):
    law = speed_law(Motion(speed=measured(speed=sense * CYCLE, kind=kind), angle=0.7))
    t, h = np.linspace(0.0, 0.4, 57)[1:], 1e-6
    theta, omega, alpha = law.at_time(t)
    ahead, behind = law.at_time(t + h), law.at_time(t - h)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * h), omega, rtol=1e-7)
    corners = law.corners(0.0, 1.0)
    smooth = np.min(np.abs(t[:, None] - corners), axis=1) > h
    slope = (ahead[1] - behind[1]) / (2 * h)
    np.testing.assert_allclose(slope[smooth], alpha[smooth], rtol=1e-4, atol=0.02)
    np.testing.assert_allclose(law.time_at(theta, 0.0, math.inf), t, rtol=1e-13)
    assert law.at_time(0.0)[0] == pytest.approx(0.7, rel=1e-15)


def test_the_rows_are_passed_and_come_again():
    law = speed_law(Motion(speed=measured(), angle=0.0))
    turn = law.time_at(4.0 * math.pi, 0.0, math.inf)[0]
    times = law.time_at(EVEN[:-1] + 12.0 * math.pi, 0.0, math.inf)
    np.testing.assert_allclose(law.at_time(times)[1], CYCLE[:-1], rtol=1e-13)
    corners = law.corners(2.5 * turn, 3.5 * turn)
    assert len(corners) == len(EVEN) - 1
    assert np.min(np.abs(corners - 3.0 * turn)) < 1e-12 * turn
    assert law.turning_times == (math.inf,)


def test_a_cubic_is_nearer_to_a_smooth_speed_than_pchip():
    theta = np.linspace(0.0, 4.0 * math.pi, 721)
    exact = -(24.0 * np.sin(2.0 * theta) - 1.5 * np.cos(0.5 * theta)) * (
        150.0 + 12.0 * np.cos(2.0 * theta) + 3.0 * np.sin(0.5 * theta)
    )

    def off(kind):
        law = speed_law(Motion(speed=measured(kind=kind), angle=0.0))
        alpha = law.at_time(law.time_at(theta, 0.0, math.inf))[2]
        return np.max(np.abs(alpha - exact)) / np.max(np.abs(exact))

    assert off("cubic") < 0.01 < off("pchip")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_random_tables_against_the_closed_form(seed):
    scene = random_speeds(seed)
    result = simulate(scene)
    assert result.status == 0
    assert stated_ratio(result, scene)[0] <= 1.0


def test_next_to_rest_the_rounding_of_the_speed_is_in_the_stated_time():
    """Where the speed comes down to a millionth its rounding moves the time by as much more."""
    slow = CYCLE - CYCLE.min() + 1e-5
    result = simulate(driven(measured(speed=slow, kind="pchip")))
    time = result.data["time"]
    assert 1e-13 * time.values[-1] < true_errors(result, result.scene)[0]["time"]
    assert true_errors(result, result.scene)[0]["time"] < time.error_estimate
    assert time.error_estimate < 1e-9 * time.values[-1]


def test_orders_of_a_measured_speed():
    found = orders(simulate(driven(measured(), until="2 cycles", every="1 deg")), "crank_speed", 4)
    second = found.amplitude[np.flatnonzero(found.order == 2.0)[0]]
    assert second == pytest.approx(12.0, rel=1e-3)
    assert found.mean == pytest.approx(150.0, rel=1e-3)


@pytest.mark.slow
def test_a_saved_run_comes_back(tmp_path):
    result = simulate(driven(measured()))
    result.save(tmp_path)
    again = Result.load(tmp_path).scene
    assert again.motion.speed.kind == "angle_table"
    assert again == result.scene


def csv(angles, speeds):
    rows = "\n".join(f"{a:g},{v:g}" for a, v in zip(angles, speeds, strict=True))
    return f"crank_angle_deg,speed_rpm\n{rows}\n"


@pytest.mark.parametrize("last", [1500.0, 1500.5])
def test_a_file_is_read_and_a_closing_row_dropped_and_said(read, tmp_path, last):
    (tmp_path / "speed.csv").write_text(csv((0, 180, 360), (1500, 1600, last)))
    scene = read(edited(DRIVEN, '"3200 rpm"', '{ file = "speed.csv", interpolation = "cubic" }'))
    speed = scene.motion.speed
    assert (speed.kind, speed.interpolation) == ("angle_table", "cubic")
    assert speed.file.x == (0.0, 180.0 * DEGREE, 360.0 * DEGREE)
    result = simulate(scene)
    peaks = result.data["crank_speed"].values.max() / RPM
    assert peaks == pytest.approx(1600.0)
    said = [reason for reason in result.reasons if "closing row" in reason]
    dropped = "speed.csv: the closing row, 0.5 rpm from the first one, is dropped"
    assert len(said) == (last != 1500.0)
    assert all(reason.endswith(dropped) for reason in said)


def test_a_time_column_counts_before_the_angle(read, tmp_path):
    rows = "crank_angle_deg,time_s,speed_rpm\n0,0,1500\n9,1,1600\n"
    (tmp_path / "speed.csv").write_text(rows)
    scene = read(edited(DRIVEN, '"3200 rpm"', '{ file = "speed.csv" }'))
    assert scene.motion.speed.kind == "time_table"
    assert scene.motion.speed.file.x == (0.0, 1.0)


@pytest.mark.parametrize(
    ("angles", "speeds", "message"),
    [
        (
            (0, 100, 360),
            (1500, 1400, 1520),
            "speed.csv: the table must cover the run, 0 to 720 degrees, or be 360 or 720 degrees "
            "whose last row repeats the first; it goes from 0 to 360 degrees",
        ),
        (
            (10, 400, 800),
            (1500, 1400, 1520),
            "speed.csv: the table must cover the run, 0 to 720 degrees, or be 360 or 720 degrees "
            "whose last row repeats the first; it goes from 10 to 800 degrees",
        ),
        (
            (0, 0, 720),
            (1500, 1400, 1500),
            "motion.speed: speed.csv: crank angles must strictly increase; row 2 breaks this",
        ),
        (
            (0, 180, 360),
            (1500, -10, 1500),
            "motion.speed: speed.csv: a speed over the crank angle must keep its sign and never "
            "come to 0, or the crank gets no farther; at 180 degrees it is -10 rpm; leave out such "
            "rows, or give the speed over time, time_s",
        ),
    ],
)
def test_what_is_refused(read, tmp_path, angles, speeds, message):
    (tmp_path / "speed.csv").write_text(csv(angles, speeds))
    assert refusal(read, edited(DRIVEN, '"3200 rpm"', '{ file = "speed.csv" }')) == message


def test_a_spline_that_comes_to_zero_between_rows_is_refused():
    angle, speed = np.radians([0, 80, 90, 100, 110, 270, 360]), [50, 50, 1, 1, 50, 50, 50]
    with pytest.raises(
        InputError, match="between two rows of the cubic curve; leave out such rows"
    ):
        measured(angle, speed)
    assert speed_law(Motion(speed=measured(angle, speed, "pchip"))).turning_times == (math.inf,)


def test_rows_that_end_before_a_run_in_time():
    run_up = measured(np.linspace(0.0, 30.0, 7), 100.0 + np.arange(7.0))
    assert simulate(driven(run_up, until="0.25 s")).status == 0
    with pytest.raises(InputError, match=r"ends at 0\.28\d+ s, before the run does, at 1718"):
        simulate(driven(run_up, until="0.3 s"))
    with pytest.raises(InputError, match="must cover the run"):
        driven(run_up, until="29.5 rad")
