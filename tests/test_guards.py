"""What turns mutants red runs by default, the claims too; `python -m validation` judges all."""

import pytest
from guards import killed, quick_guards

from validation.case import CASES, load_case
from validation.judge import judge

GUARDS = sorted(guard for guard in quick_guards() if "::" not in guard)


@pytest.mark.parametrize("name", GUARDS)
def test_a_claim_that_kills_a_mutant_holds(name):
    verdict = judge(load_case(CASES / f"{name}.toml"))
    assert verdict.green, verdict.outcome.detail


def test_of_a_hundred_mutants_95_are_red_by_default():
    guards = quick_guards()
    assert sum(row["by"] in guards for row in killed()) >= 0.95 * len(killed())
