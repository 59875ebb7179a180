"""What is said about S1: identified parameters, standing of the claims, cells without a formula."""

import pytest

from validation import s1
from validation.case import load_cases
from validation.checks.s1_figures import compression
from validation.judge import judge

CASES = {case.name: case for case in load_cases()}
ABOUT_S1 = [case for name, case in CASES.items() if name.startswith("s1_")]
PARAMETERS = {p.name: p for p in s1.identified()}


@pytest.mark.parametrize("name", PARAMETERS)
def test_the_identified_parameter_is_the_one_used(name):
    parameter = PARAMETERS[name]
    assert abs(parameter.value - parameter.used) < 10.0 * parameter.error
    assert parameter.error < 1e-5 * parameter.value


@pytest.mark.parametrize("case", ABOUT_S1, ids=lambda case: case.name)
def test_every_claim_about_s1_says_whether_it_predicts(case):
    assert case.standing.startswith(("prediction", "consistency", "arithmetic"))


@pytest.mark.parametrize(
    ("table", "without"), [(1, 0), (2, 12), (4, 1), (5, 0), (6, 12)], ids=lambda value: str(value)
)
def test_a_cell_without_a_formula_agrees_with_nothing(table, without):
    detail = judge(CASES[f"s1_table_{table}"]).outcome.detail
    said = f"{without} no formula"
    assert (said in detail) == (without > 0)
    assert ("agrees" in detail) == (table != 2)


def test_the_compression_claim_has_the_numbers_of_its_check():
    case = CASES["s1_compression_polytrope"]
    detail = compression(case).detail
    assert "8.7 % below" in case.claim
    assert "8.7 % below" in detail
    assert "6.2 % above" in case.claim
    assert "6.2 % above" in detail


def test_figure_2_tells_printed_from_implied_pressures():
    figure = judge(CASES["s1_figure_2"]).outcome.figures["s1_figure_2"]
    dots = {line.get_label(): line for line in figure.axes[0].lines}
    printed, implied = dots["Table 2 as printed"], dots["implied by Table 6"]
    assert len(printed.get_xdata()) == 13
    assert len(implied.get_xdata()) == 11
    assert printed.get_marker() != implied.get_marker()
    assert {text.get_text() for text in figure.legends[0].get_texts()} >= dots.keys()


@pytest.mark.parametrize("number", [4, 5])
def test_figures_4_and_5_say_that_they_share_table_6(number):
    case = CASES[f"s1_figure_{number}"]
    assert "Figures 4 and 5 share it" in case.claim
    title = judge(case).outcome.figures[case.name].legends[0].get_title().get_text()
    assert "Figures 4 and 5 share Table 6's torque" in title


def test_the_claims_say_what_was_identified():
    lines = s1.section()
    assert "## What S1 does not print" in lines
    assert all(any(f"| {name} |" in line for line in lines) for name in PARAMETERS)
