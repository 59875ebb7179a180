"""Free runs solved together have what each of them has alone, within the errors of both."""

import math
from dataclasses import replace

import numpy as np
import pytest
from beside_alone import assert_agree, by_hand

from crankmbs import load_scene, simulate
from crankmbs.batch.machine import machine_of
from crankmbs.batch.motion import Cases, Setup, run
from crankmbs.batch.rows import rows_of
from crankmbs.batch.serves import loads_of
from crankmbs.batch.solve import solved_together
from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.scene.loads import Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.tables import Table
from crankmbs.sweep.block import Job, solved
from crankmbs.sweep.columns import columns_of
from crankmbs.sweep.scenes import scene_of
from validation.random_settled import random_settled

pytestmark = pytest.mark.slow

SEEDS = range(3000, 3016)
ALONE: set[int] = set()


def running(name, until, **changes):
    return load_scene(name).with_(run__until=until, run__every="none", **changes)


PROPELLER = running("propeller", "7 cycles")
VISCOUS = replace(PROPELLER, torque=(*PROPELLER.torque, Viscous(coefficient=0.05)))
TURNED = replace(
    running("propeller", "1500 deg", start__angle="217 deg", start__speed=-300.0),
    torque=(Constant(torque=-40.0), Quadratic(coefficient=4e-4)),
)
SERVED = {
    "whole cycles": PROPELLER,
    "a cycle": running("propeller", "1 cycle"),
    "an angle": running("propeller", "2000 deg"),
    "a time": load_scene("propeller"),
    "no gas": running("coasting", "0.5 s"),
    "several cylinders": running("yi_diesel_free", "3.3 cycles"),
    "banks": running("v_twin", "0.2 s"),
    "viscous": VISCOUS,
    "viscous in time": VISCOUS.with_(run__until="0.3 s"),
    "backwards": TURNED,
    "backwards in time": TURNED.with_(run__until="0.11 s"),
}


@pytest.mark.parametrize("name", SERVED)
def test_a_run_together_agrees_with_it_alone(name):
    (rows,), (alone, message) = rows_of([SERVED[name]]), by_hand(SERVED[name])
    assert set(rows.columns) == set(alone) == set(columns_of(SERVED[name]))
    assert_agree(
        rows, 0, alone, least=1e-15 if name == "no gas" else 0.0
    )  # alone it rounds no load
    assert rows.messages[0] == message.partition(";")[0]
    assert rows.columns["relative_error"][0] <= SERVED[name].run.rtol


@pytest.mark.parametrize("name", ["an angle", "a time", "backwards in time"])
def test_a_peak_is_where_it_is_alone(name):
    (rows,), (alone, _) = rows_of([SERVED[name]]), by_hand(SERVED[name])
    for joint in ("main_bearing", "crank_pin", "piston_pin", "side_force"):
        column = f"{joint}_peak_angle"
        np.testing.assert_allclose(rows.columns[column][0], alone[column], atol=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_runs_agree(seed):
    scene, rng = random_settled(seed), np.random.default_rng([17, seed])
    turns = scene.period * rng.uniform(1.05, 4.0)
    assert scene.start is not None
    in_time = Extent(value=1.2 * turns / abs(scene.start.speed), unit="s")
    until = in_time if seed % 2 else Extent(value=turns, unit="rad")
    scene = replace(scene, run=Run(until=until, every=None, rtol=1e-7))
    tables = any(isinstance(load, SpeedTable) for load in scene.torque)
    assert (loads_of(scene) is None) == tables
    found = rows_of([scene])
    assert bool(found) == (not tables and seed not in ALONE)
    if found:
        assert_agree(found[0], 0, by_hand(scene)[0])


@pytest.mark.parametrize("name", ["an angle", "viscous in time", "backwards"])
def test_what_the_torques_do_is_what_the_crank_gains(name):
    (group,) = solved_together([SERVED[name]])
    scene, of = SERVED[name], {key: values[0] for key, values in group.numbers.items()}
    assert scene.start is not None
    sense, mass = math.copysign(1.0, scene.start.speed), scene.crank.moment_of_inertia
    end = simulate(scene, rtol=1e-12).data["crank_angle"].values[-1]
    total = float(inertia_alone(scene, end - sense * scene.period))
    before = sense * math.sqrt(2.0 * of["energy"] / total)
    work = sense * scene.period * float(of["crank_torque"] + of["external_torque"])
    gained = 0.5 * mass * of["speed_gain"] * (2.0 * before + of["speed_gain"])
    assert work == pytest.approx(gained, abs=1e-9 * of["energy"])


def test_many_periods_state_what_rounding_makes_of_them():
    long = running("coasting", "3000 cycles")
    (rows,), (few,) = rows_of([long]), rows_of([long.with_(run__until="1 cycle")])
    assert rows.columns["energy_closure"][0] > 3000 * 2.0**-51 > few.columns["energy_closure"][0]
    apart = abs(rows.columns["mean_speed"][0] - few.columns["mean_speed"][0])  # it repeats itself
    assert apart < rows.columns["mean_speed_error"][0]


def test_more_stages_are_taken_where_fewer_err_too_much():
    rough, fine = (
        next(solved_together([running("yi_diesel_free", "3 cycles", run__rtol=rtol)]))
        for rtol in (1e-6, 1e-10)
    )
    assert len(rough.machine.answer.rule.nodes) < len(fine.machine.answer.rule.nodes)
    assert rough.numbers["relative"][0] <= 1e-6
    assert fine.numbers["relative"][0] <= 1e-10


@pytest.mark.parametrize("until", ["5 cycles", "0.3 s"])
def test_alone_and_among_others_it_is_the_same(until):
    base = PROPELLER.with_(run__until=until)
    several = [
        base.with_(crank__inertia=inertia, start__speed=speed)
        for inertia in (0.02, 0.2, 0.11)
        for speed in np.linspace(280.0, 340.0, 22).tolist()
    ]
    (rows,) = rows_of(several)
    assert rows.which.tolist() == list(range(len(several)))
    for number, scene in enumerate(several):
        (alone,) = rows_of([scene])
        for name, values in alone.columns.items():
            np.testing.assert_array_equal(values[0], rows.columns[name][number])


def test_runs_of_different_lengths_are_carried_beside_one_another():
    several = [PROPELLER.with_(run__until=f"{n} cycles") for n in (1, 6, 3)]
    (rows,) = rows_of(several)
    for number, scene in enumerate(several):
        (alone,) = rows_of([scene])
        np.testing.assert_array_equal(
            alone.columns["mean_speed"][0], rows.columns["mean_speed"][number]
        )
    assert len(set(rows.columns["mean_speed"].tolist())) == 3


@pytest.mark.parametrize(
    "scene",
    [
        load_scene("torque_driven"),
        PROPELLER.with_(run__until="719 deg"),
        load_scene("coasting").with_(run__until="0.06 s"),
        replace(PROPELLER, friction=load_scene("friction").friction),
        PROPELLER.with_(run__formulation="minimal"),
        load_scene("yi_diesel").with_(run__until="2 cycles"),
        replace(PROPELLER, torque=(Constant(torque=1.0, after=0.1),)),
        replace(PROPELLER, torque=(TimeTable(file=Table((0.0, 9.0), (0.0, 9.0))),)),
        replace(PROPELLER, torque=(SpeedTable(file=Table((0.0, 600.0), (0.0, -20.0))),)),
    ],
)
def test_what_is_no_plain_run_is_left(scene):
    assert loads_of(scene) is None
    assert rows_of([scene]) == []


@pytest.mark.parametrize("until", ["0.03 s", "0.0374 s"])  # a period takes 0.0393 s
def test_a_time_before_a_period_is_over_is_left(until):
    assert rows_of([PROPELLER.with_(run__until=until)]) == []


@pytest.mark.parametrize("until", ["4 cycles", "0.4 s"])
@pytest.mark.parametrize("load", ["torque[1].coefficient", "torque[2].torque"])
def test_a_run_that_comes_to_rest_or_turns_back_is_followed_alone(until, load):
    scene = replace(PROPELLER, torque=(*PROPELLER.torque, Constant(torque=-1.0)))
    scene, values = scene.with_(run__until=until), ((-1.0,), (-900.0,))
    values = values if load.endswith("torque") else ((9.5e-5,), (0.1,))
    block = solved(Job(scene, (load,), values))
    assert block["status"][0] == 0
    result = simulate(scene_of(scene, (load,), values[1]))
    assert block["status"][1] == result.status
    assert block["message"][1] == result.message
    assert np.min(result.data["crank_speed"].values) < 100.0


def over(case, end, in_time=False):
    """The course of a case of the propeller's machine up to an end: inertia of the crank, c0, c1,
    c2 and the energy at the start."""
    machine, (*own, energy) = machine_of(PROPELLER), case
    cases = Cases(*np.array([[*own, 300.0, end, 1e-9]]).T)
    return run(machine.answer, cases, Setup(machine.sense, in_time), np.array([energy]))


def test_leaping_over_periods_is_passing_them():
    for c2 in (-1e-4, 0.0):
        plain = over([0.02, 1.0, 0.0, c2, 2500.0], 9)
        viscous = over([0.02, 1.0, -1e-15, c2, 2500.0], 9)  # passes period after period
        for one, other in zip(plain[:-1], viscous[:-1], strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-12)


def test_the_least_energy_is_that_of_all_periods():
    falling = [0.02, 0.0, 0.0, -1e-3, 2500.0]
    rising = [0.02, 60.0, 0.0, 0.0, 1200.0]
    for case, last in ((falling, True), (rising, False)):
        whole, one = (over(case, periods).least[0] for periods in (6, 1))
        assert (whole < one) == last
        assert whole <= one


def test_the_least_energy_in_time_is_that_of_all_periods():
    falling = [0.02, 0.0, 0.0, -3e-4, 2500.0]
    short, long = (over(falling, time, in_time=True).least[0] for time in (0.06, 0.3))
    assert long < short < 2500.0


def test_a_run_ends_where_its_time_is_over():
    """Its last cell, and the first one, are parts of one whose widths add up to it."""
    scene = SERVED["a time"]
    (group,) = solved_together([scene])
    result = simulate(scene, rtol=1e-12)
    speed = result.data["crank_speed"].values[-1]
    gained = result.measures().speed_gain
    found, error = (of["speed_gain"][0] for of in (group.numbers, group.errors))
    assert scene.end == (result.data["time"].values[-1], True)
    assert abs(found - gained.value) <= gained.error + error
    assert group.numbers["slow"][0] <= abs(speed) <= group.numbers["fast"][0]
