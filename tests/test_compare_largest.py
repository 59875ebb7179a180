"""Largest deviations of lectures are those of the curves, within their errors."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import load_scene, simulate
from crankmbs.batch.rows import rows_of
from crankmbs.compare import LECTURES, QUANTITIES, budget, compare, largest_deviations
from validation.random_settled import random_settled

DIESEL = load_scene("propeller")
SEEDS = (50048, 50050, 50061, 50074, 50135, 50277, 50564)


def largest(scene, every="0.25 deg"):
    """By a run alone."""
    result = simulate(scene.with_(run__every=every), rtol=1e-12)
    return largest_deviations(result)


def together(scene):
    """By another formulation, which has no samples: values and errors, lectures by quantities."""
    (found,) = rows_of([scene])
    return found.columns["lecture_deviation"][0], found.columns["lecture_deviation_error"][0]


def assert_agree(scene):
    """For every lecture and quantity."""
    alone, count = largest(scene), 0
    values, errors = together(scene)
    for i, lecture in enumerate(LECTURES):
        for j, quantity in enumerate(QUANTITIES):
            one = alone.get((lecture, quantity))
            assert (one is None) == np.isnan(values[i, j]), (lecture, quantity)
            if one is not None:
                count += 1
                apart = abs(one.value - values[i, j])
                assert apart <= one.error + errors[i, j], (lecture, quantity)
    assert count > 20


@pytest.mark.parametrize("until", ["settled", "5 cycles"])
@pytest.mark.parametrize("seed", SEEDS)
def test_alone_they_agree_with_those_found_together(seed, until):
    """Pressures that jump, bend and fall within a hair are among them."""
    assert_agree(random_settled(seed).with_(run__until=until, run__every="none", run__rtol=1e-5))


@pytest.mark.slow
def test_they_are_those_of_a_comparison_between_its_samples():
    result = simulate(DIESEL.with_(run__every="0.02 deg"))
    rows = {(row.reference, row.quantity): row for row in compare(result).rows}
    found = largest(DIESEL, "2 deg")
    assert len(found) > 40
    for pair, one in found.items():
        row = rows[pair]
        assert one.value == pytest.approx(row.size.largest / row.peak, rel=2e-5), pair


def test_where_nothing_checks_the_motion_their_errors_are_unknown():
    result = simulate(DIESEL)
    alone = replace(result, motion=lambda: result.passes._replace(checks=()))
    assert {one.error for one in largest_deviations(alone).values()} == {np.inf}


@pytest.mark.parametrize("name", ["propeller", "grega_lecture", "compressor"])
def test_a_comparison_and_a_budget_have_them_between_their_samples(name):
    """Nearer than samples 1 degree apart are."""
    result = simulate(load_scene(name).with_(run__every="1 deg"))
    rows = {(row.reference, row.quantity): row for row in compare(result).rows}
    splits = {(split.reference, split.quantity): split for split in budget(result).splits}
    found, missed = largest_deviations(result), 0.0
    for pair, one in found.items():
        row = rows[pair]
        assert one.value == pytest.approx(row.size.largest / row.peak, rel=1e-4, abs=1e-9), pair
        if pair in splits and row.size.largest > 1e-6 * row.peak:
            total = splits[pair].total.size.largest / splits[pair].peak
            assert one.value == pytest.approx(total, rel=1e-4), pair
        sampled = np.max(np.abs(row.error)) / np.max(np.abs(row.values - row.error))
        missed = max(missed, abs(sampled / one.value - 1.0) if one.value > 1e-6 else 0.0)
    assert missed > 2e-4


def test_the_peak_beside_which_a_deviation_stands_is_that_of_the_run():
    result = simulate(load_scene("propeller").with_(run__every="1 deg"))
    joints = {(joint.joint, joint.number): joint.peak.value for joint in result.measures().joints}
    for found in (compare(result).rows, budget(result).splits):
        peak = {row.quantity: row.peak for row in found}
        assert peak["side thrust"] == pytest.approx(joints["side force", 1], rel=1e-6)
        # the force across the cylinder is small where that along it is largest
        assert peak["piston pin force x"] == pytest.approx(joints["piston pin", 1], rel=1e-3)


def test_a_formula_that_sums_over_the_samples_is_taken_at_them_alone():
    """Between the samples it would be another; one of the angle alone is taken there, too."""

    def side_thrust(phi, gas_force, rod_ratio):
        return gas_force * rod_ratio * np.sin(phi)

    def side_thrust_of_harmonics(phi, gas_force, rod_ratio):
        curve = side_thrust(phi, gas_force, rod_ratio)
        return np.fft.irfft(np.fft.rfft(curve)[:40], len(curve)) if len(curve) > 700 else 1.0 / 0.0

    result = simulate(load_scene("propeller").with_(run__every="1 deg"))
    functions = {f.__name__: f for f in (side_thrust, side_thrust_of_harmonics)}
    found = compare(result, functions)
    alone = found.row("side thrust", "side_thrust")
    assert alone.size.largest > np.max(np.abs(alone.error))
    harmonics = found.row("side thrust", "side_thrust_of_harmonics")
    assert harmonics.size.largest == np.max(np.abs(harmonics.error))
