"""What the page says and shows as numbers and arrows, asked of its modules without its controls,
and what must be true: Python's motion, Newton's law of every drawn body, the scene handed out.

Over 300 lines, as it is one table: of a case what the page says, and guard by guard what must hold.
"""

import dataclasses
import io
import json
import math
from functools import cache

import numpy as np
from page_visit import expected
from turned import turned

from crankmbs import flywheel, load_scene, simulate
from crankmbs.compare.lectured import LECTURES, lectured
from crankmbs.mechanics.train import crank_train
from crankmbs.mechanics.variables import EVERY, SUMS
from crankmbs.page import joined
from crankmbs.page.document import page_of
from crankmbs.scene.run import Extent

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
    "uniform": ("grega_lecture", {"rod": "rigid", "rod_mass": 0.5, "pressure": 80.0}, 0),
}  # fmt: skip
"""Name -> scene, values of its knobs, cylinder from 0."""
FREED = ("freed", "freed rubbing")
EVENED = "lumped"  # the case in which a flywheel for a fluctuation is sought

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
POSES = (40, 130, 222, 310)  # samples at which the drawing is looked at

_MODULES = (
    *("answers", "cycle", "drawing", "engine", "flywheel", "forces"),
    *("geometry", "quantities", "stage", "taken", "turned", "words"),
)
# a cycle that is computed is kept under the name of its case, for mutants that only show it
_PROBE = """([script, text, { name, values, k, curves, poses, evens, fresh }]) => {
  const page = eval(script);
  const given = page.answers.decoded(JSON.parse(text));
  const turner = new page.turned.Turner(given);
  const own = new page.engine.Engine(given.rules);
  window.cycles ??= {};
  const asked = fresh ? turner.scene(values) : window.cycles[name].scene;
  const of = (scene) => page.cycle.cycleOf(own, scene, given.endings, { fine: true });
  const shown = fresh ? of(asked) : window.cycles[name];
  if (fresh) window.cycles[name] = shown;
  const root = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  document.body.replaceChildren(root);
  const stage = new page.stage.Stage(root, given.compression, () => {});
  const attributes = (each) => each && Object.fromEntries(
    Array.from(each.attributes, ({ name, value }) => [name, value]));
  const one = (what) => attributes(root.querySelector(what));
  const all = (what) => Array.from(root.querySelectorAll(what), (each) =>
    ({ ...attributes(each), text: each.textContent }));
  const posed = (body, n) => {
    const scenes = given.scene.crank.inertia;
    const ratio = scenes > 0 ? asked.crank.inertia / scenes : 1;
    stage.show(shown, { k, body, ratio, heavy: true });
    stage.pose(shown.angles[n]);
    return {
      pin: one(".chosen [data-grip=pin]"), small: one(".chosen .eye:not(.grip)"),
      piston: one(".chosen .piston"), web: one(".chosen .web"), mark: one(".mark"),
      ring: one(".ring g"), lead: one("path.lead"), says: stage.leadInWords(shown.angles[n]),
      arrows: all(".arrows path"), names: all(".arrows text"), bar: all(".scale *"),
      rim: one(".rim"), disc: one(".disc"),
    };
  };
  const bodies = ["piston", "rod", "crank"];
  const dead = { top: page.geometry.deadCentres(shown.train.shape).top,
    bottom: page.geometry.deadCentres(shown.train.shape).bottom };
  const knob = given.knobs.find(({ name }) => name === "flywheel");
  const even = (inertia) => of(turner.scene({ ...values, flywheel: inertia })).fluctuation;
  const middle = 0.5 * (shown.angles[77] + shown.angles[78]);
  const [, csv] = page.taken.dataFile(given, shown);
  return csv.text().then((data) => JSON.stringify({
    data, files: page.taken.sceneFiles(given, values, shown),
    mean: shown.mean, gain: shown.gain, fluctuation: shown.fluctuation, leads: shown.leads,
    settled: shown.settled, prescribed: shown.prescribed, angles: shown.angles,
    lead: shown.leadAt(middle), ahead: shown.timeTo(middle),
    angle: shown.angleAt(shown.timeTo(middle) + 2 * shown.duration),
    curves: Object.fromEntries([...curves, "crank ahead of the mean"].map((name) => {
      const drawn = page.quantities.drawn(name, shown, k);
      return [name, { ...drawn, now: drawn.of(shown.angles[100]) }];
    })),
    forces: bodies.map((body) => shown.samples.map((v) =>
      page.forces.forcesOn(body, shown.train, v, k))),
    poses: bodies.map((body) => poses.map((n) => posed(body, n))),
    numbers: page.words.numbersOf(shown, 2.3e-5), badge: page.words.badgeOf(shown, given.endings),
    marks: page.words.deadCentreMarks(shown, k, dead),
    rim: page.drawing.inertiaOfRim(posed("none", 0).rim.r / 1000, asked.crank.radius),
    even: evens
      ? page.flywheel.inertiaFor(0.04, even, { ...knob, value: asked.crank.inertia },
        given.sentences.fluctuation)
      : null,
  }));
}"""

_TURN = """([script, text, values]) => {
  const { answers, turned } = eval(script);
  return JSON.stringify(new turned.Turner(answers.decoded(JSON.parse(text))).scene(values));
}"""


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
    text = page_of(load_scene(name), "mine")
    return text.partition('id="given">')[2].partition("</script>")[0]


def probe(page, script, name, *, fresh=True, evens=True):
    """All that the modules say of a case.

    fresh : whether the cycle is computed, else it is that of the last time; evens : whether a
    flywheel is sought, in the case for it
    """
    scene, values, k = CASES[name]
    asked = {
        "name": name,
        "values": values,
        "k": k,
        "curves": [*CURVES, "p-V diagram", *POLARS],
        "poses": POSES,
        "evens": evens and name == EVENED,
        "fresh": fresh,
    }
    return json.loads(page.evaluate(_PROBE, [script, given(scene), asked]))


def scene_of(page, script, name):
    """The scene that the knobs give in a case, as text."""
    scene, values, _ = CASES[name]
    return page.evaluate(_TURN, [script, given(scene), values])


@cache
def truth(name):
    """Scene and data of Python for a case."""
    scene_name, values, _ = CASES[name]
    scene = turned(load_scene(scene_name), values)
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


def wrong(name, said, read):
    """The names of the guards that what a case says does not hold.

    read : of files { name: text }, the scene in them
    """
    scene, data = truth(name)
    about = (scene, data, CASES[name][2])
    guards = {
        "data": lambda: data_hold(said["data"], data),
        "files": lambda: files_hold(said, name, read),
        "cycle": lambda: cycle_holds(said, *about),
        "curves": lambda: curves_hold(said, *about),
        "polars": lambda: polars_hold(said, *about),
        "forces": lambda: forces_hold(said["forces"], *about),
        "drawing": lambda: drawing_holds(said, *about),
        "words": lambda: words_hold(said, *about),
        "flywheel": lambda: flywheel_holds(said["even"], scene),
    }
    return [guard for guard, holds in guards.items() if not holds()]


_HELD: dict[str, dict[str, str]] = {}


def files_hold(said, name, read):
    """Whether the scene in the files that are handed out has the data that are; files that are not
    those for which this was so hold another scene."""
    if name in _HELD:
        return _HELD[name] == said["files"]
    data = cycle_of(read(said["files"]), name)
    if not data_hold(said["data"], data):
        return False
    _HELD[name] = said["files"]
    return True


def data_hold(text, data):
    """The columns handed out: every variable under its name and unit, of its peak, or where it may
    cancel of that of its unit."""
    names = text.splitlines()[0].split(",")
    rows = np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)
    columns = dict(zip(names, rows.T, strict=True))
    largest: dict[str, float] = {}
    variables = [v for v in data.variables if v not in ("cylinder", "energy_residual")]
    for variable in variables:
        unit = EVERY[variable].units
        largest[unit] = max(largest.get(unit, 0.0), np.abs(data[variable].values).max())
    start = columns["time [s]"][0]
    for variable in variables:
        values, unit = data[variable].values, EVERY[variable].units
        own = np.abs(values).max()
        size = largest[unit] if variable in SUMS or own < 1e-9 * largest[unit] else own
        for number, one in enumerate(np.atleast_2d(values.T), start=1):
            of = f" {number}" if values.ndim == 2 else ""
            found = columns.get(f"{variable}{of} [{unit}]")
            if variable == "time":
                found, one, size = columns["time [s]"] - start, one - one[0], one[-1] - one[0]
            if variable == "crank_angle":
                one = one - one[0] + columns["crank_angle [rad]"][0]
            if found is None or not same(found, one, size, 5e-9):
                return False
    return True


def cycle_holds(said, scene, data, _):
    """Mean, gain and fluctuation of the speed, and the crank's lead on a ring that turns evenly."""
    time, angle = data["time"].values, data["crank_angle"].values
    speed = data["crank_speed"].values
    mean = (angle[-1] - angle[0]) / (time[-1] - time[0])
    lead = angle - angle[0] - mean * (time - time[0])
    lead -= lead[1:].mean()
    middle = 0.5 * (said["angles"][77] + said["angles"][78])
    return (
        same(said["mean"], mean)
        and same(said["gain"], (speed[-1] - speed[0]) * 30.0 / math.pi, mean)
        and same(said["fluctuation"], np.ptp(speed) / mean, near=2e-3)
        and same(said["leads"], lead, 1.0)
        and same(said["lead"], 0.5 * (lead[77] + lead[78]), 1.0)
        and same(said["ahead"], 0.5 * (time[77] + time[78]) - time[0], near=1e-4)
        and same(said["angle"], middle, near=1e-5)
        and said["prescribed"] == (scene.motion is not None)
    )


def at_mean(scene, data):
    """What the lectures say at the mean speed, exact and truncated."""
    time, angle = data["time"].values, data["crank_angle"].values
    mean = np.full(angle.shape, (angle[-1] - angle[0]) / (time[-1] - time[0]))
    still = np.zeros_like(mean)
    train = crank_train(scene)
    return [
        lectured(LECTURES[each], train, angle, mean, still)
        for each in ("untruncated lecture", "S1 (motion and forces truncated)")
    ]


def of_cylinder(values, k, total=False):
    if values.ndim == 1:
        return values
    return values.sum(axis=1) if total else values[:, k]


def curves_hold(said, scene, data, k):
    """Every curve in its unit, those of the lectures, and what one is less the next."""
    says = at_mean(scene, data)
    shape = scene.crank.radius, scene.rod.length, scene.piston.offset
    datum = shape[0] + shape[1] - math.sqrt((shape[0] + shape[1]) ** 2 - shape[2] ** 2)
    for name, (variable, per, unit) in CURVES.items():
        if variable == "gas_pressure" and scene.gas is None:
            continue
        found = said["curves"][name]
        total = name == "turning moment"
        wanted = [of_cylinder(data[variable].values, k, total)]
        if name in SAID:
            less = datum if name == "piston displacement" else 0.0
            wanted += [of_cylinder(each[SAID[name]], k, total) - less for each in says]
        elif name == "crank speed":
            wanted.append(np.full(wanted[0].shape, said["mean"]))
        large = unit == "N" and max(np.abs(each).max() for each in wanted) >= 1e3
        factor = 1e-3 if large else per
        size = factor * max(np.abs(each).max() for each in wanted)
        size = max(size, factor * 1e-6 * np.abs(data["crank_pin_force_x"].values).max())
        if found["up"]["unit"] != ("kN" if large else unit) or found["up"]["text"] != name:
            return False
        if len(found["curves"]) != len(wanted):
            return False
        pairs = zip(found["curves"], wanted, strict=True)
        if not all(same(one["y"], factor * two, size, 1e-8) for one, two in pairs):
            return False
        if not all(same(each["x"], np.degrees(said["angles"])) for each in found["curves"]):
            return False
        if not same(found["now"], factor * wanted[0][100], size, 1e-8):
            return False
        for each, one, two in zip(found["differences"], wanted, wanted[1:], strict=False):
            if not same(each["y"], factor * (one - two), size, 2e-8):
                return False
        if len(found["differences"]) != len(wanted) - 1:
            return False
    ahead = said["curves"]["crank ahead of the mean"]
    return ahead["up"]["unit"] == "°" and same(ahead["curves"][0]["y"], np.degrees(said["leads"]))


def polars_hold(said, scene, data, k):
    """Diagrams: pressure over the swept volume, and forces with X up and Y to the left."""
    says = at_mean(scene, data)[1]
    for name, variable in POLARS.items():
        found = said["curves"][name]
        wanted = [[of_cylinder(data[f"{variable}_{axis}"].values, k) for axis in "yx"]]
        if variable != "frame_force":
            key = variable.replace("_", " ")
            wanted.append([of_cylinder(says[f"{key} {axis}"], k) for axis in "yx"])
        per = 1e-3 if np.abs(wanted).max() >= 1e3 else 1.0
        units = {found[axis]["unit"] for axis in ("up", "right")}
        if not found["equal"] or units != {"kN" if per < 1.0 else "N"}:
            return False
        size = per * max(np.abs(wanted).max(), 1e-6 * np.abs(data["crank_pin_force_x"]).max())
        for curve, pair in zip(found["curves"], wanted, strict=True):
            if not same([curve["x"], curve["y"]], per * np.array(pair), size, 1e-8):
                return False
    found = said["curves"]["p-V diagram"]
    if scene.gas is None:
        return True
    volume = area(scene) * 1e6 * of_cylinder(data["piston_displacement"].values, k)
    pressure = 1e-5 * of_cylinder(data["gas_pressure"].values, k)
    (curve,) = found["curves"]
    shown = [found[axis]["unit"] for axis in ("right", "up")]
    return (
        same(curve["x"], volume)
        and same(curve["y"], pressure, near=1e-8)
        and shown == ["cm³", "bar"]
    )


def area(scene):
    """Of the piston's crown [m2]."""
    piston = scene.piston
    return piston.area if piston.bore is None else 0.25 * math.pi * piston.bore**2


def frame(bank, x, y):
    """From a cylinder's axes to the engine's, X and Y as a complex number."""
    return np.exp(1j * bank) * (x + 1j * y)


def forces_hold(forces, scene, data, k):
    """Newton: the arrows on a body and its weight give its acceleration; Euler: about its centre of
    mass those on the rod turn it."""
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    cylinder = scene.cylinders[k]
    g = gravity_of(scene)
    one = {name: of_cylinder(data[name].values, k) for name in data.data_vars}
    phi = data["crank_angle"].values + cylinder.phase
    pins = [
        frame(cylinder.bank, one["piston_position"], piston.offset),
        frame(cylinder.bank, crank.radius * np.cos(phi), crank.radius * np.sin(phi)),
    ]
    share = rod.center_of_mass / rod.length
    turned_by = np.exp(1j * data["crank_angle"].values)
    omega, alpha = data["crank_speed"].values, data["crank_acceleration"].values
    lag = frame(cylinder.bank + cylinder.phase, crank.radius, 0.0)
    of_pin = (1j * alpha - omega**2) * turned_by * lag
    of_piston = frame(cylinder.bank, -one["piston_acceleration"], 0.0)
    of_rod = (1.0 - share) * of_pin + share * of_piston
    of_crank = (1j * alpha - omega**2) * turned_by * crank.center_of_mass
    wanted = [(piston.mass, of_piston), (rod.mass, of_rod), (crank.mass, of_crank)]
    size = np.abs(data["crank_pin_force_x"].values).max()
    for arrows, (mass, accelerates) in zip(forces, wanted, strict=True):
        total = sum_of(arrows)
        needed = mass * (accelerates - g)
        if not same([total.real, total.imag], [needed.real, needed.imag], size, 1e-8):
            return False
    places = [[complex(*each["at"]) for each in arrows] for arrows in forces[1]]
    on_rod = np.array(places).T
    centre = pins[1] + share * (pins[0] - pins[1])
    if not all(
        same(np.abs(one - two), 0.0 * phi, 1.0) for one, two in zip(on_rod, pins, strict=True)
    ):
        return False
    parts = [[complex(*each["force"]) for each in arrows] for arrows in forces[1]]
    moment = sum(
        ((place - centre).conj() * force).imag
        for place, force in zip(on_rod, np.array(parts).T, strict=True)
    )
    inertia = (
        rod.mass * rod.center_of_mass * (rod.length - rod.center_of_mass)
        if rod.inertia == "two-mass"
        else rod.inertia
    )
    spin = -inertia * one["rod_angular_acceleration"]
    return same(np.abs(moment), np.abs(spin), size * rod.length, 1e-8) and named_rightly(
        forces, pins, scene
    )


def gravity_of(scene):
    if scene.gravity is None:
        return 0.0
    return scene.gravity.acceleration * np.exp(1j * scene.gravity.angle)


def sum_of(samples):
    return np.array([sum(complex(*each["force"]) for each in arrows) for arrows in samples])


def named_rightly(forces, pins, scene):
    """What acts where: gas and wall on the piston at its pin, rods on the crank at theirs."""
    on_piston, _, on_crank = (samples[0] for samples in forces)
    names = {"wall on piston", "rod on piston"} | ({"gas on piston"} if scene.gas else set())
    names |= {"friction on piston"} if scene.friction else set()
    n = len(scene.cylinders)
    rods = [f"rod {number} on crank" for number in range(1, n + 1)] if n > 1 else ["rod on crank"]
    return (
        {each["name"] for each in on_piston} == names
        and all(abs(complex(*each["at"]) - pins[0][0]) < 1e-12 for each in on_piston)
        and [each["name"] for each in on_crank] == [*rods, "bearing on crank"]
        and abs(complex(*on_crank[-1]["at"])) < 1e-12
        and all(
            abs(abs(complex(*each["at"])) - scene.crank.radius) < 1e-12 for each in on_crank[:-1]
        )
    )


def drawing_holds(said, scene, data, k):
    """Pins, piston, notch and ring where the mechanism has them in millimetres with X upwards and Y
    to the left, arrows as long as their bar says, the disc's inertia by its rim."""
    crank, cylinder = scene.crank, scene.cylinders[k]
    most = max(map(abs, said["leads"]))
    position = of_cylinder(data["piston_position"].values, k)
    for body, poses in enumerate(said["poses"]):
        for n, pose in zip(POSES, poses, strict=True):
            theta, lead = said["angles"][n], said["leads"][n]
            throw = frame(cylinder.bank + cylinder.phase + theta, crank.radius, 0.0)
            pin = frame(cylinder.bank, position[n], scene.piston.offset)
            ok = (
                at(pose["pin"], throw)
                and at(pose["small"], pin)
                and same(numbers(pose["piston"]["transform"]), [0.0, -1e3 * position[n]])
                and turns(pose["web"], theta + cylinder.phase + cylinder.bank)
                and turns(pose["mark"], theta)
                and ring_holds(pose, theta, lead, most)
                and arrows_hold(pose, said["forces"][body][n], 20.0 * crank.radius)
            )
            if not ok:
                return False
    return own_inertia(scene, said["rim"])


def own_inertia(scene, found):
    """A scene without a flywheel of its own, or one that is turned, has a rim accordingly."""
    names = {id(case): case for case in CASES.values()}
    for case in names.values():
        if truth_is(case, scene):
            own = load_scene(case[0]).crank.moment_of_inertia
            return own == 0.0 or same(found, scene.crank.moment_of_inertia / own, near=1e-6)
    return False


def truth_is(case, scene):
    return any(CASES[name] is case and truth(name)[0] is scene for name in CASES)


def at(circle, place):
    return same([float(circle["cx"]), float(circle["cy"])], [-1e3 * place.imag, -1e3 * place.real])


def numbers(text):
    return [float(each) for each in text.partition("(")[2].rstrip(")").split()]


def turns(element, angle):
    """Counter-clockwise, as the screen has it."""
    (degrees,) = numbers(element["transform"])
    return abs(np.exp(-1j * math.radians(degrees)) - np.exp(1j * angle)) < 1e-9


def ring_holds(pose, theta, lead, most):
    """The ring is behind the crank by the lead times what is said, at most 14 degrees."""
    words = pose["says"]
    if words == "the crank turns evenly":
        return most <= 1e-9 and pose["ring"] is None
    times = float(words.rpartition("shown ")[2].removesuffix(" times"))
    degrees, where = words.removeprefix("crank ").split("° ")
    ahead = "ahead" if lead > 0.0 else "behind"
    return (
        times * most <= math.radians(14.0) * (1.0 + 1e-9)
        and turns(pose["ring"], theta - times * lead)
        and abs(float(degrees) - abs(math.degrees(lead))) < 0.051
        and where.startswith(ahead)
        and pose["lead"]["class"] == f"lead {ahead}"
    )


def arrows_hold(pose, forces, least):
    """Their lengths are to the scale's bar as their forces to what it says, and all are there that
    are not too short [mm]."""
    path, text = pose["bar"]
    newtons, unit, *_ = text["text"].replace(",", "").split()
    size = float(newtons) * (1e3 if unit == "kN" else 1.0)
    bar = float(path["d"].partition("h")[2].partition("v")[0])
    by_name = {each["name"]: complex(*each["force"]) for each in forces}
    for arrow, name in zip(pose["arrows"], pose["names"], strict=True):
        points = [complex(*map(float, each.split())) for each in arrow["d"][1:-1].split("L")]
        drawn = points[3] - 0.5 * (points[0] + points[-1])
        force = by_name[name["text"]]
        if abs(drawn - bar / size * complex(-force.imag, -force.real)) > 0.3:
            return False
    long = {name for name, force in by_name.items() if bar / size * abs(force) > least}
    return {each["text"] for each in pose["names"]} == long


def words_hold(said, scene, data, k):
    """The headline's numbers, the badge, and dead centres where the piston stands still."""
    numbers_said = {name: text.replace("\u2212", "-") for name, text in said["numbers"]}
    angle, time = data["crank_angle"].values, data["time"].values
    speed, outside = data["crank_speed"].values, data["external_torque"].values
    mean = (angle[-1] - angle[0]) / (time[-1] - time[0])
    close = {
        "mean speed": (mean * 30.0 / math.pi, "rpm", 0.051),
        "fluctuation": (100.0 * np.ptp(speed) / mean, "%", 0.02),
    }
    done = np.trapezoid(outside, angle)
    drives = scene.motion is not None or done > 0.0
    close["drive torque" if drives else "load torque"] = (done / (angle[-1] - angle[0]), "N m", 0.2)
    if scene.gas is not None:
        volume = area(scene) * data["piston_displacement"].values
        pressure = data["gas_pressure"].values
        work = (
            np.trapezoid(pressure, volume, axis=0)
            if volume.ndim == 1
            else sum(np.trapezoid(p, v) for p, v in zip(pressure.T, volume.T, strict=True))
        )
        close["indicated power"] = (1e-3 * work / (time[-1] - time[0]), "kW", 0.05)
    if scene.friction is not None:
        power = data["friction_force"].values * data["piston_velocity"].values
        rubbed = -np.trapezoid(power.reshape(len(time), -1).sum(axis=1), time)
        close["friction power"] = (1e-3 * rubbed / (time[-1] - time[0]), "kW", 0.01)
        close["mechanical efficiency"] = (100.0 * (1.0 - rubbed / work), "%", 0.1)
    if numbers_said.get("cylinders", "1") != str(len(scene.cylinders)):
        return False
    for name, (value, unit, near) in close.items():
        text = numbers_said.get(name, "")
        number = text.removesuffix(f" {unit}")
        if number == text or not abs(float(number) - value) <= near + 2e-3 * abs(value) * (
            name not in ("mean speed", "fluctuation")
        ):
            return False
    still = of_cylinder(data["piston_velocity"].values, k)
    degrees = np.degrees(said["angles"])
    for mark in said["marks"]:
        at_mark = np.interp(mark["degrees"], degrees, still)
        high = np.interp(
            mark["degrees"], degrees, of_cylinder(data["piston_displacement"].values, k)
        )
        if abs(at_mark) > 1e-3 * np.abs(still).max():
            return False
        if (high < 0.5 * scene.crank.radius) != (mark["name"] == "top"):
            return False
    gain = (speed[-1] - speed[0]) * 30.0 / math.pi
    badge = said["badge"]["text"]
    if abs(gain) > 1.0 and f"{'gains' if gain > 0 else 'loses'} {abs(gain):.0f} rpm" not in badge:
        return False
    drifts = scene.motion is None and abs(gain) > 1e-3
    kind = "prescribed" if scene.motion is not None else "not settled" if drifts else "settled"
    if scene.torque and scene.torque[-1].kind == "constant":
        kind = "settled under the constant torque that balances the cycle"
        kind += ": every speed" if scene.friction is None else " at the mean"
    turns_made = round((angle[-1] - angle[0]) / math.tau)
    return (
        badge.startswith(kind)
        and said["badge"]["good"] != drifts
        and len(said["marks"]) >= 2 * turns_made
    )


def flywheel_holds(found, scene):
    if found is None:
        return True
    settled = dataclasses.replace(scene, run=dataclasses.replace(scene.run, until="settled"))
    return same(found, flywheel_of(settled), near=1e-6)


@cache
def flywheel_of(scene):
    return flywheel(scene, 0.04).inertia.value
