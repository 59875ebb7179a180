"""Of a hard case only a finite stated error that a user would accept is called right."""

from dataclasses import replace
from math import inf

import pytest

from crankmbs import simulate
from validation.case import load_cases
from validation.checks import hard

pytestmark = pytest.mark.slow

CASE = {case.name: case for case in load_cases()}["hard_one_rpm"]


@pytest.fixture(scope="module")
def run():
    return simulate(CASE.ours(), formulation="crank_angle")


def judged(run, stated, only_to=None):
    """The answer of the case if the run states an error of the side force, in its peak."""
    data = run.data.copy(deep=True)
    side = data["side_force"]
    side.attrs["error_estimate"] = stated * abs(side.values).max()
    parameters = {**CASE.parameters, "only_to": {"crank_angle": only_to} if only_to else {}}
    case = replace(CASE, parameters=parameters)
    return hard.judged(case, replace(run, data=data), case.theirs(), "")


@pytest.mark.parametrize(
    ("stated", "only_to", "word", "green"),
    [
        (0.9e-3, None, "right: ", True),
        (0.05, None, "right, but only to 5 % of the peak (side_force): ", False),
        (0.05, 0.04, "right, but only to 5 % of the peak (side_force): ", False),
        (0.05, 0.06, "right, but only to 5 % of the peak (side_force): ", True),
        (8.8, 0.06, "no answer, the stated error is 8.8 times the peak (side_force): ", False),
        (8.8, inf, "no answer, the stated error is 8.8 times the peak (side_force): ", True),
        (inf, None, "error unknown (side_force): ", False),
        (inf, 0.06, "error unknown (side_force): ", False),
        (inf, inf, "error unknown (side_force): ", True),
    ],
)
def test_a_coarse_or_unknown_error_is_named_and_has_to_be_known(run, stated, only_to, word, green):
    answer = judged(run, stated, only_to)
    assert answer.text.startswith(word)
    assert (answer.error <= CASE.tolerance) == green


def test_a_wrong_number_is_wrong_whatever_is_stated_of_others(run):
    data = run.data.copy(deep=True)
    data["side_force"].values[3] *= 1.01
    answer = hard.judged(CASE, replace(run, data=data), CASE.theirs(), "")
    assert answer.text.startswith("WRONG: side_force")
    assert answer.error > CASE.tolerance


def test_where_nothing_moves_rounding_is_no_coarse_error(run):
    still = replace(run, data=run.data.isel(time=[0]))
    assert hard.coarsest(still, {"crank_torque": 1e-15}) == (0.0, "crank_angle")
