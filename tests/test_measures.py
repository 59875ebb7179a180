"""Summary measures against closed forms, brute-force sums over own formulas, and laws."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from crankmbs import Motion, Oscillation, Ramp, Run, load_scene, simulate
from crankmbs.errors import InputError
from crankmbs.measures import Estimate, last_span, measure, orders
from crankmbs.measures.names import names_of, values_of
from crankmbs.scene.parts import Friction

RPM = math.pi / 30.0
RINGS = Friction(ring_force=30.0, viscous=5.0)
DIESEL = load_scene("propeller")  # one fired cylinder; its motion is prescribed here
SPEED = 3200.0 * RPM


def scene(speed=SPEED, *, until="2 cycles", every="1 deg", angle=0.0, base=DIESEL, **parts):
    return dataclasses.replace(
        base,
        start=None,
        torque=(),
        motion=Motion(speed=speed, angle=angle),
        run=Run(until=until, every=every),
        **parts,
    )


@pytest.fixture(scope="module")
def constant():
    return simulate(scene())


def test_constant_speed_is_its_own_mean_and_does_not_fluctuate(constant):
    found = measure(constant)
    assert found.window.kind == "last cycle"
    assert found.window.duration == pytest.approx(4.0 * math.pi / SPEED, rel=1e-13)
    assert found.mean_speed.value == pytest.approx(SPEED, rel=1e-13)
    assert found.fluctuation.value == 0.0
    assert found.fluctuation.error < 1e-11
    assert found.energy_closure < 1e-11


def test_oscillating_speed_has_its_prescribed_fluctuation_and_time_mean():
    law = Oscillation(mean=300.0, amplitude=30.0, order=2.0)
    found = measure(simulate(scene(law)))
    # time mean: 2 pi over the integral of d(theta) / (m + a cos(2 theta)) = sqrt(m^2 - a^2)
    mean = math.sqrt(300.0**2 - 30.0**2)
    assert found.mean_speed.value == pytest.approx(mean, rel=1e-12)
    assert abs(found.fluctuation.value - 60.0 / mean) <= found.fluctuation.error


@pytest.mark.parametrize("every", ["1 deg", "7 deg", "1e-4 s", "1500 deg"])
def test_a_motion_that_speeds_up_gains_as_the_law_says(every):
    """At constant acceleration omega^2 grows by 2 alpha theta; the cycle begins between samples."""
    found = measure(simulate(scene(Ramp(start=100.0, to=600.0, over=10.0), every=every)))
    end = math.sqrt(100.0**2 + 2.0 * 50.0 * 8.0 * math.pi)
    gained = end - math.sqrt(100.0**2 + 2.0 * 50.0 * 4.0 * math.pi)
    assert abs(found.speed_gain.value - gained) <= found.speed_gain.error
    assert found.speed_gain.error < (2e-3 if every != "1500 deg" else 1.0) * gained


@pytest.mark.parametrize("until", ["3 cycles", "0.1 s"])
def test_without_output_spacing_the_last_cycle_is_whole(until):
    """Also where it begins between two samples."""
    found, usual = (measure(simulate(scene(until=until, every=e))) for e in ("none", "1 deg"))
    assert found.window.kind == usual.window.kind == "last cycle"
    assert found.imep[0].value == pytest.approx(usual.imep[0].value, rel=1e-9)
    assert found.window.begin == pytest.approx(usual.window.begin, rel=1e-12)


def test_a_joint_force_is_the_magnitude_of_its_components(constant):
    last = constant.data.isel(time=slice(-721, None))
    x, y = (last[f"crank_pin_force_{axis}"].values[:, 0] for axis in "xy")
    size, time = np.hypot(x, y), last["time"].values
    (pin,) = (joint for joint in measure(constant).joints if joint.joint == "crank pin")
    assert size.max() <= pin.peak.value <= 1.005 * size.max()  # it lies between two samples
    mean = np.trapezoid(size, time) / (time[-1] - time[0])
    assert pin.mean.value == pytest.approx(mean, rel=1e-4)


def test_energy_closure_is_the_largest_residual_over_the_peak_of_the_kinetic_energy(constant):
    data = constant.data.copy(deep=True)
    data["energy_residual"][7] = -0.25 * float(data["kinetic_energy"].max())
    found = measure(dataclasses.replace(constant, data=data))
    assert found.energy_closure == pytest.approx(0.25, rel=1e-12)


def test_a_periodic_motion_gains_no_speed(constant):
    found = measure(constant)
    assert abs(found.speed_gain.value) <= found.speed_gain.error < 1e-10


@pytest.mark.parametrize(
    ("until", "angle", "kind", "turned"),
    [
        ("2 cycles", 0.0, "last cycle", 720.0),
        ("720 deg", 0.1, "last cycle", 720.0),
        ("719 deg", 0.0, "last revolution", 360.0),
        ("360 deg", 0.3, "last revolution", 360.0),
        ("300 deg", 0.0, "whole run", 300.0),
    ],
)
def test_window_is_the_last_cycle_else_revolution_else_the_run(until, angle, kind, turned):
    window = last_span(simulate(scene(until=until, angle=angle)))
    assert window.kind == kind
    assert math.degrees(window.angle) == pytest.approx(turned, rel=1e-14)
    assert window.duration == pytest.approx(math.radians(turned) / SPEED, rel=1e-12)


@pytest.mark.parametrize("speed", [SPEED, -SPEED])
def test_window_may_begin_between_two_samples(speed):
    law = Oscillation(mean=speed, amplitude=20.0, order=0.5)
    even = measure(simulate(scene(law, every="1 deg", until="1440 deg")))
    uneven = measure(simulate(scene(law, every="0.7 deg", until="1440 deg")))
    assert uneven.window.inside == uneven.window.first + 1
    assert uneven.window.begin == pytest.approx(even.window.begin, rel=1e-9)
    assert uneven.mean_speed.value == pytest.approx(even.mean_speed.value, rel=1e-9)


def indicated_work():
    """Integral of p dV over the scene's rows, by midpoints on a fine grid."""
    rows = DIESEL.gas.pressure
    angle = np.append(rows.x, rows.x[0] + 4.0 * math.pi)
    pressure = CubicSpline(angle, np.append(rows.y, rows.y[0]), bc_type="periodic")
    fine = np.linspace(angle[0], angle[-1], 20001)
    r, l = DIESEL.crank.radius, DIESEL.rod.length
    x = r * np.cos(fine) + np.sqrt(l**2 - (r * np.sin(fine)) ** 2)
    p = pressure(0.5 * (fine[1:] + fine[:-1]))
    return -DIESEL.piston.area * float(np.sum(p * np.diff(x)))


def test_indicated_power_and_imep_are_the_area_of_the_indicator_diagram(constant):
    found, work = measure(constant), indicated_work()
    displaced = DIESEL.piston.area * 2.0 * DIESEL.crank.radius
    assert found.imep[0].value == pytest.approx(work / displaced, rel=1e-5)
    assert found.indicated_work.value == pytest.approx(work, rel=1e-5)
    assert names_of(found.scene)["indicated_work"].words == "indicated work per cycle"
    assert found.indicated_power.value == pytest.approx(work * SPEED / (4 * math.pi), rel=1e-5)


def test_imep_does_not_depend_on_the_speed_law(constant):
    uneven = measure(simulate(scene(Oscillation(mean=250.0, amplitude=50.0, order=1.5))))
    (here,), (there,) = measure(constant).imep, uneven.imep
    assert abs(here.value - there.value) <= here.error + there.error
    assert here.error < 1e-3 * here.value


@pytest.mark.parametrize("every", ["100 deg", "4 deg", "0.3e-3 s"])
def test_it_does_not_depend_on_the_samples(every):
    (found,) = measure(simulate(scene(every=every))).imep
    (exact,) = measure(simulate(scene(every="0.125 deg"))).imep
    assert abs(found.value - exact.value) <= found.error + exact.error
    assert found.error < 1e-12 * found.value


def test_power_flow_closes_over_a_cycle_of_constant_speed(constant):
    found = measure(constant)
    balance = found.indicated_power.value + found.external_torque.value * SPEED
    error = found.indicated_power.error + found.external_torque.error * SPEED
    assert abs(balance) <= error < 1e-3 * found.indicated_power.value
    sum_error = found.crank_torque.error + found.external_torque.error
    assert abs(found.crank_torque.value + found.external_torque.value) <= sum_error


def test_four_cylinders_give_four_times_the_power_and_their_own_peaks(constant):
    layout = type(DIESEL.layout)(firing_order=(1, 3, 4, 2))
    found = measure(simulate(scene(layout=layout, gravity=None)))
    single = measure(simulate(scene(gravity=None)))
    power, part = found.indicated_power, single.indicated_power
    assert abs(power.value - 4.0 * part.value) <= power.error + 4.0 * part.error
    names = [(row.joint, row.cylinder) for row in found.joints]
    assert names[:2] == [("main bearing", None), ("crank pin", 1)]
    assert len(names) == len(set(names)) == 13
    pins = [row for row in found.joints if row.joint == "crank pin"]
    (alone,) = [row for row in single.joints if row.joint == "crank pin"]
    for pin in pins:
        assert pin.cycle_angle == pytest.approx(alone.cycle_angle, abs=1e-7)
        assert pin.peak.value == pytest.approx(alone.peak.value, rel=1e-9)
    at = {round(math.degrees(pin.crank_angle)) % 720 for pin in pins}
    assert len(at) == 4


@pytest.mark.parametrize(("every", "most"), [("3 deg", 0.05), ("1 deg", 4e-3), ("0.7 deg", 1e-3)])
def test_peak_between_samples_stays_within_the_stated_error(every, most):
    coarse = measure(simulate(scene(every=every)))
    fine = measure(simulate(scene(every="0.01 deg", until="1 cycles")))
    for found, exact in zip(coarse.joints, fine.joints, strict=True):
        assert found.peak.value <= exact.peak.value + exact.peak.error
        assert exact.peak.value - found.peak.value <= 2.0 * found.peak.error
        assert found.peak.error <= most * found.peak.value


def test_without_gas_there_is_no_indicated_power():
    found = measure(simulate(scene(base=load_scene("coasting"))))
    assert found.indicated_power is None
    assert found.imep is None


def test_less_than_a_cycle_has_power_but_no_imep():
    found = measure(simulate(scene(until="400 deg")))
    assert found.imep is None
    assert found.indicated_power is not None


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_orders_find_amplitude_and_phase_of_a_prescribed_oscillation(sense):
    law = Oscillation(mean=sense * 300.0, amplitude=12.0, order=1.5, phase=0.7)
    found = orders(simulate(scene(law, angle=0.2)), "crank_speed", highest=4.0)
    assert found.order.tolist() == [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]
    assert float(found.mean) == pytest.approx(sense * 300.0, rel=1e-12)
    expected = np.where(found.order == 1.5, 12.0, 0.0)
    assert found.amplitude == pytest.approx(expected, abs=1e-9)
    assert found.phase[2] == pytest.approx(0.7, abs=1e-9)


def test_orders_of_a_cylinder_count_from_its_own_cycle_angle():
    layout = type(DIESEL.layout)(firing_order=(1, 3, 4, 2))
    found = orders(simulate(scene(layout=layout, angle=0.4)), "gas_force")
    assert found.amplitude.shape == (24, 4)
    for k in range(1, 4):
        assert found.amplitude[:, k] == pytest.approx(found.amplitude[:, 0], rel=1e-9)
        assert np.cos(found.phase[:, k] - found.phase[:, 0]) == pytest.approx(1.0, abs=1e-9)


def test_orders_of_uneven_samples_agree_with_those_of_even_ones(constant):
    uneven = simulate(scene(until="2 cycles", every="1e-4 s"))
    here, there = orders(constant, "side_force"), orders(uneven, "side_force")
    assert here.amplitude == pytest.approx(there.amplitude, rel=0.0, abs=1e-12 * 5e3)


@pytest.mark.parametrize(
    ("until", "name", "highest", "message"),
    [
        ("1 rev", "crank_speed", 12.0, "run.until: .* one whole cycle, 2 rev .* turns 1 rev"),
        ("1 cycle", "crank_sped", 12.0, "no variable"),
        ("1 cycle", "crank_speed", 180.0, "from 0.5 to 100"),
        ("1 cycle", "crank_speed", 0.2, "from 0.5 to 100"),
    ],
)
def test_orders_that_cannot_be_are_refused(until, name, highest, message):
    with pytest.raises(InputError, match=message):
        orders(simulate(scene(until=until)), name, highest)


def test_mean_torque_is_work_per_angle():
    """Rods and load together change the crank's own kinetic energy, nothing else."""
    scene = load_scene("propeller")
    result = simulate(scene)
    sums = measure(result)
    end, gain = float(result.data["crank_speed"].values[-1]), sums.speed_gain
    gained = scene.crank.inertia * gain.value * (end - 0.5 * gain.value)
    worked = (sums.crank_torque.value + sums.external_torque.value) * sums.window.angle
    error = (sums.crank_torque.error + sums.external_torque.error) * sums.window.angle
    assert abs(worked - gained) <= error + scene.crank.inertia * end * gain.error
    assert error < 1e-3 * abs(sums.crank_torque.value * sums.window.angle)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("friction", {"run__until": "3 cycles"}),
        ("propeller", {"torque": (), "gas": None, "friction": RINGS, "run__until": "4 cycles"}),
        ("compressor", {}),
        ("steam_engine", {"run__until": "2 cycles"}),
    ],
)
def test_powers_balance_with_what_the_moving_parts_gain(name, changes):
    """What gas gives goes to friction, to the loads and into kinetic energy."""
    measures = simulate(load_scene(name).with_(**changes)).measures()
    power = {key: each for key, (each, *_) in values_of(measures).items() if "power" in key}
    parts = [power[key] for key in ("friction_power", "kinetic_power") if key in power]
    left = sum(part.value for part in parts) + power["brake_power"].value
    gas = power.get("indicated_power", Estimate(0.0, 0.0))
    allowed = sum(part.error for part in (*parts, power["brake_power"], gas))
    assert abs(gas.value - left) <= allowed
    assert allowed < 1e-8 * sum(abs(part.value) for part in (*parts, gas))
