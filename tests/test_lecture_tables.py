"""Cells of S1's tables from its truncated formulas, with the misprints corrected.

R = 46 mm, lambda = 0.3 and k = 0.0282 at 3200 rpm; A_p = 57.079 cm2, p_0 = 1 kgf/cm2 and
m_1 = 0.15727 kgf s2/m are what its Tables 1, 2 and 4 fit. Tolerances are one unit of the last
printed digit, two where the print rounds unevenly.
"""

import numpy as np
import pytest

from crankmbs import lecture

CENTRAL = {"crank_radius": 0.046, "rod_length": 0.046 / 0.3}
ROD = {**CENTRAL, "offset": 0.0282 * 0.046}
OMEGA = lecture.angular_speed(rotational_frequency=3200.0 / 60.0)
KGF = 9.80665
AT = 98066.5  # kgf/cm2 in Pa

# degrees, travel [mm], velocity [m/s], acceleration [m/s2]
TABLE_1 = [
    (0, 0.0, -0.130, 6715.190),
    (30, 7.693, 9.597, 5270.161),  # printed 7.69 and 9.9597
    (90, 52.511, 15.415, -1505.959),
    (120, 73.837, 11.412, -3319.750),  # printed 11.413
    (180, 92.0, 0.130, -3615.872),
    (210, 87.756, -5.592, -3720.502),  # printed -3720.440
    (240, 74.512, -11.2821, -3395.44),  # printed 74.369
    (300, 28.512, -15.417, 1770.090),
]
# degrees, pressure [kgf/cm2], gas force, inertia force, net force [kgf]
TABLE_4 = [
    (0, 1.133, 7.591, -1056.098, -1048.506),
    (90, 0.6908, -17.648, 236.842, 219.194),
    (120, 0.7055, -16.809, 522.097, 505.288),
    (150, 0.8819, -6.741, 578.251, 571.51),
    (180, 0.9001, -5.702, 568.668, 562.966),
    (360, 65.7187, 3694.078, -1056.098, 2637.98),  # printed -1356.098
]
# degrees, net force, side thrust, rod force, tangential, normal force [kgf]
TABLE_5 = [
    (0, -1048.506, 8.870, -1048.5, 8.87, -1048.50),
    (30, -830.017, -117.48, -839.35, -516.75, -660.07),
    (90, 219.194, 63.90, 229.06, 219.19, -63.9),
    (120, 505.288, 127.00, 522.34, 374.09, -362.63),  # printed 373.91 and -362.59
    (180, 562.966, -4.76, 562.97, 4.76, -562.96),  # printed 562.06
    (300, -143.868, 38.59, -148.72, 143.89, -38.51),  # printed -38.50
    (330, -172.097, 27.27, -174.03, 109.67, -135.40),  # printed F = 172.097
    (360, 2637.98, -22.32, 2637.98, -22.32, 2637.98),
]
# degrees, net force [kgf], torque [kgf m]
TABLE_6 = [(0, -1048.506, 0.40802), (30, -830.017, -23.770), (90, 219.194, 10.084)]


@pytest.mark.parametrize(("degrees", "travel", "velocity", "acceleration"), TABLE_1)
def test_table_1(degrees, travel, velocity, acceleration):
    angle = np.radians(degrees)
    found = lecture.piston_displacement_series(angle, **ROD) * 1e3
    assert found == pytest.approx(travel, abs=1e-3)
    found = lecture.piston_velocity_series(angle, omega=OMEGA, **ROD)
    assert found == pytest.approx(velocity, abs=1e-3)
    found = lecture.piston_acceleration_series(angle, omega=OMEGA, **ROD)
    assert found == pytest.approx(acceleration, abs=2e-3)


@pytest.mark.parametrize(("degrees", "pressure", "gas", "inertia", "net"), TABLE_4)
def test_table_4(degrees, pressure, gas, inertia, net):
    gas_force = lecture.gas_force(
        gas_pressure=pressure * AT, ambient_pressure=AT, piston_area=57.079e-4
    )
    inertia_force = lecture.inertia_force_series(
        np.radians(degrees), reciprocating_mass=0.15727 * KGF, omega=OMEGA, **ROD
    )
    net_force = lecture.net_force(gas_force=gas_force, inertia_force=inertia_force)
    assert gas_force / KGF == pytest.approx(gas, abs=1e-3)
    assert inertia_force / KGF == pytest.approx(inertia, abs=1e-3)
    assert net_force / KGF == pytest.approx(net, abs=1e-3)


@pytest.mark.parametrize(("degrees", "net", "side", "along", "tangential", "normal"), TABLE_5)
def test_table_5(degrees, net, side, along, tangential, normal):
    given = {"crank_angle": np.radians(degrees), "net_force": net}
    assert lecture.side_thrust_series(**given, **ROD) == pytest.approx(side, abs=1e-2)
    assert lecture.rod_force_series(**given, **CENTRAL) == pytest.approx(along, abs=1e-2)
    assert lecture.tangential_force_series(**given, **ROD) == pytest.approx(tangential, abs=1e-2)
    assert lecture.radial_force_series(**given, **ROD) == pytest.approx(normal, abs=1e-2)


@pytest.mark.parametrize(("degrees", "net", "torque"), TABLE_6)
def test_table_6(degrees, net, torque):
    tangential = lecture.tangential_force_series(np.radians(degrees), net_force=net, **ROD)
    found = lecture.crank_torque(tangential_force=tangential, crank_radius=0.046)
    assert found == pytest.approx(torque, abs=2e-3)


def test_mean_speed_of_the_paper_is_not_its_7_metres_per_second():
    stroke = lecture.stroke_central(crank_radius=0.046)
    assert lecture.mean_piston_speed(stroke=stroke, omega=OMEGA) == pytest.approx(9.813, abs=5e-4)
