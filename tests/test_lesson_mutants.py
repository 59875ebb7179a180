"""Break what the lessons compute by themselves, one formula at a time: their guards see it."""

import pytest
from lesson_guards import GUARDS, wrong
from lesson_mutants import MUTANTS, ROW
from lesson_shown import lesson_script, probe
from py_mini_racer import JSEvalException

from crankmbs.lessons import LESSONS

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", LESSONS)
def test_what_a_lesson_shows_is_true(v8, name):
    assert wrong(name, probe(v8, lesson_script(name), name)) == []


@pytest.mark.parametrize("name", LESSONS)
def test_a_broken_formula_of_a_lesson_is_seen(v8, name):
    head, begin, own = lesson_script(name).partition(f"const lesson_{name} = (() => {{")
    survivors = []
    for find, replace in MUTANTS[name]:
        assert own.count(find) == 1, f"{find!r} stands {own.count(find)} times"
        if not seen(v8, head + begin + own.replace(find, replace), name):
            survivors.append((find, replace))
    assert survivors == []
    assert wrong(name, probe(v8, lesson_script(name), name)) == []  # no cycle was touched


def test_a_broken_row_of_pistons_is_seen(v8):
    script, survivors = lesson_script("balance"), []
    for find, replace in ROW:
        assert script.count(find) == 1, f"{find!r} stands {script.count(find)} times"
        if not seen(v8, script.replace(find, replace), "balance"):
            survivors.append((find, replace))
    assert survivors == []


def seen(v8, script, name):
    """Whether a mutant breaks a guard or ends in an error, but not as it is no script."""
    try:
        guards = GUARDS[name](**probe(v8, script, name))
        return any(not holds for _, holds in guards)
    except JSEvalException as error:
        return "SyntaxError" not in str(error)


def test_every_lesson_has_mutants():
    assert sorted(MUTANTS) == sorted(LESSONS)
