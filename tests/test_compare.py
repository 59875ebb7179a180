"""A run against closed form and lectures: laws, known truncation errors, red on mutants."""

import csv
import dataclasses
import math

import numpy as np
import pytest

from crankmbs import Crank, Motion, Piston, Rod, Run, Scene, compare, load_scene, simulate
from crankmbs.compare import CLOSED_FORM, LECTURES, QUANTITIES, percent, save_comparison, short_name
from crankmbs.compare.size import size_of
from crankmbs.errors import InputError
from crankmbs.lecture import datum_shift

UNTRUNCATED, S0, S1 = LECTURES
ENGINES = ["yi_diesel", "yi_diesel_free", "v_twin", "grega_lecture", "compressor", "coasting"]
ROUNDING = 1e-12  # of the peak
TIGHT = 1e-4  # of the peak: what a shifted parameter must exceed


def lecture_engine(name, **parts):
    """A shipped machine under the lectures' assumptions: constant speed, two masses, no gravity."""
    base = load_scene(name)
    rod = dataclasses.replace(base.rod, inertia="two-mass")
    changed = {"rod": rod, "gravity": None, "start": None, "torque": (), **parts}
    motion, run = Motion(speed=300.0), Run(until="1 cycle")
    return dataclasses.replace(base, motion=motion, run=run, **changed)


def shares(comparison, reference):
    """Largest error over the peak, by quantity."""
    rows = [row for row in comparison.rows if row.reference == reference]
    return {row.quantity: row.size.largest / row.peak for row in rows}


def from_lecture_datum(comparison):
    """The displacement's error, less the constant between both datums, over its peak."""
    scene, row = comparison.excerpt.result.scene, comparison.row("piston displacement", UNTRUNCATED)
    shift = datum_shift(
        crank_radius=scene.crank.radius, rod_length=scene.rod.length, offset=scene.piston.offset
    )
    return float(np.max(np.abs(row.error - shift))) / row.peak


def part_shifted(scene, part, **changes):
    return dataclasses.replace(
        scene, **{part: dataclasses.replace(getattr(scene, part), **changes)}
    )


@pytest.fixture(scope="module")
def yi():
    return simulate(load_scene("yi_diesel"))


@pytest.fixture(scope="module")
def coasting():
    return dataclasses.replace(load_scene("coasting"), run=Run(until="1 rev"))


@pytest.fixture(scope="module")
def multibody(coasting):
    return simulate(part_shifted(coasting, "piston", offset=0.002), formulation="multibody")


@pytest.mark.parametrize("name", ENGINES)
def test_under_the_lectures_assumptions_the_lectures_are_exact(name):
    scene = lecture_engine(name)
    comparison = compare(simulate(scene, formulation="kinetostatic"), cylinder=len(scene.cylinders))
    found = shares(comparison, UNTRUNCATED)
    gas = {"gas torque"} if scene.gas is None else set()
    assert set(found) == set(QUANTITIES) - gas
    assert from_lecture_datum(comparison) < ROUNDING
    del found["piston displacement"]
    assert max(found.values()) < ROUNDING


@pytest.mark.parametrize(
    ("part", "changes", "quantity"),
    [
        ("rod", {"inertia": 5.5e-3}, "side thrust"),
        ("rod", {"inertia": 5.5e-3}, "torque"),
        ("gravity", None, "main bearing force x"),
        ("gravity", None, "net force"),
        ("motion", None, "torque"),
        ("motion", None, "piston acceleration"),
    ],
)
def test_without_the_lectures_assumptions_they_are_not(part, changes, quantity):
    scene = lecture_engine("coasting")
    if changes is not None:
        scene = part_shifted(scene, part, **changes)
    elif part == "gravity":
        scene = dataclasses.replace(scene, gravity=load_scene("coasting").gravity)
    else:
        swinging = {"mean": 300.0, "amplitude": 1.0, "order": 1.0}
        scene = dataclasses.replace(scene, motion=Motion(speed=swinging))
    assert shares(compare(simulate(scene)), UNTRUNCATED)[quantity] > TIGHT


@pytest.mark.parametrize(
    ("part", "changes", "quantity"),
    [
        ("crank", {"radius": 0.046 * 1.001}, "piston velocity"),
        ("crank", {"center_of_mass": 1e-3}, "main bearing force y"),
        ("rod", {"length": 0.1540}, "piston displacement"),
        ("rod", {"mass": 1.43}, "crank pin force x"),
        ("rod", {"center_of_mass": 0.0431}, "side thrust"),
        ("rod", {"inertia": 5.51e-3}, "torque"),
        ("piston", {"mass": 1.142}, "piston pin force x"),
        ("piston", {"offset": -0.002}, "piston displacement"),
        ("gravity", {"acceleration": -0.0}, "net force"),
        ("gravity", {"angle": 0.0}, "radial force"),
    ],
)
def test_a_shifted_parameter_turns_the_multibody_comparison_red(multibody, part, changes, quantity):
    own = compare(multibody)
    assert shares(own, CLOSED_FORM)[quantity] < 1e-6
    mutant = dataclasses.replace(multibody, scene=part_shifted(multibody.scene, part, **changes))
    assert shares(compare(mutant), CLOSED_FORM)[quantity] > TIGHT


def test_multibody_meets_the_closed_form_in_every_quantity(multibody):
    found = shares(compare(multibody), CLOSED_FORM)
    assert max(found.values()) < 1e-12  # exudyn's equations, solved at each sample
    assert max(found.values()) > 0.0  # with coordinates and multipliers of their own


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_other_formulations_are_the_closed_form(coasting, formulation):
    found = shares(compare(simulate(coasting, formulation=formulation)), CLOSED_FORM)
    assert max(found.values()) < ROUNDING


@pytest.mark.parametrize(
    ("quantity", "unit", "error"),
    [
        ("piston displacement", lambda r, w: r, 3.99e-3),
        ("piston velocity", lambda r, w: r * w, 5.10e-3),
        ("piston acceleration", lambda r, w: r * w**2, 1.58e-2),
    ],
)
def test_truncation_errors_are_the_catalogued_ones(yi, quantity, unit, error):
    # docstrings of crankmbs.lecture, rod ratio 0.3 and k = 0.0282
    row = compare(yi).row(quantity, S1)
    speed = 3200.0 * math.pi / 30.0
    assert row.size.largest / unit(0.046, speed) == pytest.approx(error, rel=2e-3)


def test_s0_has_the_gas_torque_exact_and_s1_truncates_it(yi):
    comparison = compare(yi)
    assert shares(comparison, S0)["gas torque"] < ROUNDING
    assert shares(comparison, S1)["gas torque"] > 1e-3


def test_the_error_is_formula_minus_run_and_the_angle_is_the_cylinders_own():
    result = simulate(lecture_engine("grega_lecture", rod=load_scene("grega_lecture").rod))
    first, third = (compare(result, cylinder=number).row("side thrust", S1) for number in (1, 3))
    comparison = compare(result, cylinder=3)
    assert np.array_equal(third.error, third.values - comparison.simulated["side thrust"])
    assert third.size[:3] == pytest.approx(
        first.size[:3], rel=1e-9
    )  # cylinders differ in phase alone
    assert int(np.argmax(np.abs(first.error))) != int(np.argmax(np.abs(third.error)))


def test_a_machine_without_gas_is_compared_but_for_the_gas_torque(coasting):
    comparison = compare(simulate(coasting))
    assert [(entry.quantity, entry.reason) for entry in comparison.left_out] == [
        ("gas torque", "the scene has no gas")
    ]
    assert "torque" in comparison.simulated


def test_a_rod_ratio_of_one_leaves_out_the_truncated_lectures_alone():
    scene = Scene(
        crank=Crank(radius=0.1, inertia=0.01),
        rod=Rod(length=0.1, mass=0.2, center_of_mass=0.05, inertia="two-mass"),
        piston=Piston(mass=0.3),
        motion=Motion(speed=10.0),
        run=Run(until="60 deg"),
    )
    comparison = compare(simulate(scene))
    assert comparison.references == (CLOSED_FORM, UNTRUNCATED)
    assert max(shares(comparison, UNTRUNCATED).values()) < ROUNDING
    left = {entry.quantity for entry in comparison.left_out if entry.what == S1}
    assert left >= {"piston displacement", "side thrust", "torque", "main bearing force x"}
    assert all("rod ratio" in entry.reason for entry in comparison.left_out if entry.what)


def test_where_the_rod_folds_nothing_is_compared():
    scene = Scene(
        crank=Crank(radius=0.1, inertia=0.01),
        rod=Rod(length=0.1, mass=0.2, center_of_mass=0.05, inertia="two-mass"),
        piston=Piston(mass=0.3),
        motion=Motion(speed=10.0),
        run=Run(until="1 rev"),
    )
    comparison = compare(simulate(scene))  # it ends at the fold, 90 degrees
    assert math.degrees(comparison.excerpt.theta[-1]) == pytest.approx(89.0)
    assert max(shares(comparison, UNTRUNCATED).values()) < 1e-8
    with pytest.raises(InputError, match="folded"):
        compare(simulate(dataclasses.replace(scene, motion=Motion(speed=10.0, angle=1.57))))


def test_a_crank_at_rest_is_compared_but_for_what_is_zero():
    run = Run(until="0.1 s", every="10 ms")
    scene = dataclasses.replace(
        load_scene("yi_diesel"), motion=Motion(speed=0.0, angle=1.0), run=run
    )
    comparison = compare(simulate(scene))
    reasons = {entry.quantity: entry.reason for entry in comparison.left_out}
    assert set(reasons) == {"piston velocity", "piston acceleration"}
    radius, length, offset = scene.running_gear[0].shape
    force = comparison.excerpt.variables["gas_force"][0, 0]

    def displacement(angle):
        aside = radius * math.sin(angle) - offset
        return -radius * math.cos(angle) - math.sqrt(length**2 - aside**2)

    lever = (displacement(1.0 + 1e-5) - displacement(1.0 - 1e-5)) / 2e-5
    assert comparison.simulated["gas torque"][0] == pytest.approx(force * lever, rel=1e-8)
    assert "zero" in reasons["piston velocity"]
    assert shares(comparison, UNTRUNCATED)["side thrust"] < ROUNDING


def test_what_does_not_exist_is_named(yi):
    with pytest.raises(InputError, match="cylinder must be from 1 to 1; 2 came"):
        compare(yi, cylinder=2)
    with pytest.raises(InputError, match=r'no "thrust" here; did you mean "side thrust"[?] The'):
        compare(yi).row("thrust")
    known = r'"Greg" here; did you mean "Grega"[?] There are "Grega", "closed form", "untruncated l'
    with pytest.raises(InputError, match=known):
        compare(yi).row("side thrust", "Greg")


def test_a_row_is_taken_by_what_its_table_says(yi):
    comparison = compare(yi)
    names = {short_name(row.reference): row.reference for row in comparison.rows}
    assert len(names) == 4
    for printed, name in names.items():
        row = comparison.row("side thrust", name)
        assert comparison.row("side thrust [N]", printed) is row
        assert row.reference == name


def test_the_file_says_what_the_rows_say(yi, tmp_path):
    comparison = compare(yi)
    with save_comparison(comparison, tmp_path).open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert len(lines) == len(comparison.rows) == 4 * len(QUANTITIES)
    (line,) = (
        line
        for line in lines
        if (line["quantity"], line["reference"]) == ("side thrust", UNTRUNCATED)
    )
    row = comparison.row("side thrust", UNTRUNCATED)
    assert float(line["max"]) == pytest.approx(297.1, abs=0.05)
    assert float(line["rms"]) == pytest.approx(row.size.rms, rel=1e-11)
    assert float(line["max_percent"]) == pytest.approx(percent(row.size.largest, row.peak))
    assert (line["unit"], line["cylinder"], line["angle_deg"]) == ("N", "1", "270")


def test_a_size_has_its_maximum_its_angle_and_its_rms_over_the_angle():
    angle = 2.0 * math.pi * np.linspace(0.0, 1.0, 4001) ** 2  # uneven: denser at the start
    size = size_of(-3.0 * np.sin(angle), angle + 4.0 * math.pi, 4.0 * math.pi)
    assert size.largest == pytest.approx(3.0, rel=1e-6)
    assert size.rms == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-6)
    assert size.angle == pytest.approx(0.5 * math.pi, abs=2e-3)


def test_of_equal_maxima_the_first_in_the_cycle_counts():
    angle = np.linspace(0.0, 4.0 * math.pi, 9)
    curve = np.cos(angle)
    curve[-1] += 1e-12  # what rounding may do
    assert size_of(curve, angle, 4.0 * math.pi).angle == 0.0


def test_a_curve_of_zeros_and_a_single_sample_have_sizes():
    assert size_of(np.zeros(3), np.arange(3.0), 1.0)[:2] == (0.0, 0.0)
    assert size_of(np.array([-2.0]), np.array([7.0]), 4.0) == (2.0, 2.0, 3.0)
    assert math.isnan(percent(1.0, 0.0))
