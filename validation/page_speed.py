"""`python -m validation.page_speed`: what a turned knob costs the page's engine, in chromium.

From the new scene to 361 samples with every reaction, the median of many turns, each to a value
that has not been before; and the parts of it. The drawing is not in it.
"""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace

from playwright.sync_api import sync_playwright

from crankmbs import load_scene
from crankmbs.page import exported, joined
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


def main() -> int:
    """Print the medians in milliseconds, by scene and knob."""
    path = shutil.which("chromium")
    if path is None:
        print("error: chromium is missing: apt-get install chromium", file=sys.stderr)
        return 2
    print("scene, knob: all [ms] = pressures and cells + tables and motion + samples")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = browser.new_page()
        for name in _SCENES:
            scene = load_scene(name)
            scene = replace(scene, run=replace(scene.run, until=SETTLED))
            given = [encoded(rules()), encoded(exported(scene))]
            script = _TIMED.replace("ANSWERS", joined("answers"))
            for knob, *parts in page.evaluate(script, given):
                each = " + ".join(f"{part:.2f}" for part in parts)
                print(f"{name}, {knob}: {sum(parts):.2f} = {each}")
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
