"""What axe has against two pages and a lesson, in both themes: nothing."""

from pathlib import Path

import axe_playwright_python
import pytest
from browser import visiting

from crankmbs import load_scene
from crankmbs.lessons import write_lesson
from crankmbs.page import page_of

pytestmark = pytest.mark.slow

AXE = Path(axe_playwright_python.__file__).with_name("axe.min.js").read_text(encoding="utf-8")
FOUND = """async () => (await axe.run()).violations.map(
  ({ id, nodes }) => [id, nodes.map(({ html }) => html)])"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("axe")
    found = {"lesson": write_lesson("polar", folder)}
    for name in ("propeller", "run_up"):
        found[name] = folder / f"{name}.html"
        found[name].write_text(page_of(load_scene(name), name), encoding="utf-8")
    return found


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["propeller", "run_up", "lesson"])
def test_axe_finds_nothing(browser, files, name, scheme):
    options = {"color_scheme": scheme, "bypass_csp": True, "offline": True}
    with visiting(browser, size=(1366, 641), **options) as visit:
        visit.page.goto(files[name].as_uri())
        visit.page.wait_for_selector("path.simulated")
        visit.page.evaluate(AXE)
        assert visit.page.evaluate(FOUND) == []
        if visit.page.locator("#more").count():
            visit.page.click("#more")
            assert visit.page.evaluate(FOUND) == []


def test_axe_sees_what_is_wrong(browser, files):
    with visiting(browser, bypass_csp=True, offline=True) as visit:
        visit.page.goto(files["propeller"].as_uri())
        visit.page.evaluate("document.getElementById('angle').removeAttribute('aria-label')")
        visit.page.evaluate(AXE)
        assert "label" in [rule for rule, _ in visit.page.evaluate(FOUND)]
