"""Largest deviations of lectures are those of the curves, within their errors."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import load_scene, simulate
from crankmbs.batch.rows import rows_of
from crankmbs.compare import LECTURES, QUANTITIES, compare, largest_deviations
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
