"""Scenes built in Python: SI floats or strings, checked by the same rules as a file."""

import dataclasses
import math
import pickle

import numpy as np
import pytest
from pydantic import TypeAdapter
from scene_texts import scene

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

DEGREE = math.pi / 180.0


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
