"""Break what the page shows, one law at a time: the guards of `page_shown` see it."""

import pytest
from page_cases import CASES, probe, scene_of, shown_script
from page_mutants import MUTANTS
from page_shown import wrong
from page_shown_mutants import DRAWING, SHOWN
from playwright.sync_api import Error

from crankmbs.page.script import FOLDER

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def true(page):
    """What is wrong with each case as the page has it, and the scenes that its knobs give; the
    cycles are kept."""
    script = shown_script()
    found = {case: wrong(case, probe(page.page, script, case)) for case in CASES}
    return found, {case: scene_of(page.page, script, case) for case in CASES}


@pytest.mark.parametrize("case", CASES)
def test_what_is_shown_is_true(true, case):
    assert true[0][case] == []


@pytest.mark.parametrize("module", SHOWN)
def test_what_is_shown_wrongly_is_seen(page, true, module):
    source = (FOLDER / f"{module}.js").read_text(encoding="utf-8")
    script = shown_script()
    survivors = []
    for find, replace, case in SHOWN[module]:
        assert source.count(find) == 1, f"{find!r} stands {source.count(find)} times"
        assert script.count(find) == 1, f"{find!r} stands in another module too"
        if not seen(page, script.replace(find, replace), case, (module, true[1])):
            survivors.append((find, replace))
    assert survivors == []


def seen(page, script, case, about):
    """Whether a mutant breaks a guard or ends in an error, but not as it is no script.

    about : its module, and the scenes that the knobs give without it
    """
    module, scenes = about
    try:
        if module == "turned":
            return scene_of(page.page, script, case) != scenes[case]
        return wrong(case, probe(page.page, script, case, fresh=module == "cycle")) != []
    except Error as error:
        return "SyntaxError" not in str(error)


def test_every_module_has_mutants_or_only_draws():
    modules = {path.stem for path in FOLDER.glob("*.js")}
    groups = [MUTANTS.keys(), SHOWN.keys(), DRAWING.keys()]
    assert sorted(modules) == sorted(name for group in groups for name in group)
