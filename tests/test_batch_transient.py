"""Free runs solved together have what each of them has alone, within the errors of both."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from beside_alone import assert_agree, by_hand

from crankmbs import load_scene, simulate
from crankmbs.batch import transient
from crankmbs.batch.lanes import LANES, laid, taken
from crankmbs.batch.machine import machine_of
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
    assert set(rows.columns) == set(alone) == set(columns_of(SERVED[name], series=False))
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
    scene, (begun, gained) = SERVED[name], group.answer[0, :2]
    assert scene.start is not None
    sense, mass = math.copysign(1.0, scene.start.speed), scene.crank.moment_of_inertia
    total = float(inertia_alone(scene, group.begin[0]))
    before = sense * math.sqrt(2.0 * begun / total)
    work = sense * scene.period * float(group.answer[0, 7:9].sum())
    assert work == pytest.approx(0.5 * mass * gained * (2.0 * before + gained), abs=1e-9 * begun)


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
    assert len(rough.machine.answer.rule[2]) < len(fine.machine.answer.rule[2])
    assert rough.relative[0] <= 1e-6
    assert fine.relative[0] <= 1e-10


@pytest.mark.parametrize("until", ["5 cycles", "0.3 s"])
def test_alone_and_among_others_it_is_the_same(until):
    base = PROPELLER.with_(run__until=until)
    several = [
        base.with_(crank__inertia=inertia, start__speed=speed)
        for inertia in (0.02, 0.2, 0.11)
        for speed in np.linspace(280.0, 340.0, 22).tolist()
    ]
    (rows,) = rows_of(several)
    assert rows.which.tolist() == list(range(2 * LANES + 2))  # the first one alone, then the rest
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
    block = solved(Job(scene, (load,), values, series=False))
    assert block.status[0] == 0
    result = simulate(scene_of(scene, (load,), values[1]))
    assert block.status[1] == result.status
    assert block.message[1] == result.message
    assert np.min(result.data["crank_speed"].values) < 100.0


@pytest.mark.parametrize("name", ["a time", "viscous", "viscous in time", "an angle"])
def test_its_loops_are_the_same_compiled_and_plain(name, monkeypatch):
    scene = SERVED[name].with_(run__rtol=1e-5)
    (compiled,) = solved_together([scene])
    kernels = {n: f for n, f in vars(transient).items() if hasattr(f, "py_func")}
    for kernel, one in kernels.items():
        monkeypatch.setattr(transient, kernel, one.py_func)
    (plain,) = solved_together([scene])
    np.testing.assert_allclose(plain.answer, compiled.answer, rtol=1e-7, atol=1e-9)
    signatures = str([one.signatures for one in kernels.values()])
    assert set(re.findall(r"\b(\w+)\(", signatures)) <= {"Array", "Tuple", "UniTuple", "array"}
    assert all(one.targetoptions["nogil"] for one in kernels.values())


def carried(given, *, in_time):
    """What `carry` fills for cases of the propeller's machine, one after the other."""
    machine = machine_of(PROPELLER)
    (width, inertia, _, torque), cases = machine.answer.of_angle, laid(np.asarray(given))
    groups, _, lanes = cases.shape
    energy = np.empty((groups, *inertia.shape, lanes))
    ends, seen = np.empty((groups, len(width), lanes)), np.empty((groups, 4, lanes))
    about, shared = (machine.sense, 0, 0.0, in_time), (width, inertia, torque)
    transient.carry(about, machine.answer.rule, shared, cases, (energy, ends, seen))
    return taken(ends, len(given)), taken(seen, len(given))


def test_leaping_over_periods_is_passing_them():
    own = [0.02, 1.0, 0.0, -1e-4, 2500.0]
    ends, seen = carried([[*own, 9.0]], in_time=False)
    viscous, then = carried([[*own[:2], -1e-15, *own[3:], 9.0]], in_time=False)
    np.testing.assert_allclose(ends, viscous, rtol=1e-12)
    np.testing.assert_allclose(seen[:, [0, 3]], then[:, [0, 3]], rtol=1e-12)


def test_the_least_energy_is_that_of_all_periods():
    falling = [0.02, 0.0, 0.0, -1e-3, 2500.0, 6.0]
    rising = [0.02, 60.0, 0.0, 0.0, 1200.0, 6.0]
    for case, last in ((falling, True), (rising, False)):
        _, whole = carried([case], in_time=False)
        _, one = carried([[*case[:5], 1.0]], in_time=False)
        assert (whole[0, 3] < one[0, 3]) == last
        assert whole[0, 3] <= one[0, 3]


def test_a_peak_beside_the_end_of_a_cell_that_is_less_exact_is_within_the_errors():
    """Just before a dead centre; the cell behind it, smoother, has the larger value at its end."""
    until = {"run__until": "0.028401 s", "run__rtol": 1e-6, "run__every": "none"}
    scene = random_settled(50157).with_(**until, start__angle=6.1055828, start__speed=-1053.7781)
    (found,) = rows_of([scene])
    alone = simulate(scene.with_(run__every="0.25 deg"), rtol=1e-12).measures()
    peak = next(one.peak for one in alone.joints if one.joint == "crank pin")
    apart = abs(float(found.columns["crank_pin_peak"][0, 0]) - peak.value)
    assert 2.0 * peak.error < apart
    assert apart <= float(found.columns["crank_pin_peak_error"][0, 0]) + peak.error
