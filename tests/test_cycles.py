"""What each whole cycle amounts to: energy, closed forms, the oracle, honest errors."""

import csv
import math
from dataclasses import replace

import h5py
import numpy as np
import pytest
from test_events import HEAVY
from test_fuel import (
    FOUR,
    FUELS,
    GOVERNOR,
    THIN_GAS,
    assert_as_the_oracle_has_it,
    exact,
    fuelled,
)
from test_windows import FREE, wheel

from crankmbs import (
    Constant,
    Extent,
    Fuel,
    Motion,
    Oscillation,
    OutputError,
    Quadratic,
    Result,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.motion import cycles as kept
from crankmbs.motion.free import passes
from crankmbs.scene.parts import Friction

PERIOD = 4.0 * math.pi
LOADS = (
    Quadratic(coefficient=6e-4, from_speed=325.0),
    Viscous(coefficient=0.02),
    TimeTable(file=Table((0.0, 0.02, 0.05, 1.0), (0.0, -30.0, 10.0, -20.0))),
    Constant(torque=-25.0, after=0.033, until=0.07),
)


def until(scene, value, unit, **run):
    return replace(scene, run=replace(scene.run, until=Extent(value=value, unit=unit), **run))


def test_a_little_energy_gained_by_a_heavy_wheel_has_the_rounding_of_all_of_it():
    heavy = wheel(Constant(torque=0.001), speed=300.0).with_(crank__inertia=20.0)
    scene = until(heavy, 4.0 * math.pi, "rad", every="1 deg")
    gained = simulate(scene).cycles["kinetic_energy_gained"]
    off = np.abs(gained.values - 0.001 * scene.period).max()
    assert 1e-12 < off <= gained.error_estimate < 1e-9


def unbalanced(cycles):
    """Kinetic energy gained less all works [J], largest of all cycles; and the largest term."""
    left, largest = cycles["kinetic_energy_gained"].values.copy(), 0.0
    for name in ("gas_work", "load_work", "drive_work", "friction_work"):
        if name in cycles:
            work = cycles[name].values
            left -= work.reshape(len(left), -1).sum(axis=1)
            largest = max(largest, float(np.abs(work).max()))
    return float(np.abs(left).max()), largest


SCENES = {
    "propeller": until(load_scene("propeller"), 2.6, "cycle"),
    "begins between two knots": until(
        replace(FOUR, gas=THIN_GAS, start=replace(FOUR.start, angle=0.123456)), 2.2, "cycle"
    ),
    "fuel and loads": fuelled(FUELS["all at once"], cycles=2.3, gas=THIN_GAS, torque=LOADS),
    "friction": fuelled(
        FUELS["scatter"],
        cycles=2.2,
        gas=THIN_GAS,
        torque=LOADS[1:],
        friction=Friction(ring_force=40.0, ring_pressure=0.02, viscous=30.0),
    ),
    "backwards": fuelled(
        FUELS["scatter"],
        cycles=2.0,
        gas=THIN_GAS,
        torque=LOADS[1:],
        start=replace(FOUR.start, speed=-300.0),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("name", SCENES)
def test_the_energy_of_each_cycle_closes(name, formulation):
    scene = SCENES[name]
    cycles = simulate(scene, formulation=formulation, rtol=1e-11).cycles
    assert cycles.sizes["cycle"] == math.floor(scene.run.until.value)
    left, largest = unbalanced(cycles)
    assert left < 1e-9 * largest


def test_the_first_cycle_begins_when_the_run_does():
    assert simulate(load_scene("coasting")).cycles["time"].values[0] == 0.0


def test_the_energy_closes_to_rounding():
    for name in ("propeller", "begins between two knots", "fuel and loads"):
        left, largest = unbalanced(simulate(SCENES[name], rtol=1e-13).cycles)
        assert left < 1e-12 * largest


@pytest.mark.parametrize("name", ["yi_diesel", "compressor"])
def test_a_drive_gives_what_is_missing(name):
    scene = load_scene(name)
    uneven = Motion(speed=Oscillation(mean=80.0, amplitude=9.0, order=2, phase=0.3), angle=0.4)
    for motion in (scene.motion, uneven):
        cycles = simulate(until(replace(scene, motion=motion), 2.5, "cycle")).cycles
        assert cycles.sizes["cycle"] == 2
        left, largest = unbalanced(cycles)
        assert left < 1e-12 * largest


@pytest.mark.parametrize("name", ["yi_diesel", "compressor"])
def test_a_drive_gives_what_friction_takes(name):
    friction = Friction(ring_force=30.0, ring_pressure=0.02, viscous=5.0)
    scene = replace(load_scene(name), friction=friction)
    cycles = simulate(until(scene, 2.5, "cycle")).cycles
    assert np.all(cycles["friction_work"].values < -1.0)
    left, largest = unbalanced(cycles)
    assert left < 1e-12 * largest


def test_a_drive_fires_by_its_shares():
    motion = Motion(speed=FOUR.start.speed, angle=0.7)
    cycles = simulate(fuelled(FUELS["misfire"], 3.2, start=None, torque=(), motion=motion)).cycles
    left, largest = unbalanced(cycles)
    assert left < 1e-12 * largest
    assert cycles["fuel"].values.tolist() == [[1, 1, 1, 1], [0, 1, 0, 1], [1, 1, 0, 1]]


@pytest.mark.parametrize("formulation", FREE)
def test_a_bare_wheel_by_closed_form(formulation):
    """At 40 rad/s, and 10 rad/s faster each second from 0.5 to 1.2 s."""
    scene = wheel(Constant(torque=5.0, after=0.5, until=1.2), speed=40.0, until=1.6)
    cycles = simulate(scene, formulation=formulation).cycles
    place = PERIOD * np.arange(6)

    def time(angle):
        inside = 0.5 + (np.sqrt(1600.0 + 20.0 * np.maximum(angle - 20.0, 0.0)) - 40.0) / 10.0
        beyond = 1.2 + (angle - 50.45) / 47.0
        return np.where(angle < 20.0, angle / 40.0, np.where(angle < 50.45, inside, beyond))

    assert cycles.sizes["cycle"] == 5
    close = {"rtol": 1e-10, "atol": 1e-10}
    np.testing.assert_allclose(cycles["time"], time(place)[:-1], **close)
    np.testing.assert_allclose(cycles["mean_speed"], PERIOD / np.diff(time(place)), **close)
    work = 5.0 * np.diff(np.clip(place, 20.0, 50.45))
    np.testing.assert_allclose(cycles["load_work"].values[:, 0], work, **close)
    np.testing.assert_allclose(cycles["kinetic_energy_gained"], work, **close)
    speed = np.sqrt(1600.0 + 20.0 * (np.clip(place, 20.0, 50.45) - 20.0))
    np.testing.assert_allclose(cycles["least_speed"], speed[:-1], **close)
    np.testing.assert_allclose(cycles["largest_speed"], speed[1:], **close)


@pytest.mark.parametrize("formulation", FREE)
def test_a_cycle_in_which_it_turns_back_is_none(formulation):
    """It slows down by 10 rad/s each second from 20, so turns back 20 rad on."""
    scene = wheel(Constant(torque=-5.0), speed=20.0, until=6.0)
    cycles = simulate(scene, formulation=formulation).cycles
    assert cycles["cycle"].values.tolist() == [1, 2, 3, 4, 5, 6]
    expected = 0.3 + PERIOD * np.array([0.0, 1.0, 0.0, -1.0, -2.0, -3.0])
    np.testing.assert_allclose(cycles["crank_angle"], expected, atol=1e-12)
    assert (cycles["mean_speed"].values > 0.0).tolist() == [True] + 5 * [False]


@pytest.mark.slow
def test_the_oracle_has_the_same_cycle():
    """Its time, speeds every twelve degrees, the load's work by Simpson's rule, the shares; and
    the samples of a run as exact as it is by default."""
    scene = fuelled(FUELS["all at once"], cycles=1.1, gas=THIN_GAS).with_(run__every="12 deg")
    found = simulate(scene, rtol=1e-10).cycles
    angles = np.linspace(0.0, PERIOD, 61)[1:]
    motion, shares = exact(scene, angles)
    assert_as_the_oracle_has_it(simulate(scene).data.isel(time=slice(61)), motion, shares)
    time, speed = motion.time.astype(float), motion.omega.astype(float)
    assert float(found["duration"][0]) == pytest.approx(time[-1], rel=1e-9)
    speed = np.concatenate([[scene.start.speed], speed])
    rise = np.abs(np.diff(speed, 2)).max()
    assert 0.0 <= float(found["largest_speed"][0]) - speed.max() <= rise
    assert 0.0 <= speed.min() - float(found["least_speed"][0]) <= rise
    weights = np.full(61, 2.0)
    weights[1::2], weights[[0, -1]] = 4.0, 1.0
    work = -scene.torque[0].coefficient * float(speed**2 @ weights) * PERIOD / 180.0
    assert float(found["load_work"][0, 0]) == pytest.approx(work, rel=1e-4)
    behind = [(2.0 * math.pi - c.phase) % PERIOD + 1e-3 for c in FOUR.cylinders]
    row = [int(np.searchsorted(angles, at)) for at in behind]
    decided = shares[row, np.arange(4)].astype(float)
    np.testing.assert_allclose(found["fuel"].values[0], decided, rtol=1e-9)


def test_the_indicated_work_is_the_area_of_the_diagram():
    """Closed polygon through p and V at 20,000 angles of each cylinder's cycle."""
    scene = load_scene("yi_diesel_free")
    found = simulate(until(scene, 1.0, "cycle")).cycles
    piston = scene.piston
    phi = np.linspace(0.0, PERIOD, 20_001)
    r, l, e = scene.crank.radius, scene.rod.length, piston.offset
    x = r * np.cos(phi) + np.sqrt(l**2 - (r * np.sin(phi) - e) ** 2)
    pressure = pressures_of(scene)[0](phi)
    work = -piston.gas_area * np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(x))
    np.testing.assert_allclose(found["gas_work"].values, work, rtol=1e-5)
    stroke = np.sqrt((l + r) ** 2 - e**2) - np.sqrt((l - r) ** 2 - e**2)
    np.testing.assert_allclose(found["imep"].values, work / (piston.gas_area * stroke), rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("formulation", FREE)
@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
def test_errors_are_honest(rtol, formulation):
    scene = until(SCENES["fuel and loads"], 2.1, "cycle")
    exactly = simulate(scene, rtol=1e-13).cycles
    found = simulate(scene, rtol=rtol, formulation=formulation).cycles
    for name, one in found.data_vars.items():
        true = np.abs(one.values - exactly[name].values).max()
        floor = 1e-12 * np.abs(exactly[name].values).max()
        assert true <= 2.0 * one.error_estimate + floor, name


def test_multibody_has_the_same_cycles():
    loads = (Viscous(coefficient=0.1), Constant(torque=20.0, after=0.3))
    scene = replace(wheel(*loads, speed=60.0, until=0.8), **HEAVY)
    ours, theirs = (
        simulate(scene, formulation=f, cost_cap=4.0).cycles for f in ("crank_angle", "multibody")
    )
    assert ours.sizes == theirs.sizes
    for name, one in theirs.data_vars.items():
        apart = np.abs(one.values - ours[name].values).max()
        assert apart <= 2.0 * (one.error_estimate + ours[name].error_estimate), name
        assert one.error_estimate < 1e-3 * max(1.0, np.abs(one.values).max())
    left, largest = unbalanced(theirs)
    assert left < 1e-4 * largest


@pytest.mark.slow
def test_settled_under_a_governor_the_mean_is_its_speed():
    cycles = simulate(fuelled(Fuel(governor=GOVERNOR), cycles=150.0, gas=THIN_GAS)).cycles
    assert cycles.sizes["cycle"] == 150
    assert float(cycles["mean_speed"][-1]) == pytest.approx(GOVERNOR.speed, rel=1e-9)
    assert np.ptp(cycles["fuel"].values[-1]) < 1e-6


def test_the_samples_do_not_matter():
    scene = SCENES["fuel and loads"]
    bare = replace(scene, run=replace(scene.run, every=None))
    ours, theirs = (simulate(one).cycles for one in (scene, bare))
    assert ours.identical(theirs)


@pytest.mark.parametrize("every", ["1 deg", "none"])
def test_of_more_cycles_the_last_are_kept(monkeypatch, every):
    scene = load_scene("propeller").with_(run__until="40 cycles", run__every=every)
    all_of = simulate(scene).cycles
    for module in (kept, passes):
        monkeypatch.setattr(module, "MOST_CYCLES", 5)
    last = simulate(scene).cycles
    assert last["cycle"].values.tolist() == [36, 37, 38, 39, 40]
    assert str(last.attrs["left_out"]) == "the first 35 cycles are left out"
    for name, one in last.data_vars.items():
        np.testing.assert_allclose(one.values, all_of[name].values[-5:], rtol=1e-11, atol=1e-9)


@pytest.mark.slow
def test_saved_and_loaded_they_are_the_same(tmp_path):
    result = simulate(SCENES["fuel and loads"])
    result.save(tmp_path)
    again = Result.load(tmp_path)
    assert again.cycles.identical(result.cycles)
    assert again.data.identical(result.data)
    with (tmp_path / "cycles.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["cycle"] for row in rows] == ["1", "2"]
    work = [float(row["load_work 4 [J]"]) for row in rows]
    np.testing.assert_allclose(work, result.cycles["load_work"].values[:, 3], rtol=1e-10)


def test_a_run_of_no_whole_cycle_has_none(tmp_path):
    result = simulate(until(load_scene("propeller"), 0.5, "cycle"))
    assert result.cycles.sizes["cycle"] == 0
    result.save(tmp_path)
    assert Result.load(tmp_path).cycles.identical(result.cycles)
    assert not (tmp_path / "cycles.csv").exists()


@pytest.mark.slow
def test_a_file_whose_cycles_cannot_be_is_refused(tmp_path):
    file = simulate(SCENES["fuel and loads"]).save(tmp_path) / "result.nc"
    with h5py.File(file, "a") as raw:
        del raw["cycle_load_work"]
    with pytest.raises(OutputError, match="no readable result"):
        Result.load(file)
