"""Random settled motions: no true error exceeds twice the stated one, seeds fixed beforehand."""

import pytest

from crankmbs import simulate
from validation.checks.settled import stated_ratio
from validation.random_settled import random_settled

pytestmark = pytest.mark.slow

SEEDS = range(1000, 1040)


@pytest.mark.parametrize("seed", SEEDS)
def test_errors_are_honest(seed):
    scene = random_settled(seed)
    result = simulate(scene, formulation="crank_angle")
    assert result.status == 0, result.message
    ratio, said = stated_ratio(result, scene)
    assert ratio <= 2.0, said


@pytest.mark.parametrize("seed", SEEDS[2:10])
def test_those_of_minimal_too(seed):
    scene = random_settled(seed)
    result = simulate(scene, formulation="minimal")
    assert result.status == 0, result.message
    ratio, said = stated_ratio(result, scene)
    assert ratio <= 2.0, said
