"""Prescribed speeds: derivatives, inverses, and what each law promises."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from crankmbs import Motion, Oscillation, Ramp, SpeedFile, Table
from crankmbs.mechanics.speed import speed_law

TABLE = Table((0.0, 0.5, 1.2, 2.0, 3.0), (10.0, 40.0, 35.0, 35.0, 90.0))
MOTIONS = {
    "constant": Motion(speed=-12.0, angle=0.4),
    "ramp": Motion(speed=Ramp(start=20.0, to=80.0, over=1.5), angle=-1.0),
    "oscillation": Motion(
        speed=Oscillation(mean=50.0, amplitude=20.0, order=2.0, phase=0.3), angle=0.7
    ),
    "backwards": Motion(speed=Oscillation(mean=-50.0, amplitude=49.0, order=0.5), angle=0.7),
    "table": Motion(speed=SpeedFile(file=TABLE), angle=2.0),
    "cubic": Motion(speed=SpeedFile(file=TABLE, interpolation="cubic"), angle=2.0),
}
EVERY = pytest.mark.parametrize("name", MOTIONS)
TIMES = np.linspace(0.01, 2.9, 37)


@EVERY
def test_speed_and_acceleration_are_derivatives(name):
    law, h = speed_law(MOTIONS[name]), 1e-5
    theta, omega, alpha = law.at_time(TIMES)
    ahead, behind = law.at_time(TIMES + h), law.at_time(TIMES - h)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * h), omega, rtol=1e-6)
    smooth = np.min(np.abs(TIMES[:, None] - np.array([*law.corners(0.0, 9.0), -9.0])), axis=1) > h
    slope = (ahead[1] - behind[1])[smooth] / (2 * h)
    np.testing.assert_allclose(slope, alpha[smooth], rtol=1e-5, atol=1e-3)
    assert np.all(np.isfinite(theta))


@EVERY
def test_it_starts_at_its_angle(name):
    assert speed_law(MOTIONS[name]).at_time(0.0)[0] == pytest.approx(MOTIONS[name].angle, rel=1e-15)


@EVERY
def test_times_are_found_again(name):
    law = speed_law(MOTIONS[name])
    end = law.turning_times[-1]
    found = law.time_at(law.at_time(TIMES)[0], 0.0, end)
    np.testing.assert_allclose(found, TIMES, rtol=1e-14)


def test_the_mean_of_the_oscillation_is_taken_over_the_angle():
    law = speed_law(MOTIONS["oscillation"])
    theta = 0.7 + np.linspace(0.0, math.pi, 257)  # one period of order 2
    omega = law.at_time(law.time_at(theta, 0.0, math.inf))[1]
    assert np.mean(omega[:-1]) == pytest.approx(50.0, rel=1e-13)
    np.testing.assert_allclose(omega, 50.0 + 20.0 * np.cos(2.0 * theta + 0.3), rtol=1e-13)


def test_a_ramp_is_held_and_its_corner_counts_from_the_right():
    law = speed_law(MOTIONS["ramp"])
    theta, omega, alpha = law.at_time([0.0, 1.5, 4.0])
    np.testing.assert_allclose(omega, [20.0, 80.0, 80.0])
    np.testing.assert_allclose(alpha, [40.0, 0.0, 0.0])
    np.testing.assert_allclose(theta, [-1.0, 74.0, 274.0])
    assert law.corners(0.0, 9.0) == [1.5]
    assert len(law.corners(1.5, 9.0)) == 0
    assert law.turning_times == (math.inf,)


def test_a_table_passes_its_rows_and_its_angle_is_the_integral():
    law = speed_law(MOTIONS["table"])
    np.testing.assert_allclose(law.at_time(TABLE.x)[1], TABLE.y, rtol=1e-14)
    area = sum(
        quad(lambda t: float(law.at_time(t)[1]), a, b)[0]
        for a, b in zip(TABLE.x[:-1], TABLE.x[1:], strict=True)
    )
    assert law.at_time(3.0)[0] == pytest.approx(2.0 + area, rel=1e-13)
    assert law.turning_times == (3.0,)


def test_a_table_that_starts_before_the_run():
    shifted = Table(tuple(x - 0.7 for x in TABLE.x), TABLE.y)
    law = speed_law(Motion(speed=SpeedFile(file=shifted), angle=2.0))
    whole = speed_law(MOTIONS["table"])
    assert law.at_time(0.0)[0] == pytest.approx(2.0, rel=1e-15)
    gained = whole.at_time(1.5)[0] - whole.at_time(0.7)[0]
    assert law.at_time(0.8)[0] - 2.0 == pytest.approx(gained, rel=1e-13)


@pytest.mark.parametrize(
    ("speed", "turns"),
    [
        (Ramp(start=10.0, to=-10.0, over=2.0), (1.0, math.inf)),
        (Ramp(start=10.0, to=0.0, over=2.0), (2.0, math.inf)),
        (SpeedFile(file=Table((0.0, 1.0, 3.0), (5.0, 0.0, -5.0))), (1.0, 3.0)),
    ],
)
def test_where_a_law_reverses_or_rests(speed, turns):
    np.testing.assert_allclose(speed_law(Motion(speed=speed)).turning_times, turns)


def test_a_record_that_begins_later_is_counted_from_its_first_row():
    later = Table(tuple(64.0 + t for t in TABLE.x), TABLE.y, "speed.csv")
    moved = Motion(speed=SpeedFile(file=later), angle=2.0)
    assert moved.speed.file.source == "speed.csv from 64 s on"
    np.testing.assert_allclose(
        speed_law(moved).at_time(TIMES), speed_law(MOTIONS["table"]).at_time(TIMES), rtol=1e-12
    )
