"""Scenes built in Python: SI floats or strings, checked by the same rules as a file."""

import dataclasses
import math
import pickle

import numpy as np
import pytest
from pydantic import TypeAdapter

from crankmbs import (
    Constant,
    Crank,
    Cylinder,
    Extent,
    Gas,
    Gravity,
    Indicator,
    InputError,
    Layout,
    Motion,
    Oscillation,
    Piston,
    Quadratic,
    Ramp,
    Rod,
    Run,
    Scene,
    SpeedFile,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    shipped_scenes,
)
from crankmbs.errors import SceneError

DEGREE = math.pi / 180.0


def scene(**changes):
    parts = {
        "crank": Crank(radius=0.046, inertia=0.02),
        "rod": Rod(length=0.15),
        "piston": Piston(mass=1.14, area=57e-4),
        "start": Start(angle=0.0, speed=335.1),
        "run": Run(until="0.75 s"),
    }
    return Scene(**{**parts, **changes})


def test_floats_are_si_and_strings_are_converted():
    assert Crank(radius="46 mm", inertia="0.02 kg m^2") == Crank(radius=0.046, inertia=0.02)
    assert Start(angle="90 deg", speed=100.0).angle == math.pi / 2.0
    assert Motion(speed="30 rpm").speed == pytest.approx(math.pi)
    assert Run(until="3 rev").until == Extent(value=6.0 * math.pi, unit="rad")
    assert Run(until="3 rev", every="none").every is None


@pytest.mark.parametrize("number", [np.float64(0.5), np.float32(0.5), np.int64(1), 1])
def test_numpy_numbers_become_floats(number):
    radius = Crank(radius=number, inertia=1.0).radius
    assert type(radius) is float
    assert radius == number


def test_parts_may_be_dicts():
    assert scene(crank={"radius": 0.046, "inertia": 0.02}) == scene()


def test_a_scene_is_frozen_hashable_and_can_be_changed_and_sent():
    first = scene(torque=(Quadratic(coefficient=1e-4),))
    with pytest.raises(dataclasses.FrozenInstanceError):
        first.title = "other"
    other = dataclasses.replace(first, title="other")
    assert (other.title, other.crank) == ("other", first.crank)
    assert hash(first) == hash(dataclasses.replace(other, title=""))
    assert pickle.loads(pickle.dumps(first)) == first


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_dumped_scene_is_read_back(name):
    first = load_scene(name)
    adapter = TypeAdapter(Scene)
    assert adapter.validate_json(adapter.dump_json(first)) == first


def test_every_part_survives_a_dump():
    table = Table((0.0, 1.0), (1.0, 2.0))
    loads = (TimeTable(file=table), SpeedTable(file=table), Constant(torque=1.0))
    adapter = TypeAdapter(Scene)
    for first in (
        scene(torque=loads, rod=Rod(length=0.3, mass=1.0, center_of_mass=0.1, inertia="two-mass")),
        scene(start=None, motion=Motion(speed=Ramp(start=1.0, to=2.0, over=1.0))),
        scene(start=None, motion=Motion(speed=SpeedFile(file=table))),
        scene(start=None, motion=Motion(speed=Oscillation(mean=2.0, amplitude=1.0, order=2.0))),
    ):
        assert adapter.validate_python(adapter.dump_python(first)) == first


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Crank(radius=-1, inertia=0.1), "radius: must be above 0; -1 came"),
        (lambda: Crank(radius="-1 mm", inertia=0.1), 'radius: must be above 0; "-1 mm" came'),
        (lambda: Crank(radius=math.nan, inertia=0.1), "radius: must be finite; nan came"),
        (
            lambda: Crank(radius=True, inertia=0.1),
            'radius: must be a number in SI units, or text such as "46 mm"; true came',
        ),
        (lambda: Crank(inertia=1), "radius: this argument is missing; it has no default"),
        (
            lambda: scene(crank=Crank(radius=0.046)),
            "crank.inertia: this key is missing; a free crank needs it, only a prescribed speed, "
            "motion, does without",
        ),
        (lambda: Crank(radius=1, inertia=1, mas=1), 'mas: unknown argument; did you mean "mass"?'),
        (
            lambda: Crank(radius=1, inertia=1, mass=2, center_of_mass=1),
            "inertia about the crank axis must be at least mass * center_of_mass^2 = 2 kg m^2; "
            "1 came",
        ),
        (lambda: Piston(mass=1, bore=0.1, area=0.1), "give bore or area, not both; both came"),
        (lambda: Rod(length=1, inertia="lumped"), 'inertia: must be "two-mass"; "lumped" came'),
        (
            lambda: Run(until=0.75),
            "until: must be an angle or a time with its unit, such as "
            '"20 cycles", "10 rev" or "0.75 s"; 0.75 came',
        ),
        (lambda: Extent(value=0.0, unit="s"), "must be finite and above 0; 0 s came"),
        (
            lambda: Extent(value=1.0, unit="m"),
            'unit must be "rad", "cycle" or "s"; "m" came',
        ),
        (
            lambda: Oscillation(mean=-1.0, amplitude=1.0, order=1.0),
            "amplitude must be below the mean speed, or the crank stops; 1 and -1 rad/s came",
        ),
        (
            lambda: Run(until={"value": 1.0}),
            "until.unit: this argument is missing; it has no default",
        ),
        (
            lambda: Run(until={"value": 1.0, "unit": "s", "x": 1}),
            "until.x: unknown argument",
        ),
        (
            lambda: Run(until={"value": -1.0, "unit": "s"}),
            "until: must be finite and above 0; -1 s came",
        ),
        (
            lambda: Gas(pressure=[1, 2], ambient=1e5),
            "pressure: must be the name of a CSV file or a Table(crank angles [rad], pressures "
            '[Pa]), a list of them, or a pressure such as "1 bar"; 1 came',
        ),
        (
            lambda: scene(torque=[Constant(torque=1.0), 3]),
            "torque[2]: must be one of Constant, Viscous, Quadratic, TimeTable, SpeedTable, "
            "AngleTable; 3 came",
        ),
        (
            lambda: Gas(pressure=np.zeros((5, 2)), ambient=1e5),
            "pressure: must be the name of a CSV file or a Table(crank angles [rad], pressures "
            '[Pa]), a list of them, or a pressure such as "1 bar"; an array of shape (5, 2) came',
        ),
        (
            lambda: SpeedTable(file=math.sin),
            "file: must be the name of a CSV file or a Table(speeds [rad/s], torques [N m]); "
            "a function came",
        ),
        (
            lambda: scene(torque=lambda t, omega: -omega),
            "torque: must be a tuple or list of Constant, Viscous, Quadratic, TimeTable, "
            "SpeedTable or AngleTable; a function came",
        ),
        (
            lambda: scene(torque=[lambda t, omega: -omega]),
            "torque[1]: must be one of Constant, Viscous, Quadratic, TimeTable, SpeedTable, "
            "AngleTable; a function came",
        ),
        (
            lambda: Motion(speed=lambda t: 300.0),
            'speed: must be a number in rad/s, text such as "3200 rpm", or one of Oscillation, '
            "Ramp, SpeedFile; a function came",
        ),
        (
            lambda: Layout(cylinders=Cylinder()),
            "cylinders: must be a tuple or list of Cylinder; "
            "Cylinder(phase=0.0, bank=0.0, position=None) came",
        ),
        (lambda: Layout(firing_order=3), "firing_order: must be a tuple or list; 3 came"),
        (
            lambda: Crank(0.046, 0.1),
            "Crank takes its values by name, Crank(radius=..., inertia=...); 2 came without",
        ),
        (
            lambda: Scene(crank=Crank(radius=1, inertia=1)),
            "rod: this argument is missing; give rod=Rod(length, mass, center_of_mass, inertia)",
        ),
        (
            lambda: Crank(radius=None, inertia=1),
            'radius: must be a number in SI units, or text such as "46 mm"; None came',
        ),
        (lambda: scene(title=3), "title: must be a str; 3 came"),
        (
            lambda: Gas(pressure=Table((0, 6), (1, 1)), absolute="no"),
            'absolute: must be True or False; "no" came',
        ),
        (
            lambda: Gas(pressure=Table((0, 360, 720), (1, 2, 1)), absolute=False),
            "table: the rows span 41253 degrees, more than the period of 720; check stroke, 4 "
            'came, or for a file of several cycles give cycles="mean" or "sequence"; a Table has '
            "its angles in radians",
        ),
        (
            lambda: Gas(pressure=Table((0, 6), (1, 1))),
            'an absolute pressure needs ambient, the crankcase side; give ambient="1 bar", or '
            "absolute=False when the file is gauge",
        ),
        (
            lambda: scene(start=None),
            "give motion (the speed is prescribed) or start (the crank is free), exactly one of "
            "the two; neither came",
        ),
        (lambda: Ramp(to=1.0, over=1.0), "start: this argument is missing; it has no default"),
        (lambda: Ramp(start=math.inf, to=1.0, over=1.0), "start: must be finite; inf came"),
        (
            lambda: Ramp(begin=1.0, to=1.0, over=1.0),
            "begin: unknown argument; known arguments are start, to, over",
        ),
        (
            lambda: scene(crank={"radius": -1, "inertia": 1}),
            "crank.radius: must be above 0; -1 came",
        ),
        (
            lambda: scene(crank=Rod(length=1)),
            "crank: must be given as Crank(radius, inertia, mass, center_of_mass); Rod(length=1.0, "
            "mass=0.0, center_of_mass=0.0, inertia=0.0) came",
        ),
    ],
)
def test_what_cannot_be_raises_one_sentence(build, message):
    with pytest.raises(InputError) as caught:
        build()
    assert str(caught.value) == message
    assert not isinstance(caught.value, SceneError)


def test_two_mass_rod_is_the_lectures_inertia():
    lumped = Rod(length=0.3, mass=2.0, center_of_mass=0.1, inertia="two-mass")
    assert lumped.moment_of_inertia == pytest.approx(2.0 * 0.1 * 0.2, rel=1e-15)
    assert Rod(length=0.3, mass=2.0, inertia=0.01).moment_of_inertia == 0.01


def test_bore_and_area():
    assert Piston(mass=1, bore=0.1).gas_area == pytest.approx(math.pi * 0.0025)
    assert Piston(mass=1, area=0.1).gas_area == 0.1
    assert Piston(mass=1).gas_area is None


@pytest.mark.parametrize(
    ("order", "stroke", "degrees"),
    [
        ((1, 3, 4, 2), 4, [0, 180, 540, 360]),
        ((1, 2, 3), 2, [0, 240, 120]),
        ((1, 5, 3, 6, 2, 4), 4, [0, 240, 480, 120, 600, 360]),
        ((2, 1), 4, [360, 0]),
    ],
)
def test_the_kth_to_fire_lags_k_spacings(order, stroke, degrees):
    cylinders = Layout(firing_order=order).resolve(stroke * math.pi)
    assert [c.phase / DEGREE for c in cylinders] == pytest.approx(degrees)
    assert {c.bank for c in cylinders} == {0.0}


def test_an_explicit_layout_is_kept():
    pair = (Cylinder(bank="-30 deg"), Cylinder(phase="300 deg", bank="30 deg"))
    assert Layout(cylinders=pair).resolve(4.0 * math.pi) == pair
    assert scene(layout=Layout(cylinders=pair)).cylinders == pair


def test_period():
    gas = {"pressure": Table((0.0, math.pi), (0.0, 1.0)), "absolute": False}
    assert scene().period == 4.0 * math.pi
    assert scene(gas=Gas(**gas, stroke=2)).period == 2.0 * math.pi


def test_a_run_of_cycles_is_an_angle():
    assert Extent(value=3.0, unit="cycle").resolve(4.0 * math.pi) == (12.0 * math.pi, False)
    assert Extent(value=3.0, unit="s").resolve(4.0 * math.pi) == (3.0, True)


def test_every_kind_of_drive_and_load_can_be_built():
    over_time = Table((0.0, 1.0), (10.0, 20.0))
    loads = (
        Constant(torque="87 N m"),
        Viscous(coefficient=0.26),
        Quadratic(coefficient=7.775e-4),
        TimeTable(file=over_time),
        SpeedTable(file=Table((0.0, 1.0, 1.0), (10.0, 20.0, 0.0))),
    )
    assert scene(torque=loads).torque == loads
    assert Ramp(start=0.0, to=10.0, over="2 s").over == 2.0
    driven = scene(start=None, motion=Motion(speed=SpeedFile(file=over_time)))
    assert driven.motion.speed.file is over_time
    assert Gravity(acceleration=9.81).angle == math.pi


def test_a_rod_may_be_as_short_as_the_loop_allows():
    assert scene(rod=Rod(length=0.046)).rod.length == 0.046


@pytest.mark.parametrize(
    ("rod", "accepted"),
    [
        (Rod(length=0.15, mass=1.0), True),
        (Rod(length=0.15, inertia=0.01), True),
        (Rod(length=0.15, mass=1.0, center_of_mass=0.15), False),
        (Rod(length=0.15), False),
    ],
)
def test_a_free_crank_without_inertia_needs_a_rod_that_resists(rod, accepted):
    massless = {"crank": Crank(radius=0.046, inertia=0.0), "rod": rod}
    if accepted:
        assert scene(**massless).crank.inertia == 0.0
        return
    with pytest.raises(InputError, match=r"crank\.inertia: a free crank needs an inertia above 0"):
        scene(**massless)


def test_an_inertia_left_out_is_that_of_a_mass_at_its_centre():
    assert Crank(radius=0.046).moment_of_inertia == 0.0
    assert Crank(radius=0.046, mass=2.0, center_of_mass=-0.1).moment_of_inertia == 2.0 * 0.1**2
    assert Crank(radius=0.046, inertia=0.03, mass=2.0, center_of_mass=0.1).moment_of_inertia == 0.03


def test_an_indicator_needs_its_exhaust_pressure_with_four_strokes_only():
    diagram = Indicator(
        compression_ratio=10.0,
        n_compression=1.3,
        n_expansion=1.25,
        intake_pressure="1 bar",
        peak_pressure="50 bar",
    )
    assert Gas(indicator=diagram, ambient=1e5, stroke=2).indicator is diagram
    with pytest.raises(InputError, match="needs its exhaust_pressure"):
        Gas(indicator=diagram, ambient=1e5)
