"""Break the page's engine, one law at a time: the numbers that Python is held against change."""

import math
import re
from functools import cache

import numpy as np
import pytest
from page_engine import ANSWERS, Engine, differences
from page_guards import GUARDS, tasks
from page_mutants import MUTANTS
from py_mini_racer import JSEvalException

from crankmbs import simulate
from crankmbs.page import joined
from crankmbs.page.export import encoded
from crankmbs.page.script import FOLDER

pytestmark = pytest.mark.slow

_VISIBLE = 2e-9  # relative: twice what the engine may differ by from Python
_STEP = 'var step = () => { if (++steps > most) throw new Error("no end"); };'


@pytest.fixture(scope="module")
def results():
    return {name: simulate(scene, rtol=1e-10) for name, scene in GUARDS.items()}


@pytest.fixture(scope="module")
def asked(results):
    angles = {name: result.data["crank_angle"].values for name, result in results.items()}
    found = tasks(angles).items()
    return {key: [name, encoded(arguments)] for key, (name, arguments) in found}


@pytest.fixture(scope="module")
def unbroken(v8, asked):
    """By what is asked, the answer and the steps that it takes."""
    return cache(lambda key: answered(v8, joined(ANSWERS), asked[key]))


def answered(v8, script, task, most="Infinity"):
    """What a script answers, and its steps, each a turn of a loop that goes on while something
    holds; it gives up after the most, as a mutant may never come to an end."""
    v8.eval(f"{_STEP} var steps = 0, most = {most};")
    try:
        found = Engine(v8, script.replace("while (", "while (step(), ")).asked(*task)
    except JSEvalException as error:
        if "SyntaxError" in str(error):
            raise
        found = {"broken": str(error)}
    return found, v8.eval("steps")


def shows(v8, script, task, answer):
    """Whether a broken script answers otherwise, or takes far more steps than the right one."""
    right, steps = answer
    found, _ = answered(v8, script, task, 1000 + 20 * steps)
    return differs(right, found)


def test_the_guards_are_right(asked, unbroken, results):
    answers = {key: unbroken(key)[0] for key in asked}
    for name, result in results.items():
        found = answers[f"answer {name}"]
        assert result.status == 0, result.message
        assert found["ending"] == "complete", name
        assert max(differences(result, found["variables"]).values()) < 1e-9, name
    assert all("broken" not in one for one in answers.values())


def differs(one, other):
    """Whether two answers differ by more than may be, of the largest number in a list."""
    if isinstance(one, dict):
        if not isinstance(other, dict) or one.keys() != other.keys():
            return True
        return any(differs(value, other[key]) for key, value in one.items())
    if isinstance(one, list) and any(isinstance(each, dict) for each in one):
        return len(one) != len(other) or any(map(differs, one, other))
    if one is None or isinstance(one, str | bool):
        return one != other
    a, b = (np.array(list(flat(part)), dtype=float) for part in (one, other))
    if len(a) != len(b):
        return True
    size = max(np.abs(a).max(initial=0.0), 1e-6)
    return not bool((np.abs(a - b) <= _VISIBLE * size).all())


def flat(value):
    """The numbers in lists of lists; what is no number is NaN, and so like nothing."""
    if not isinstance(value, list):
        yield math.nan if value is None else value
        return
    for each in value:
        yield from flat(each)


@pytest.mark.parametrize("module", list(MUTANTS))
def test_a_broken_law_shows_in_the_numbers(v8, asked, unbroken, module):
    source = (FOLDER / f"{module}.js").read_text(encoding="utf-8")
    script, survivors = joined(ANSWERS), []
    for find, replace, by in MUTANTS[module]:
        assert source.count(find) == 1, f"{find!r} stands {source.count(find)} times"
        assert script.count(find) == 1, f"{find!r} stands in another module too"
        broken = script.replace(find, replace)
        if not shows(v8, broken, asked[by], unbroken(by)):
            others = [key for key in asked if shows(v8, broken, asked[key], unbroken(key))]
            survivors.append((find, replace, f"not shown by {by}, but by {others}"))
    assert survivors == []


def test_every_module_of_the_engine_has_mutants():
    modules = re.findall(r"^const (\w+) = \(\(\) => \{$", joined(ANSWERS), re.MULTILINE)
    assert set(modules) - {ANSWERS.stem} == MUTANTS.keys()
