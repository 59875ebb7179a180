"""What the figures of the lessons draw and say, asked of their modules without controls."""

import re
from functools import cache
from importlib import import_module
from weakref import WeakKeyDictionary

from crankmbs import load_scene
from crankmbs.lessons import LESSONS
from crankmbs.lessons.article import article
from crankmbs.page import joined

CHANGED = {
    "valley": {"rod_ratio": 0.35},
    "half": {"rod_ratio": 0.4},
    "series": {"rod_ratio": 0.4},
    "side": {"share": 1.3},
    "turning": {"speed": 1500.0},
    "twin": {"bank": 70.0, "weight": 40.0},
    "step": {"size": 10.0, "method": "Heun"},
    "order": {"size": 10.0},
    "stated": {"size": 2.5, "method": "Heun"},
}
"""Values of a figure's knobs in place of those that it begins with, where these show less."""

SIZE = {"width": 400.0, "height": 300.0, "type": 14.0}
"""Of a drawing and its letters [px]."""

_DRAWN = """var cycles = globalThis.cycles ?? new Map();
var Drawn = class {
  constructor(tagName) {
    Object.assign(this, { tagName, attributes: [], children: [], textContent: "" });
  }
  setAttribute(name, value) {
    this.attributes.push({ name, value: String(value) });
  }
  append(child) {
    this.children.push(child);
  }
  replaceChildren() {
    this.children = [];
  }
};
var document = { createElementNS: (_, tagName) => new Drawn(tagName) };"""
"""All that a lesson's drawing takes of a browser, to tell what was drawn; the cycles are kept."""

_PROBE = """((script, text, { changed, fine, size }) => {
  const { lesson, engine, cycle, turned, given: taken } = eval(script);
  const given = taken.valuesOf(JSON.parse(text));
  const turner = new turned.Turner(given);
  const figures = lesson.start();
  const number = (scene) => {
    const key = JSON.stringify([fine, scene]);
    const own = new engine.Engine(given.rules);
    if (!cycles.has(key)) cycles.set(key, cycle.cycleOf(own, scene, given.endings, { fine }));
    return [...cycles.keys()].indexOf(key);
  };
  const told = (each) => ({
    name: each.tagName, text: each.textContent,
    ...Object.fromEntries(each.attributes.map(({ name, value }) => [name, value])),
  });
  const drawing = (made, shown, theta) => {
    if (!made.draw) return null;
    const root = new Drawn("svg");
    made.draw(root, shown, theta, size);
    return [root, ...root.children].map(told);
  };
  return Object.fromEntries(given.figures.map((spec) => {
    const made = figures[spec.name];
    const values = { ...spec.values, ...changed[spec.name] };
    const scene = made.scene ? made.scene(turner, values, given) : turner.scene(values);
    const solved = number(scene);
    const shown = [...cycles.values()][solved];
    const shapes = made.shapes(shown, values, given);
    return [spec.name, {
      values, scene: { ...scene, gas: null, loads: null }, levels: made.levels?.(shown) ?? null,
      says: made.says?.(shown, values, given) ?? {},
      shapes: shapes.map(({ curves, differences, of, holdsBelow }) =>
        ({ curves, differences, holdsBelow, now: of(shown.angles[100]) })),
      drawing: drawing(made, shown, shown.angles[100]), at: shown.at(shown.angles[100]),
      solved, textbook: given.textbook ?? null,
    }];
  }));
})"""

_CYCLE = """((number) => {
  const { samples, angles, mean, rows, fluctuation } = [...cycles.values()][number];
  return { samples, angles, mean, rows, fluctuation };
})"""
_SOLVED: WeakKeyDictionary[object, dict[int, dict[str, object]]] = WeakKeyDictionary()
"""The cycles that a V8 has solved and told of, by their numbers there."""


@cache
def made(name):
    """A lesson with the scene that it is about."""
    module = import_module(f"crankmbs.lessons.{name}")
    return module.lesson(load_scene(module.SCENE))


@cache
def given(name):
    """What the page of a lesson is given."""
    text = article(made(name), name, dict.fromkeys(LESSONS, ""), linked=False)
    return re.search(r'id="given"[^>]*>(.*?)</script>', text, re.DOTALL)[1]


def lesson_script(name):
    """The script of a lesson, whose start gives its figures, with the modules that compute."""
    script = joined(f"lesson_{name}")
    for old, new in (
        ("return begun(", "return ("),
        (
            f"return lesson_{name};\n}})()",
            f"return {{ lesson: lesson_{name}, engine, cycle, turned, given }};\n}})()",
        ),
    ):
        assert script.count(old) == 1
        script = script.replace(old, new)
    return script


def probe(v8, script, name):
    """What all figures of a lesson draw and say: figure -> what; of the lesson on errors with the
    second pass, whose own error does not show beside those that it is about.

    A cycle is solved and told of once, as no formula of a lesson has a part in it.
    """
    asked = {"changed": CHANGED, "fine": name == "trust", "size": SIZE}
    v8.eval(_DRAWN)
    figures = v8.call(_PROBE, script, given(name), asked)
    cycles = _SOLVED.setdefault(v8, {})
    for figure in figures.values():
        number = figure.pop("solved")
        if number not in cycles:
            cycles[number] = v8.call(_CYCLE, number)
        figure |= cycles[number]
    return figures
