"""The gas: interpolation against the oracle's, periods, knots, and the value at a step."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from crankmbs import Cylinder, Gas, Layout, Table, load_scene
from crankmbs.mechanics.pressure import pressures_of, repeat
from crankmbs.mechanics.train import CrankTrain, crank_angle_knots, crank_train
from validation.adapter import machine_of
from validation.oracles.pressure import evaluate_pressure

ROWS = Table((0.3, 0.3003, 2.0, 3.5, 6.0, 9.0, 12.4), (2e5, 5e5, 9e5, 1e5, -2e4, -2e4, 3e4))
BASE = load_scene("propeller")
KINDS = ("step", "linear", "pchip", "cubic")


def with_gas(**changes):
    return replace(BASE, gas=Gas(**{"pressure": ROWS, "absolute": False, **changes}))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("zero", ["gas_exchange_tdc", "firing_tdc"])
def test_interpolation(kind, zero):
    scene = with_gas(interpolation=kind, zero=zero)
    angle = np.linspace(-30.0, 30.0, 2003)
    ours = pressures_of(scene)[0](angle)
    exact = evaluate_pressure(machine_of(scene).pressure, angle.astype(np.longdouble))
    assert np.abs(ours - exact.astype(float)).max() < 1e-12 * np.abs(ours).max()


@pytest.mark.parametrize("kind", KINDS)
def test_the_rows_are_met_and_the_period_closes(kind):
    pressure = pressures_of(with_gas(interpolation=kind))[0]
    for turns in (0, 1, -3):
        angle = np.array(ROWS.x) + 4 * pi * turns
        np.testing.assert_allclose(pressure(angle), ROWS.y, rtol=1e-9, atol=1e-6)
    assert pressure.period == pytest.approx(4 * pi, rel=1e-15)


def test_pchip_does_not_overshoot_across_the_periods_end():
    pressure = pressures_of(with_gas(interpolation="pchip"))[0]
    values = pressure(np.linspace(12.4, 0.3 + 4 * pi, 500))
    assert values.min() == pytest.approx(3e4)
    assert np.all(np.diff(values) >= 0.0)


def test_a_closing_row_changes_nothing():
    closed = Table((*ROWS.x, 0.3 + 4 * pi), (*ROWS.y, ROWS.y[0]))
    for kind in KINDS:
        ours, others = (
            pressures_of(with_gas(pressure=rows, interpolation=kind))[0] for rows in (ROWS, closed)
        )
        np.testing.assert_array_equal(ours.coefficients, others.coefficients)


def test_ambient_is_subtracted():
    positive = Table(ROWS.x, tuple(abs(y) for y in ROWS.y))
    absolute = with_gas(pressure=positive, absolute=True, ambient=1e5)
    gauge = with_gas(pressure=positive)
    difference = pressures_of(gauge)[0](0.7) - pressures_of(absolute)[0](0.7)
    assert difference == pytest.approx(1e5, rel=1e-12)


@pytest.mark.parametrize("hair", [0.0, 1e-15, -1e-15])
def test_at_a_step_the_value_after_it_counts(hair):
    pressure = pressures_of(with_gas(interpolation="step"))[0]
    for angle, value in zip(ROWS.x, ROWS.y, strict=True):
        assert pressure(angle + hair) == value
        assert pressure(angle + hair - 8 * pi) == value


def test_no_gas_no_pressure():
    assert pressures_of(load_scene("coasting")) is None
    assert len(crank_angle_knots(CrankTrain(load_scene("coasting"), None))) == 0


def test_knots_of_every_cylinder_once():
    cylinders = (Cylinder(), Cylinder(phase=1.0, bank=1.0), Cylinder(phase=4 * pi))
    scene = replace(with_gas(), layout=Layout(cylinders=cylinders))
    knots = crank_angle_knots(crank_train(scene))
    expected = np.sort(np.concatenate([ROWS.x, np.mod(np.array(ROWS.x) - 1.0, 4 * pi)]))
    np.testing.assert_allclose(knots, expected, atol=1e-12)


def test_repeat():
    found = repeat(np.array([0.5, 2.0]), 3.0, -2.5, 5.0)
    np.testing.assert_allclose(found, [-1.0, 0.5, 2.0, 3.5])
    assert len(repeat(np.empty(0), 3.0, 0.0, 9.0)) == 0


def test_cubics_that_runs_share_cannot_be_written_to():
    one, again = (pressures_of(load_scene("propeller"))[0] for _ in range(2))
    assert one.coefficients is again.coefficients
    for shared in (one.knots, one.coefficients):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 1.0
