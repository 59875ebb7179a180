"""Two rows at one angle are a jump; a closing row unlike the first; a spline that overshoots."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from references import worst_ratio
from turned import turned

from crankmbs import Gas, InputError, Motion, Run, Start, Table, load_scene, simulate
from crankmbs.mechanics.pressure import pressures_of, remarks
from validation.adapter import machine_of
from validation.oracles.arithmetic import distance, multiprecision
from validation.oracles.pressure import evaluate_pressure

BASE = load_scene("propeller")
KINDS = ("step", "linear", "pchip", "cubic")
BAR = 1e5


def rows(*pairs):
    """A table from pairs of angle [deg] and pressure [bar]."""
    angle, pressure = np.array(pairs, dtype=float).T
    return Table(np.radians(angle), BAR * pressure, source="rows.csv")


def with_gas(table, **changes):
    return replace(BASE, gas=Gas(**{"pressure": table, "absolute": False, **changes}))


OPEN = ((180, 2), (300, 8), (360, 20), (380, 40), (420, 20), (500, 5), (600, 1.5))
FIRED = ((180, 2), (300, 8), (360, 20), (360, 60), (380, 45), (420, 20), (500, 5), (600, 1.5))
TABLES = {
    "inside": rows((0, 1), (90, 1.2), *FIRED),
    "two, one of them at the end": rows((0, 1.2), *FIRED, (720, 1.5), (720, 1.2)),
    "where the period begins": rows((0, 1), (0, 1.2), *OPEN),
    "where it begins, closed": rows((0, 1), (0, 1.2), *OPEN, (720, 1)),
    "where it ends": rows((0, 1.2), *OPEN, (720, 1), (720, 1.2)),
    "where it begins and ends": rows((0, 1), (0, 1.2), *OPEN, (720, 1), (720, 1.2)),
    "two rows, then three": rows((0, 1), (0, 2), (180, 8), (180, 4), (360, 3), (420, 2), (420, 5)),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("zero", ["gas_exchange_tdc", "firing_tdc"])
@pytest.mark.parametrize("name", TABLES)
def test_interpolation_runs_from_jump_to_jump(name, zero, kind):
    scene = with_gas(TABLES[name], interpolation=kind, zero=zero)
    angle = np.linspace(-30.0, 30.0, 2003)
    ours = pressures_of(scene)[0](angle)
    exact = evaluate_pressure(machine_of(scene).pressure, angle.astype(np.longdouble))
    assert np.abs(ours - exact.astype(float)).max() < 1e-12 * np.abs(ours).max()


@pytest.mark.parametrize("kind", KINDS)
def test_the_oracle_agrees_in_both_arithmetics(kind):
    table = machine_of(with_gas(TABLES["inside"], interpolation=kind)).pressure
    wide, at = multiprecision(40), np.linspace(-9.0, 15.0, 50)
    long = evaluate_pressure(table, at.astype(np.longdouble))
    exact = evaluate_pressure(table, wide.array(at), wide)
    assert max(map(distance, long, exact)) < 2e-18 * 60 * BAR


@pytest.mark.parametrize("kind", KINDS[1:])
@pytest.mark.parametrize(
    ("name", "at", "before", "after"),
    [
        ("inside", 360.0, 20.0, 60.0),
        ("two, one of them at the end", 720.0, 1.5, 1.2),
        ("where the period begins", 0.0, 1.0, 1.2),
        ("where it begins, closed", 720.0, 1.0, 1.2),
        ("where it ends", -720.0, 1.0, 1.2),
        ("two rows, then three", 420.0, 2.0, 5.0),
    ],
)
def test_at_a_jump_the_second_value_counts_and_the_first_just_below(name, at, before, after, kind):
    pressure = pressures_of(with_gas(TABLES[name], interpolation=kind))[0]
    assert pressure(np.radians(at)) == pytest.approx(after * BAR, rel=1e-12)
    assert pressure(np.radians(at) - 1e-8) == pytest.approx(before * BAR, rel=1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_the_ways_to_write_a_jump_at_the_periods_end_are_one(kind):
    angle = np.linspace(0.0, 4.0 * pi, 500)
    ways = [name for name in TABLES if name.startswith("where")]
    found = [pressures_of(with_gas(TABLES[name], interpolation=kind))[0](angle) for name in ways]
    assert np.ptp(found, axis=0).max() == 0.0


def test_nothing_is_smeared_over_a_jump():
    """Two constants stay constant, whatever joins the rows."""
    square = rows((0, 5), (90, 5), (180, 5), (180, 1), (300, 1), (500, 1), (720, 1), (720, 5))
    angle = np.linspace(0.0, 4.0 * pi, 1000)
    found = pressures_of(with_gas(square, interpolation="cubic"))[0](angle)
    expected = np.where(np.mod(angle, 4.0 * pi) < pi - 1e-9, 5.0, 1.0)
    np.testing.assert_allclose(found, BAR * expected, rtol=1e-12)


CYCLE = rows(
    *[(0, -0.02), (90, -0.05), (150, -0.05), (180, 0), (240, 0.3), (300, 2), (340, 8), (360, 21)],
    *[(360, 58), (372, 50), (400, 22), (450, 7), (500, 3.4), (540, 2.5), (540, 0.4), (600, 0.1)],
    *[(660, 0.05), (720, 0.06), (720, -0.02)],
)
SHORT = Run(until="700 deg", every="13 deg")  # no sample on a row: there two values are right


@pytest.mark.slow
@pytest.mark.parametrize("speed", [335.0, -335.0])
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_error_is_honest_with_jumps(kind, formulation, speed):
    scene = with_gas(CYCLE, interpolation=kind)
    scene = replace(scene, start=Start(angle=0.0, speed=speed), run=SHORT)
    result = simulate(scene, formulation=formulation)
    assert result.status == 0
    assert result.error.estimated <= scene.run.rtol
    assert worst_ratio(result) <= 2.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["pchip", "cubic"])
def test_the_error_of_multibody_is_honest_with_jumps(kind):
    scene = replace(with_gas(CYCLE, interpolation=kind), run=SHORT)
    result = simulate(scene, formulation="multibody", cost_cap=60.0)
    assert result.status == 0
    assert result.error.estimated <= 1e-5
    assert worst_ratio(result) <= 2.0


@pytest.mark.parametrize("kind", KINDS)
def test_the_error_is_honest_with_jumps_at_a_prescribed_speed(kind):
    scene = with_gas(CYCLE, interpolation=kind)
    motion = Motion(speed="3000 rpm")
    result = simulate(replace(scene, start=None, motion=motion, torque=(), run=SHORT))
    assert result.formulation == "kinetostatic"
    assert worst_ratio(result) <= 2.0


MEASURED = ((0, 1.0), (180, 1.5), (360, 3.0), (540, 2.0))  # a range of 2 bar


@pytest.mark.parametrize(("last", "closing"), [(1.019, None), (1.3, "0.31 bar"), (0.8, 2.1e4)])
def test_a_closing_row_near_the_first_is_dropped_and_said(last, closing):
    scene = with_gas(rows(*MEASURED, (720, last)), closing=closing)
    plain = with_gas(rows(*MEASURED))
    ours, others = (pressures_of(one)[0].coefficients for one in (scene, plain))
    np.testing.assert_array_equal(ours, others)
    apart = abs(last - 1.0)
    said = f"rows.csv: the closing row, {apart:.3g} bar from the first one, is dropped"
    assert remarks(scene) == (said,)
    result = simulate(replace(scene, run=Run(until="30 deg", every="10 deg")))
    assert said in result.reasons
    assert remarks(plain) == ()


@pytest.mark.parametrize(
    ("last", "closing", "limit"),
    [
        (1.021, None, "it lies 0.021 bar from it, more than 0.02 bar (1 % of the range)"),
        (1.01, "0.5 kPa", "it lies 0.01 bar from it, more than 0.005 bar (closing)"),
        (1.01, 0, "it lies 0.01 bar from it, more than 0 bar (closing)"),
    ],
)
def test_a_closing_row_far_from_the_first_is_refused_with_the_ways_out(last, closing, limit):
    with pytest.raises(InputError) as caught:
        with_gas(rows(*MEASURED, (720, last)), closing=closing)
    assert str(caught.value) == (
        "rows.csv: the closing row, at 720 degrees, must equal the first one, as the pressure is "
        f"periodic; {limit}; drop the row, raise closing, or give two rows at 720 degrees for a "
        "jump"
    )


def test_both_rows_of_a_jump_at_the_end_must_close():
    table = rows((0, 1), (0, 3), (180, 1.5), (360, 3), (540, 2), (720, 1.5), (720, 3))
    with pytest.raises(InputError, match=r"it lies 0\.5 bar from it"):
        with_gas(table)


def test_the_demo_presses_the_closing_row_too():
    scene = with_gas(rows(*MEASURED, (720, 1.3)), closing="0.31 bar")
    assert turned(scene, {"pressure": 200.0}).gas.closing == pytest.approx(0.62 * BAR)


def beside(distance, rise):
    """Benchmark B's table with a row added, [deg] and of the peak behind another."""
    table = BASE.gas.pressure
    angle, pressure = np.degrees(table.x), np.array(table.y)
    angle = np.insert(angle, 10, angle[9] + distance)
    return with_gas(
        Table(np.radians(angle), np.insert(pressure, 10, pressure[9] + rise * pressure.max())),
        interpolation="cubic",
    )


@pytest.mark.parametrize("distance", [1e-6, 1e-3])
def test_a_spline_that_overshoots_is_warned_of(distance):
    """Two rows 1e-6 degrees apart that differ by 1e-6 of the peak move the speed by 3 %."""
    scene = beside(distance, distance)
    (warning,) = remarks(scene)
    assert warning.startswith("warning: table: between the rows at ")
    assert "% of the table's range beyond both" in warning
    run = Run(until="30 deg", every="10 deg")
    assert warning in simulate(replace(scene, run=run)).reasons
    assert remarks(replace(scene, gas=replace(scene.gas, interpolation="pchip"))) == ()


def test_the_size_of_an_overshoot_and_its_rows():
    """Flat tops of three rows: what sampling finds."""
    table = rows(*((60 * k - 180, 10 * (k % 6 < 3)) for k in range(12)))
    scene = with_gas(table, interpolation="cubic")
    (warning,) = remarks(scene)
    angle = np.linspace(0.0, 4.0 * pi, 100_001)
    share = (pressures_of(scene)[0](angle).max() / BAR - 10.0) / 10.0
    assert f"the spline goes {100.0 * share:.3g} % of the table's range beyond both" in warning


@pytest.mark.parametrize("apart", [30.0, 45.0])
def test_a_coarse_but_smooth_table_is_no_overshoot(apart):
    """The top of a sine lies between two rows: at most 0.04 of the range above them."""
    angle = np.arange(0.5 * apart, 720.0, apart)
    table = Table(np.radians(angle), 3.0 + np.cos(np.radians(angle)))
    assert remarks(with_gas(table, interpolation="cubic")) == ()


def test_a_constant_spline_does_not_overshoot():
    assert (
        remarks(with_gas(rows((0, 5), (200, 5), (400, 5), (600, 5)), interpolation="cubic")) == ()
    )
