"""Scenes that between them use every formula of the page's engine, and what it must answer."""

import math
from dataclasses import replace

import numpy as np

from crankmbs import load_scene
from crankmbs.mechanics.axes import closed_loops, displacements
from crankmbs.page import exported
from crankmbs.page.film import film_of
from crankmbs.scene.drives import Motion, Oscillation, Ramp, SpeedFile, Start
from crankmbs.scene.forces import (
    ConstantForce,
    Damper,
    ForceAngleTable,
    Spring,
    TravelTable,
)
from crankmbs.scene.fuel import Fuel, Misfire
from crankmbs.scene.gas import Polytrope
from crankmbs.scene.loads import AngleTable, Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Cylinder, Friction, Gravity, Layout, OwnPiston, OwnRod
from crankmbs.scene.run import Extent
from crankmbs.scene.tables import CylinderTable, Table

EVERY = Extent(value=math.radians(15.0), unit="rad")
MACHINE = {
    "layout": Layout(
        cylinders=(
            Cylinder(phase=0.0, bank=-0.4, position=0.0),
            Cylinder(phase=2.0, bank=0.5, position=0.1),
        )
    ),
    "gravity": Gravity(acceleration=9.81, angle=2.5),
}


POLYTROPE = Polytrope(polytrope=1.32, closes=math.radians(-20.0), compression_ratio=18.0)


def running(name, until, **changes):
    scene = load_scene(name)
    run = replace(scene.run, until=until, every=EVERY)
    return replace(scene, run=run, **changes)


def started():
    """Every load, window and kink, fuel of every kind."""
    scene = running("yi_diesel_free", Extent(value=0.14, unit="s"), **MACHINE)
    angle = np.linspace(0.0, 6.0, 9)
    bent = Table((250.0, 325.0, 330.0, 330.0, 400.0), (60.0, 40.0, 20.0, 35.0, -90.0))
    loads = (
        Quadratic(coefficient=2e-4, after=0.02, until_speed=345.0),
        Viscous(coefficient=0.05, from_speed=342.0),
        TimeTable(file=Table((0.0, 0.03, 0.03, 0.05, 1.0), (0.0, 40.0, -30.0, 10.0, 0.0))),
        SpeedTable(file=bent, until=0.1),
        AngleTable(
            file=Table(tuple(angle.tolist()), tuple((20.0 * np.sin(3.0 * angle)).tolist())),
            interpolation="pchip",
        ),
        Constant(torque=-40.0, after=0.04, until=0.09),
    )
    lists = (Misfire(cylinder=2, cycles="2"), Misfire(cylinder=1, cycles="every 2"))
    crank = replace(scene.crank, mass=6.0, center_of_mass=0.01)
    gas = replace(scene.gas, motored=POLYTROPE)
    fuel = Fuel(misfire=lists, until=0.1)
    return replace(scene, crank=crank, torque=loads, gas=gas, fuel=fuel)


def backwards():
    scene = running("coasting", Extent(value=2.0, unit="cycle"))
    loads = (SpeedTable(file=Table((-120.0, -98.0, -60.0), (9.0, 2.0, 0.0))),)
    return replace(scene, start=Start(angle=0.3, speed=-100.0), torque=loads)


def short_rod():
    """So short that cells of 6 degrees must be cut."""
    scene = running("coasting", Extent(value=1.0, unit="cycle"))
    return replace(scene, rod=replace(scene.rod, length=0.0475))


def settling():
    """Under a table of the speed, whose rows the speed passes in every cycle."""
    scene = running("propeller", "settled", **MACHINE)
    table = Table((150.0, 335.0, 337.0, 500.0), (0.0, -15.0, -30.0, -60.0))
    return replace(scene, torque=(SpeedTable(file=table),))


def balanced():
    return running("yi_diesel_free", "settled", gas=None, torque=(Constant(torque=0.0),))


RUBBING = Friction(ring_force=30.0, ring_pressure=0.03, viscous=20.0)


def rubbing(name, until, friction, **changes):
    return replace(running(name, until, **changes), friction=friction)


def driven(speed):
    scene = running("yi_diesel", Extent(value=1.5, unit="cycle"), **MACHINE)
    return replace(scene, motion=Motion(speed=speed, angle=0.2))


def timed(scene):
    """Its run ends at a time."""
    return replace(scene, run=replace(scene.run, until=Extent(value=0.05, unit="s")))


def misfiring(scene):
    fuel = Fuel(misfire=(Misfire(cylinder=2, cycles="1"),), after=0.01)
    return replace(scene, gas=replace(scene.gas, motored=POLYTROPE), fuel=fuel)


def several_cycles():
    """Of which cells come again, with the same cylinders firing, also under other loads."""
    scene = running("yi_diesel_free", Extent(value=4.0, unit="cycle"))
    return misfiring(replace(scene, torque=(*scene.torque, Constant(torque=-20.0, until=0.06))))


def even_cells():
    """Like cylinders at whole cells from one another, in other banks."""
    first = MACHINE["layout"].cylinders[0]
    leaning = replace(first, phase=math.pi, bank=0.5, position=0.1)
    layout = Layout(cylinders=(first, leaning))
    until = Extent(value=1.2, unit="cycle")
    return running("coasting", until, layout=layout, gravity=MACHINE["gravity"])


def like_cylinders(**changes):
    """At whole cells from one another."""
    scene = running("yi_diesel_free", Extent(value=1.2, unit="cycle"))
    cylinders = (Cylinder(phase=0.0), Cylinder(phase=math.pi))
    return replace(scene, layout=Layout(cylinders=cylinders), **changes)


def unlike_pressures():
    angles = (0.0, math.pi, 2.0 * math.pi, 3.0 * math.pi)
    values = ((1e5, 3e6, 2e5, 1e5), (1e5, 1e6, 5e5, 2e5))
    gas = load_scene("yi_diesel_free").gas
    return like_cylinders(gas=replace(gas, pressure=CylinderTable(angles, values, "each its own")))


def both_ends():
    """Gas below the pistons too, over as long again."""
    scene = running("yi_diesel_free", Extent(value=0.06, unit="s"), **MACHINE)
    rows = tuple(np.linspace(0.3, 0.3 + 8.0 * math.pi, 12, endpoint=False).tolist())
    values = (1e5, 3e5, 9e5, 2e5, 1e5, 4e5, 6e5, 1e5, 2e5, 1e5, 5e5, 3e5)
    gas = replace(scene.gas, crank_end=Table(rows, values), cycles="sequence")
    return replace(scene, gas=gas, piston=replace(scene.piston, rod_diameter=0.04))


def uneven(scene):
    """The second cylinder with another throw, rod and piston than the first."""
    own = Cylinder(
        phase=2.0,
        bank=0.5,
        position=0.1,
        radius=0.9 * scene.crank.radius,
        rod=OwnRod(length=1.2 * scene.rod.length, mass=0.7 * scene.rod.mass),
        piston=OwnPiston(mass=1.3 * scene.piston.mass, bore=0.07, rod_diameter=0.02, offset=0.02),
    )
    first = MACHINE["layout"].cylinders[0]
    return replace(scene, layout=Layout(cylinders=(first, own)))


WAYS = CylinderTable(
    (0.0, 0.02, 0.05, 0.3), ((100.0, 600.0, -300.0, 200.0), (400.0, 300.0, 900.0, 100.0)), "ways"
)
SOFT = CylinderTable((0.0, 0.05, 0.3), ((-5.0, 10.0, 3.0), (15.0, 20.0, 8.0)), "soft ways")
STEP = Table((0.0, 0.03, 0.03, 0.3), (100.0, -200.0, 650.0, 80.0))
TURN = Table((0.1, 1.5, 3.0, 3.0, 5.0), (100.0, -200.0, 650.0, 80.0, 10.0))
TURNS = Table((0.3, 3.5, 6.0, 7.0, 11.0), (100.0, -400.0, 350.0, 80.0, 10.0))
PUSHES = (
    Spring(stiffness=5e3, relaxed_at=0.02),
    ConstantForce(force=-150.0, cylinder=1),
    TravelTable(file=WAYS),
    TravelTable(file=STEP, cylinder=2),
    ForceAngleTable(file=TURN, interpolation="pchip", cylinder=1),
    ForceAngleTable(file=TURNS),
)
DRAGS = (*PUSHES, Damper(coefficient=30.0), Damper(coefficient=50.0, cylinder=2))
"""Forces of every kind on the pistons, and besides what drags."""


def stepping(scene):
    """A force that jumps where the first piston is at a sample, 60 degrees after its centre."""
    loop = closed_loops(scene, np.array([math.radians(60.0)]))
    at = float(displacements(scene, loop)[0, 0])
    step = Table((0.0, at, at, 0.3), (0.0, 100.0, -900.0, 0.0))
    return replace(scene, force=(*scene.force, TravelTable(file=step, cylinder=1)))


SWING = Oscillation(mean=300.0, amplitude=60.0, order=1.5, phase=0.4)
RISE = Ramp(start=250.0, to=330.0, over=0.02)
MEASURED_SPEED = SpeedFile(file=Table((0.0, 0.02, 0.05, 0.2), (280.0, 300.0, 260.0, 300.0)))

ROWS = Table((0.013, 2.0, 3.3, 5.1, 0.013 + math.tau), (300.0, 380.0, 180.0, 270.0, 300.0))
OVER_ANGLE = SpeedFile(file=ROWS, kind="angle_table", interpolation="cubic")

GUARDS = {
    "swinging": driven(SWING),
    "rising": misfiring(driven(RISE)),
    "measured speed": driven(MEASURED_SPEED),
    "over the angle": driven(OVER_ANGLE),
    "settling": settling(),
    "backwards": backwards(),
    "short rod": short_rod(),
    "several cycles": several_cycles(),
    "even cells": even_cells(),
    "unlike pressures": unlike_pressures(),
    "pushed alone": like_cylinders(force=(ConstantForce(force=-150.0, cylinder=1),)),
    "affine": running("v_twin", "settled"),
    "rings": rubbing("v_twin", "settled", replace(RUBBING, viscous=0.0), **MACHINE),
    "rubbing": rubbing("propeller", Extent(value=1.2, unit="cycle"), RUBBING),
    "rubbing driven": replace(misfiring(driven(RISE)), friction=RUBBING),
    "rubbing backwards": replace(backwards(), friction=replace(RUBBING, ring_pressure=0.0)),
    "started": replace(started(), friction=RUBBING),
    "both ends": replace(misfiring(both_ends()), friction=RUBBING),
    "unlike": replace(uneven(misfiring(both_ends())), friction=RUBBING),
    "pushed": stepping(replace(running("v_twin", "settled", **MACHINE), force=PUSHES)),
    "dragged and settled": replace(running("v_twin", "settled", **MACHINE), force=DRAGS),
    "dragged": replace(uneven(running("propeller", Extent(value=1.2, unit="cycle"))), force=DRAGS),
    "pushed backwards": replace(backwards(), force=(TravelTable(file=SOFT),)),
    "pushed driven": replace(driven(RISE), force=DRAGS),
}


def light(inertia=0.001):
    """So light that at the begin it has not the energy that is wanting later."""
    scene = driven(300.0)
    return replace(scene, crank=replace(scene.crank, mass=0.0, inertia=inertia))


def near_rest():
    scene = light(1e-6)
    return replace(scene, rod=replace(scene.rod, mass=0.1), piston=replace(scene.piston, mass=0.1))


def dragging():
    """Of friction that brakes a light crank by more than half of its energy in a period."""
    scene = driven(RISE)
    heavier = replace(scene.crank, mass=0.0, inertia=0.004)
    return replace(scene, crank=heavier, friction=replace(RUBBING, viscous=200.0))


FREED = {
    "swinging": driven(SWING),
    "over the angle": driven(OVER_ANGLE),
    "backwards": timed(driven(-300.0)),
    "rising": timed(driven(RISE)),
    "light": light(),
    "near rest": near_rest(),
    "slow at the begin": replace(light(), motion=Motion(speed=300.0, angle=1.7)),
    "dragging": dragging(),
    "pushed": replace(dragging(), force=DRAGS),
    "dragging backwards": replace(dragging(), motion=Motion(speed=-280.0, angle=0.2)),
}
"""Prescribed speeds that are set free."""


def tasks(angles):
    """What is asked of an engine, the name of what answers and its arguments by what a mutant's
    `by` calls it: lectures, pressures carried over, and the guards by their names at crank angles.
    """
    found = {
        "lectured": ("lectured", lecture("untruncated lecture")),
        "lectured S1": ("lectured", lecture(S1)),
        "lectured uneven": ("lectured", lecture(S1, uneven)),
    }
    shape = {"radius": 0.044, "length": 0.14, "offset": 0.011}
    scenes = {" ".join(pair): joined_by(*pair) for pair in JOINED}
    scenes |= {"jumping": jumping()}
    scenes |= {name: GUARDS[name] for name in ("started", "affine", "both ends")}
    for name, scene in scenes.items():
        found[f"carried {name}"] = "carried", {"scene": exported(scene), "shape": shape}
    names = ("affine", "started", "pushed", "even cells", "unlike pressures", "pushed alone")
    for name in names:
        asked = {"scene": longer(GUARDS[name]), "angles": angles[name][::3]}
        found[f"dragged {name}"] = "dragged", asked
    around, steps = np.linspace(0.2, 12.0, 24), jumping()
    steps = replace(steps, gas=replace(steps.gas, interpolation="step"))
    found["dragged steps"] = "dragged", {"scene": longer(steps), "angles": around}
    for name, scene in FREED.items():
        found[f"freeing {name}"] = "freeing", {"scene": exported(scene), "angles": around}
    still = balanced()
    film = film_of(uneven(misfiring(driven(RISE))))
    times = np.random.default_rng(5).uniform(0.0, film.given["time"][-1], 40)
    found["replayed"] = "replayed", {"film": film.given, "times": times}
    ends = np.array([0.0, still.period])
    found["answer balanced"] = "answer", {"scene": exported(still), "angles": ends}
    for name, scene in GUARDS.items():
        found[f"answer {name}"] = "answer", {"scene": exported(scene), "angles": angles[name]}
    return found


def longer(scene):
    """What a knob makes of a scene: another rod, the pressure carried over."""
    found = exported(scene)
    return {**found, "rod": {**found["rod"], "length": 1.03 * found["rod"]["length"]}}


JOINED = (
    ("propeller", "pchip"),
    ("yi_diesel", "cubic"),
    ("yi_diesel", "linear"),
    ("propeller", "step"),
)


def joined_by(name, interpolation):
    scene = load_scene(name)
    return replace(scene, gas=replace(scene.gas, interpolation=interpolation))


S1 = "S1 (motion and forces truncated)"


def jumping():
    """Rows that jump, joined by splines from jump to jump."""
    scene = load_scene("propeller")
    angle = (0.0, 2.0, 4.0, 6.0, 6.4, 6.4, 7.0, 8.0, 9.0, 10.5, 12.0)
    value = (1e5, 0.0, 1e5, 9e5, 3e6, 4e6, 2e6, 1e6, 6e5, 2e5, 1e5)
    gas = replace(scene.gas, pressure=Table(angle, value), interpolation="cubic")
    return replace(scene, gas=gas)


def lecture(name, change=lambda scene: scene):
    scene = change(replace(load_scene("yi_diesel"), **MACHINE))
    theta = np.linspace(0.0, 12.0, 19)
    samples = [
        {"theta": each, "omega": 300.0, "alpha": 2e3 * math.sin(each), "shares": []}
        for each in theta.tolist()
    ]
    return {"scene": exported(scene), "lecture": name, "samples": samples}
