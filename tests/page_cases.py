"""The cases in which the modules of the page, without its controls, say and show something, and
the motion that Python has for each."""

import dataclasses
import json
import math
from functools import cache
from pathlib import Path

import numpy as np
from page_visit import expected
from turned import turned

from crankmbs import load_scene, simulate
from crankmbs.page import joined
from crankmbs.page.document import page_of
from crankmbs.scene.forces import Spring, TravelTable
from crankmbs.scene.parts import Layout, OwnRod
from crankmbs.scene.run import Extent
from crankmbs.scene.tables import CylinderTable

CASES = {
    "vee": ("v_twin", {"rod_ratio": 0.3, "offset": 5.0, "pressure": 80.0, "load": 90.0}, 1),
    "row": (
        "propeller",
        {"speed": 3400.0, "load": 80.0, "rod_mass": 2.0, "cylinders": "3", "flywheel": 0.05,
         "counterweight": -20.0},
        2,
    ),
    "lumped": ("propeller", {"rod": "two-mass", "offset": -4.0}, 0),
    "driven": ("yi_diesel", {"speed": 4000.0, "rod_ratio": 0.2, "cylinders": "6"}, 2),
    "prescribed": ("propeller", {"speed_is": "prescribed", "speed": 2500.0}, 0),
    "drifting": ("propeller", {"load": 0.0}, 0),
    "rubbing": ("friction", {"rod_ratio": 0.26, "offset": 3.0}, 0),
    "freed": (
        "compressor",
        {"speed_is": "free", "speed": 1200.0, "flywheel": 0.015, "rod_ratio": 0.3,
         "pressure": 120.0},
        0,
    ),
    "freed rubbing": ("friction", {"speed_is": "free", "flywheel": 0.02, "rod_mass": 1.0}, 0),
    "steam": ("absolute_steam", {"pressure": 80.0, "rod_ratio": 0.25, "offset": 12.0}, 0),
    "stages": (
        "uneven_stages",
        {"speed": 1000.0, "pressure": 90.0, "flywheel": 0.5, "counterweight": -2.0},
        1,
    ),
    "pressing": ("press", {"rod_ratio": 0.25, "pressure": 110.0, "speed": 1300.0}, 0),
    "uniform": ("grega_lecture", {"rod": "rigid", "rod_mass": 0.5, "pressure": 80.0}, 0),
}  # fmt: skip
"""Name -> scene, values of its knobs, cylinder from 0."""
FREED = ("freed", "freed rubbing")


def named(name):
    """A shipped scene, or one made of it."""
    return MADE[name]() if name in MADE else load_scene(name)


def absolute_steam():
    """The steam engine, its pressures absolute."""
    scene, ambient = load_scene("steam_engine"), 101325.0

    def lifted(table):
        return dataclasses.replace(table, y=tuple(y + ambient for y in table.y))

    ends = {key: lifted(getattr(scene.gas, key)) for key in ("pressure", "crank_end")}
    gas = dataclasses.replace(scene.gas, absolute=True, ambient=ambient, **ends)
    return dataclasses.replace(scene, gas=gas)


def uneven_stages():
    """The compressor of two stages, the second with a throw, a rod and an offset of its own."""
    scene = load_scene("two_stage_compressor")
    first, second = scene.layout.cylinders
    piston = dataclasses.replace(second.piston, offset=0.006)
    rod = OwnRod(length=0.16, mass=0.6, inertia=3e-3)
    second = dataclasses.replace(second, radius=0.04, rod=rod, piston=piston)
    return dataclasses.replace(scene, layout=Layout(cylinders=(first, second)))


def press():
    """The compressor with a spring, and what it presses on the way down."""
    scene = load_scene("compressor")
    stroke = scene.running_gear[0].stroke
    x = tuple(part * stroke for part in (0.0, 0.5, 0.8, 1.0))
    ways = CylinderTable(x, ((0.0, 0.0, -900.0, -900.0), (-100.0,) * 4), "press")
    force = TravelTable(file=ways), Spring(stiffness=8e3, relaxed_at=0.5 * stroke)
    return dataclasses.replace(scene, force=force)


MADE = {made.__name__: made for made in (absolute_steam, uneven_stages, press)}

CURVES = {
    "crank speed": ("crank_speed", 30.0 / math.pi, "rpm"),
    "turning moment": ("crank_torque", 1.0, "N m"),
    "torque of the cylinder": ("crank_torque", 1.0, "N m"),
    "piston displacement": ("piston_displacement", 1e3, "mm"),
    "piston velocity": ("piston_velocity", 1.0, "m/s"),
    "piston acceleration": ("piston_acceleration", 1.0, "m/s²"),
    "gas pressure": ("gas_pressure", 1e-5, "bar"),
    "side force on the piston": ("side_force", 1.0, "N"),
    "piston pin force, axial": ("piston_pin_force_x", 1.0, "N"),
    "crank pin force, axial": ("crank_pin_force_x", 1.0, "N"),
    "crank pin force, across": ("crank_pin_force_y", 1.0, "N"),
    "main bearing force, X": ("main_bearing_force_x", 1.0, "N"),
    "main bearing force, Y": ("main_bearing_force_y", 1.0, "N"),
    "frame force, X": ("frame_force_x", 1.0, "N"),
    "frame force, Y": ("frame_force_y", 1.0, "N"),
}
"""What a plot calls it -> variable, shown units per SI unit, unit; newtons may become kN."""
SAID = {
    "turning moment": "torque",
    "torque of the cylinder": "torque",
    "piston displacement": "piston displacement",
    "piston velocity": "piston velocity",
    "piston acceleration": "piston acceleration",
    "side force on the piston": "side thrust",
    "piston pin force, axial": "piston pin force x",
    "crank pin force, axial": "crank pin force x",
    "crank pin force, across": "crank pin force y",
    "main bearing force, X": "main bearing force x",
    "main bearing force, Y": "main bearing force y",
}
POLARS = {
    "main bearing, polar": "main_bearing_force",
    "crank pin, polar": "crank_pin_force",
    "frame force, polar": "frame_force",
}
DOUBLE = ("crank end pressure",)  # of double-acting cylinders
FORCED = ("applied force",)  # of what forces from outside act on
POSES = (40, 130, 222, 310)  # samples at which the drawing is looked at

_MODULES = (
    *("cycle", "drawing", "engine", "forces", "given"),
    *("geometry", "quantities", "stage", "taken", "turned", "words"),
)
_PROBE = f"({Path(__file__).with_name('page_probe.js').read_text(encoding='utf-8')})"
_PICTURE = Path(__file__).with_name("page_picture.js").read_text(encoding="utf-8")
_TURN = """((script, text, values) => {
  const { given, turned } = eval(script);
  return new turned.Turner(given.valuesOf(JSON.parse(text))).scene(values);
})"""


def shown_script():
    """The page's script, giving its modules."""
    script = joined("page")
    modules = ", ".join(_MODULES)
    end = "return page;\n})()"
    assert script.count(end) == 1
    return script.replace(end, f"return {{ {modules} }};\n}})()")


@cache
def given(name):
    """What the page of a scene is given."""
    text = page_of(named(name), "mine")
    return text.partition('id="given">')[2].partition("</script>")[0]


def probe(v8, script, name, *, fresh=False):
    """All that the modules say of a case, but for its drawing.

    fresh : whether the cycle is computed, else it is that of the first time
    """
    scene, values, k = CASES[name]
    asked = {
        "name": name,
        "values": values,
        "k": k,
        "curves": [
            *(*CURVES, "p-V diagram", *POLARS),
            *DOUBLE[: named(scene).double_acting],
            *FORCED[: len(named(scene).force)],
        ],
        "fresh": fresh,
    }
    return v8.call(_PROBE, script, given(scene), asked)


def picture(page, script, name):
    """The drawing of a case in the browser, of the cycle of the first time."""
    scene, values, k = CASES[name]
    asked = {"name": name, "values": values, "k": k, "poses": POSES}
    return json.loads(page.evaluate(_PICTURE, [script, given(scene), asked]))


def scene_of(v8, script, name):
    """The scene that the knobs give in a case."""
    scene, values, _ = CASES[name]
    return v8.call(_TURN, script, given(scene), values)


@cache
def truth(name):
    """Scene and data of Python for a case."""
    scene_name, values, _ = CASES[name]
    scene = turned(named(scene_name), values)
    return scene, cycle_of(scene, name)


def cycle_of(scene, name):
    """The cycle that is shown: the settled one, the first, or that from the start."""
    if name == "drifting":
        every = Extent(value=math.radians(2.0), unit="rad")
        until = Extent(value=1.0, unit="cycle")
        run = dataclasses.replace(scene.run, until=until, every=every, rtol=1e-11)
        return simulate(dataclasses.replace(scene, run=run)).data
    if name in FREED:
        every = Extent(value=scene.settled_period / 360.0, unit="rad")
        run = dataclasses.replace(scene.run, every=every)
        return simulate(dataclasses.replace(scene, run=run), rtol=1e-11).data
    return expected(scene)


def same(found, wanted, size=None, near=2e-9):
    """Whether numbers are those of Python, to a share of the largest of them."""
    found, wanted = (np.array(each, dtype=float) for each in (found, wanted))
    if found.shape != wanted.shape:
        return False
    size = np.abs(wanted).max() if size is None else size
    return bool((np.abs(found - wanted) <= near * max(size, 1e-9)).all())


def of_cylinder(values, k, total=False):
    if values.ndim == 1:
        return values
    return values.sum(axis=1) if total else values[:, k]


def frame(bank, x, y):
    """From a cylinder's axes to the engine's, X and Y as a complex number."""
    return np.exp(1j * bank) * (x + 1j * y)
