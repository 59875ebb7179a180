"""A written scene is read as the same scene, to the last bit."""

import dataclasses
import math

import pytest

from crankmbs import (
    Constant,
    Cylinder,
    Extent,
    Layout,
    Motion,
    Oscillation,
    Ramp,
    SpeedFile,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    shipped_scenes,
)
from crankmbs.scene.write import scene_files

TURN = Table((0.0, math.pi, 2.0 * math.pi), (10.0 * math.pi, 12.0 * math.pi, 10.0 * math.pi))
FREE, DRIVEN = load_scene("propeller"), load_scene("yi_diesel")


def without_source(part):
    """The same part, of a scene read from one file or another."""
    if isinstance(part, Table):
        return dataclasses.replace(part, source="")
    if isinstance(part, tuple):
        return tuple(map(without_source, part))
    if not dataclasses.is_dataclass(part):
        return part
    fields = {f.name: without_source(getattr(part, f.name)) for f in dataclasses.fields(part)}
    return dataclasses.replace(part, **fields)


def again(scene, folder):
    for name, text in scene_files(scene, "again").items():
        (folder / name).write_text(text)
    return load_scene(folder / "again.toml")


@pytest.mark.parametrize("name", shipped_scenes())
def test_shipped_scenes_come_back(name, tmp_path):
    scene = load_scene(name)
    assert without_source(again(scene, tmp_path)) == without_source(scene)


@pytest.mark.parametrize(
    "speed",
    [
        314.1592653589793,
        Oscillation(mean=1.0 / 3.0, amplitude=0.1, order=1.5, phase=0.7),
        Ramp(start=1.0, to=math.pi, over=0.2),
        SpeedFile(file=Table((0.0, 5.0), (math.pi / 30.0, math.pi / 3.0))),
        SpeedFile(file=Table((0.0, 5.0), (1.0, 2.0)), interpolation="cubic"),
        SpeedFile(file=TURN, kind="angle_table", interpolation="cubic"),
    ],
)
def test_prescribed_speeds_come_back(speed, tmp_path):
    scene = dataclasses.replace(DRIVEN, motion=Motion(speed=speed, angle=0.1))
    assert without_source(again(scene, tmp_path)) == without_source(scene)


def test_loads_layout_and_run_come_back(tmp_path):
    table = Table((0.0, 1.0), (1.0 / 3.0, 2.0))
    scene = dataclasses.replace(
        FREE,
        title='a "title" with \x7f and \u00fc',
        start=Start(angle=1.0 / 3.0, speed=1e-5),
        layout=Layout(cylinders=(Cylinder(), Cylinder(phase=1.0, bank=-0.1))),
        torque=(
            Constant(torque=-1e-7),
            Viscous(coefficient=0.1 + 0.2),
            TimeTable(file=table),
            SpeedTable(file=Table((0.0, math.pi), (0.0, -1.0))),
        ),
        run=dataclasses.replace(
            FREE.run, until=Extent(value=0.1 + 0.2, unit="s"), every=None, formulation="minimal"
        ),
    )
    files = scene_files(scene, "again")
    assert {"again_time_table3.csv", "again_speed_table4.csv"} < set(files)
    assert without_source(again(scene, tmp_path)) == without_source(scene)


def test_a_jump_and_a_closing_row_come_back(tmp_path):
    angle = (0.0, 1.0, 2.0, 2.0, 4.0, 7.0, 10.0, 4.0 * math.pi)
    table = Table(angle, (1e5, 2e5, 3e5, 9e5, 5e5, 2e5, 1e5, 1.2e5))
    gas = dataclasses.replace(FREE.gas, pressure=table, closing=0.3e5)
    scene = dataclasses.replace(FREE, gas=gas)
    back = again(scene, tmp_path)
    assert back.gas.closing == 0.3e5
    assert back.gas.pressure.x[2] == back.gas.pressure.x[3] == 2.0
    assert back.gas.pressure.y == table.y


def test_a_written_scene_reads_well():
    text = scene_files(load_scene("yi_diesel_free"), "mine")["mine.toml"]
    for line in (
        'radius = "46 mm"',
        'length = "153.333333333 mm"',
        'area = "57.079 cm^2"',
        'offset = "1.2972 mm"',
        'ambient = "1 kgf/cm^2"',
        "firing_order = [1, 3, 4, 2]",
        'pressure = "mine_pressure.csv"',
        'speed = "3200 rpm"',
        'until = "20 cycles"',
    ):
        assert line in text.splitlines()
    assert "stroke" not in text  # at its default


@pytest.mark.parametrize(
    ("value", "line"),
    [
        ({"crank__radius": 0.1 + 0.2, "rod__length": 1.0}, 'radius = "300.00000000000006 mm"'),
        ({"crank__radius": 0.045}, 'radius = "45 mm"'),
        ({"run__until": "10 rev"}, 'until = "10 rev"'),
        ({"run__until": "15 deg"}, 'until = "15 deg"'),
        ({"run__until": "1 cycle"}, 'until = "1 cycle"'),
        ({"gas__ambient": "14.7 psi"}, 'ambient = "14.7 psi"'),
        ({"gas__ambient": "0.95 bar"}, 'ambient = "0.95 bar"'),
        ({"start__angle": "-0.1 deg"}, 'angle = "-0.1 deg"'),
        ({"crank__inertia": "12345.6 kg cm^2"}, 'inertia = "1.23456 kg m^2"'),
        ({"crank__inertia": "120.7 lb in^2"}, 'inertia = "120.7 lb in^2"'),
        ({"torque__1__coefficient": "9e-6 N m/rpm^2"}, 'coefficient = "9e-06 N m/rpm^2"'),
        ({"start__angle": "0.3 rad"}, 'angle = "0.3 rad"'),
        ({"start__speed": "333 rad/s"}, 'speed = "333 rad/s"'),
    ],
)
def test_a_number_has_the_fewest_digits_that_read_as_it(value, line, tmp_path):
    scene = (DRIVEN if "gas__ambient" in value else FREE).with_(**value)
    assert line in scene_files(scene, "mine")["mine.toml"].splitlines()
    assert without_source(again(scene, tmp_path)) == without_source(scene)
