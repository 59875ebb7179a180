"""Cylinders with a throw, a rod and a piston of their own."""

import math
from dataclasses import replace

import numpy as np
import pytest

import crankmbs
from crankmbs import (
    Cylinder,
    InputError,
    Layout,
    OwnPiston,
    OwnRod,
    Result,
    SceneError,
    load_scene,
    simulate,
)
from crankmbs.batch.serves import loads_of
from crankmbs.compare.causes import budget
from crankmbs.indicated.shape import of_scene
from crankmbs.measures import measure, orders
from crankmbs.measures.plausible import warnings
from crankmbs.mechanics.carried import carried_over
from crankmbs.mechanics.harmonics import closed_orders
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.report.machine import machine_rows
from crankmbs.scene.bearings import Bearings
from crankmbs.scene.drives import Motion
from crankmbs.scene.read import parse_scene
from crankmbs.scene.write import scene_files
from crankmbs.sweep.scenes import scene_of
from validation.random_unlike import random_unlike

COMPRESSOR = load_scene("two_stage_compressor")
TEXT = """
[crank]
radius = "40 mm"
inertia = "0.4 kg m^2"
mass = "6 kg"
center_of_mass = "-3 mm"
[rod]
length = "160 mm"
mass = "1.2 kg"
center_of_mass = "45 mm"
inertia = "two-mass"
[piston]
mass = "2 kg"
bore = "100 mm"
[[cylinder]]
phase = "10 deg"
[[cylinder]]
phase = "200 deg"
bank = "30 deg"
radius = "35 mm"
rod = { length = "140 mm", mass = "0.9 kg", center_of_mass = "40 mm", inertia = "3e-3 kg m^2" }
piston = { mass = "1 kg", bore = "60 mm", offset = "2 mm" }
pressure = "4 bar"
[gas]
stroke = 2
ambient = "1 bar"
pressure = "2.5 bar"
[gravity]
acceleration = "9.81 m/s^2"
[start]
angle = "20 deg"
speed = "900 rpm"
[[torque]]
kind = "constant"
torque = "3 N m"
[[force]]
kind = "spring"
stiffness = "2 N/mm"
[run]
until = "1.5 rev"
every = "5 deg"
"""


def parsed(tmp_path, text=TEXT):
    return parse_scene(text, tmp_path / "mine.toml")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return parsed(tmp_path_factory.mktemp("scene"))


def alone(scene, number):
    """A scene with one of its cylinders, whose parts are those of the scene."""
    gear, cylinder = scene.running_gear[number - 1], scene.cylinders[number - 1]
    gas = scene.gas and replace(scene.gas, pressure=scene.gas.tables[number - 1])
    place = Cylinder(phase=cylinder.phase, bank=cylinder.bank)
    return replace(
        scene,
        crank=replace(scene.crank, radius=gear.radius),
        rod=gear.rod,
        piston=gear.piston,
        gas=gas,
        layout=Layout(cylinders=(place,)),
    )


def driven(scene, speed=90.0):
    """At a constant speed, without loads."""
    return replace(scene, start=None, torque=(), motion=Motion(speed=speed))


def test_what_a_cylinder_leaves_out_is_the_scenes_key_by_key(scene):
    (r, rod, piston), (own_r, own_rod, own_piston) = scene.running_gear
    assert (r, rod, piston) == (0.04, scene.rod, scene.piston)
    assert (own_r, own_rod.length, own_piston.offset) == (0.035, 0.14, 0.002)
    assert own_piston.gas_area == pytest.approx(math.pi / 4.0 * 0.06**2)
    half = scene.with_(layout__cylinders__2__rod=OwnRod(mass=0.5)).running_gear[1].rod
    assert half == replace(scene.rod, mass=0.5)  # its inertia the two masses' of its own
    by_area = scene.with_(layout__cylinders__2__piston=OwnPiston(area=1e-3)).running_gear[1]
    assert by_area.piston.bore is None
    assert scene.unlike
    assert not load_scene("v_twin").unlike


def test_parts_that_are_written_out_change_nothing():
    twin = load_scene("v_twin")
    own = OwnRod(length=twin.rod.length, mass=twin.rod.mass)
    written = tuple(replace(c, radius=twin.crank.radius, rod=own) for c in twin.cylinders)
    same = replace(twin, layout=replace(twin.layout, cylinders=written))
    assert not same.unlike
    for name, column in simulate(twin).data.data_vars.items():
        assert np.array_equal(simulate(same).data[name], column), name


@pytest.mark.parametrize("number", [1, 2])
def test_each_cylinder_does_what_it_does_alone(scene, number):
    both, one = simulate(driven(scene)), simulate(driven(alone(scene, number)))
    for name, column in one.data.data_vars.items():
        if "cylinder" not in column.dims or name in ("journal_torque", "pin_torque"):
            continue
        theirs = both.data[name].values[:, number - 1]
        peak = float(np.max(np.abs(column))) or 1.0
        assert np.max(np.abs(theirs - column.values[:, 0])) < 1e-12 * peak, name


def test_what_they_do_to_the_crank_adds_up(scene):
    runs = [simulate(driven(each)).data for each in (scene, alone(scene, 1), alone(scene, 2))]
    empty = replace(alone(scene, 1), rod=replace(scene.rod, mass=0.0), force=(), gas=None).with_(
        piston__mass=0.0
    )
    bare = simulate(driven(empty)).data
    for name in ("external_torque", "main_bearing_force_x", "frame_force_y", "kinetic_energy"):
        both, one, other, crank = (data[name].values for data in (*runs, bare))
        peak = float(np.max(np.abs(both)))
        assert np.max(np.abs(both - one - other + crank)) < 1e-9 * peak, name


def test_exudyns_rigid_bodies_agree_within_what_is_stated(scene):
    ours, theirs = simulate(scene), simulate(scene, formulation="multibody")
    assert theirs.status == 0
    for name, column in theirs.data.data_vars.items():
        apart = float(np.max(np.abs(column - ours.data[name])))
        stated = float(column.attrs["error_estimate"]) + ours.data[name].attrs["error_estimate"]
        assert apart <= 2.0 * stated, name


@pytest.mark.slow
@pytest.mark.parametrize("seed", [6, 9])
def test_random_ones_agree_over_the_angle_and_over_time(seed):
    runs = [simulate(random_unlike(seed), formulation=f).data for f in ("crank_angle", "minimal")]
    for name in runs[0].data_vars:
        ours, theirs = (data[name] for data in runs)
        stated = sum(float(one.attrs["error_estimate"]) for one in (ours, theirs))
        assert float(np.max(np.abs(ours.values - theirs.values))) <= 2.0 * stated, name


def test_a_two_stage_compressor_takes_the_work_of_its_polytropes():
    result = simulate(COMPRESSOR)
    assert result.status == 0
    n, work = 1.3, 0.0
    for bore, clearance, suction, delivery in (
        (0.13, 0.04, 0.97e5, 2.85e5),
        (0.08, 0.05, 2.75e5, 8.2e5),
    ):
        ratio = (delivery / suction) ** (1.0 / n)
        filled = 1.0 + clearance - clearance * ratio  # of the swept volume
        swept = math.pi / 4.0 * bore**2 * 0.09
        grown = (delivery / suction) ** ((n - 1.0) / n) - 1.0
        work += n / (n - 1.0) * suction * filled * swept * grown
    measured = measure(result)
    power = work * measured.mean_speed.value / (2.0 * math.pi)
    assert measured.indicated_power.value == pytest.approx(-power, rel=2e-4)
    cycle = result.cycles["imep"].values[-1]
    assert cycle == pytest.approx([one.value for one in measured.imep], rel=1e-9)
    assert measured.imep[1].value / measured.imep[0].value == pytest.approx(2.84, abs=0.01)


def test_orders_at_constant_speed_are_those_of_the_closed_form(scene):
    turning = driven(replace(scene, gas=None, force=(), gravity=None))
    closed = closed_orders(turning)
    spectrum = orders(simulate(turning.with_(run__until="2 cycles")), "frame_force_x")
    of_first = {order: k for k, order in enumerate(spectrum.order.tolist())}
    for k in range(4):
        amplitude = spectrum.amplitude[of_first[k + 1.0]]
        assert amplitude == pytest.approx(abs(closed.frame_force_x[k]) * 90.0**2, rel=1e-9)


@pytest.mark.parametrize("cylinder", [1, 2])
def test_the_lectures_take_each_cylinders_own_numbers(scene, cylinder):
    both = budget(simulate(driven(scene)), cylinder=cylinder)
    one = budget(simulate(driven(alone(scene, cylinder))))
    for name in ("piston displacement", "side thrust", "crank pin force y", "torque"):
        theirs, own = both.split(name), one.split(name)
        assert np.max(np.abs(theirs.values - own.values)) < 1e-12 * own.peak
        for ours, alike in zip(theirs.causes, own.causes, strict=True):
            assert np.max(np.abs(ours.curve - alike.curve)) < 1e-12 * own.peak, (name, ours.name)
    bearing = both.split("main bearing force x")
    total = sum(cause.curve for cause in bearing.causes)
    assert np.max(np.abs(total - bearing.total.curve)) < 1e-14 * bearing.peak


def test_a_throw_that_two_rods_share_has_one_radius():
    shared = replace(
        COMPRESSOR,
        bearings=Bearings(),
        layout=Layout(cylinders=tuple(replace(c, throw=1) for c in COMPRESSOR.cylinders)),
    )
    data = simulate(shared).data
    for axis in "xy":
        journals = data[f"main_journal_force_{axis}"].values.sum(axis=1)
        bearing = data[f"main_bearing_force_{axis}"].values
        assert np.max(np.abs(journals - bearing)) < 1e-12 * np.max(np.abs(bearing))
    with pytest.raises(InputError, match="its radius is the same; cylinders 1 and 2 of throw 1"):
        shared.with_(layout__cylinders__2__radius=0.04)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('radius = "35 mm"', 'radius = "150 mm"', r"cylinder\[2\]: rod.length must be at least"),
        ('bore = "60 mm"', 'bore = "60 mm", area = "1 cm^2"', "give bore or area, not both"),
        ('bore = "60 mm"', 'bores = "60 mm"', r"cylinder\[2\].piston.bores"),
        ('radius = "35 mm"', 'radius = "35 kg"', r"cylinder\[2\].radius"),
        ('pressure = "2.5 bar"', "", r"cylinder\[1\].pressure: this key is missing"),
        ('[gas]\nstroke = 2\nambient = "1 bar"\npressure = "2.5 bar"\n', "", r"needs \[gas\]"),
        ("[gravity]", "[layout]\nfiring_order = [1, 2]\n[gravity]", "layout.firing_order: beside"),
        ("[[cylinder]]", "[cylinder]", "not valid TOML"),
    ],
)
def test_what_cannot_be_is_refused_by_its_place(tmp_path, old, new, said):
    assert old in TEXT
    with pytest.raises(SceneError, match=said):
        parsed(tmp_path, TEXT.replace(old, new))


def test_none_is_a_cylinder_without_gas(tmp_path):
    scene = parsed(tmp_path, TEXT.replace('pressure = "4 bar"', 'pressure = "none"'))
    forces = simulate(scene).data["gas_force"].values
    assert np.all(forces[:, 1] == 0.0)
    assert np.all(forces[:, 0] > 1000.0)


def test_it_is_written_read_saved_and_said(scene, tmp_path):
    for name, text in scene_files(scene, "mine").items():
        (tmp_path / name).write_text(text)
    assert load_scene(tmp_path / "mine.toml").running_gear == scene.running_gear
    result = simulate(scene)
    result.save(tmp_path / "mine.nc")
    assert Result.load(tmp_path / "mine.nc").scene == scene
    rows = dict(machine_rows(scene))
    assert rows["cylinder[2]"].startswith("radius 35 mm; rod: length 140 mm, ratio 0.25")
    heavy = scene.with_(layout__cylinders__2__piston__mass=1000.0)
    assert warnings(heavy)[0].startswith("cylinder[2]: piston.mass: 1000 kg is more than")


def test_a_sweep_varies_one_of_them():
    swept = crankmbs.sweep(COMPRESSOR, {"layout.cylinders.2.piston.mass": [0.9, 1.4]})
    assert loads_of(COMPRESSOR) is None
    for k, mass in enumerate([0.9, 1.4]):
        one = measure(simulate(COMPRESSOR.with_(layout__cylinders__2__piston__mass=mass)))
        fluctuation = float(swept["fluctuation"].values[k])
        assert fluctuation == pytest.approx(one.fluctuation.value, rel=1e-12)


def test_tables_move_with_each_cylinders_own_stroke():
    longer = COMPRESSOR.with_(layout__cylinders__2__rod=OwnRod(length=0.3))
    moved = carried_over(longer, COMPRESSOR)
    first, second = pressures_of(moved)
    old = pressures_of(COMPRESSOR)
    np.testing.assert_allclose(first.knots, old[0].knots, atol=1e-12)
    assert np.max(np.abs(second.knots - old[1].knots)) > 0.01


def test_what_takes_like_cylinders_alone_says_so(scene):
    with pytest.raises(InputError, match="rod_ratio: the cylinders are unlike"):
        scene_of(scene, ["rod_ratio"], [0.25])
    with pytest.raises(InputError, match="a scene of the cylinder that was measured"):
        of_scene(scene)


def test_a_throw_that_contradicts_itself_is_refused_without_bearings():
    twin = load_scene("two_stage_compressor")
    low, high = twin.layout.cylinders
    shared = Layout(cylinders=(replace(low, throw=1), replace(high, throw=1, radius=0.03)))
    with pytest.raises(InputError, match="cylinders of one throw share a pin, so its radius"):
        replace(twin, layout=shared)
