"""`python -m validation.page_speed`: what a turned knob costs the page, in chromium.

The engine's own part: from the new scene to 361 samples with every reaction, the median of many
turns, each to a value that has not been before; and the parts of it. Then the whole: from a
slider's event until the page is drawn and laid out, as it is and with the processor throttled four
times. Beside them stands how many processes wanted the machine, as they lengthen all of it.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from crankmbs import load_scene
from crankmbs.page import exported, joined, page_of
from crankmbs.page.export import encoded, rules
from crankmbs.scene.run import SETTLED

__all__ = ["main"]

_SCENES = ("propeller", "v_twin", "yi_diesel_free")
_TIMED = """([rules, text]) => {
  const answers = ANSWERS;
  const scene = answers.decoded(JSON.parse(text));
  const engine = answers.engineOf(JSON.parse(rules));
  const { crank, rod, piston } = scene;
  const knobs = {
    rod: (by) => ({ rod: { ...rod, length: rod.length * (1 + by) } }),
    offset: (by) => ({ piston: { ...piston, offset: piston.offset + 0.1 * by * crank.radius } }),
    mass: (by) => ({ piston: { ...piston, mass: piston.mass * (1 + by) } }),
    flywheel: (by) => ({ crank: { ...crank, inertia: crank.inertia * (1 + by) } }),
  };
  return Object.entries(knobs).map(([name, turned]) => {
    const turns = Array.from({ length: 300 }, (_, k) =>
      answers.timed(engine, { ...scene, ...turned(1e-3 * (k + 1)) }));
    const middle = (part) => turns.slice(100).map(part).sort((a, b) => a - b)[100];
    return [name, ...turns[0].map((_, part) => middle((turn) => turn[part]))];
  });
}"""

_THROTTLED = 4
_DRAWN = """(name) => {
  const slider = document.getElementById(`knob-${name}`);
  const [low, high] = [Number(slider.min), Number(slider.max)];
  const turns = Array.from({ length: 150 }, (_, k) => {
    slider.value = low + (high - low) * (0.4 + 0.1 * Math.sin(k / 15));
    const begin = performance.now();
    slider.dispatchEvent(new Event("input"));
    document.body.getBoundingClientRect();
    return performance.now() - begin;
  });
  const sorted = turns.slice(50).sort((a, b) => a - b);
  return [sorted[50], sorted[95]];
}"""


def main() -> int:
    """Print the medians in milliseconds, by scene and knob."""
    path = shutil.which("chromium")
    if path is None:
        print("error: chromium is missing: apt-get install chromium", file=sys.stderr)
        return 2
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = browser.new_page()
        print("scene, knob: all [ms] = pressures and cells + tables and motion + samples")
        for name in _SCENES:
            _print_engine(page, name)
        print("scene, knob, throttled: from event to drawn [ms], median and 95 %; load average")
        for name in _SCENES:
            _print_drawn(browser, name)
        browser.close()
    return 0


def _print_engine(page: Page, name: str) -> None:
    """The engine's part, knob by knob."""
    scene = load_scene(name)
    scene = replace(scene, run=replace(scene.run, until=SETTLED))
    given = [encoded(rules()), encoded(exported(scene))]
    script = _TIMED.replace("ANSWERS", joined("answers"))
    for knob, *parts in page.evaluate(script, given):
        each = " + ".join(f"{part:.2f}" for part in parts)
        print(f"{name}, {knob}: {sum(parts):.2f} = {each}")


def _print_drawn(browser: Browser, name: str) -> None:
    """From the event to the drawn page, knob by knob, on a laptop's screen."""
    context = browser.new_context(
        viewport={"width": 1366, "height": 641}, reduced_motion="reduce", offline=True
    )
    page = context.new_page()
    with tempfile.TemporaryDirectory(dir=".") as folder:
        file = Path(folder, "page.html").absolute()
        file.write_text(page_of(load_scene(name), name), encoding="utf-8")
        page.goto(file.as_uri())
    page.wait_for_selector("#upper path.simulated")
    devtools = context.new_cdp_session(page)
    for times in (1, _THROTTLED):
        devtools.send("Emulation.setCPUThrottlingRate", {"rate": times})
        for knob in ("flywheel", "offset"):
            median, most = page.evaluate(_DRAWN, knob)
            load = os.getloadavg()[0]
            print(f"{name}, {knob}, {times}: {median:.1f}, {most:.1f}; {load:.1f}")
    context.close()


if __name__ == "__main__":
    sys.exit(main())
