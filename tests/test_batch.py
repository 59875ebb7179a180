"""Scenes solved together have what each of them has alone, within the errors of both."""

from dataclasses import replace

import numpy as np
import pytest
from beside_alone import assert_agree, by_hand

from crankmbs import load_scene, simulate
from crankmbs.batch.machine import machine_of
from crankmbs.batch.rows import rows_of
from crankmbs.batch.serves import loads_of
from crankmbs.batch.solve import solved_together
from crankmbs.scene.bearings import Bearings, Shell
from crankmbs.scene.loads import Constant, Quadratic, SpeedTable, Viscous
from crankmbs.scene.parts import Cylinder, Friction, Gravity
from crankmbs.scene.tables import Table
from crankmbs.sweep.block import Job, solved
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.scenes import scene_of
from validation.random_bearings import random_bearings
from validation.random_settled import random_settled

pytestmark = pytest.mark.slow

SEEDS = range(2000, 2024)
LEFT = {2000, 2001, 2002, 2005, 2007, 2009, 2018, 2019, 2021}  # with tables over the speed
COARSE = {2010, 2014}  # more than its tolerance, by the finest rules


def settling(name, **changes):
    return load_scene(name).with_(run__until="settled", run__every="none", **changes)


SHIPPED = [settling(name) for name in ("propeller", "yi_diesel_free", "v_twin")]
SHELL = Shell(diameter="50 mm", width="20 mm")
ON_ONE_PIN = tuple(
    replace(cylinder, position=place, throw=1)
    for cylinder, place in zip(SHIPPED[2].cylinders, ("0 mm", "30 mm"), strict=True)
)
WITH_JOURNALS = [
    settling("propeller", bearings=Bearings(crank_pin=SHELL), friction=Friction(ring_force=40.0)),
    settling(
        "yi_diesel_free",
        layout__spacing="0.1 m",
        bearings=Bearings(throw_unbalance=4 * ("-9 kg mm",)),
    ),
    settling(
        "v_twin",
        layout__cylinders=ON_ONE_PIN,
        gravity=Gravity(acceleration="9.81 m/s^2"),
        bearings=Bearings(main_journal=SHELL, journal_positions=("-50 mm", "80 mm")),
    ),
]


@pytest.mark.parametrize(
    "scene",
    SHIPPED + WITH_JOURNALS,
    ids=lambda scene: scene.title[:20] + " with journals" * (scene.bearings is not None),
)
def test_shipped_scenes_agree(scene):
    (rows,) = rows_of([scene])
    alone, message = by_hand(scene)
    assert set(rows.columns) == set(alone) == set(columns_of(scene))
    assert_agree(rows, 0, alone)
    assert rows.messages[0] == message.partition(";")[0]
    assert rows.columns["relative_error"][0] <= scene.run.rtol


@pytest.mark.parametrize(
    "scene", [SHIPPED[0], SHIPPED[2].with_(start__angle="217 deg")], ids=["one", "two"]
)
def test_a_peak_is_where_it_is_alone(scene):  # in an even engine every cylinder is as good
    (rows,), (alone, _) = rows_of([scene]), by_hand(scene)
    for joint in ("main_bearing", "crank_pin", "piston_pin", "side_force"):
        name = f"{joint}_peak_angle"
        np.testing.assert_allclose(rows.columns[name][0], alone[name], atol=1e-6)


def test_what_a_fitted_diagram_errs_counts():
    (rows,) = rows_of([SHIPPED[2]])
    assert (rows.columns["imep_error"] > 1e-11 * rows.columns["imep"]).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_random_scenes_agree(seed):
    scene = random_settled(seed)
    scene = random_bearings(scene, seed) if seed % 2 else scene
    scene = replace(scene, run=replace(scene.run, every=None, rtol=1e-7))
    assert (loads_of(scene) is None) == (seed in LEFT)
    found = rows_of([scene])
    assert bool(found) == (seed not in LEFT | COARSE)
    if found:
        assert_agree(found[0], 0, by_hand(scene)[0])


def test_backwards_and_from_any_angle():
    turned = settling("propeller", start__angle="217 deg", start__speed=-300.0)
    turned = replace(turned, torque=(Constant(torque=-40.0), Quadratic(coefficient=4e-4)))
    (rows,), (alone, _) = rows_of([turned]), by_hand(turned)
    assert rows.columns["mean_speed"][0] < 0.0
    assert rows.columns["indicated_power"][0] < 0.0
    assert_agree(rows, 0, alone)


def test_a_start_too_slow_for_the_first_compression_is_followed_alone():
    slow = settling("propeller", start__speed=30.0)
    assert rows_of([slow]) == []
    assert simulate(slow).status != 0


def test_a_light_load_states_what_rounding_makes_of_it():
    light = settling("propeller", torque__1__coefficient=1e-6, crank__inertia=20.0)
    light = replace(light, torque=(*light.torque, Constant(torque=-10.62)))
    (rows,), (alone, _) = rows_of([light]), by_hand(light)
    assert rows.columns["mean_speed_error"][0] > 1e-11 * rows.columns["mean_speed"][0]
    assert_agree(rows, 0, alone)


def test_more_stages_are_taken_where_fewer_err_too_much():
    rough, fine = (
        next(solved_together([settling("yi_diesel_free", run__rtol=rtol)]))
        for rtol in (1e-6, 1e-10)
    )
    count = [len(one.machine.answer.rule.nodes) for one in (rough, fine)]
    assert count[0] < count[1]
    assert rough.numbers["relative"][0] <= 1e-6
    assert fine.numbers["relative"][0] <= 1e-10


def test_none_is_better_than_one_that_errs_more_than_it_may():
    assert list(solved_together([settling("propeller", run__rtol=1e-13)])) == []


def test_alone_and_among_others_it_is_the_same():
    several = [settling("propeller", crank__inertia=inertia) for inertia in (0.02, 0.2, 0.11)]
    seen = []
    for rows in rows_of(several):
        for place, number in enumerate(rows.which.tolist()):
            (alone,) = rows_of([several[number]])
            for name, values in alone.columns.items():
                np.testing.assert_array_equal(values[0], rows.columns[name][place])
            seen.append(number)
    assert sorted(seen) == [0, 1, 2]


def test_every_machine_has_its_own_group():
    scenes = [SHIPPED[0], None, SHIPPED[2], settling("propeller", start__speed=300.0)]
    groups = solved_together(scenes)
    machines = {number: group.machine for group in groups for number in group.which.tolist()}
    assert sorted(machines) == [0, 2, 3]
    assert machines[0] is machines[3] is not machines[2]


@pytest.mark.parametrize(
    "scene",
    [
        replace(SHIPPED[0], friction=Friction(ring_force=40.0, viscous=10.0)),
        load_scene("yi_diesel"),
        settling("propeller", run__formulation="minimal"),
        replace(SHIPPED[0], torque=(SpeedTable(file=Table((0.0, 600.0), (0.0, -20.0))),)),
    ],
)
def test_what_is_no_plain_settled_motion_is_left(scene):
    assert loads_of(scene) is None
    assert rows_of([scene]) == []


@pytest.mark.parametrize("scene", SHIPPED, ids=lambda scene: scene.title[:20])
def test_friction_that_does_not_depend_on_the_speed_is_a_torque_over_the_angle(scene):
    scene = replace(scene, friction=Friction(ring_force=30.0, ring_pressure=0.01))
    (rows,), (alone, _) = rows_of([scene]), by_hand(scene)
    assert set(rows.columns) == set(alone)
    assert rows.columns["friction_power"][0] > 10.0
    assert 0.5 < rows.columns["mechanical_efficiency"][0] < 0.999
    assert_agree(rows, 0, alone)


def test_friction_backwards_and_without_gas():
    turned = settling("propeller", start__angle="217 deg", start__speed=-300.0)
    loads = Constant(torque=-60.0), Quadratic(coefficient=4e-4)
    turned = replace(turned, torque=loads, friction=Friction(ring_force=30.0, ring_pressure=0.01))
    driven = replace(turned, gas=None, friction=Friction(ring_force=30.0))
    shares = []
    for scene in (turned, driven):
        (rows,), (alone, _) = rows_of([scene]), by_hand(scene)
        assert_agree(rows, 0, alone)
        shares.append(rows.columns.get("mechanical_efficiency"))
    assert 0.0 < shares[0][0] < 1.0
    assert shares[1] is None


def test_every_friction_is_a_machine_of_its_own():
    rubbed = replace(SHIPPED[0], friction=Friction(ring_force=1.0))
    scenes = [scene_of(rubbed, ["friction.ring_force"], [force]) for force in (10.0, 50.0)]
    powers = [rows.columns["friction_power"][0] for rows in rows_of(scenes)]
    assert 3.0 * powers[0] < powers[1]


def test_a_load_that_stalls_the_crank_says_so_alone():
    names, values = ("torque[1].coefficient",), ((9.5e-5,), (0.0,), (3.0,))
    block = solved(Job(SHIPPED[0], names, values))
    assert block["status"][0] == 0
    for number in (1, 2):
        result = simulate(scene_of(SHIPPED[0], names, values[number]))
        assert block["status"][number] == result.status
        assert block["message"][number] == result.message


def test_in_an_even_engine_the_other_cylinders_are_as_the_first():
    assert machine_of(SHIPPED[1]).shares == 4
    weighed = settling("yi_diesel_free", gravity={"acceleration": 9.81, "angle": 0.5})
    pulled = settling("yi_diesel_free", crank__mass=5.0, crank__center_of_mass=0.01)
    for scene in (weighed, pulled):
        assert machine_of(scene).shares == 1
        (rows,), (alone, _) = rows_of([scene]), by_hand(scene)
        assert_agree(rows, 0, alone)


def test_in_an_uneven_engine_every_cylinder_is_by_itself():
    uneven = tuple(Cylinder(phase=f"{phase} deg") for phase in (0, 180, 340, 540))
    scene = settling("yi_diesel_free", layout={"cylinders": uneven})
    assert machine_of(scene).shares == 1
    (rows,), (alone, _) = rows_of([scene]), by_hand(scene)
    assert_agree(rows, 0, alone)


@pytest.mark.parametrize(
    ("speed", "drive", "center"), [(300.0, 8.0, 0.01), (-300.0, -72.0, 0.01), (300.0, 8.0, 0.0)]
)
def test_in_an_even_star_every_cylinder_has_its_bank_and_its_turn(speed, drive, center):
    star = tuple(Cylinder(phase=f"{240 * k} deg", bank=f"{120 * k} deg") for k in range(3))
    loads = Constant(torque=drive), Quadratic(coefficient=4e-4)
    scene = settling("propeller", layout={"cylinders": star}, start__angle="217 deg")
    scene = scene.with_(start__speed=speed, crank__center_of_mass=center)
    scene = replace(scene, torque=loads, gravity=None)
    assert machine_of(scene).shares == 1
    (rows,), (alone, _) = rows_of([scene]), by_hand(scene)
    assert_agree(rows, 0, alone)


def test_with_another_shape_in_every_case_each_is_as_alone():
    knobs = ["rod.length", "piston.mass"]
    shapes = [scene_of(SHIPPED[0], knobs, given) for given in ((0.16, 0.5), (0.19, 0.8))]
    (rows,) = rows_of(shapes)
    assert rows.which.tolist() == [0, 1]
    for number, scene in enumerate(shapes):
        assert_agree(rows, number, by_hand(scene)[0])


FAMILIES = {
    "one cylinder": SHIPPED[0],
    "shares": SHIPPED[1],
    "banks": SHIPPED[2],
    "journals, weight": WITH_JOURNALS[2],
    "bearings, friction": WITH_JOURNALS[0],
    "backwards": replace(
        settling("propeller", start__angle="217 deg", start__speed=-300.0),
        torque=(Constant(torque=-40.0), Quadratic(coefficient=4e-4)),
        friction=Friction(ring_force=40.0, ring_pressure=0.05),
    ),
    "in time": load_scene("propeller").with_(run__until="0.31 s", run__every="none"),
    "to an angle": load_scene("propeller").with_(run__until="2000 deg", run__every="none"),
}


@pytest.mark.parametrize("name", FAMILIES)
def test_machines_of_other_lengths_and_masses_are_as_alone(name):
    """One of them stalls, which leaves the tables of the others to these."""
    scene, random = FAMILIES[name], np.random.default_rng(7)
    knobs = "crank.radius", "rod.length", "piston.mass", "rod.mass"
    own = scene.crank.radius, scene.rod.length, scene.piston.mass, scene.rod.mass
    factors = random.uniform(0.97, 1.03, (4, 4))
    several = [scene_of(scene, knobs, (own * each).tolist()) for each in factors]
    several[1] = replace(
        several[1], torque=(*scene.torque, Constant(torque=-np.sign(scene.start.speed) * 2000.0))
    )
    found = rows_of(several)
    assert sorted(number for rows in found for number in rows.which.tolist()) == [0, 2, 3]
    assert any(len(rows.which) > 1 for rows in found)
    for rows in found:
        for place, number in enumerate(rows.which):
            (alone,) = rows_of([several[number]])
            assert_agree(rows, place, {column: each[0] for column, each in alone.columns.items()})
    first = next(rows for rows in found if 0 in rows.which)
    assert_agree(first, first.which.tolist().index(0), by_hand(several[0])[0])


def test_beside_a_case_without_a_motion_it_is_as_alone():
    stalls = replace(SHIPPED[0], torque=(*SHIPPED[0].torque, Constant(torque=-900.0)))
    (rows,), (alone,) = rows_of([stalls, SHIPPED[0]]), rows_of([SHIPPED[0]])
    assert rows.which.tolist() == [1]
    for name, values in alone.columns.items():
        np.testing.assert_array_equal(rows.columns[name], values)


def test_a_viscous_load_is_as_alone_beside_others():
    several = [
        replace(SHIPPED[0], torque=(*SHIPPED[0].torque, Viscous(coefficient=drag)))
        for drag in (0.0, 1e-3, 0.02)
    ]
    (rows,) = rows_of(several)
    for number, scene in enumerate(several):
        assert_agree(rows, number, by_hand(scene)[0])


def test_a_force_that_passes_zero_has_its_mean():
    """By other nodes it is the same, and by a fine sum."""
    (group,) = solved_together([SHIPPED[0]])
    result = simulate(SHIPPED[0].with_(run__every="0.02 deg"), rtol=1e-12)
    time, force = result.data["time"].values, np.abs(result.data["side_force"].values[:, 0])
    fine = np.trapezoid(force, time) / (time[-1] - time[0])
    assert abs(fine / group.numbers["side_force_mean"][0, 0] - 1.0) < 2e-7
    assert group.errors["side_force_mean"][0, 0] < 1e-11 * fine


def test_cells_beside_jumps_of_the_pressure_are_seen_at_three_nodes():
    scene = load_scene("propeller").with_(run__until="settled")
    for interpolation, fewest in (("pchip", 1), ("step", 3)):
        answer = machine_of(scene.with_(gas__interpolation=interpolation)).answer
        seen = np.bincount(answer.lectures.sparse // len(answer.rule.nodes))
        assert seen[1:-1].min() >= fewest
