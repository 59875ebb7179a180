"""Numbers far outside what machines have: each rule speaks, and is silent where it should be."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
from turned import turned

from crankmbs import (
    Bearings,
    Constant,
    Crank,
    CylinderTable,
    Piston,
    Quadratic,
    Rod,
    Shell,
    SpeedTable,
    Start,
    Table,
    TravelTable,
    load_scene,
    shipped_scenes,
)
from crankmbs.measures.plausible import warnings
from crankmbs.scene.read import parse_scene
from crankmbs.scene.template import template

DIESEL, FOUR, V_TWIN = (load_scene(name) for name in ("yi_diesel", "yi_diesel_free", "v_twin"))
COMPRESSOR, BARS = load_scene("compressor"), load_scene("torque_driven")
BAR = 1e5
SHELL = Shell(diameter="210 mm", width="120 mm")


def pressed(scene, factor):
    """With every pressure times a factor, the ambient as it was."""
    table = scene.gas.pressure
    return regassed(scene, pressure=Table(table.x, [factor * y for y in table.y]))


def regassed(scene, **changes):
    return replace(scene, gas=replace(scene.gas, **changes))


def repistoned(scene, **changes):
    return replace(scene, piston=replace(scene.piston, **changes))


def reroded(scene, **changes):
    return replace(scene, rod=replace(scene.rod, **changes))


def turned_by(scene, degrees):
    """With a table whose angles count from elsewhere."""
    table = scene.gas.pressure
    return regassed(scene, pressure=Table([x + degrees * pi / 180 for x in table.x], table.y))


def with_indicator(**changes):
    """The engine that `crankmbs new` writes."""
    scene = parse_scene(template("mine"), Path("mine.toml"))
    return regassed(scene, indicator=replace(scene.gas.indicator, **changes))


SHIPPED = {name: load_scene(name) for name in shipped_scenes()}
SPARED = {
    **SHIPPED,
    "what new writes": parse_scene(template("mine"), Path("mine.toml")),
    "textbook bars without mass": replace(BARS, crank=Crank(radius=0.1, inertia=1e-3)),
    "a two-mass rod": reroded(FOUR, inertia="two-mass"),
    "a rod of a uniform bar": reroded(FOUR, center_of_mass=0.0767, inertia=1.6 * 0.1533**2 / 12),
    "twice the pressure": turned(FOUR, {"pressure": 200.0}),
    "a motor on a compressor": replace(
        COMPRESSOR, motion=None, start=Start(angle=0.0, speed=150.0), torque=(Constant(torque=9),)
    ),
    "a starter at rest": replace(
        FOUR, start=Start(angle=0.0, speed=0.0), torque=(Constant(torque=90),)
    ),
    "a gauge pressure of 0": regassed(
        V_TWIN, pressure=0.0, indicator=None, absolute=False, ambient=None
    ),
    "a vacuum pump": regassed(V_TWIN, pressure=1e3, indicator=None),
    "an engine peaking 30 degrees late": turned_by(DIESEL, 16.0),
    "a piston and a rod of a model engine": reroded(
        repistoned(
            replace(V_TWIN, crank=Crank(radius=0.005, inertia=1e-6)),
            bore=0.01,
            mass=0.8e-3,
            offset=0.0,
        ),
        length=0.02,
        mass=0.5e-3,
        center_of_mass=0.007,
        inertia="two-mass",
    ),
    "a crosshead's bearings": replace(DIESEL, bearings=Bearings(crank_pin=SHELL)),
    "the flywheel of a hit-and-miss engine": replace(
        V_TWIN, crank=Crank(radius=0.075, inertia=18.0)
    ),
    "a cylinder far beside the crankshaft": repistoned(FOUR, offset=0.023),
    "an offset mechanism without gas": reroded(repistoned(BARS, offset=0.12), length=0.3),
    "a press, its flywheel behind a gear": replace(BARS, crank=Crank(radius=0.1, inertia=25e3)),
    "a plunger": repistoned(replace(BARS, crank=Crank(radius=0.15, inertia=1.0)), bore=0.06),
}


@pytest.mark.parametrize("name", SPARED)
def test_what_machines_have_is_let_pass(name):
    assert warnings(SPARED[name]) == ()


FOLDED = "folds onto the crank at a cycle angle of {} degrees, where the motion is not determined"
DRIVING = Table((0.0, 500.0), (50.0, 50.0))
ODD = {
    "MPa for bar": (
        pressed(DIESEL, 10.0),
        "gas: the pressure peaks at 645.6 bar, and engines fire below 300; check its unit, such "
        "as MPa for bar",
    ),
    "kPa for bar": (
        regassed(pressed(DIESEL, 0.01), absolute=False, ambient=None),
        "gas: the pressure of a four-stroke cycle peaks at 0.647 bar above ambient; even turned "
        "over it reaches several bar; check its unit",
    ),
    "bore times ten": (
        repistoned(V_TWIN, bore=0.94),
        "piston.bore: a piston 940 mm wide with a stroke of 72 mm has a bore 13.1 times the "
        "stroke; machines have 0.15 to 3.5 times; check its unit",
    ),
    "area in mm^2": (
        repistoned(DIESEL, area=57.079e-4 * 100),
        "piston.area: a piston 852.5 mm wide with a stroke of 92 mm has a bore 9.27 times the "
        "stroke; machines have 0.15 to 3.5 times; check its unit",
    ),
    "bore of a tenth": (
        reroded(repistoned(V_TWIN, bore=0.0094, mass=0.004), mass=0.0, inertia=0.0),
        "piston.bore: a piston 9.4 mm wide with a stroke of 72 mm has a bore 0.131 times the "
        "stroke; machines have 0.15 to 3.5 times; check its unit",
    ),
    "rod in mm": (
        reroded(FOUR, length=153.3),
        "rod.length: a rod of 153.3 m is 3333 times as long as the crank's radius, and machines "
        "have up to 50; a bare number is in metres",
    ),
    "rod in grams": (
        reroded(FOUR, mass=1602.847, inertia=5.8422),
        "rod.mass: 1603 kg is more than solid steel 85.25 mm wide and 153.3 mm long, 6.87 kg; a "
        "bare number is in kg",
    ),
    "piston in grams": (
        repistoned(V_TWIN, mass=380.0),
        "piston.mass: 380 kg is more than solid steel 94 mm wide and 470 mm long, 25.6 kg; a bare "
        "number is in kg",
    ),
    "rod in grams without a bore": (
        reroded(BARS, mass=2000.0),
        "rod.mass: 2000 kg is more than solid steel 600 mm wide and 300 mm long, 666 kg; a bare "
        "number is in kg",
    ),
    "rod's inertia in kg cm^2": (
        reroded(FOUR, inertia=58.422202),
        "rod.inertia: 58.42 kg m^2 about the centre of mass is that of the whole mass 6037 mm away "
        "from it, and the rod is 153.3 mm long; check its unit",
    ),
    "centre of mass beyond the rod": (
        reroded(FOUR, center_of_mass=0.16),
        "rod.center_of_mass: 160 mm from the crank pin is not between the pins, 0 to 153.3 mm; "
        "check its unit",
    ),
    "centre of mass behind the crank pin": (
        reroded(FOUR, center_of_mass=-0.038),
        "rod.center_of_mass: -38 mm from the crank pin is not between the pins, 0 to 153.3 mm; "
        "check its unit",
    ),
    "a piston of a thousandth": (
        repistoned(V_TWIN, mass=0.5e-3),
        "piston.mass: 0.5 g is less than a disc of aluminium 94 mm wide and 1.88 mm high, 35.2 g; "
        "check its unit",
    ),
    "a rod of a thousandth": (
        reroded(FOUR, mass=1.602847e-3, inertia=5.8422e-6),
        "rod.mass: 1.603 g is less than a bar of aluminium 153.3 mm long and 3.07 mm wide, 3.89 g; "
        "check its unit",
    ),
    "a rod as long as the crank's radius": (
        reroded(BARS, length=0.1, center_of_mass=0.05, inertia="two-mass"),
        "rod.length: a rod as long as crank.radius + |piston.offset|, 100 mm, "
        f"{FOLDED.format(90)}: a run ends there",
    ),
    "a rod that folds with an offset": (
        reroded(
            repistoned(BARS, offset=0.01), length=0.11, center_of_mass=0.05, inertia="two-mass"
        ),
        "rod.length: a rod as long as crank.radius + |piston.offset|, 110 mm, "
        f"{FOLDED.format(270)}: a run ends there",
    ),
    "an offset in cm": (
        repistoned(FOUR, offset=0.08),
        "piston.offset: 80 mm is 1.74 times the crank's radius, with which a stroke of 92 mm "
        "becomes one of 111 mm; engines have up to half the radius; check its unit",
    ),
    "an offset in cm to the other side": (
        repistoned(FOUR, offset=-0.08),
        "piston.offset: -80 mm is 1.74 times the crank's radius, with which a stroke of 92 mm "
        "becomes one of 111 mm; engines have up to half the radius; check its unit",
    ),
    "a flywheel a thousand times as heavy": (
        replace(FOUR, crank=Crank(radius=0.046, inertia=150.0)),
        "crank.inertia: 150 kg m^2 is more than that of a solid steel disc 552 mm in diameter and "
        "184 mm wide, 13.2 kg m^2; flywheels of engines have a tenth of that and less; check its "
        "unit",
    ),
    "a flywheel for a wide bore": (
        replace(V_TWIN, crank=Crank(radius=0.036, inertia=35.0)),
        "crank.inertia: 35 kg m^2 is more than that of a solid steel disc 564 mm in diameter and "
        "188 mm wide, 14.7 kg m^2; flywheels of engines have a tenth of that and less; check its "
        "unit",
    ),
    "a shell wide in metres": (
        replace(DIESEL, bearings=Bearings(crank_pin=Shell(diameter=0.056, width=42.0))),
        "bearings.crank_pin: a width of 42 m is 750 times the diameter, 0.056 m; bearings have "
        "0.05 to 5 times; check its unit",
    ),
    "a journal in metres": (
        replace(DIESEL, bearings=Bearings(main_journal=Shell(diameter=65, width=42))),
        "bearings.main_journal: a diameter of 65 m is outside 0.001 to 2 m, where bearings lie; a "
        "bare number is in metres",
    ),
    "ambient of 1 Pa": (
        regassed(DIESEL, ambient=1.0),
        "gas.ambient: 1e-05 bar is outside 0.2 to 50 bar, where crankcases lie; a bare number is "
        "in Pa",
    ),
    "a pressure of 30 Pa": (
        regassed(V_TWIN, pressure=30.0, indicator=None),
        "gas.pressure: 0.0003 bar is outside 0.01 to 4000 bar, where pressures of cylinders lie; a "
        "bare number is in Pa",
    ),
    "a gauge pressure of -30 Pa": (
        regassed(V_TWIN, pressure=-30.0, indicator=None, absolute=False, ambient=None),
        "gas.pressure: -0.0003 bar is outside 0.01 to 4000 bar, where pressures of cylinders lie; "
        "a bare number is in Pa",
    ),
    "kPa for Pa": (
        regassed(V_TWIN, pressure=5e8, indicator=None),
        "gas.pressure: 5e+03 bar is outside 0.01 to 4000 bar, where pressures of cylinders lie; a "
        "bare number is in Pa",
    ),
    "one of a list": (
        regassed(DIESEL, motored=(1.2, *("1 bar",) * (len(DIESEL.cylinders) - 1))),
        "gas.motored: 1.2e-05 bar is outside 0.01 to 4000 bar, where pressures of cylinders lie; a "
        "bare number is in Pa",
    ),
    "an intake of 1 Pa": (
        with_indicator(intake_pressure=1.0),
        "gas.indicator.intake_pressure: 1e-05 bar is outside 0.01 to 4000 bar, where pressures of "
        "cylinders lie; a bare number is in Pa",
    ),
    "a load that drives": (
        replace(FOUR, torque=(Quadratic(coefficient=1e-4), Constant(torque=87.3))),
        "torque[2]: the constant of +87.3 N m at the start drives, as the gas does; a load that "
        "brakes has the sign opposite to the speed's",
    ),
    "a table that drives": (
        replace(FOUR, torque=(SpeedTable(file=DRIVING),)),
        "torque[1]: the speed table of +50 N m at the start drives, as the gas does; a load that "
        "brakes has the sign opposite to the speed's",
    ),
    "angles from the firing dead centre": (
        turned_by(DIESEL, 360.0),
        "gas: the pressure peaks at a cycle angle of 13.62 degrees, far from the firing dead "
        'centre at 360; check the table\'s angles, and zero = "firing_tdc" where they count from '
        "there",
    ),
    "a compressor's angles from the bottom": (
        turned_by(COMPRESSOR, 180.0),
        "gas: the pressure peaks at a cycle angle of 180 degrees, far from the firing dead centre "
        "at 0; check the table's angles",
    ),
    "millimetres for metres": (
        replace(
            BARS,
            crank=Crank(radius=100, inertia=7.0),
            rod=Rod(length=300),
            piston=Piston(mass=0.4),
        ),
        "crank.radius: a stroke of 200 m is outside 0.001 to 5 m, where machines lie; a bare "
        "number is in metres",
    ),
    "metres for kilometres": (
        replace(
            DIESEL, crank=Crank(radius=46e-6, inertia=1.0), piston=Piston(mass=1.1, bore=0.085)
        ),
        "crank.radius: a stroke of 9.2e-05 m is outside 0.001 to 5 m, where machines lie; a bare "
        "number is in metres",
    ),
}


@pytest.mark.parametrize("name", ODD)
def test_what_no_machine_has_is_said(name):
    scene, sentence = ODD[name]
    assert warnings(scene) == (sentence,)


def test_the_slide_of_a_press_may_be_wide():
    """250 kg at a stroke of 100 mm were called more than solid steel as wide as the stroke."""
    crank, rod = Crank(radius=0.05, inertia=7.0), Rod(length=0.4)
    assert warnings(replace(BARS, crank=crank, rod=rod, piston=Piston(mass=250.0))) == ()


MOTOR = Table((0.0, 12.0), (3000.0, 0.0))
PRESS = load_scene("validation/scenes/press.toml")


def worked(forward, back=0.0):
    """The press with a force of two columns over the last 16 mm of its 80 mm."""
    rows = np.array([0.0, 0.064, 0.064, 0.081]), [0.0, 0.0, 1.0, 1.0]
    columns = [[share * force for share in rows[1]] for force in (forward, back)]
    return PRESS.with_(force=(TravelTable(file=CylinderTable(rows[0], columns)),))


def test_a_force_that_drives_beside_the_motor_is_said():
    (said,) = warnings(worked(22000.0))
    stroke = PRESS.running_gear[0].stroke
    assert said.startswith("force[1]: the ")
    assert float(said.split(" does ")[1].split(" J")[0]) == pytest.approx(
        22000.0 * (stroke - 0.064), rel=2e-3
    )
    assert "negative while the piston moves towards the crank" in said
    idle = PRESS.with_(start=Start(angle=0.0, speed=12.0), torque=(SpeedTable(file=MOTOR),))
    assert warnings(worked(22000.0).with_(start=idle.start, torque=idle.torque)) == (said,)
    braked = worked(22000.0).with_(torque=(Constant(torque=-20.0),))  # a motor of its own
    for silent in worked(-22000.0), worked(22000.0, 23000.0), braked, PRESS:
        assert warnings(silent) == ()


def test_every_number_is_named():
    worst = regassed(pressed(reroded(FOUR, center_of_mass=0.2), 10.0), ambient=1.0)
    named = [said.split(":")[0] for said in warnings(worst)]
    assert named == ["rod.center_of_mass", "gas.ambient", "gas"]


IN_LINE = load_scene("yi_diesel_free")  # of a bore of 85.25 mm


@pytest.mark.parametrize(("spacing", "said"), [(30.0, True), (85.0, True), (85.5, False)])
def test_cylinders_in_line_do_not_overlap(spacing, said):
    found = warnings(IN_LINE.with_(layout__spacing=spacing * 1e-3))
    start = f"layout.spacing: cylinders 1 and 2 of one bank are {spacing:.4g} mm apart"
    assert [sentence.startswith(start) for sentence in found] == [True] * said


def test_cylinders_of_two_banks_may_stand_side_by_side():
    pair = [
        {"phase": 0.0, "bank": bank, "position": place} for bank, place in ((-0.5, 0), (0.5, 0.03))
    ]
    scene = load_scene("v_twin")
    assert warnings(scene.with_(layout__cylinders=pair)) == ()
    row = [{**each, "bank": 0.5} for each in pair]
    (sentence,) = warnings(scene.with_(layout__cylinders=row))
    assert sentence.startswith(
        "layout.cylinders: position: cylinders 1 and 2 of one bank are 30 mm"
    )


@pytest.mark.parametrize(("width", "said"), [("60 mm", False), ("62 mm", True)])
def test_shells_fit_between_the_middles_of_two_journals(width, said):
    """100 mm apart: half of two journals of 39 mm and a big end."""
    shells = Bearings(
        main_journal=Shell(diameter="65 mm", width="39 mm"),
        crank_pin=Shell(diameter="56 mm", width=width),
    )
    found = warnings(IN_LINE.with_(layout__spacing="100 mm", bearings=shells))
    start = "bearings: main journals 1 and 2 are 100 mm apart, less than one journal"
    assert [sentence.startswith(start) for sentence in found] == [True] * said
