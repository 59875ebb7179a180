"""Every tolerance has been seen to fail: the shifted parameter of a claim turns it red."""

from dataclasses import replace

import pytest

from validation.case import load_cases
from validation.judge import judge

CASES = load_cases()


SHORTENED = [case for case in CASES if case.mutant.until is not None]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_shifted_parameter_turns_the_claim_red(case):
    assert judge(replace(case, mutated=True, shortened=True)).word == "fails"


@pytest.mark.parametrize("case", SHORTENED, ids=lambda case: case.name)
def test_a_shorter_run_alone_does_not(case):
    assert judge(replace(case, shortened=True)).word == "holds"
