"""Break what the page says and draws, one law at a time: the guards of `page_shown` and
`page_drawing` see it."""

import pytest
from browser import visiting
from page_cases import CASES, picture, probe, scene_of, shown_script, truth
from page_drawing import drawing_holds
from page_mutants import MUTANTS
from page_shown import wrong
from page_shown_mutants import DRAWING, SHOWN
from playwright.sync_api import Error
from py_mini_racer import JSEvalException

from crankmbs.page.script import FOLDER

pytestmark = pytest.mark.slow

DRAWN = ("drawing", "stage")  # what a browser is needed for


@pytest.fixture(scope="module")
def said(v8):
    """What the page says of each case; the cycles are kept, and no mutant touches them."""
    found = {case: probe(v8, shown_script(), case) for case in CASES}
    yield found
    assert all(probe(v8, shown_script(), case) == found[case] for case in CASES)


@pytest.fixture(scope="module")
def page(browser):
    """An empty page, in which the same holds of what is drawn."""
    with visiting(browser, offline=True) as visit:
        found = {case: picture(visit.page, shown_script(), case) for case in CASES}
        yield visit.page
        assert all(picture(visit.page, shown_script(), case) == found[case] for case in CASES)


@pytest.mark.parametrize("case", CASES)
def test_what_is_said_is_true(said, case):
    assert wrong(case, said[case]) == []


@pytest.mark.parametrize("case", CASES)
def test_what_is_drawn_is_true(page, said, case):
    assert drawn_rightly(page, shown_script(), case, said)


def drawn_rightly(page, script, case, said):
    return drawing_holds(said[case] | picture(page, script, case), *truth(case), CASES[case][2])


@pytest.mark.parametrize("module", [each for each in SHOWN if each not in DRAWN])
def test_what_is_said_wrongly_is_seen(v8, said, module):
    def seen(script, case):
        if module == "turned":
            return scene_of(v8, script, case) != scene_of(v8, shown_script(), case)
        fresh = module in ("cycle", "shapes")  # by which a cycle, too, finds what lies between
        return wrong(case, probe(v8, script, case, fresh=fresh)) != []

    assert survivors(module, seen) == []


@pytest.mark.parametrize("module", DRAWN)
def test_what_is_drawn_wrongly_is_seen(page, said, module):
    assert survivors(module, lambda *broken: not drawn_rightly(page, *broken, said)) == []


def survivors(module, seen):
    """The mutants that are not seen and end in no error, or are no scripts."""
    source = (FOLDER / f"{module}.js").read_text(encoding="utf-8")
    script, found = shown_script(), []
    for find, replace, case in SHOWN[module]:
        assert source.count(find) == 1, f"{find!r} stands {source.count(find)} times"
        assert script.count(find) == 1, f"{find!r} stands in another module too"
        try:
            if not seen(script.replace(find, replace), case):
                found.append((find, replace))
        except (Error, JSEvalException) as error:
            if "SyntaxError" in str(error):
                found.append((find, replace))
    return found


def test_every_module_has_mutants_or_only_draws():
    modules = {path.stem for path in FOLDER.glob("*.js")}
    groups = [MUTANTS.keys(), SHOWN.keys(), DRAWING.keys()]
    assert sorted(modules) == sorted(name for group in groups for name in group)
