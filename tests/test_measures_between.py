"""Errors of the summary measures hold what the samples miss."""

import dataclasses
import math

import numpy as np
import pytest

from crankmbs import (
    Crank,
    Motion,
    Oscillation,
    Run,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.batch.rows import rows_of
from crankmbs.digits import digits, error_digits
from crankmbs.measures import Estimate, JointForce, measure
from crankmbs.scene.parts import Gravity
from validation.adapter import reference_variables

pytestmark = pytest.mark.slow

FREE = load_scene("yi_diesel_free")
DIESEL = load_scene("propeller")
STEADY = Motion(speed=300.0)
STEPS = dataclasses.replace(
    DIESEL,
    gas=dataclasses.replace(DIESEL.gas, interpolation="step"),
    torque=(Viscous(coefficient=0.3),),
    start=Start(angle=0.2, speed=-335.0),
)


def estimates(found):
    """Every estimate of measures by its place."""
    for field in dataclasses.fields(found):
        part = getattr(found, field.name)
        rows = [part] if isinstance(part, Estimate) or not isinstance(part, tuple) else part
        for k, row in enumerate(rows):
            if isinstance(row, Estimate):
                yield f"{field.name} {k}", row
            elif isinstance(row, JointForce):
                yield f"peak {row.joint} {row.cylinder}", row.peak
                yield f"mean {row.joint} {row.cylinder}", row.mean


@pytest.mark.parametrize(
    ("base", "until", "every", "finely"),
    [
        (FREE, "1.3 cycles", "1 deg", "0.02 deg"),
        (FREE, "1.3 cycles", "5 deg", "0.02 deg"),
        (FREE, "1.3 cycles", "30 deg", "0.02 deg"),  # the firing peaks lie between the samples
        (FREE, "1.3 cycles", "2e-3 s", "2e-6 s"),
        (FREE, "0.8 cycles", "40 deg", "0.02 deg"),
        (FREE, "12 deg", "20 deg", "0.02 deg"),  # two samples: no spline says what is between
        (FREE, "40 deg", "20 deg", "0.02 deg"),
        (STEPS, "1.3 cycles", "1 deg", "0.02 deg"),
        (STEPS, "1.3 cycles", "20 deg", "0.02 deg"),
        (STEPS, "1.3 cycles", "7e-4 s", "2e-6 s"),
    ],
)
def test_every_error_covers_what_lies_between_the_samples(base, until, every, finely):
    """The truth is the same run at so many samples that what they miss hardly counts."""
    runs = [
        simulate(dataclasses.replace(base, run=Run(until=until, every=step)), rtol=rtol)
        for step, rtol in ((every, 1e-8), (finely, 1e-10))
    ]
    found, exact = (dict(estimates(measure(run))) for run in runs)
    assert found.keys() == exact.keys()
    for name, here in found.items():
        missed = abs(here.value - exact[name].value)
        assert missed <= here.error + exact[name].error, name
        assert here.error <= 10.0 * (missed + exact[name].error) + 0.01 * abs(here.value), name


def fired(*rows):
    """The propeller over three cycles under a pressure of such rows of angle [rad] and MPa."""
    table = Table(*zip(*((angle, 1e6 * pressure) for angle, pressure in rows), strict=True))
    gas = dataclasses.replace(DIESEL.gas, interpolation="linear", pressure=table)
    return dataclasses.replace(DIESEL, gas=gas).with_(crank__inertia=0.05, run__until="3 cycles")


@pytest.mark.parametrize("later", [0.0, 5e-4, 1e-3, 3e-3])
def test_errors_of_peaks_cover_a_jump_anywhere_between_two_samples(later):
    """The truth is what cells that end at the jump have."""
    at = 0.6 + later
    scene = fired((0.0, 0.1), (at, 0.1), (at, 4.0), (2.5, 0.1), (6.0, 0.1), (9.0, 0.1))
    (rows,) = rows_of([scene.with_(run__every="none")])
    for force in measure(simulate(scene.with_(run__every="0.2 deg"))).joints:
        name = f"{force.joint.replace(' ', '_')}_peak"
        exact, error = (float(rows.columns[n][0].item()) for n in (name, f"{name}_error"))
        assert 0.0 < abs(force.peak.value - exact) <= force.peak.error + error, name


@pytest.mark.parametrize("width", [1e-4, 3e-7, 0.0])
def test_a_peak_is_no_higher_before_a_pressure_that_falls_within_a_hair(width):
    """Up to where it falls, all is as where it falls slowly, but for the rounding of the angle."""
    rounded = 1e-14 * 3e6 / width * DIESEL.piston.gas_area if width else 0.0
    peaks = []
    for fall in (width, 0.5):
        rows = ((0.0, 0.1), (0.4, 6.0), (0.4 + fall, 3.0), (2.5, 0.1), (6.0, 0.1), (9.0, 0.1))
        driven = dataclasses.replace(fired(*rows), torque=(), start=None, motion=STEADY)
        forces = measure(simulate(driven)).joints
        peaks.append([force.peak for force in forces if force.joint.endswith("pin")])
    assert len(peaks[0]) == 2
    for narrow, wide in zip(*peaks, strict=True):
        assert abs(narrow.value - wide.value) <= narrow.error + wide.error + rounded


def test_a_pulse_of_a_load_between_two_samples_is_in_the_error_of_the_fluctuation():
    """To and fro within a quarter turn: the samples show little of it."""
    times = (0.0, 0.0155, 0.0155, 0.0165, 0.0165, 0.0175, 0.0175, 1.0)
    pulse = Table(times, (0.0, 0.0, 2000.0, 2000.0, -2000.0, -2000.0, 0.0, 0.0))
    base = dataclasses.replace(FREE, gas=None, torque=(TimeTable(file=pulse),))
    coarse, fine = (
        measure(simulate(dataclasses.replace(base, run=Run(until="1 cycle", every=step))))
        for step in ("90 deg", "0.25 deg")
    )
    assert fine.fluctuation.value > 0.03
    missed = abs(coarse.fluctuation.value - fine.fluctuation.value)
    assert missed <= 2.0 * coarse.fluctuation.error + fine.fluctuation.error


@pytest.mark.parametrize("width", [2e-3, 1e-5])
def test_a_pulse_of_the_pressure_between_two_samples_is_in_the_peak(width):
    """Where it is highest all but the gas force is as without it."""
    peaks = []
    for top in (6.0, 5.0):
        rows = ((0.0, 0.1), (0.4, 0.1), (0.4 + width, top), (0.4 + 2 * width, 0.1))
        table = fired(*rows, (2.5, 0.1), (6.0, 0.1), (9.0, 0.1))
        driven = dataclasses.replace(table, torque=(), start=None, motion=STEADY)
        forces = measure(simulate(driven.with_(run__every="1 deg"))).joints
        peaks.append(next(one for one in forces if one.joint == "side force"))
    assert peaks[0].cycle_angle == pytest.approx(0.4 + width, abs=1e-8)
    rod = np.arcsin(DIESEL.crank.radius / DIESEL.rod.length * np.sin(0.4 + width))
    more = 1e6 * DIESEL.piston.gas_area * np.tan(rod)
    assert peaks[0].peak.value - peaks[1].peak.value == pytest.approx(more, rel=1e-6)


def test_a_pendulum_that_swings_many_times_between_two_samples_is_measured_all_the_same():
    def swung(every):
        return dataclasses.replace(
            load_scene("coasting"),
            crank=dataclasses.replace(DIESEL.crank, inertia=1e-2, mass=5.0, center_of_mass=-0.04),
            gravity=Gravity(acceleration=9.81, angle=0.0),
            torque=(),
            start=Start(angle=2.0, speed=0.0),
            run=Run(until="3 s", every=every),
        )

    found, exact = (dict(estimates(measure(simulate(swung(e))))) for e in ("2.9 s", "1 deg"))
    for name, here in found.items():
        assert abs(here.value - exact[name].value) <= 1.05 * (here.error + exact[name].error), name
        assert here.error < 1e-6 * max(abs(here.value), 1.0), name


def test_an_error_that_nothing_checks_is_said_to_be_unknown():
    result = simulate(DIESEL.with_(run__until="1 cycle"))
    alone = result.passes._replace(checks=())
    found = measure(dataclasses.replace(result, motion=lambda: alone))
    assert found.mean_speed.error == math.inf
    assert error_digits(found.mean_speed.error) == "-"
    assert digits(*found.joints[0].peak) == digits(found.joints[0].peak.value)


def swinging(every):
    """A crank that swings about the direction in which gravity pulls its mass."""
    return dataclasses.replace(
        load_scene("coasting"),
        crank=Crank(radius=0.046, inertia=0.02, mass=5.0, center_of_mass=0.04),
        gravity=Gravity(acceleration=9.81, angle=0.74),
        torque=(),
        start=Start(angle=0.64, speed=-2.0),
        run=Run(until="2.93 s", every=every),
    )


def test_a_maximum_between_two_samples_far_from_the_largest_one_counts():
    """The piston pin's largest force, 9.8382 N, lies not beside the largest sample, 9.8356 N."""
    found, exact = (measure(simulate(swinging(every))) for every in ("20 deg", "0.1 deg"))
    here, there = (m.joints[2].peak for m in (found, exact))
    assert there.value == pytest.approx(9.838246, abs=1e-6)
    assert abs(here.value - there.value) <= here.error + there.error < 0.02
    assert found.joints[2].crank_angle == pytest.approx(exact.joints[2].crank_angle, abs=1e-4)


LAWS = {"constant": 335.0, "uneven": Oscillation(mean=335.0, amplitude=20.0, order=1.5, phase=0.3)}


@pytest.mark.parametrize("every", ["1 deg", "7.3 deg", "1e-3 s"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("place", "names"),
    [
        (0, ["main_bearing_force_x", "main_bearing_force_y"]),
        (1, ["crank_pin_force_x", "crank_pin_force_y"]),
        (2, ["piston_pin_force_x", "piston_pin_force_y"]),
        (3, ["side_force"]),
    ],
)
def test_a_peak_is_the_largest_force_of_the_motion_and_lies_where_it_is(law, every, place, names):
    """Against the oracle at 4001 angles around the peak; 13 digits of it are good."""
    motion = Motion(speed=LAWS[law])
    driven = dataclasses.replace(DIESEL, start=None, torque=(), motion=motion)
    scene = dataclasses.replace(driven, run=Run(until="1 cycle", every=every))
    row = measure(simulate(scene)).joints[place]
    assert row.peak.error < 1e-13 * row.peak.value
    theta = row.crank_angle + 1e-7 * np.arange(-2000.0, 2001.0)
    omega, alpha = np.full_like(theta, 335.0), np.zeros_like(theta)
    if law == "uneven":
        wave = 1.5 * theta + 0.3
        omega = 335.0 + 20.0 * np.cos(wave)
        alpha = -20.0 * 1.5 * np.sin(wave) * omega
    exact = reference_variables(scene, theta, omega, alpha)
    size = np.sqrt(sum(np.asarray(exact[name], dtype=float).reshape(4001) ** 2 for name in names))
    assert row.peak.value == pytest.approx(size.max(), rel=1e-13)
    assert abs(int(np.argmax(size)) - 2000) <= 3


@pytest.mark.parametrize("name", ["yi_diesel_free", "propeller", "v_twin", "coasting"])
def test_peaks_and_fluctuation_of_a_free_crank_are_as_good_as_its_motion(name):
    """Against the samples of the same run every hundredth of a degree: they miss 1e-7 at most."""
    base = load_scene(name)
    coarse, fine = (
        simulate(dataclasses.replace(base, run=Run(until="1 cycle", every=every)))
        for every in ("1 deg", "0.01 deg")
    )
    found, data = measure(coarse), fine.data
    bearing = np.hypot(data["main_bearing_force_x"], data["main_bearing_force_y"]).values.max()
    assert found.joints[0].peak.value == pytest.approx(bearing, rel=1e-7)
    assert found.joints[0].peak.value >= bearing * (1.0 - 1e-9)
    assert found.joints[0].peak.error < 1e-8 * bearing
    swing = np.ptp(data["crank_speed"].values) / found.mean_speed.value
    assert found.fluctuation.value == pytest.approx(swing, rel=1e-6)
    assert found.fluctuation.error < 1e-6 * swing
