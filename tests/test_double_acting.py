"""Gas on both sides of a piston."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import InputError, Result, load_scene, simulate
from crankmbs.batch.rows import rows_of
from crankmbs.figures import save_figures
from crankmbs.measures.plausible import warnings
from crankmbs.mechanics.carried import carried_over
from crankmbs.mechanics.train import crank_train
from crankmbs.page import exported
from crankmbs.report.machine import machine_rows
from crankmbs.scene.drives import Start
from crankmbs.scene.fuel import Fuel, Misfire
from crankmbs.scene.gas import Gas, Indicator
from crankmbs.scene.loads import Constant, Quadratic
from crankmbs.scene.parts import Friction, Piston
from crankmbs.scene.run import Extent
from crankmbs.scene.tables import CylinderTable, Table
from crankmbs.scene.write import scene_files
from crankmbs.sweep.columns import row_of

STEAM = load_scene("steam_engine")
AREA, ROD = math.pi / 4.0 * 0.3**2, math.pi / 4.0 * 0.05**2
ANGLES = tuple(np.radians([0.0, 70.0, 200.0, 310.0]).tolist())
BELOW = Table(ANGLES, (1e5, 1.5e5, 4e5, 2e5))


def free(scene=STEAM, **parts):
    """The steam engine with a flywheel, under a load that takes what its steam gives."""
    start = Start(angle=0.1, speed=21.0)
    load = (Quadratic(coefficient=3.4),)
    return replace(scene, motion=None, start=start, torque=load, **parts)


def with_gas(scene=STEAM, **parts):
    return replace(scene, gas=replace(scene.gas, **parts))


FREE = free()


def test_each_end_and_the_ambient_push_on_their_areas():
    head = Table(ANGLES, (6e5, 3e5, 1.2e5, 2e5))
    ambient = 1.1e5
    gas = Gas(pressure=head, crank_end=BELOW, ambient=ambient, stroke=2, interpolation="linear")
    data = simulate(replace(STEAM, gas=gas)).data
    turned = np.mod(data["crank_angle"].values, 2.0 * math.pi)
    above, below = (
        np.interp(turned, (*one.x, 2.0 * math.pi), (*one.y, one.y[0])) for one in (head, BELOW)
    )
    # head end down on the bore, crank end up on the ring, ambient up on the piston rod
    force = above * AREA - below * (AREA - ROD) - ambient * ROD
    np.testing.assert_allclose(data["gas_force"].values[:, 0], force, rtol=1e-12, atol=1e-8)
    np.testing.assert_allclose(data["gas_pressure"].values[:, 0], above - ambient, atol=1e-7)
    np.testing.assert_allclose(data["crank_end_pressure"].values[:, 0], below - ambient, atol=1e-7)


def test_the_printed_pressures_give_the_turning_moment():
    at = simulate(STEAM).data.isel(time=125)
    net = 30e3 * AREA - 1.5e3 * (AREA - ROD)
    assert float(at["gas_force"][0]) == pytest.approx(net, rel=1e-12)
    assert float(at["crank_torque"][0]) == pytest.approx(3017.20186, abs=1e-5)


def test_a_crank_end_at_ambient_is_none():
    single = simulate(with_gas(crank_end=None)).data
    double = simulate(with_gas(crank_end=0.0)).data
    assert np.all(double["crank_end_pressure"] == 0.0)
    for name in single.data_vars:
        peak = float(np.abs(single[name]).max()) or 1.0
        np.testing.assert_allclose(double[name], single[name], rtol=0.0, atol=1e-11 * peak)


def test_equal_pressures_push_on_the_piston_rod_alone():
    scene = with_gas(crank_end=STEAM.gas.pressure)
    data = simulate(scene).data
    np.testing.assert_allclose(
        data["gas_force"], ROD * data["gas_pressure"], rtol=0.0, atol=1e-9 * AREA * 5e5
    )
    bare = replace(scene, piston=replace(STEAM.piston, rod_diameter=None))
    force = simulate(bare).data["gas_force"]
    assert float(np.abs(force).max()) < 1e-9 * AREA * 5e5


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_powers_add_and_pressures_are_of_their_own_areas(formulation):
    result = simulate(FREE, formulation=formulation)
    data, found = result.data, result.measures()
    last = data.isel(time=slice(360, None))
    travel = last["piston_displacement"].values[:, 0]

    def loop(name):
        values = last[name].values[:, 0]
        return np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(travel))

    head, crank = loop("gas_pressure"), -loop("crank_end_pressure")
    assert found.imep[0].value == pytest.approx(head / 0.45, rel=2e-4)
    assert found.imep_crank_end[0].value == pytest.approx(crank / 0.45, rel=2e-4)
    seconds = float(last["time"][-1] - last["time"][0])
    ends = found.indicated_power_head_end.value, found.indicated_power_crank_end.value
    assert ends[0] == pytest.approx(head * AREA / seconds, rel=2e-4)
    assert ends[1] == pytest.approx(crank * (AREA - ROD) / seconds, rel=2e-4)
    assert found.indicated_power.value == pytest.approx(sum(ends), rel=1e-12)
    cycles = result.cycles
    assert float(cycles["imep"][-1, 0]) == pytest.approx(found.imep[0].value, rel=1e-9)
    of_crank = found.imep_crank_end[0].value
    assert float(cycles["imep_crank_end"][-1, 0]) == pytest.approx(of_crank, rel=1e-9)
    work = AREA * 0.45 * found.imep[0].value + (AREA - ROD) * 0.45 * of_crank
    assert float(cycles["gas_work"][-1, 0]) == pytest.approx(work, rel=1e-9)


def test_backwards_the_works_of_the_ends_change_their_sign():
    forwards, backwards = (
        simulate(replace(STEAM, motion=replace(STEAM.motion, speed=speed)))
        for speed in (20.0, -20.0)
    )
    for name in ("imep", "imep_crank_end"):
        ahead, behind = (run.cycles[name].values[-1, 0] for run in (forwards, backwards))
        assert behind == pytest.approx(-ahead, rel=1e-9)


def test_single_acting_scenes_have_none_of_it():
    result = simulate(load_scene("propeller"))
    assert "crank_end_pressure" not in result.data
    assert "imep_crank_end" not in result.cycles
    assert crank_train(result.scene).crank_end is None
    found = result.measures()
    ends = found.imep_crank_end, found.indicated_power_head_end, found.indicated_power_crank_end
    assert ends == (None, None, None)


def test_rings_feel_the_net_force():
    scene = replace(FREE, friction=Friction(ring_pressure=0.02))
    data = simulate(scene).data
    away = np.abs(data["piston_velocity"].values) > 1e-3
    rubs = 0.02 * np.abs(data["gas_force"].values) * -np.sign(data["piston_velocity"].values)
    np.testing.assert_allclose(data["friction_force"].values[away], rubs[away], atol=1e-7)
    assert not np.allclose(np.abs(rubs), 0.02 * AREA * np.abs(data["gas_pressure"].values))


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_fuel_belongs_to_the_head_end(formulation):
    cold = Table(ANGLES, (1e4, 2e4, 0.0, 5e3))
    fuel = Fuel(misfire=(Misfire(cylinder=1, cycles="2"),))
    scene = free(with_gas(motored=cold), fuel=fuel)
    missed = simulate(scene, formulation=formulation).data
    at = missed["crank_angle"].values
    share = missed["fuel"].values[:, 0]
    assert set(share) == {0.0, 1.0}
    fired, motored = (
        crank_train(replace(scene, fuel=None, gas=replace(scene.gas, motored=None, pressure=one)))
        for one in (scene.gas.pressure, cold)
    )
    expected = np.where(share == 1.0, fired.pressure[0](at), motored.pressure[0](at))
    np.testing.assert_allclose(missed["gas_force"].values[:, 0], AREA * expected, atol=1e-6)
    below = fired.crank_end[0](at)
    np.testing.assert_allclose(missed["crank_end_pressure"].values[:, 0], below, atol=1e-6)
    np.testing.assert_allclose(
        missed["gas_pressure"].values[:, 0], expected + (1 - ROD / AREA) * below, atol=1e-6
    )


@pytest.mark.slow
def test_multibody_agrees():
    scene = replace(FREE, run=replace(FREE.run, until=Extent(value=6.0, unit="rad")))
    reduced, bodies = (simulate(scene, formulation=f).data for f in ("crank_angle", "multibody"))
    for name in ("crank_speed", "gas_pressure", "crank_end_pressure", "piston_pin_force_x"):
        peak = float(np.abs(reduced[name]).max())
        np.testing.assert_allclose(bodies[name], reduced[name], rtol=0.0, atol=1e-4 * peak)


def test_sequences_of_both_ends_come_together_again():
    turn = 2.0 * math.pi
    above = Table(tuple(k * turn / 4 for k in range(8)), (5e5, 2e5, 1e5, 1e5, 4e5, 1e5, 0.0, 0.0))
    below = Table(tuple(k * turn / 3 for k in range(9)), (0.0, 3e5, 0.0) * 3)
    gas = Gas(pressure=above, crank_end=below, absolute=False, stroke=2, cycles="sequence")
    scene = replace(FREE, gas=gas)
    assert crank_train(scene).period == pytest.approx(6.0 * turn)
    assert scene.settled_period == pytest.approx(6.0 * turn)
    net, (head,), (crank,) = (
        crank_train(scene).pressure[0],
        crank_train(replace(scene, gas=replace(gas, crank_end=None))).pressure,
        crank_train(scene).crank_end,
    )
    phi = np.linspace(-3.0, 45.0, 999)
    expected = head(phi) - (1.0 - ROD / AREA) * crank(phi)
    np.testing.assert_allclose(net(phi), expected, atol=1e-9 * 5e5)


def test_cases_of_a_sweep_solved_together_are_those_of_runs_alone():
    settled = replace(FREE.run, until="settled")
    scenes = [
        replace(FREE, run=settled).with_(piston__rod_diameter=across)
        for across in ("30 mm", "50 mm", "120 mm")
    ]
    (together, *others) = rows_of(scenes)
    rows = [together, *others]
    for found in rows:
        for place, number in enumerate(found.which):
            alone = row_of(simulate(scenes[number]), None)
            names = ("imep", "imep_crank_end", "indicated_power", "mean_speed")
            for name in (*names, "indicated_power_head_end", "indicated_power_crank_end"):
                apart = np.abs(found.columns[name][place] - alone[name]).max()
                allowed = found.columns[f"{name}_error"][place] + alone[f"{name}_error"]
                assert apart <= np.max(allowed), name
            lectures = alone["lecture_deviation"], alone["lecture_deviation_error"]
            ours = found.columns["lecture_deviation"][place]
            errors = found.columns["lecture_deviation_error"][place] + lectures[1]
            apart = np.abs(ours - lectures[0]) - errors
            assert not np.any(apart > 1e-9)


def test_another_geometry_carries_both_ends_along():
    before = with_gas(crank_end=BELOW)
    longer = replace(before, rod=replace(STEAM.rod, length=0.9))
    moved = carried_over(longer, before).gas
    assert moved.crank_end.x != BELOW.x
    assert moved.crank_end.y == BELOW.y
    assert moved.pressure.x != before.gas.pressure.x
    diagram = Indicator(
        compression_ratio=8.0,
        n_compression=1.3,
        n_expansion=1.3,
        intake_pressure=1e5,
        peak_pressure=5e6,
    )
    gas = Gas(indicator=diagram, ambient=1e5, stroke=2, crank_end=BELOW)
    of_diagram = carried_over(replace(longer, gas=gas), replace(before, gas=gas)).gas
    assert of_diagram.crank_end == moved.crank_end
    assert of_diagram.indicator == diagram


def test_columns_of_crank_ends_are_carried_by_cylinder():
    columns = CylinderTable(ANGLES, (BELOW.y, BELOW.y[::-1]))
    twin = load_scene("v_twin")
    gas = Gas(pressure=1e5, crank_end=columns, absolute=False, aligned=True, stroke=2)
    before = replace(twin, gas=gas)
    longer = replace(before, rod=replace(twin.rod, length=1.2 * twin.rod.length))
    moved = carried_over(longer, before).gas
    assert not moved.aligned
    assert len(moved.crank_end) == 2


def test_a_scene_is_written_and_read_again(tmp_path):
    for name, scene in (("steam", STEAM), ("constant", with_gas(crank_end=2500.0))):
        for file, text in scene_files(scene, name).items():
            (tmp_path / file).write_text(text)
        again = load_scene(tmp_path / f"{name}.toml")
        assert again.piston == scene.piston
        for key in ("pressure", "crank_end"):
            ours, theirs = (getattr(one.gas, key) for one in (again, scene))
            assert ours == theirs or (ours.x, ours.y) == (theirs.x, theirs.y)
    assert "steam_crank_end.csv" in scene_files(STEAM, "steam")


def test_a_result_is_saved_and_read_again(tmp_path):
    result = simulate(STEAM)
    result.save(tmp_path / "run")
    again = Result.load(tmp_path / "run")
    assert again.scene == STEAM
    assert again.measures() == result.measures()
    assert again.cycles.identical(result.cycles)


def test_the_figures_show_both_ends(tmp_path):
    result = simulate(STEAM)
    assert tmp_path / "pressure.png" in save_figures(result, tmp_path)
    along, axes = result.plot("pressure").axes
    head, crank = axes.lines
    data = result.data.isel(time=slice(360, None))
    displacement = data["piston_displacement"].values[:, 0]
    for line, area, name in (
        (head, AREA, "gas_pressure"),
        (crank, AREA - ROD, "crank_end_pressure"),
    ):
        np.testing.assert_allclose(line.get_xdata(), 1e6 * area * displacement, atol=1e-6)
        np.testing.assert_allclose(line.get_ydata(), 1e-5 * data[name].values[:, 0], atol=1e-9)
    assert [line.get_label() for line in along.lines[:2]] == ["head end", "crank end"]
    assert len(simulate(load_scene("propeller")).plot("pressure").axes[1].lines) == 1


def test_the_machine_is_described_by_both_ends():
    rows = machine_rows(STEAM)
    said = " ".join(text for _, text in rows)
    for words in ("piston rod 50 mm", "double-acting", "in the head end", "in the crank end"):
        assert words in said
    (piston,) = (text for name, text in machine_rows(load_scene("propeller")) if name == "piston")
    assert "rod" not in piston


def test_a_load_that_drives_as_the_crank_end_does_is_warned_of():
    gas = replace(STEAM.gas, pressure=0.0, interpolation="pchip")
    driven = replace(FREE, gas=gas, torque=(Constant(torque=500.0),))
    (said,) = warnings(driven)
    assert "drives, as the gas does" in said
    assert warnings(replace(driven, torque=(Constant(torque=-500.0),))) == ()


def test_the_page_is_given_both_ends():
    given = exported(STEAM)
    share = given["piston"]["crank_end_share"]
    assert share == pytest.approx(1.0 - ROD / AREA, rel=1e-15)
    assert len(given["gas"]["crank_end"]) == len(given["gas"]["below"]) == 1
    assert exported(load_scene("propeller"))["gas"]["crank_end"] == []


REFUSED = {
    "piston.bore: with gas the piston needs its bore": lambda: replace(
        STEAM, piston=Piston(mass=225.0, rod_diameter=0.05)
    ),
    "rod_diameter must be less than the bore, 0.3 m; 0.3 m came": lambda: replace(
        STEAM.piston, rod_diameter=0.3
    ),
    "rod_diameter must be less than the bore, 0.112838 m; 0.2 m came": lambda: Piston(
        mass=1.0, area=0.01, rod_diameter=0.2
    ),
    "gas.crank_end: as many files as cylinders are needed, 1, or one for all; 2 came": (
        lambda: with_gas(crank_end=(BELOW, BELOW))
    ),
    "crank_end: an absolute pressure cannot be negative; -1 Pa came": lambda: Gas(
        pressure=1e5, crank_end=-1.0, ambient=1e5
    ),
    "zero, interpolation, closing and cycles belong to a pressure file": lambda: Gas(
        pressure=1e5, crank_end=2e5, ambient=1e5, interpolation="linear"
    ),
    "give pressure or indicator, exactly one of the two; neither came": lambda: Gas(
        crank_end=BELOW, ambient=1e5
    ),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_what_cannot_be_is_refused(sentence):
    with pytest.raises(InputError, match=sentence):
        REFUSED[sentence]()


def test_a_file_of_the_crank_end_has_what_belongs_to_files():
    gas = Gas(pressure=1e5, crank_end=BELOW, ambient=1e5, interpolation="linear", stroke=2)
    assert gas.interpolation == "linear"


def test_gravity_and_fuel_are_said():
    rows = dict(machine_rows(load_scene("run_up")))
    assert rows["gravity"] == "none"
    assert rows["fuel"] == "governor at 900 rpm; from 150 rpm"
    assert dict(machine_rows(STEAM))["gravity"].startswith("9.81 m/s^2")
