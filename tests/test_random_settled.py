"""Random settled motions: no true error exceeds twice the stated one, seeds fixed beforehand."""

import pytest

from crankmbs import simulate
from validation.checks.settled import stated_ratio
from validation.random_settled import random_settled

pytestmark = pytest.mark.slow

SEEDS = range(1000, 1040)
LONG = {1001, 1019, 1026, 1028, 1029, 1031}  # of which the oracle takes up to half a minute
LONG_OF_MINIMAL = {1002, 1004, 1006, 1008}  # several seconds each


def marked(seeds, long):
    return [pytest.param(one, marks=pytest.mark.long if one in long else ()) for one in seeds]


@pytest.mark.parametrize("seed", marked(SEEDS, LONG))
def test_errors_are_honest(seed):
    scene = random_settled(seed)
    result = simulate(scene, formulation="crank_angle")
    assert result.status == 0, result.message
    ratio, said = stated_ratio(result, scene)
    assert ratio <= 2.0, said


@pytest.mark.parametrize("seed", marked(SEEDS[2:10], LONG_OF_MINIMAL))
def test_those_of_minimal_too(seed):
    scene = random_settled(seed)
    result = simulate(scene, formulation="minimal")
    assert result.status == 0, result.message
    ratio, said = stated_ratio(result, scene)
    assert ratio <= 2.0, said
