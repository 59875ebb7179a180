"""Volumes, polytropes and Brauer's construction of them."""

import numpy as np
import pytest

from crankmbs import lecture
from crankmbs.errors import InputError

ROD = {"crank_radius": 0.046, "rod_length": 0.046 / 0.3, "offset": 0.0012972}
AREA = 57.079e-4


@pytest.mark.parametrize(("angle", "exponent"), [(15.0, 1.32), (15.0, 1.18), (8.0, 1.4)])
def test_brauer_points_lie_on_the_polytrope(angle, exponent):
    start = {"reference_volume": 2.5e-5, "reference_pressure": 4.7e6, "exponent": exponent}
    volume, pressure = lecture.brauer_points(
        np.arange(-3, 12), volume_angle=np.radians(angle), **start
    )
    assert pressure == pytest.approx(lecture.polytropic_pressure(volume, **start), rel=1e-13)


def test_brauer_lines_construct_the_next_point():
    """The construction with ruler and compass: 45-degree lines between the two slanted ones."""
    angle = np.radians(15.0)
    beta = lecture.brauer_angle(volume_angle=angle, exponent=1.32)
    volume, pressure = lecture.brauer_points(
        np.array([0, 1]),
        volume_angle=angle,
        exponent=1.32,
        reference_volume=1.0,
        reference_pressure=10.0,
    )
    below_volume_axis = volume[0] * np.tan(angle)
    assert volume[1] == pytest.approx(volume[0] + below_volume_axis, rel=1e-15)
    left_of_pressure_axis = pressure[1] * np.tan(beta)
    assert pressure[0] == pytest.approx(pressure[1] + left_of_pressure_axis, rel=1e-15)


@pytest.mark.parametrize(("exponent", "beta"), [(1.32, 20.205), (1.18, 17.916)])
def test_brauer_angles_of_the_paper(exponent, beta):
    found = lecture.brauer_angle(volume_angle=np.radians(15.0), exponent=exponent)
    assert np.degrees(found) == pytest.approx(beta, abs=5e-4)


@pytest.mark.parametrize("angle", [0.0, -0.1, 1.6, float("nan")])
def test_brauer_refuses_an_angle_that_leads_nowhere(angle):
    with pytest.raises(InputError, match=r"volume_angle: must lie between 0 and pi/2, got"):
        lecture.brauer_angle(volume_angle=angle, exponent=1.3)


def test_the_pistons_area_is_that_of_a_circle():
    radius = np.array([0.03, 0.05])
    np.testing.assert_allclose(lecture.piston_area(bore=2.0 * radius), np.pi * radius**2)


def test_polytrope_keeps_p_times_v_to_the_n():
    volume = np.array([1.0, 2.0, 7.0])
    pressure = lecture.polytropic_pressure(
        volume, reference_volume=3.0, reference_pressure=1e5, exponent=1.25
    )
    assert pressure * volume**1.25 == pytest.approx(1e5 * 3.0**1.25, rel=1e-14)


def test_volume_runs_from_the_clearance_to_the_compression_ratio():
    swept = AREA * lecture.stroke(**ROD)
    clearance = lecture.clearance_volume(swept_volume=swept, compression_ratio=20.0)
    dead_centres = np.array([lecture.top_dead_centre(**ROD), lecture.bottom_dead_centre(**ROD)])
    volume = lecture.cylinder_volume(
        dead_centres, piston_area=AREA, clearance_volume=clearance, **ROD
    )
    assert volume == pytest.approx([clearance, 20.0 * clearance], rel=1e-13)


def test_clearance_volume_of_the_paper():
    stroke = lecture.stroke_central(crank_radius=0.046)
    clearance = lecture.clearance_volume(swept_volume=AREA * stroke, compression_ratio=20.0)
    assert clearance == pytest.approx(2.7638253e-05, rel=2e-8)


@pytest.mark.parametrize("ratio", [1.0, 0.5, float("nan")])
def test_clearance_volume_refuses_a_ratio_of_one(ratio):
    with pytest.raises(InputError, match=r"compression_ratio: must be above 1, got"):
        lecture.clearance_volume(swept_volume=5e-4, compression_ratio=ratio)


def test_gas_force_pushes_towards_the_crank():
    pressures = np.array([0.9e5, 1e5, 3e5])
    force = lecture.gas_force(gas_pressure=pressures, ambient_pressure=1e5, piston_area=AREA)
    assert force == pytest.approx([-0.1e5 * AREA, 0.0, 2e5 * AREA], abs=1e-9)
