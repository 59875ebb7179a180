"""A lesson that is open in the browser, and the fixture that opens it."""

import re
from contextlib import ExitStack
from functools import cache

import pytest
from browser import resize, visiting

from crankmbs.lessons import write_lesson

PASSES = "() => [...document.querySelectorAll('figure')].every((f) => f.dataset.passes === '2')"
LAPTOP = (1366, 641)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The file of a lesson, written once."""
    folder = tmp_path_factory.mktemp("lessons")

    def file(name):
        target = folder / f"{name}.html"
        return target if target.is_file() else write_lesson(name, folder)

    return file


class Opened:
    """A lesson that is open."""

    def __init__(self, visit, file):
        self.page = visit.page
        self.visit = visit
        self.page.goto(file.as_uri())
        self.settle()

    def settle(self):
        """Wait for the second pass of every figure."""
        self.page.wait_for_function(PASSES)

    def said(self, what):
        """The number in a text that follows a figure."""
        self.settle()
        text = self.page.locator(f'[data-say="{what}"]').first.inner_text()
        return float(re.search(r"[-\u2212\d.]+", text)[0].replace("\u2212", "-"))

    def curve(self, figure, style="simulated"):
        return self.page.locator(f"#{figure} path.curve.{style}").first.get_attribute("d")

    def type(self, figure, knob, text):
        entry = self.page.locator(f"#{figure} .knob:has(#{figure}-knob-{knob}) input.entry")
        entry.fill(str(text))
        entry.press("Enter")

    def choose(self, figure, choice, word):
        self.page.locator(f"#{figure} select[data-choice={choice}]").select_option(word)

    def answer(self, question, text):
        root = self.page.locator(f"#{question}")
        root.locator("input").fill(text)
        root.locator("button").click()
        return root.locator(".reply")


@pytest.fixture
def lesson(browser, written):
    """Opens lessons, and at the end finds that nothing was asked for nor complained of."""
    visits = []

    def opened(name, size=LAPTOP, **options):
        manager = visiting(browser, size=size, offline=True, **options)
        visits.append(manager)
        return Opened(manager.__enter__(), written(name))

    yield opened
    for manager in visits:
        manager.__exit__(None, None, None)


@pytest.fixture(scope="module")
def kept(browser, written):
    """Opens lessons that stay open, for tests that change nothing that another one looks at; they
    stand on the screen of a size, as styles and observers alone lay them out."""
    with ExitStack() as visits:

        @cache
        def opened(name):
            visit = visits.enter_context(visiting(browser, size=LAPTOP, offline=True))
            return Opened(visit, written(name))

        def sized(name, size=LAPTOP):
            lesson = opened(name)
            resize(lesson.page, size)
            return lesson

        yield sized
