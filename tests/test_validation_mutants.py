"""A speed that is slightly off turns every curve of the lectures over the angle red."""

from dataclasses import replace

import pytest

from validation.case import Mutant, load_cases
from validation.judge import judge

pytestmark = pytest.mark.slow

OVER_THE_ANGLE = {
    "curves.truncation",
    "curves.maximum_speed",
    "s2.mean_speed",
    "s2.special_angles",
    "two_mass.torque_of_one_cylinder",
    "two_mass.torque_of_all_cylinders",
}
CURVES = [case for case in load_cases() if case.check in OVER_THE_ANGLE]


@pytest.mark.parametrize("case", CURVES, ids=lambda case: case.name)
def test_a_wrong_speed_turns_a_lecture_s_curve_red(case):
    slightly_faster = Mutant("motion.speed", 1.0001)
    assert judge(replace(case, mutated=True, mutant=slightly_faster)).word == "fails"
