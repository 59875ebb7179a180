"""The tables that `run` prints: which angle stands in which column, which window a table names."""

import math
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Crank,
    Gas,
    Layout,
    Motion,
    Piston,
    Rod,
    Run,
    Scene,
    SpeedTable,
    Table,
    load_scene,
    simulate,
)
from crankmbs.report.machine import machine_rows
from crankmbs.report.rows import (
    FORCE_HEADINGS,
    cycle_remark,
    measure_rows,
    measure_tables,
    peak_rows,
    tables,
    unsteady,
)
from crankmbs.scene.parts import Friction

PEAK = 370.0  # deg, of the pressure, in the cycle of each cylinder
ORDER = (1, 3, 4, 2)


@pytest.fixture(scope="module")
def rows():
    """Pistons without mass: a pin carries what the gas puts on its piston over cos(beta), and the
    pressure has one corner, so steep that its force peaks there."""
    angles = tuple(math.radians(a) for a in (0.0, PEAK - 20.0, PEAK, PEAK + 20.0))
    scene = Scene(
        crank=Crank(radius=0.04, inertia=0.05),
        rod=Rod(length=0.13),
        piston=Piston(mass=0.0, area=5e-3),
        gas=Gas(
            pressure=Table(angles, (1e5, 1e5, 5e6, 1e5)),
            absolute=False,
            stroke=4,
            interpolation="linear",
        ),
        layout=Layout(firing_order=ORDER),
        motion=Motion(speed=100.0),
        run=Run(until="2 cycles"),
    )
    table = peak_rows(simulate(scene).measures())
    return {name: dict(zip(FORCE_HEADINGS, cells, strict=True)) for name, *cells in table}


@pytest.mark.parametrize("joint", ["crank pin", "piston pin"])
@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_peak_has_its_crank_angle_and_its_own_cycle_angle(rows, joint, number):
    """Cylinder k of the order fires 180 degrees after the one before it."""
    row = rows[f"{joint} {number} [N]"]
    assert float(row["cycle angle [deg]"]) == pytest.approx(PEAK, abs=2e-3)
    at_crank = (PEAK + 180.0 * ORDER.index(number)) % 720.0
    assert float(row["crank angle [deg]"]) == pytest.approx(at_crank, abs=2e-3)


def test_the_main_bearing_has_no_cycle_angle(rows):
    assert rows["main bearing [N]"]["cycle angle [deg]"] == ""


def test_pressure_and_torque_stand_below_the_forces(rows):
    assert float(rows["gauge pressure 2 [bar]"]["peak"]) == pytest.approx(50.0)
    assert float(rows["gauge pressure 2 [bar]"]["cycle angle [deg]"]) == pytest.approx(
        PEAK, abs=2e-3
    )
    assert float(rows["gas and inertia torque, max [N m]"]["peak"]) > 0.0


def test_a_periodic_run_has_peaks_of_its_last_cycle():
    result = simulate(load_scene("propeller"))
    found = result.measures()
    names = [table.headings[0] for table in tables(result, found)]
    assert names == ["over the last cycle", "over the last cycle", "over cycles 1 to 19"]
    assert unsteady(result, found) == ""
    rows = {name: float(value) for name, value, _ in measure_rows(found)}
    # power is torque times speed, and the piston passes the stroke twice a revolution
    speed = rows["mean speed [rpm]"]
    torque = rows["mean load torque (drive, where positive) [N m]"]
    assert rows["brake power [kW]"] == pytest.approx(-torque * speed * math.pi / 30e3, rel=1e-5)
    stroke = 2.0 * result.scene.crank.radius
    assert rows["mean piston speed [m/s]"] == pytest.approx(stroke * speed / 30.0, rel=1e-5)


def test_a_machine_that_is_driven_takes_drive_power():
    result = simulate(load_scene("compressor"))
    names = [name for name, *_ in measure_rows(result.measures())]
    assert "drive power [kW]" in names


def test_a_machine_without_gas_that_works_takes_drive_power():
    """What the motor gives is what friction and the forces on the slide take."""
    motor = SpeedTable(file=Table((0.0, 12.0), (3000.0, 0.0)))
    press = load_scene("validation/scenes/press.toml").with_(torque=(motor,), run__until="settled")
    result = simulate(press)
    assert result.status == 0
    rows = {name: float(value) for name, value, _ in measure_rows(result.measures())}
    taken = rows["friction power of the pistons [kW]"]
    assert rows["power of the forces on the pistons [kW]"] < 0.0
    works = taken - rows["power of the forces on the pistons [kW]"]
    assert rows["drive power [kW]"] == pytest.approx(works, rel=1e-5)


def test_a_machine_without_gas_says_what_a_cycle_is():
    assert "two turns, 720 deg" in cycle_remark(load_scene("coasting"))
    assert math.degrees(load_scene("coasting").period) == pytest.approx(720.0)
    assert not any(cycle_remark(load_scene(name)) for name in ("propeller", "compressor"))
    assert ("cycle", cycle_remark(load_scene("coasting"))) in machine_rows(load_scene("coasting"))


def test_a_run_that_speeds_up_has_peaks_of_the_whole_run():
    """It is driven from rest, so its last cycle says nothing of the run."""
    result = simulate(load_scene("torque_driven"))
    found = result.measures()
    cycle, run = tables(result, found)
    assert cycle.headings[0] == "over the last cycle"
    assert not any("fluctuation" in name for name, *_ in cycle.rows)
    assert run.headings[0] == "over the whole run, 0 to 1 s"
    speed = dict(zip(run.headings, run.rows[0], strict=True))
    assert speed["over the whole run, 0 to 1 s"] == "highest speed [rpm]"
    assert speed["cycle"] == "2"
    assert float(speed["at time [s]"]) == pytest.approx(0.936, abs=1e-3)
    assert "changes by +131 rpm over the last cycle" in unsteady(result, found)


@pytest.mark.parametrize(
    ("force", "kind"),
    [pytest.param(15.0, "reversal", marks=pytest.mark.slow), (60.0, "load off")],
)
def test_a_run_shorter_than_a_cycle_that_rests_is_not_periodic(force, kind):
    """The crank swings, or is pushed and rubs to rest: at either end its speed is 0, so that it
    does not drift."""
    push = Constant(torque=5.0, until=0.1)
    scene = load_scene("coasting").with_(friction=Friction(ring_force=force), run__until="20 s")
    start = {"start__angle": "60 deg", "start__speed": "0 rpm"}
    result = simulate(scene.with_(torque=() if kind == "reversal" else (push,), **start))
    found = result.measures()
    assert kind in result.event_table.values("kind")
    assert found.window.kind == "whole run"
    assert abs(found.speed_gain.value) < 1e-6
    assert "rests or turns back" in unsteady(result, found)
    whole, run = tables(result, found)
    assert "at time [s]" in run.headings
    names = [name for name, *_ in whole.rows]
    assert not any("fluctuation" in name or "efficiency" in name for name in names)
    means = [name for name in names if name.startswith("mean ")]
    assert bool(means) == (kind != "reversal")  # over the angle turned: of swings it says nothing
    if kind != "reversal":
        rows = {name: value for name, value, _ in whole.rows}
        assert rows["drift of the speed over the whole run [rpm]"] == "0"
        assert not any("kinetic" in name for name in names)


@pytest.mark.slow
def test_a_run_that_turns_back_has_no_cycle():
    result = simulate(load_scene("run_down"))
    found = result.measures()
    assert found.imep is None
    run, cycles = tables(result, found)
    assert run.headings[0] == "over the whole run, 0 to 1.48434 s"
    assert cycles.headings[0] == "over cycles 1 to 6"
    assert "turns back" in unsteady(result, found)


def test_each_end_and_each_stroke_has_its_row():
    scene = load_scene("steam_engine")
    result = simulate(scene)
    rows = {row[0]: row[1] for row in peak_rows(result.measures())}
    for end, name in (("head end", "gas_pressure"), ("crank end", "crank_end_pressure")):
        peak = float(result.data[name].max()) / 1e5
        assert float(rows[f"gauge pressure, {end} [bar]"]) == pytest.approx(peak, rel=1e-3)
    compressor = load_scene("two_stage_compressor")
    low, high = compressor.layout.cylinders
    layout = Layout(cylinders=(replace(low, radius=0.02), replace(high, radius=0.03)))
    run = Run(until="1 cycle")
    motion = Motion(speed=90.0)
    unlike = replace(compressor, layout=layout, start=None, torque=(), motion=motion, run=run)
    result = simulate(unlike)
    found = {row[0]: row[1] for row in measure_rows(result.measures())}
    speed = result.measures().mean_speed.value
    for number, gear in enumerate(unlike.running_gear, start=1):
        value = float(found[f"mean piston speed, cylinder {number} [m/s]"])
        assert value == pytest.approx(gear.stroke * speed / math.pi, rel=1e-5)


def test_of_cycles_that_differ_it_is_said_in_which_a_peak_is():
    degrees = np.array([0.0, 340.0, 370.0, 400.0, 720.0])
    rows = [
        (720.0 * k + degrees[:-1], (1e5, 1e5, top, 1e5)) for k, top in enumerate((3e6, 5e6, 4e6))
    ]
    angles = np.radians(np.concatenate([*(angle for angle, _ in rows), [2160.0]]))
    pressures = np.concatenate([*(each for _, each in rows), [1e5]])
    gas = Gas(
        pressure=Table(tuple(angles), tuple(pressures)), absolute=False, stroke=4, cycles="sequence"
    )
    scene = load_scene("propeller").with_(run__until="6 cycles", run__every="none")
    scene = replace(scene, gas=gas, start=None, torque=(), motion=Motion(speed=100.0))
    _, table = measure_tables(simulate(scene).measures())
    pressure = next(row for row in table.rows if row[0].startswith("gauge pressure"))
    assert dict(zip(table.headings, pressure, strict=True))["cycle"] == "5"
    _, table = measure_tables(simulate(load_scene("propeller")).measures())
    assert "cycle" not in table.headings


def test_of_cycles_that_differ_the_least_and_the_largest_are_said():
    """A misfire in cylinder 3: its pressures and the speeds differ, the pressures elsewhere do
    not."""
    result = simulate(load_scene("misfire"))
    last = tables(result, result.measures())[-1]
    assert last.headings == [
        "over cycles 1 to 10",
        *("least", "in cycle", "largest", "in cycle", "num. error"),
    ]
    cycles, rows = result.cycles, {name: cells for name, *cells in last.rows}
    names = {
        "mean speed [rpm]": (cycles.mean_speed, cycles.mean_speed, pi / 30.0),
        "indicated mean effective pressure, cylinder 3 [bar]": (
            *2 * (cycles.imep.sel(cylinder=3),),
            1e5,
        ),
        "crank speed [rpm]": (cycles.least_speed, cycles.largest_speed, pi / 30.0),
    }
    assert list(rows) == list(names)
    for name, (least, largest, scale) in names.items():
        low, in_low, high, in_high, _ = rows[name]
        assert float(low) == pytest.approx(float(least.min()) / scale, rel=1e-5)
        assert float(high) == pytest.approx(float(largest.max()) / scale, rel=1e-5)
        assert float(least.sel(cycle=int(in_low))) == least.min()
        assert float(largest.sel(cycle=int(in_high))) == largest.max()


@pytest.mark.parametrize("name", ["yi_diesel_free", "coasting", "torque_driven"])
def test_alike_or_few_cycles_are_not_told_apart(name):
    result = simulate(load_scene(name))
    assert not tables(result, result.measures())[-1].headings[0].startswith("over cycles")


@pytest.mark.parametrize("offset", [0.04, -0.04, 0.0])
def test_an_offset_slide_has_its_quick_return_ratio(offset):
    """(180 + phi) / (180 - phi), phi between the lines of crank and rod at both dead centres."""
    scene = load_scene("coasting").with_(
        crank__radius=0.05, rod__length=0.15, rod__center_of_mass=0.0, piston__offset=offset
    )
    said = dict(machine_rows(scene))["dead centres"]
    phi = math.degrees(math.asin(abs(offset) / 0.1) - math.asin(abs(offset) / 0.2))
    ratio = (180.0 + phi) / (180.0 - phi)
    assert (f"quick-return ratio {ratio:.6g}: " in said) == bool(offset)
    out = 180.0 + math.copysign(phi, offset)
    assert (f"{out:.6g} deg from the first to the second" in said) == bool(offset)
