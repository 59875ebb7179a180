"""The exact motion against mpmath derivatives of the closed loop, and what follows from it.

The oracle knows one thing: the piston pin lies on the cylinder axis, a rod's length from the pin.
"""

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from crankmbs import lecture
from crankmbs.errors import InputError

mp.dps = 40

RODS = [
    {"crank_radius": 0.05, "rod_length": 0.25, "offset": 0.0},
    {"crank_radius": 0.046, "rod_length": 0.046 / 0.3, "offset": 0.0012972},
    {"crank_radius": 0.1, "rod_length": 0.3, "offset": -0.01},
    {"crank_radius": 0.9, "rod_length": 1.0, "offset": 0.05},
]
ANGLES = [0.0, 0.4, 1.5707963267948966, 2.2, 3.141592653589793, 4.0, 5.5, 12.0]


def displacement(crank_angle, *, crank_radius, rod_length, offset=0.0):
    """Distance of the piston pin from l + r, from the circle about the crank pin."""
    r, l, e = mpf(crank_radius), mpf(rod_length), mpf(offset)
    return l + r - r * mp.cos(crank_angle) - mp.sqrt(l**2 - (r * mp.sin(crank_angle) - e) ** 2)


@pytest.mark.parametrize("rod", RODS)
@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize(("omega", "alpha"), [(300.0, 0.0), (-120.0, 0.0), (40.0, -5e4)])
def test_motion_is_the_derivative_of_the_closed_loop(rod, angle, omega, alpha):
    def over_time(t):
        return displacement(mpf(angle) + mpf(omega) * t + mpf(alpha) * t**2 / 2, **rod)

    found = (
        lecture.piston_displacement(angle, **rod),
        lecture.piston_velocity(angle, omega=omega, **rod),
        lecture.piston_acceleration(angle, omega=omega, alpha=alpha, **rod),
    )
    r = rod["crank_radius"]
    units = (r, r * abs(omega), r * (omega**2 + abs(alpha)))
    for order, (value, unit) in enumerate(zip(found, units, strict=True)):
        assert value == pytest.approx(float(mpmath.diff(over_time, 0, order)), abs=2e-14 * unit)


def test_a_wrong_rod_is_noticed():
    rod = RODS[1]
    longer = {**rod, "rod_length": 1.000001 * rod["rod_length"]}
    exact = float(displacement(1.0, **longer))
    assert lecture.piston_displacement(1.0, **rod) != pytest.approx(exact, abs=2e-14)


@pytest.mark.parametrize("rod", RODS)
def test_dead_centres_and_stroke(rod):
    def slope(angle):
        return mpmath.diff(lambda x: displacement(x, **rod), angle)

    top = lecture.top_dead_centre(**rod)
    bottom = lecture.bottom_dead_centre(**rod)
    assert top == pytest.approx(float(mpmath.findroot(slope, top + 1e-3)), abs=1e-15)
    assert bottom == pytest.approx(float(mpmath.findroot(slope, bottom + 1e-3)), abs=1e-14)
    highest, lowest = (displacement(mpmath.findroot(slope, x), **rod) for x in (top, bottom))
    assert lecture.datum_shift(**rod) == pytest.approx(float(highest), abs=1e-16)
    assert lecture.stroke(**rod) == pytest.approx(float(lowest - highest), rel=1e-15)


def test_a_rod_as_long_as_the_crank_has_no_bottom_dead_centre():
    with pytest.raises(InputError, match="rod ratio"):
        lecture.bottom_dead_centre(crank_radius=1.0, rod_length=1.0)


@pytest.mark.parametrize("rod", RODS)
def test_maximum_speed_is_where_the_acceleration_is_zero(rod):
    def second(angle):
        return mpmath.diff(lambda x: displacement(x, **rod), angle, 2)

    angle = lecture.maximum_speed_angle(**rod)
    root = mpmath.findroot(second, angle + 1e-3)
    assert angle == pytest.approx(float(root), abs=2e-15)
    speed = mpmath.diff(lambda x: displacement(x, **rod), root)
    assert lecture.maximum_piston_speed(omega=100.0, **rod) == pytest.approx(
        float(100 * speed), rel=1e-15
    )


@pytest.mark.parametrize("rod", RODS)
def test_upstroke_is_the_downstroke_of_the_opposite_offset(rod):
    fine = lecture.piston_velocity(np.linspace(np.pi, 2.0 * np.pi, 200_001), omega=1.0, **rod)
    mirrored = {**rod, "offset": -rod["offset"]}
    assert lecture.maximum_piston_speed(omega=1.0, **mirrored) == pytest.approx(
        -fine.min(), rel=1e-9
    )


@pytest.mark.parametrize("ratio", [0.01, 0.2, 0.3, 0.6, 0.95])
def test_central_maximum_speed_angle_solves_the_cubic(ratio):
    u = np.sin(lecture.maximum_speed_angle(crank_radius=ratio, rod_length=1.0)) ** 2
    assert ratio**4 * u**3 - ratio**2 * u**2 - u + 1.0 == pytest.approx(0.0, abs=1e-15)


def test_textbook_maximum_speed():
    """Khurmi, Theory of Machines: r 0.3 m, l 1 m, 200 rpm."""
    rod = {"crank_radius": 0.3, "rod_length": 1.0}
    omega = lecture.angular_speed(rotational_frequency=200.0 / 60.0)
    assert lecture.maximum_piston_speed(omega=omega, **rod) == pytest.approx(6.561732, abs=5e-7)
    assert np.degrees(lecture.maximum_speed_angle(**rod)) == pytest.approx(74.52893, abs=5e-6)


def test_mean_speed_is_the_mean_of_the_speed():
    rod = RODS[1]
    angles = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    speed = np.abs(lecture.piston_velocity(angles, omega=335.0, **rod)).mean()
    mean = lecture.mean_piston_speed(stroke=lecture.stroke(**rod), omega=335.0)
    assert mean == pytest.approx(speed, rel=1e-7)


def test_constant_speed_turns_through_its_angle():
    omega = lecture.angular_speed(rotational_frequency=3200.0 / 60.0)
    turned = lecture.crank_angle_at(time=0.01, omega=omega)
    assert np.degrees(turned) == pytest.approx(6.0 * 3200.0 * 0.01, rel=1e-15)


@pytest.mark.parametrize("ratio", [0.2, 0.263, 0.2645, 0.3, 0.33, 0.7])
def test_acceleration_minimum(ratio):
    angles = np.linspace(0.5 * np.pi, np.pi, 1_000_001)
    rod = {"crank_radius": 1.0, "rod_length": 1.0 / ratio, "omega": 1.0}
    exact = lecture.piston_acceleration(angles, **rod)
    series = lecture.piston_acceleration_series(angles, **rod)
    found = lecture.acceleration_minimum_angle(rod_ratio=ratio)
    truncated = lecture.acceleration_minimum_angle_series(rod_ratio=ratio)
    assert lecture.piston_acceleration(found, **rod) <= exact.min() + 1e-15
    assert found == pytest.approx(angles[exact.argmin()], abs=2e-3)
    assert lecture.piston_acceleration_series(truncated, **rod) <= series.min() + 1e-15
    assert truncated == pytest.approx(angles[series.argmin()], abs=2e-6)


def test_acceleration_minimum_leaves_bottom_dead_centre_at_the_limits():
    limit = lecture.ACCELERATION_MINIMUM_LIMIT
    assert 3.0 * limit**3 - 4.0 * limit + 1.0 == pytest.approx(0.0, abs=1e-15)
    ratios = np.array([0.1, limit - 1e-9, limit + 1e-9])
    assert (lecture.acceleration_minimum_angle(rod_ratio=ratios) < np.pi).tolist() == [
        False,
        False,
        True,
    ]
    truncated = lecture.ACCELERATION_MINIMUM_LIMIT_SERIES
    ratios = np.array([0.1, truncated, truncated + 1e-9])
    assert (lecture.acceleration_minimum_angle_series(rod_ratio=ratios) < np.pi).tolist() == [
        False,
        False,
        True,
    ]


def test_values_at_quarter_turns():
    central = {"crank_radius": 0.05, "rod_length": 0.2}
    quarters = np.arange(4) * 0.5 * np.pi
    assert lecture.quarter_displacements_series(**central) == pytest.approx(
        lecture.piston_displacement_series(quarters, **central), abs=1e-16
    )
    assert lecture.quarter_velocities(crank_radius=0.05, omega=100.0) == pytest.approx(
        lecture.piston_velocity(quarters, omega=100.0, **central), abs=1e-14
    )
    assert lecture.dead_centre_accelerations(omega=100.0, **central) == pytest.approx(
        lecture.piston_acceleration(quarters[::2], omega=100.0, **central), rel=1e-15
    )


def test_brix_correction_is_the_lead_at_a_quarter_turn():
    rod = {"crank_radius": 0.05, "rod_length": 0.2}
    lead = lecture.piston_displacement(0.5 * np.pi, **rod) - lecture.stroke(**rod) / 2.0
    assert lecture.brix_correction(**rod) == pytest.approx(lead, rel=1e-14)


@pytest.mark.parametrize("rod", RODS)
def test_greatest_rod_angle(rod):
    fine = np.abs(lecture.rod_angle(np.linspace(0.0, 2.0 * np.pi, 40_001), **rod))
    assert lecture.maximum_rod_angle(**rod) == pytest.approx(fine.max(), abs=1e-15)


@pytest.mark.parametrize("rod", RODS)
def test_rod_angle_functions_agree(rod):
    angles = np.array(ANGLES)
    beta = lecture.rod_angle(angles, **rod)
    ratio = lecture.rod_ratio(crank_radius=rod["crank_radius"], rod_length=rod["rod_length"])
    k = lecture.relative_offset(crank_radius=rod["crank_radius"], offset=rod["offset"])
    assert lecture.sin_beta(angles, **rod) == pytest.approx(ratio * (np.sin(angles) - k), abs=1e-15)
    assert lecture.cos_beta(angles, **rod) == pytest.approx(np.cos(beta), abs=1e-15)
    assert lecture.tan_beta(angles, **rod) == pytest.approx(np.tan(beta), rel=1e-13, abs=1e-15)


@pytest.mark.parametrize("rod", RODS)
def test_orders_add_up_to_the_truncated_displacement(rod):
    angles = np.array(ANGLES)
    central = {key: rod[key] for key in ("crank_radius", "rod_length")}
    parts = lecture.first_order_displacement(angles, **rod)
    parts = parts + lecture.second_order_displacement(angles, **central)
    assert lecture.piston_displacement_series(angles, **rod) == pytest.approx(parts, abs=1e-15)
