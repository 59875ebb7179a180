"""A page of a scene, opened in the browser from its file: its knobs, its curves, its files."""

import io
import re
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from browser import visiting

from crankmbs import load_scene, simulate
from crankmbs.page import page_of
from crankmbs.page.document import shown_scene
from crankmbs.scene.run import Extent

PASSES = "() => !document.getElementById('numbers').textContent.includes('…')"


@contextmanager
def opened(browser, folder, scene, address="", *, everything=True, **options):
    """A page of a scene, or of that of a name; everything : unfolded."""
    scene = load_scene(scene) if isinstance(scene, str) else scene
    file = folder / "page.html"
    file.write_text(page_of(scene, "mine"), encoding="utf-8")
    with visiting(browser, offline=True, **options) as visit:
        visit.page.goto(f"{file.as_uri()}{address}")
        if everything and visit.page.get_attribute("#more", "aria-expanded") == "false":
            visit.page.click("#more")
            visit.page.evaluate("document.activeElement.blur()")
        yield Opened(visit, file)


class Opened:
    """What one sees of a page, and does to it."""

    def __init__(self, visit, file):
        self.visit, self.page, self.file = visit, visit.page, file

    def text(self, what):
        return self.page.inner_text(what)

    @property
    def message(self):
        return self.text("#message")

    @property
    def address(self):
        return self.page.evaluate("location.hash")

    @property
    def degrees(self):
        return float(self.page.input_value("#angle"))

    def curve(self, plot="upper", style="simulated"):
        return self.page.get_attribute(f"#{plot} path.{style}", "d")

    def draws(self, curve):
        """Whether the upper plot has a curve, at whatever height a message leaves it."""
        across = np.linspace(0.0, 1.0, 361)
        one, other = (unit_square(text).T for text in (self.curve(), curve))
        return np.allclose(np.interp(across, *one), np.interp(across, *other), atol=0.02)

    def type(self, knob, text):
        """A number typed into a knob."""
        entry = self.page.locator(f".knob:has(#knob-{knob}) input.entry")
        entry.fill(str(text))
        entry.press("Enter")

    def go(self, address):
        """To another address of the page."""
        self.page.evaluate("(text) => { location.hash = text }", address)

    def settle(self):
        """Wait for the second pass."""
        self.page.wait_for_function(PASSES)
        return self

    def data(self):
        """The columns of the CSV file, by name."""
        _, content = self.settle().visit.saved("#csv")
        names = content.decode().splitlines()[0].split(",")
        rows = np.loadtxt(io.BytesIO(content), delimiter=",", skiprows=1)
        return dict(zip(names, rows.T, strict=True))


def unit_square(curve):
    """The points of a path of one begin and relative steps, in the square from 0 to 1."""
    steps = np.array(re.findall(r"-?[\d.]+", curve), dtype=float).reshape(-1, 2)
    points = steps.cumsum(axis=0)
    return (points - points.min(axis=0)) / np.ptp(points, axis=0)


def expected(scene, speed=None):
    """What Python has for the cycle that the page shows of a scene, at its angles.

    speed : where the cycle begins, of a scene that comes round at every speed
    """
    shown = shown_scene(scene)
    period = shown.settled_period if shown.settles else scene.period
    run = replace(shown.run, every=Extent(value=period / 360.0, unit="rad"), rtol=1e-10)
    if speed is not None:
        shown = replace(shown, start=replace(shown.start, speed=speed))
        run = replace(run, until=Extent(value=period, unit="rad"))
    result = simulate(replace(shown, run=run))
    assert result.status == 0
    return result.data.isel(time=slice(-361, None))


def assert_same(data, expected):
    """Columns of the page against a result, to 1e-9 of each variable's peak."""
    start = expected["time"].values[0]
    np.testing.assert_allclose(
        data["time [s]"] - data["time [s]"][0], expected["time"].values - start, atol=1e-11
    )
    for name in ("crank_speed", "external_torque", "main_bearing_force_x", "side_force"):
        array = expected[name]
        values = np.atleast_2d(array.values.T)
        for k, one in enumerate(values, start=1):
            number = f" {k}" if "cylinder" in array.dims else ""
            found = data[f"{name}{number} [{array.attrs['units']}]"]
            size = 1e-9 * max(np.abs(one).max(), 1.0)
            np.testing.assert_allclose(found, one, rtol=0.0, atol=size, err_msg=name)
