"""Errors of the summary measures hold what the samples miss."""

import dataclasses
import math

import pytest

from crankmbs import Run, Start, Table, TimeTable, Viscous, load_scene, simulate
from crankmbs.digits import digits, error_digits
from crankmbs.machine import Gravity
from crankmbs.measures import Estimate, JointForce, measure

FREE = load_scene("yi_diesel_free")
DIESEL = load_scene("propeller")
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
        for k, row in enumerate(part if isinstance(part, tuple) else [part]):
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
        assert missed <= 2.0 * here.error + exact[name].error, name
        assert here.error <= 10.0 * (missed + exact[name].error) + 0.01 * abs(here.value), name


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


def test_an_error_that_the_samples_cannot_tell_is_said_to_be_unknown():
    """A pendulum that swings many times from one sample to the next."""
    swinging = dataclasses.replace(
        load_scene("coasting"),
        crank=dataclasses.replace(DIESEL.crank, inertia=1e-2, mass=5.0, center_of_mass=-0.04),
        gravity=Gravity(acceleration=9.81, angle=0.0),
        torque=(),
        start=Start(angle=2.0, speed=0.0),
        run=Run(until="3 s", every="2.9 s"),
    )
    found = measure(simulate(swinging))
    assert found.mean_speed.error == math.inf
    assert error_digits(found.mean_speed.error) == "-"
    assert digits(*found.joints[0].peak) == digits(found.joints[0].peak.value)
