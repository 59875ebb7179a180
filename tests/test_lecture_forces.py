"""Forces against equilibrium and virtual work; masses against what they must conserve."""

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from crankmbs import lecture

mp.dps = 30

RODS = [
    {"crank_radius": 0.05, "rod_length": 0.25, "offset": 0.0},
    {"crank_radius": 0.046, "rod_length": 0.046 / 0.3, "offset": 0.0012972},
    {"crank_radius": 0.1, "rod_length": 0.3, "offset": -0.01},
]
ANGLES = np.array([0.0, 0.4, 1.5, 2.2, 3.1, 4.0, 5.5])
FORCES = np.array([-900.0, 2600.0, 400.0, 150.0, -30.0, 700.0, -200.0])


def central(rod):
    return {key: rod[key] for key in ("crank_radius", "rod_length")}


@pytest.mark.parametrize("rod", RODS)
@pytest.mark.parametrize("angle", ANGLES)
def test_forces_balance_at_both_pins(rod, angle):
    """Vectors from the pins' positions alone: rod, wall and net force on the piston sum to zero."""
    force = 1000.0
    r, l, e = (mpf(rod[key]) for key in ("crank_radius", "rod_length", "offset"))
    radial = mp.matrix([mp.cos(angle), mp.sin(angle)])
    crank_pin = r * radial
    piston_pin = mp.matrix([crank_pin[0] + mp.sqrt(l**2 - (crank_pin[1] - e) ** 2), e])
    along = (crank_pin - piston_pin) / l
    compression = -force / along[0]
    on_crank = compression * along

    rod_force = lecture.rod_force(angle, net_force=force, **rod)
    assert rod_force == pytest.approx(float(compression), rel=1e-14)
    wall_on_piston = on_crank[1]
    assert lecture.side_thrust(angle, net_force=force, **rod) == pytest.approx(
        float(wall_on_piston), abs=1e-12
    )
    tangent = mp.matrix([-radial[1], radial[0]])
    for found, direction in (
        (lecture.tangential_force(angle, rod_force=rod_force, **rod), tangent),
        (lecture.radial_force(angle, rod_force=rod_force, **rod), -radial),
    ):
        assert found == pytest.approx(float(mpmath.fdot(on_crank, direction)), abs=1e-11)


@pytest.mark.parametrize("rod", RODS)
def test_torque_has_the_power_of_the_net_force(rod):
    omega = 300.0
    rod_force = lecture.rod_force(ANGLES, net_force=FORCES, **rod)
    tangential = lecture.tangential_force(ANGLES, rod_force=rod_force, **rod)
    torque = lecture.crank_torque(tangential_force=tangential, crank_radius=rod["crank_radius"])
    power = FORCES * lecture.piston_velocity(ANGLES, omega=omega, **rod)
    assert torque * omega == pytest.approx(power, rel=1e-13)


@pytest.mark.parametrize("rod", RODS)
def test_truncated_torque_has_the_power_at_the_truncated_speed(rod):
    omega = 300.0
    tangential = lecture.tangential_force_series(ANGLES, net_force=FORCES, **rod)
    power = FORCES * lecture.piston_velocity_series(ANGLES, omega=omega, **rod)
    assert tangential * rod["crank_radius"] * omega == pytest.approx(power, rel=1e-13)


@pytest.mark.parametrize("rod", RODS)
def test_force_polygons_close(rod):
    rod_force = lecture.rod_force(ANGLES, net_force=FORCES, **rod)
    side = lecture.side_thrust(ANGLES, net_force=FORCES, **rod)
    tangential = lecture.tangential_force(ANGLES, rod_force=rod_force, **rod)
    radial = lecture.radial_force(ANGLES, rod_force=rod_force, **rod)
    assert np.hypot(FORCES, side) == pytest.approx(np.abs(rod_force), rel=1e-14)
    assert np.hypot(tangential, radial) == pytest.approx(np.abs(rod_force), rel=1e-14)


@pytest.mark.parametrize("rod", RODS)
def test_orders_add_up_to_the_truncated_inertia_force(rod):
    moving = {"reciprocating_mass": 1.5, "omega": 300.0}
    whole = lecture.inertia_force(
        reciprocating_mass=1.5,
        piston_acceleration=lecture.piston_acceleration_series(ANGLES, omega=300.0, **rod),
    )
    first = lecture.first_order_inertia_force(ANGLES, **moving, **rod)
    second = lecture.second_order_inertia_force(ANGLES, **moving, **central(rod))
    series = lecture.inertia_force_series(ANGLES, **moving, **rod)
    assert first + second == pytest.approx(whole, rel=1e-13)
    assert series == pytest.approx(whole, rel=1e-13)
    once = lecture.first_order_inertia_force(ANGLES + np.pi, **moving, **rod)
    twice = lecture.second_order_inertia_force(ANGLES + np.pi, **moving, **central(rod))
    assert once == pytest.approx(-first, rel=1e-12)
    assert twice == pytest.approx(second, rel=1e-12)


def test_textbook_thrust_and_torque():
    """Khurmi, Theory of Machines: bore 0.5, r 0.3, l 1.2 m, 250 kg, 250 rpm, 60 deg, 0.35 MPa."""
    rod = {"crank_radius": 0.3, "rod_length": 1.2}
    angle = np.pi / 3.0
    omega = lecture.angular_speed(rotational_frequency=250.0 / 60.0)
    gas = lecture.gas_force(
        gas_pressure=0.35e6, ambient_pressure=0.0, piston_area=lecture.piston_area(bore=0.5)
    )
    inertia = lecture.inertia_force(
        reciprocating_mass=250.0,
        piston_acceleration=lecture.piston_acceleration(angle, omega=omega, **rod),
    )
    net = lecture.net_force(gas_force=gas, inertia_force=inertia)
    side = lecture.side_thrust(angle, net_force=net, **rod)
    tangential = lecture.tangential_force(
        angle, rod_force=lecture.rod_force(angle, net_force=net, **rod), **rod
    )
    torque = lecture.crank_torque(tangential_force=tangential, crank_radius=0.3)
    assert side == pytest.approx(10.964e3, abs=0.5)
    assert torque == pytest.approx(14.4895e3, abs=0.05)


def test_two_masses_conserve_mass_centre_and_only_their_own_inertia():
    rod = {"rod_mass": 1.6, "rod_length": 0.15, "center_of_mass": 0.04}
    split = lecture.two_mass_rod(**rod)
    assert split.piston_pin + split.crank_pin == pytest.approx(1.6, rel=1e-15)
    assert split.piston_pin * 0.15 == pytest.approx(1.6 * 0.04, rel=1e-15)
    about_centre = split.crank_pin * 0.04**2 + split.piston_pin * 0.11**2
    assert lecture.two_mass_rod_inertia(**rod) == pytest.approx(about_centre, rel=1e-15)


def test_reduced_crank_has_the_centrifugal_force_of_its_parts():
    crank_radius, omega = 0.046, 335.0
    reduced = lecture.reduced_crank_mass(
        crank_pin_mass=0.6, web_mass=1.2, center_of_mass=0.02, crank_radius=crank_radius
    )
    parts = (0.6 * crank_radius + 2 * 1.2 * 0.02) * omega**2
    assert lecture.rotating_inertia_force(
        rotating_mass=reduced, crank_radius=crank_radius, omega=omega
    ) == pytest.approx(parts, rel=1e-14)


def test_reciprocating_and_rotating_mass_share_out_everything():
    split = lecture.two_mass_rod(rod_mass=1.6, rod_length=0.15, center_of_mass=0.04)
    whole = lecture.reciprocating_mass(piston_mass=1.1, rod_piston_pin_mass=split.piston_pin)
    whole += lecture.rotating_mass(crank_mass=1.4, rod_crank_pin_mass=split.crank_pin)
    assert whole == pytest.approx(1.1 + 1.6 + 1.4, rel=1e-15)


def test_design_masses_of_the_paper():
    """S1 Table 3 in g/cm2; its engine's 1.5423 kg reciprocate, which the diesel's ranges allow."""
    in_grams = {
        engine: [[10 * bound for bound in bounds] for bounds in grams]
        for engine, grams in {
            "carburettor": [(10, 15), (12, 20)],
            "diesel": [(20, 30), (25, 35)],
        }.items()
    }
    for engine, (piston, rod) in in_grams.items():
        assert list(lecture.SPECIFIC_MASSES[engine].piston) == piston
        assert list(lecture.SPECIFIC_MASSES[engine].rod) == rod
    diesel = lecture.SPECIFIC_MASSES["diesel"]
    area = lecture.piston_area(bore=0.08525)
    assert diesel.bore[0] <= 0.08525 <= diesel.bore[1]
    lightest, heaviest = (
        lecture.design_mass(specific_mass=diesel.piston[i], piston_area=area)
        + lecture.ROD_SHARE_PISTON_PIN[i]
        * lecture.design_mass(specific_mass=diesel.rod[i], piston_area=area)
        for i in (0, 1)
    )
    assert lightest < 1.5423 < heaviest
    assert lecture.ROD_SHARE_PISTON_PIN[0] + lecture.ROD_SHARE_CRANK_PIN[1] == 1.0
    assert lecture.ROD_SHARE_PISTON_PIN[1] + lecture.ROD_SHARE_CRANK_PIN[0] == 1.0
