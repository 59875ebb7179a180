"""Every tolerance has been seen to fail: the shifted parameter of a claim turns it red."""

from dataclasses import replace

import pytest

from validation.case import Mutant, load_cases
from validation.judge import judge

pytestmark = pytest.mark.slow

CASES = load_cases()


OVER_THE_ANGLE = {
    "curves.truncation",
    "curves.maximum_speed",
    "s2.mean_speed",
    "s2.special_angles",
    "two_mass.torque_of_one_cylinder",
    "two_mass.torque_of_all_cylinders",
}
CURVES = [case for case in CASES if case.check in OVER_THE_ANGLE]
SHORTENED = [case for case in CASES if case.mutant.until is not None]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_shifted_parameter_turns_the_claim_red(case):
    verdict = judge(replace(case, mutated=True, shortened=True))
    assert verdict.word == "fails", verdict.outcome.detail


@pytest.mark.parametrize("case", SHORTENED, ids=lambda case: case.name)
def test_a_shorter_run_alone_does_not(case):
    assert judge(replace(case, shortened=True)).word == "holds"


@pytest.mark.parametrize("case", CURVES, ids=lambda case: case.name)
def test_a_wrong_speed_turns_a_lecture_s_curve_red(case):
    slightly_faster = Mutant("motion.speed", 1.0001)
    assert judge(replace(case, mutated=True, mutant=slightly_faster)).word == "fails"
