"""The live page and the page in one file, in a real browser, and with no other host."""

import io
import re
import signal
import subprocess
import sys
import zipfile
from urllib.parse import urlsplit

import numpy as np
import pytest
from browser import chromium, visiting
from playwright.sync_api import sync_playwright
from typer.testing import CliRunner

from crankmbs import load_scene, simulate
from crankmbs.cli.app import app
from crankmbs.demo.knobs import turned
from crankmbs.demo.outcome import prepared
from crankmbs.measures import fluctuation, last_span
from crankmbs.scene.write import scene_files

SCENE = "propeller"


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def address():
    command = "from crankmbs.cli import main; main()"
    with subprocess.Popen(
        [sys.executable, "-u", "-c", command, "demo", SCENE, "--port", "0", "--no-browser"],
        stdout=subprocess.PIPE,
        text=True,
    ) as server:
        try:
            yield re.search(r"http://localhost:\d+/", server.stdout.readline())[0]
            server.send_signal(signal.SIGINT)
            assert server.wait(timeout=60) == 0
        finally:
            server.kill()


@pytest.fixture(scope="module")
def page(browser, address):
    with visiting(browser) as visit:
        yield visit.open(address)


@pytest.fixture
def live(page):
    """The page as it was opened."""
    page.set("play", "active", False)
    page.set("tabs", "active", 0)
    page.set("angle", "value", 0)
    page.click("reset")
    return page.settled()


@pytest.fixture(scope="module")
def scene():
    return prepared(load_scene(SCENE))


def read(name, content, folder):
    """The scene in a file that the page handed out."""
    if name.endswith(".zip"):
        zipfile.ZipFile(io.BytesIO(content)).extractall(folder)
        return load_scene(folder / name.replace(".zip", ".toml"))
    (folder / name).write_bytes(content)
    return load_scene(folder / name)


def test_play_turns_the_crank_and_pause_and_step_hold_it(live):
    before = live.get("angle", "value")
    live.click("► play")
    live.wait(f"model('angle').value > {before + 5}")
    live.click("❚❚ pause")
    held = live.get("angle", "value")
    assert not live.get("play", "active")
    live.click("1° ►")
    assert live.get("angle", "value") == pytest.approx(round(held) + 1)
    live.click("◄ 1°")
    assert live.get("angle", "value") == pytest.approx(round(held))


TURN_BY_HAND = """([slow, seconds]) => {
  const model = (name) => Bokeh.documents[0].get_model_by_name(name)
  const request = window.requestAnimationFrame, clock = performance.now
  let turn = null
  window.requestAnimationFrame = (f) => (f.name === "turn" ? (turn = f, 0) : request(f))
  performance.now = () => 0
  model("slow").value = String(slow)
  model("play").active = true
  const angles = seconds.map((t) => { turn(1000 * slow * t); return model("angle").value })
  model("play").active = false
  window.requestAnimationFrame = request
  performance.now = clock
  return angles
}"""


def test_the_crank_turns_as_fast_as_the_run_has_it(live):
    time, degrees = live.column("frames data", "time"), live.column("frames data", "degrees")
    at = np.linspace(0.1, 0.9, 9) * time[-1]
    angles = live.page.evaluate(TURN_BY_HAND, [50, at.tolist()])
    assert angles == pytest.approx(np.interp(at, time, degrees), abs=1e-6)
    assert np.ptp(np.diff(angles)) > 1.0  # the speed swings


def test_the_mechanism_is_drawn_to_scale(live, scene):
    live.set("angle", "value", 77)
    for ratio in (0.2, 0.45):
        live.set("rod_ratio", "value", ratio)
        live.settled()
        x0, y0, x1, y1 = (live.column("rod drawn", end)[0] for end in ("x0", "y0", "x1", "y1"))
        r = scene.crank.radius
        assert (y0, x0) == pytest.approx((r * np.cos(np.radians(77)), r * np.sin(np.radians(77))))
        assert np.hypot(x1 - x0, y1 - y0) == pytest.approx(r / ratio)
        assert x1 == pytest.approx(scene.piston.offset, abs=1e-12)


def fluctuation_of_samples(scene):
    """As the page has it."""
    result = simulate(scene)
    return fluctuation(result, last_span(result)).value


def test_dragging_the_flywheel_draws_what_simulate_gives(live, scene):
    drawn = live.fluctuation()
    slider = live.page.locator(".bk-Slider").filter(has_text="flywheel")
    box = slider.locator(".noUi-handle").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    live.page.mouse.move(x, y)
    live.page.mouse.down()
    for shift in (15, 30, 45, 60):
        live.page.mouse.move(x + shift, y)
    live.page.mouse.up()
    inertia = live.settled().get("flywheel", "value")
    assert inertia > 1.3 * scene.crank.inertia
    expected = fluctuation_of_samples(turned(scene, {"flywheel": inertia}))
    assert live.fluctuation() == pytest.approx(expected, rel=1e-9)
    assert live.fluctuation() < 0.8 * drawn
    assert f"{100.0 * expected:.3f} %" in live.get("numbers", "text")


def test_the_scene_handed_out_gives_the_run_shown(live, tmp_path):
    for knob, value in (("rod_ratio", 0.4), ("offset", 3.3), ("pressure", 130), ("speed", 2500)):
        live.set(knob, "value", value)
    live.set("rod", "active", 1)
    live.set("cylinders", "value", "3")
    live.settled()
    assert live.get("message", "text") == ""
    result = simulate(read(*live.saved("scene TOML"), tmp_path))
    shown = live.column("frames data", "speed") * np.pi / 30.0
    assert len(result.scene.cylinders) == 3
    assert result.scene.rod.inertia == "two-mass"
    assert result.data["crank_speed"].values == pytest.approx(shown, rel=1e-13)
    assert result.data["crank_angle"].values[-1] == pytest.approx(19 * 4 * np.pi)


def test_the_data_handed_out_are_those_of_the_run(live):
    name, content = live.saved("data CSV")
    table = np.genfromtxt(io.BytesIO(content), delimiter=",", names=True, deletechars="")
    assert name == f"{SCENE}.csv"
    shown = live.column("frames data", "speed") * np.pi / 30.0
    assert table["crank_speed_[rad/s]"] == pytest.approx(shown, rel=1e-11)


@pytest.mark.parametrize("tab", range(1, 5))
def test_every_tab_follows_its_knobs(live, tab):
    sources = ["speed data", "motion data", "thrust data", "budget data", "bearing data"]
    column = {
        1: "piston acceleration, simulated",
        2: "side thrust, lecture",
        3: "torque: constant speed",
        4: "crank pin force x, simulated",
    }[tab]
    before = live.column(sources[tab], column)
    live.set("tabs", "active", tab)
    live.set("flywheel", "value", 0.05)
    live.set("rod_ratio", "value", 0.25)
    after = live.settled().column(sources[tab], column)
    assert np.max(np.abs(after - before)) > 1e-3 * np.max(np.abs(before))


def test_a_scene_that_cannot_run_says_so_and_the_last_good_state_stays(live, scene, tmp_path):
    live.set("rod_ratio", "value", 0.9)
    good = live.settled().column("frames data", "piston x0")
    assert live.get("message", "text") == ""
    live.set("offset", "value", 23.0)
    message = live.settled().get("message", "text")
    files = scene_files(turned(scene, {"rod_ratio": 0.9}), "bad")
    files["bad.toml"] = files["bad.toml"].replace("[piston]", '[piston]\noffset = "23 mm"')
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    said = CliRunner().invoke(app, ["check", str(tmp_path / "bad.toml")])
    assert said.exit_code == 2
    assert message == said.stderr.strip().replace(f"{tmp_path / 'bad.toml'}: ", "")
    assert live.column("frames data", "piston x0").tolist() == good.tolist()
    live.click("reset")
    assert live.settled().get("message", "text") == ""


def test_nothing_overlaps_and_all_fits_on_a_slide(live):
    root = live.page.locator(".bk-Column").first.bounding_box()
    assert root["x"] + root["width"] <= 1280
    assert root["y"] + root["height"] <= 800
    boxes = [box.bounding_box() for box in live.page.locator(".bk-Slider, .bk-Button").all()]
    assert len(boxes) >= 13
    for k, a in enumerate(boxes):
        assert a["x"] + a["width"] <= 1280
        for b in boxes[k + 1 :]:
            apart_x = a["x"] + a["width"] <= b["x"] or b["x"] + b["width"] <= a["x"]
            apart_y = a["y"] + a["height"] <= b["y"] or b["y"] + b["height"] <= a["y"]
            assert apart_x or apart_y


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    target = tmp_path_factory.mktemp("page") / "demo.html"
    command = ["page", SCENE, "-o", str(target), "--vary", "rod_ratio"]
    assert CliRunner().invoke(app, command).exit_code == 0
    return target


def test_the_single_file_opens_from_disk_without_network(browser, file, scene, tmp_path):
    with visiting(browser, offline=True) as visit:
        visit.open(file.as_uri())
        assert {urlsplit(url).scheme for url in visit.requests} <= {"file", "blob"}
        visit.click("► play")
        visit.wait("model('angle').value > 5")
        ratios = visit.get("rod_ratio", "categories")
        assert len(ratios) == 9
        visit.set("rod_ratio", "value", ratios[5])
        named = float(ratios[5])
        shown = read(*visit.saved("scene TOML"), tmp_path)
        assert shown.crank.radius / shown.rod.length == pytest.approx(named, abs=5e-4)
        expected = fluctuation_of_samples(shown)
        assert visit.fluctuation() == pytest.approx(expected, rel=1e-4)
        _, content = visit.saved("data CSV")
        head, *rows = content.decode().splitlines()
        assert '"side thrust, simulated [kN]"' in head.split(",", 2)[2]
        assert len(rows) == 361


def test_the_single_file_names_no_other_host(file):
    text = file.read_text()
    sources = re.findall(r'<(?:script|link|img)[^>]*\b(?:src|href)="([^"]+)"', text)
    assert [source for source in sources if "//" in source] == []
    assert "Bokeh" in text
