"""Debian's chromium without windows, and a visit to a page in it."""

import fcntl
import os
import shutil
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import sync_playwright

# the shell composes no windows, so that a visit takes a third of the time on a processor
_NAMES = ("chromium-headless-shell", "chromium")
_INSTALL = (
    ["apt-get", "update"],
    ["apt-get", "install", "--yes", "--no-install-recommends", _NAMES[0]],
)

# a browser whose styles are asked for reads the file again, and refuses that to itself
_READ_AGAIN = "'file:' URLs are treated as unique security origins"


def chromium():
    """The path of the browser, installed by apt-get where that can be; else the test is skipped."""
    if _installed() is None and os.geteuid() == 0 and shutil.which("apt-get"):
        with Path(tempfile.gettempdir(), "crankmbs-chromium.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # several processes test at once
            if _installed() is None:
                for command in _INSTALL:
                    subprocess.run(command, check=False, capture_output=True)
    path = _installed()
    if path is None:
        missing = f"no chromium is there or can be installed here: apt-get install {_NAMES[0]}"
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(missing)
        pytest.skip(missing)
    return path


def _installed():
    """The path of the browser, if there is one."""
    return next(filter(None, map(shutil.which, _NAMES)), None)


@contextmanager
def started():
    """The browser, open."""
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield opened
        opened.close()


def resize(page, size):
    """Another screen for an open page, and the frames in which its plots follow."""
    width, height = size
    if page.viewport_size != {"width": width, "height": height}:
        page.set_viewport_size({"width": width, "height": height})
        drawn(page)


def drawn(page, frames=2):
    """Wait until what changed the layout is observed and drawn, or for more frames."""
    page.evaluate(_FRAMES, frames)


_FRAMES = """(left) => new Promise((done) => {
  const next = () => (left-- > 0 ? requestAnimationFrame(next) : setTimeout(done));
  next();
})"""
STILL = 10
"""Frames after which what has not moved stands still: what plays moves in the second."""


class Visit:
    """A page in the browser, and what it asks for and complains of."""

    def __init__(self, page):
        self.page = page
        self.requests: list[str] = []
        self.errors: list[str] = []
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", self._heard)

    def _heard(self, message):
        if _READ_AGAIN not in message.text:
            self.errors.append(message.text)

    def saved(self, button):
        """The file that a button hands out: its name and content."""
        with self.page.expect_download() as started:
            self.page.click(button)
        return started.value.suggested_filename, started.value.path().read_bytes()


@contextmanager
def visiting(browser, *, size=(1280, 800), motion="reduce", **options):
    """A visit, at the end of which nothing has been complained of or asked from elsewhere.

    motion : "reduce", or "no-preference", which lets pages play by themselves
    """
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, reduced_motion=motion, **options
    )
    try:
        context.set_default_timeout(20e3)
        visit = Visit(context.new_page())
        yield visit
        assert {urlsplit(url).scheme for url in visit.requests} <= {"file", "blob", "about"}
        assert visit.errors == [], visit.errors
    finally:
        context.close()
