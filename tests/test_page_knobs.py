"""The knobs of the page: which there are, and the scene that each gives."""

import dataclasses

import numpy as np
import pytest
from turned import turned

from crankmbs import (
    Constant,
    InputError,
    Motion,
    Oscillation,
    Rod,
    Run,
    SpeedTable,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    shipped_scenes,
)
from crankmbs.page.knobs import FIRING_ORDERS, choices_of, first_of, knobs_of

SINGLE, DIESEL = load_scene("propeller"), load_scene("yi_diesel_free")
RPM = np.pi / 30.0


@pytest.mark.parametrize("name", shipped_scenes())
def test_knobs_at_their_values_leave_the_scene_alone(name):
    scene = load_scene(name)
    assert turned(scene, {knob.name: knob.value for knob in knobs_of(scene)}) is scene
    for knob in knobs_of(scene):
        assert knob.low <= knob.value <= knob.high
        assert knob.low < knob.high


def test_only_knobs_that_mean_something_are_there():
    everywhere = {"rod_ratio", "offset", "rod_mass"}
    free = {"flywheel", "speed", "load"}
    assert {k.name for k in knobs_of(DIESEL)} == everywhere | free | {"pressure"}
    assert {k.name for k in knobs_of(SINGLE)} == everywhere | free | {"pressure", "counterweight"}
    assert {k.name for k in knobs_of(load_scene("grega_lecture"))} == everywhere | {
        "flywheel", "speed", "pressure",
    }  # fmt: skip
    assert {k.name for k in knobs_of(load_scene("torque_driven"))} == everywhere | {
        "flywheel", "load", "counterweight",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("propeller", "the load takes it evenly"),
        ("turning_moment", "the load takes it evenly"),  # its table over the angle is the engine
        ("two_stage_compressor", "The torque of the drive is even"),
        ("coasting", "Pistons and rods speed up"),
    ],
)
def test_the_first_sentence_says_who_drives(name, said):
    scene = load_scene(name)
    first = first_of(scene)
    assert first.question == "Why does the speed swing?"
    assert said in first.sentence


def test_who_drives_does_not_depend_on_the_sense():
    scene = load_scene("two_stage_compressor")
    backwards = dataclasses.replace(scene.start, speed=-scene.start.speed)
    braked = dataclasses.replace(scene, start=backwards, torque=(Viscous(coefficient=1.0),))
    assert "the load takes it evenly" in first_of(braked).sentence


def test_only_choices_that_mean_something_are_there():
    assert [c.name for c in choices_of(DIESEL)] == ["rod", "cylinders", "speed_is"]
    assert [c.name for c in choices_of(load_scene("yi_diesel"))] == ["rod", "cylinders", "speed_is"]
    of_each = dataclasses.replace(DIESEL.gas, pressure=(DIESEL.gas.pressure,) * 4)
    assert "cylinders" not in {c.name for c in choices_of(dataclasses.replace(DIESEL, gas=of_each))}
    of_all = load_scene("turning_moment")
    assert "cylinders" not in {c.name for c in choices_of(of_all)}  # its table is that of three
    assert next(c.value for c in choices_of(load_scene("grega_lecture"))) == "two-mass"


def test_another_rod_keeps_its_shape():
    rod = turned(SINGLE, {"rod_ratio": 0.25, "rod_mass": 2.0}).rod
    old = SINGLE.rod
    assert rod.length == pytest.approx(SINGLE.crank.radius / 0.25)
    assert rod.center_of_mass / rod.length == pytest.approx(old.center_of_mass / old.length)
    assert rod.inertia / (rod.mass * rod.length**2) == pytest.approx(
        old.inertia / (old.mass * old.length**2)
    )


def test_the_rod_is_rigid_or_two_masses():
    assert turned(SINGLE, {"rod": "two-mass"}).rod.inertia == "two-mass"
    assert turned(SINGLE, {"rod": "rigid"}) == SINGLE
    bare = dataclasses.replace(SINGLE, rod=Rod(length=0.15, inertia=1e-3))
    assert turned(bare, {"rod": "rigid"}) == bare  # no mass, yet an inertia
    lumped = load_scene("grega_lecture")
    bar = turned(lumped, {"rod": "rigid"}).rod
    assert bar.inertia == pytest.approx(bar.mass * bar.length**2 / 12.0)
    assert turned(lumped, {"rod_ratio": 0.2}).rod.inertia == "two-mass"


def test_more_cylinders_share_the_load_evenly():
    scene = turned(SINGLE, {"cylinders": "6", "load": 50})
    assert scene.layout.firing_order == FIRING_ORDERS["6"]
    assert scene.torque[0].coefficient == pytest.approx(3.0 * SINGLE.torque[0].coefficient)
    for number, order in FIRING_ORDERS.items():
        assert sorted(order) == list(range(1, int(number) + 1))


def test_loads_are_the_same_torque_at_another_speed():
    loads = (
        Constant(torque=-3.0),
        Viscous(coefficient=0.1),
        *SINGLE.torque,
        SpeedTable(file=Table((0.0, 300.0), (0.0, -5.0))),
        TimeTable(file=Table((0.0, 5.0), (-1.0, -1.0))),
    )
    scene = dataclasses.replace(SINGLE, torque=loads)
    new = turned(scene, {"speed": 0.5 * scene.start.speed / RPM})
    constant, viscous, quadratic, table, over_time = new.torque
    assert new.start.speed == pytest.approx(0.5 * scene.start.speed)
    assert constant.torque == -3.0
    assert viscous.coefficient == pytest.approx(0.2)
    assert quadratic.coefficient == pytest.approx(4.0 * SINGLE.torque[0].coefficient)
    assert (table.file.x[1], table.file.y[1]) == pytest.approx((150.0, -5.0))
    assert over_time == loads[-1]


def test_a_swinging_speed_keeps_its_share_of_swing():
    swing = Oscillation(mean=300.0, amplitude=30.0, order=2.0)
    scene = dataclasses.replace(
        SINGLE, start=None, torque=(), motion=Motion(speed=swing), run=Run(until="1 cycle")
    )
    speed = turned(scene, {"speed": 100.0 / RPM}).motion.speed
    assert (speed.mean, speed.amplitude) == pytest.approx((100.0, 10.0))


def test_pressure_scales_table_and_diagram():
    table = turned(DIESEL, {"pressure": 150}).gas
    assert table.pressure.y == pytest.approx(tuple(1.5 * p for p in DIESEL.gas.pressure.y))
    assert table.ambient == DIESEL.gas.ambient
    twin = load_scene("v_twin")
    diagram = turned(twin, {"pressure": 50}).gas.indicator
    assert diagram.peak_pressure == pytest.approx(0.5 * twin.gas.indicator.peak_pressure)
    assert diagram.intake_pressure == pytest.approx(0.5 * twin.gas.indicator.intake_pressure)


def test_a_scene_that_cannot_be_is_refused():
    with pytest.raises(InputError, match=r"rod\.length must be at least"):
        turned(SINGLE, {"rod_ratio": 0.9, "offset": 20.0})
