"""`python -m validation.page_speed`: what a turned knob costs the page, in chromium.

The engine's own part: from the new scene to 361 samples with every reaction, the median of many
turns, each to a value that has not been before; and the parts of it. Then the whole: what
the main thread works for a turn of a slider, one a frame, from its event to the end of painting, as
it is and with the processor throttled four times. It is time of the processor: that in which others
had it does not count, but they lengthen it by what they take from caches, so their number stands
beside it.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from bisect import bisect_right
from dataclasses import replace
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

from crankmbs import load_scene
from crankmbs.page import exported, joined, page_of
from crankmbs.page.export import encoded, rules
from crankmbs.scene.run import SETTLED

__all__ = ["main"]

_SCENES = ("propeller", "v_twin", "yi_diesel_free")
_TIMED = """([rules, text]) => {
  const speed = SPEED;
  const scene = speed.decoded(text);
  const engine = speed.engineOf(rules);
  const { crank, rod, piston } = scene;
  const knobs = {
    rod: (by) => ({ rod: { ...rod, length: rod.length * (1 + by) } }),
    offset: (by) => ({ piston: { ...piston, offset: piston.offset + 0.1 * by * crank.radius } }),
    mass: (by) => ({ piston: { ...piston, mass: piston.mass * (1 + by) } }),
    flywheel: (by) => ({ crank: { ...crank, inertia: crank.inertia * (1 + by) } }),
  };
  return Object.entries(knobs).map(([name, turned]) => {
    const turns = Array.from({ length: 300 }, (_, k) =>
      speed.timed(engine, { ...scene, ...turned(1e-3 * (k + 1)) }));
    const middle = (part) => turns.slice(100).map(part).sort((a, b) => a - b)[100];
    return [name, ...turns[0].map((_, part) => middle((turn) => turn[part]))];
  });
}"""

_THROTTLED = 4
_TURNS, _BEFORE = 150, 50  # the first are not counted
_DRAWN = """async ([name, turns]) => {
  const slider = document.getElementById(`knob-${name}`);
  const [low, high] = [Number(slider.min), Number(slider.max)];
  for (let k = 0; k <= turns; k++) {
    await new Promise(requestAnimationFrame);
    performance.mark(`turn ${k}`);
    slider.value = low + (high - low) * (0.4 + 0.1 * Math.sin(k / 15));
    slider.dispatchEvent(new Event("input"));
  }
}"""
_TRACED = ["devtools.timeline", "blink.user_timing", "toplevel"]


def main(arguments: list[str] | None = None) -> int:
    """Print the medians in milliseconds, by scene and knob."""
    parser = argparse.ArgumentParser(prog="python -m validation.page_speed", description=__doc__)
    parser.parse_args(arguments)
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
        print("scene, knob, throttled: main thread [ms], median and 95 %; load average")
        for name in _SCENES:
            _print_drawn(browser, name)
        browser.close()
    return 0


def _print_engine(page: Page, name: str) -> None:
    """The engine's part, knob by knob."""
    scene = load_scene(name)
    scene = replace(scene, run=replace(scene.run, until=SETTLED))
    given = [encoded(rules()), encoded(exported(scene))]
    script = _TIMED.replace("SPEED", joined(Path(__file__).with_suffix(".js")))
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
            median, most = _turns(page, knob)
            load = os.getloadavg()[0]
            print(f"{name}, {knob}, {times}: {median:.1f}, {most:.1f}; {load:.1f}")
    context.close()


def _turns(page: Page, knob: str) -> tuple[float, float]:
    """Median and 95 % of the main thread's work for a turn [ms]."""
    events: list[dict[str, Any]] = []
    complete: list[object] = []
    devtools = page.context.new_cdp_session(page)
    devtools.on("Tracing.dataCollected", lambda data: events.extend(data["value"]))
    devtools.on("Tracing.tracingComplete", lambda data: complete.append(data))
    config = {"includedCategories": _TRACED, "excludedCategories": ["*"]}
    devtools.send("Tracing.start", {"traceConfig": config, "transferMode": "ReportEvents"})
    page.evaluate(_DRAWN, [knob, _TURNS])
    devtools.send("Tracing.end")
    while not complete:
        page.wait_for_timeout(20)
    devtools.detach()
    marks = {each["name"]: each for each in events if each["name"].startswith("turn ")}
    thread = marks["turn 0"]["pid"], marks["turn 0"]["tid"]
    own = [each for each in events if (each["pid"], each["tid"]) == thread and "tdur" in each]
    work = [0.0] * (_TURNS + 1)
    begins = sorted(mark["ts"] for mark in marks.values())
    until = 0.0
    for event in sorted(own, key=lambda each: (each["ts"], -each["dur"])):
        if event["ts"] < until:
            continue  # part of the one before
        until = event["ts"] + event["dur"]
        work[bisect_right(begins, until) - 1] += 1e-3 * event["tdur"]
    counted = sorted(work[_BEFORE:_TURNS])
    return counted[len(counted) // 2], counted[int(0.95 * len(counted))]


if __name__ == "__main__":
    sys.exit(main())
