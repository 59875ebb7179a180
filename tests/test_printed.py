"""Printed numbers, and beside each what the same problem gives in full, computed anew."""

from functools import cache

import pytest

from validation import reference
from validation.case import load_cases
from validation.oracles import end_states
from validation.oracles.arithmetic import Number, distance
from validation.oracles.textbook import computed

ROWS = {(row["machine"], row["quantity"]): row for row in reference.rows("printed")}
IN_FULL = {key: row for key, row in ROWS.items() if row["made_by"] != "a rigid rod"}
STATES = {"crank_angle": 0, "crank_speed": 1}


@cache
def textbook() -> dict[tuple[str, str], Number]:
    return computed()


def anew(machine: str, quantity: str, made_by: str) -> Number:
    if made_by == "reference/end_states.csv":
        return end_states.stored()[machine][STATES[quantity]]
    return textbook()[machine.removesuffix("_by_hand"), quantity]


def last_digit(text: str) -> float:
    digits, _, power = text.partition("e")
    return 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


@pytest.mark.slow
@pytest.mark.parametrize("key", IN_FULL, ids=str)
def test_computed_here_is_what_the_oracle_computes(key):
    row = ROWS[key]
    text = row["computed_here"]
    assert distance(anew(*key, row["made_by"]), text) <= 0.5 * last_digit(text)


@pytest.mark.parametrize("key", ROWS, ids=str)
def test_the_last_printed_digit_is_that_of_the_print(key):
    row = ROWS[key]
    assert float(row["last_digit"]) == pytest.approx(last_digit(row["printed"]), rel=1e-9)


@pytest.mark.parametrize("key", IN_FULL, ids=str)
def test_what_a_print_is_off_by_is_said(key):
    row = ROWS[key]
    said = row["why"].partition(":")[0]
    off = float(row["printed"]) - float(row["computed_here"])
    assert said[0] in "+-"
    assert abs(off - float(said)) <= 0.51 * last_digit(said)


@pytest.mark.parametrize("column", ["source", "where", "method", "why"])
def test_every_printed_number_says_where_and_how(column):
    assert all(row[column] for row in ROWS.values())


@pytest.mark.parametrize("machine", sorted({machine for machine, _ in ROWS}))
def test_every_print_has_its_claim_and_beside_it_the_exact_answer(machine):
    kinds = {
        case.check.partition(".")[0]
        for case in load_cases()
        if case.parameters.get("machine") in (machine, machine.removesuffix("_by_hand"))
    }
    assert kinds == {"printed", "computed"}
