"""Debian's chromium, and a visit to a page of bokeh models in it."""

import fcntl
import os
import shutil
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

READY = "window.Bokeh && Bokeh.documents.length > 0 && Bokeh.documents[0].is_idle"
MODEL = "(name) => Bokeh.documents[0].get_model_by_name(name)"
_INSTALL = (
    ["apt-get", "update"],
    ["apt-get", "install", "--yes", "--no-install-recommends", "chromium"],
)


def chromium():
    """The path of chromium, installed by apt-get where that can be; else the test is skipped."""
    if shutil.which("chromium") is None and os.geteuid() == 0 and shutil.which("apt-get"):
        with Path(tempfile.gettempdir(), "crankmbs-chromium.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # several processes test at once
            if shutil.which("chromium") is None:
                for command in _INSTALL:
                    subprocess.run(command, check=False, capture_output=True)
    path = shutil.which("chromium")
    if path is None:
        missing = "chromium is missing and cannot be installed here: apt-get install chromium"
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(missing)
        pytest.skip(missing)
    return path


class Visit:
    """A page in the browser: reads and sets its models by name, and notes what it asks for."""

    def __init__(self, page):
        self.page = page
        self.requests: list[str] = []
        self.errors: list[str] = []
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", self._console)

    def _console(self, message):
        if message.type in ("error", "warning"):
            self.errors.append(message.text)

    def open(self, url):
        self.page.goto(url)
        self.page.wait_for_function(READY)
        return self

    def get(self, name, key):
        return self.page.evaluate(f"([n, k]) => ({MODEL})(n)[k]", [name, key])

    def set(self, name, key, value):
        self.page.evaluate(f"([n, k, v]) => {{ ({MODEL})(n)[k] = v }}", [name, key, value])

    def column(self, source, column):
        return np.array(
            self.page.evaluate(f"([n, c]) => Array.from(({MODEL})(n).data[c])", [source, column])
        )

    def settled(self):
        """Wait until the answer to the last turn of a knob is there."""
        number = "JSON.parse(model(NAME).data.json[0] || '{\"number\": 0}').number"
        asked, answered = (number.replace("NAME", f"'{n}'") for n in ("request", "answer"))
        self.wait(f"{asked} === {answered}")
        return self

    def wait(self, condition):
        self.page.wait_for_function(f"() => {{ const model = {MODEL}; return {condition} }}")

    def click(self, button):
        self.page.get_by_role("button", name=button, exact=True).click()

    def saved(self, button):
        """The file that a button hands out: its name and content."""
        with self.page.expect_download() as started:
            self.click(button)
        return started.value.suggested_filename, started.value.path().read_bytes()

    def fluctuation(self):
        """Of the curve that is drawn."""
        speed = self.column("speed data", "speed, simulated")
        return np.ptp(speed) / self.column("speed data", "speed, constant")[0]


@contextmanager
def visiting(browser, *, offline=False):
    context = browser.new_context(viewport={"width": 1280, "height": 800}, offline=offline)
    try:
        context.set_default_timeout(20e3)
        visit = Visit(context.new_page())
        yield visit
        hosts = {urlsplit(url).hostname for url in visit.requests} - {None}
        assert hosts <= {"localhost"}
        assert visit.errors == []
    finally:
        context.close()
