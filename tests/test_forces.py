"""Forces from outside on the pistons, against formulas by hand: a crank with an offset slider."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Crank,
    Cylinder,
    Gravity,
    InputError,
    Layout,
    Load,
    Motion,
    Piston,
    Rod,
    Run,
    Scene,
    Start,
    Table,
    TimeTable,
    load_scene,
    simulate,
)
from crankmbs.mechanics.forces import OnCrank
from crankmbs.result import Result
from crankmbs.scene.forces import (
    ConstantForce,
    Damper,
    ForceAngleTable,
    ForceTimeTable,
    Spring,
    TravelTable,
)
from crankmbs.scene.parts import Friction
from crankmbs.scene.python_force import Force
from crankmbs.scene.tables import CylinderTable
from crankmbs.scene.write import scene_files

R, L, E = 0.04, 0.14, 0.006
TOP, BOTTOM = math.sqrt((L + R) ** 2 - E**2), math.sqrt((L - R) ** 2 - E**2)
STROKE = TOP - BOTTOM
INERTIA = 0.05
ONE = Layout(firing_order=(1,))
TWO = Layout(cylinders=(Cylinder(), Cylinder(phase=1.7)))

TRAVEL = (0.0, 0.02, 0.05, 0.09)
FORWARD, BACK = (-80.0, 10.0, 40.0, -60.0), (30.0, -20.0, 70.0, 50.0)
TURN = np.radians([0.0, 90.0, 200.0, 300.0])
OVER_ANGLE = (20.0, -60.0, 50.0, 0.0)

BOTH_WAYS = TravelTable(file=CylinderTable(TRAVEL, (FORWARD, BACK)))
KINDS = {
    "spring": (
        Spring(stiffness=1500.0, relaxed_at=0.03),
        lambda t, phi, s, v: -1500.0 * (s - 0.03),
    ),
    "damper": (Damper(coefficient=25.0), lambda t, phi, s, v: -25.0 * v),
    "constant": (ConstantForce(force=70.0), lambda t, phi, s, v: 70.0 + 0.0 * t),
    "travel": (
        TravelTable(file=Table(TRAVEL, FORWARD)),
        lambda t, phi, s, v: np.interp(s, TRAVEL, FORWARD),
    ),
    "both ways": (
        BOTH_WAYS,
        lambda t, phi, s, v: np.where(
            v > 0.0, np.interp(s, TRAVEL, FORWARD), np.interp(s, TRAVEL, BACK)
        ),
    ),
    "angle": (
        ForceAngleTable(file=Table(tuple(TURN.tolist()), OVER_ANGLE)),
        lambda t, phi, s, v: np.interp(phi, TURN, OVER_ANGLE, period=2.0 * math.pi),
    ),
    "time": (
        ForceTimeTable(file=Table((0.0, 0.1, 0.4), (0.0, 90.0, -50.0))),
        lambda t, phi, s, v: np.interp(t, (0.0, 0.1, 0.4), (0.0, 90.0, -50.0)),
    ),
    "function": (
        Force(function=lambda t, phi, s, v: 800.0 * s - 10.0 * v + 30.0 * math.sin(phi + 5.0 * t)),
        lambda t, phi, s, v: 800.0 * s - 10.0 * v + 30.0 * np.sin(phi + 5.0 * t),
    ),
}


def machine(*force, speed=30.0, until="0.3 s", every="0.01 s", layout=ONE, torque=()):
    return Scene(
        crank=Crank(radius=R, inertia=INERTIA),
        rod=Rod(length=L, mass=0.8, center_of_mass=0.05, inertia=0.003),
        piston=Piston(mass=1.2, offset=E),
        layout=layout,
        start=Start(angle=0.3, speed=speed),
        torque=torque,
        force=force,
        run=Run(until=until, every=every, rtol=1e-9),
    )


def driven(*force, speed=40.0, until="0.3 s", every="0.01 s", layout=ONE):
    """The same at a prescribed speed."""
    scene = machine(*force, until=until, every=every, layout=layout)
    return replace(scene, start=None, motion=Motion(speed=speed, angle=0.3))


def arm(phi):
    """dx/dphi of the piston's pin at x = r cos phi + sqrt(l^2 - (r sin phi - e)^2)."""
    u = R * np.sin(phi) - E
    return -R * np.sin(phi) - u * R * np.cos(phi) / np.sqrt(L**2 - u**2)


def displacement(phi):
    return TOP - R * np.cos(phi) - np.sqrt(L**2 - (R * np.sin(phi) - E) ** 2)


def by_hand(data, law, phase=0.0):
    t, phi, omega = (data[name].values for name in ("time", "crank_angle", "crank_speed"))
    phi = phi + phase
    return law(t, phi, displacement(phi), -arm(phi) * omega)


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_its_formula_and_closes_the_energy(kind, formulation):
    force, law = KINDS[kind]
    data = simulate(machine(force, every="0.001 s"), formulation=formulation).data
    power = by_hand(data, lambda t, phi, s, v: law(t, phi, s, v) * v)
    np.testing.assert_allclose(data["applied_force"].values[:, 0], by_hand(data, law), atol=2e-5)
    np.testing.assert_allclose(data["external_torque"].values, 0.0, atol=1e-9)
    energy = data["kinetic_energy"].values
    assert np.ptp(energy) > 0.01 * energy[0]
    work = np.append(0.0, np.cumsum(0.5e-3 * (power[1:] + power[:-1])))
    np.testing.assert_allclose(energy - energy[0], work, atol=0.01 * np.ptp(energy))
    assert np.max(np.abs(data["energy_residual"].values)) < 1e-7 * energy[0]


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_a_spring_stores_what_the_crank_gives(formulation):
    data = simulate(machine(KINDS["spring"][0]), formulation=formulation).data
    s = data["piston_displacement"].values[:, 0]
    total = data["kinetic_energy"].values + 750.0 * (s - 0.03) ** 2
    np.testing.assert_allclose(total, total[0], rtol=1e-8)


def test_the_virtual_work_of_a_spring():
    scene = machine(KINDS["spring"][0], layout=TWO)
    theta = np.linspace(0.0, 6.0, 23)
    stored = [
        sum(750.0 * (displacement(theta + h + phase) - 0.03) ** 2 for phase in (0.0, 1.7))
        for h in (-1e-5, 1e-5)
    ]
    torque = OnCrank(scene, scene.force[0])(0.0, theta, 20.0)
    np.testing.assert_allclose(torque, -np.subtract(*stored[::-1]) / 2e-5, atol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_the_pin_bears_it_and_the_frame_does_not_feel_it(kind):
    force, law = KINDS[kind]
    data, without = (simulate(scene).data for scene in (driven(force), driven()))
    applied = data["applied_force"].values
    np.testing.assert_allclose(applied[:, 0], by_hand(data, law), atol=1e-9)
    more = {name: data[name].values - without[name].values for name in without.data_vars}
    np.testing.assert_allclose(more["piston_pin_force_x"], applied, atol=1e-9)
    np.testing.assert_allclose(more["frame_force_x"], 0.0, atol=1e-9)
    np.testing.assert_allclose(more["frame_force_y"], 0.0, atol=1e-9)
    at = arm(data["crank_angle"].values)
    np.testing.assert_allclose(more["external_torque"], at * applied[:, 0], atol=1e-9)


def test_on_one_piston_by_its_own_cycle_angle():
    force, law = KINDS["angle"]
    data = simulate(machine(replace(force, cylinder=2), layout=TWO)).data
    applied = data["applied_force"].values
    np.testing.assert_array_equal(applied[:, 0], 0.0)
    np.testing.assert_allclose(applied[:, 1], by_hand(data, law, 1.7), atol=2e-5)


def test_it_switches_at_the_true_dead_centres():
    centres = [math.asin(E / (L + R)), math.pi + math.asin(E / (L - R))]
    scene = driven(TravelTable(file=CylinderTable((0.0, 0.09), ((-9.0, -9.0), (4.0, 4.0)))))
    data = simulate(replace(scene, run=Run(until="2 rev", every="0.01 deg"))).data
    angle = np.mod(data["crank_angle"].values, 2.0 * math.pi)
    clear = np.min(np.abs(np.subtract.outer(angle, centres)), axis=1) > 1e-9
    forward = (angle > centres[0]) & (angle < centres[1])
    expected = np.where(forward, -9.0, 4.0)[clear]
    np.testing.assert_array_equal(data["applied_force"].values[clear, 0], expected)


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_it_switches_where_the_crank_turns_back(formulation):
    spring = Spring(stiffness=4e4, relaxed_at=0.03)
    result = simulate(machine(spring, BOTH_WAYS, speed=8.0), formulation=formulation)
    data = result.data
    assert "reversal" in result.events["kind"].values
    law = KINDS["both ways"][1]
    expected = by_hand(data, lambda *at: -4e4 * (at[2] - 0.03) + law(*at))
    np.testing.assert_allclose(data["applied_force"].values[:, 0], expected, atol=1e-3)
    assert np.max(np.abs(data["energy_residual"].values)) < 1e-6


def test_held_at_rest_until_a_load_exceeds_it():
    against = TravelTable(file=CylinderTable((0.0, 0.09), ((-100.0, -100.0), (100.0, 100.0))))
    load = TimeTable(file=Table((0.0, 0.6), (0.0, 12.0)))
    scene = machine(against, speed=0.0, until="0.6 s", torque=(load,))
    data = simulate(scene).data
    at = arm(0.3)
    free = 100.0 * abs(at) / 20.0
    t = data["time"].values
    held = t < free - 1e-9
    assert 5 < held.sum() < len(t) - 5
    np.testing.assert_array_equal(data["crank_angle"].values[held], 0.3)
    assert np.all(np.diff(data["crank_angle"].values[~held]) > 0.0)
    np.testing.assert_allclose(
        data["applied_force"].values[held, 0], 20.0 * t[held] / at, atol=1e-9
    )
    np.testing.assert_allclose(data["applied_force"].values[t > free + 1e-3, 0][:3], -100.0)


@pytest.mark.parametrize(
    "formulation", [pytest.param("crank_angle", marks=pytest.mark.slow), "minimal"]
)
def test_a_function_with_its_kinks_costs_what_the_table_does(formulation):
    """It turns back, swings and is held at rest by friction and by its jump with the velocity. A
    step over time that passes a kink must not feel it, and a crank at rest not move to and fro."""
    travel, ways = (0.0, 0.03, 0.03, 0.09), ((2.0, 2.0, -1.0, -1.0), (2.0, 2.0, 4.0, 4.0))

    def push(t, cycle_angle, displacement, velocity):
        return 2.0 if displacement < 0.03 else -1.0 if velocity > 0.0 else 4.0

    scene = replace(
        machine(TravelTable(file=CylinderTable(travel, ways)), speed=4.0, until="20 s"),
        friction=Friction(ring_force=1.5),
        gravity=Gravity(acceleration=9.81, angle=-math.pi / 2),
    )
    pushed = scene.with_(force=(Force(push, kink_displacements=(0.03,)),))
    of_table, result = (simulate(each, formulation=formulation) for each in (scene, pushed))
    assert result.message.startswith(of_table.message)
    assert result.message.startswith("at rest at")
    assert list(result.events["kind"].values) == list(of_table.events["kind"].values)
    for name in ("time", "crank_angle"):
        ends = [float(each.data[name].values[-1]) for each in (result, of_table)]
        errors = [each.data[name].error_estimate for each in (result, of_table)]
        assert ends[0] == pytest.approx(ends[1], abs=sum(errors))
    assert result.cost.evaluations < 6 * of_table.cost.evaluations


def test_a_function_that_jumps_with_the_sense_holds_until_it_is_overcome():
    """10 t against dry friction of 4: at rest until 0.4 s, then 5 s^2 / J = 0.05."""

    def driven(t, theta, omega):
        return 10.0 * t - 4.0 * ((omega > 0.0) - (omega < 0.0))

    scene = Scene(
        crank=Crank(radius=R, inertia=INERTIA),
        rod=Rod(length=L, mass=0.0),
        piston=Piston(mass=0.0),
        start=Start(angle=0.3, speed=0.0),
        torque=(Load(driven, kink_speeds=(0.0,)),),
        run=Run(until="0.6 s", every="10 ms"),
    )
    data = simulate(scene).data
    t = data["time"].values
    speed = np.where(t > 0.4, 5.0 * (t - 0.4) ** 2 / INERTIA, 0.0)
    np.testing.assert_allclose(data["crank_speed"].values, speed, atol=1e-6)


def test_windows_in_time_at_a_prescribed_speed():
    window = {"after": 0.055, "until": 0.205}
    data = simulate(driven(replace(KINDS["spring"][0], **window))).data
    t, applied = data["time"].values, data["applied_force"].values[:, 0]
    acts = (t > 0.055) & (t < 0.205)
    expected = np.where(acts, by_hand(data, KINDS["spring"][1]), 0.0)
    np.testing.assert_allclose(applied, expected, atol=1e-9)
    assert np.max(np.abs(data["energy_residual"].values)) < 1e-7


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_windows_of_a_free_crank(formulation):
    force = replace(KINDS["constant"][0], after=0.055, until=0.205)
    result = simulate(machine(force), formulation=formulation)
    t = result.data["time"].values
    expected = np.where((t > 0.055) & (t < 0.205), 70.0, 0.0)
    np.testing.assert_allclose(result.data["applied_force"].values[:, 0], expected)
    assert list(result.events["kind"].values) == ["load on", "load off"]
    np.testing.assert_allclose(result.events["time"].values, [0.055, 0.205], atol=1e-12)


def test_the_work_in_a_cycle():
    """Both ways against the piston, over two strokes each, and a damper's."""
    against = TravelTable(file=CylinderTable((0.0, 0.09), ((-100.0, -100.0), (100.0, 100.0))))
    scene = driven(against, Damper(coefficient=25.0), ConstantForce(force=70.0))
    cycles = simulate(replace(scene, run=Run(until="2 cycles", every="1 deg"))).cycles
    phi = np.linspace(0.0, 4.0 * math.pi, 4001)[:-1]
    damped = -25.0 * np.mean(arm(phi) ** 2) * 40.0 * 4.0 * math.pi
    works = cycles["force_work"].values[-1]
    np.testing.assert_allclose(works, [-400.0 * STROKE, damped, 0.0], rtol=1e-9, atol=1e-9)


def test_settled_is_where_a_long_run_ends():
    drive = Constant(torque=10.0)
    scene = machine(KINDS["spring"][0], Damper(coefficient=300.0), torque=(drive,))
    settled = simulate(replace(scene, run=Run(until="settled", every="1 deg")))
    run = Run(until="15 cycles", every="none", rtol=1e-9)
    long = simulate(replace(scene, run=run))
    mean = long.cycles["mean_speed"].values[-1]
    np.testing.assert_allclose(settled.cycles["mean_speed"].values[-1], mean, rtol=1e-6)


@pytest.mark.parametrize(
    ("scene", "says"),
    [
        (lambda: machine(Damper(coefficient=1.0, cylinder=3), layout=TWO), "from 1 to 2; 3 came"),
        (lambda: machine(Damper(coefficient=1.0, cylinder=0)), "cylinder"),
        (
            lambda: machine(TravelTable(file=Table((0.0, 0.07), (1.0, 2.0)))),
            r"rows must cover the stroke, 0 to 80\.\d+ mm; they go from 0 to 70 mm",
        ),
        (
            lambda: machine(TravelTable(file=Table((0.01, 0.09), (1.0, 2.0)))),
            "they go from 10 to 90 mm",
        ),
        (
            lambda: TravelTable(file=CylinderTable((0.0, 0.1), ((1.0, 2.0),) * 3)),
            "one force, or two, forward and back; 3 came",
        ),
        (lambda: driven(Damper(coefficient=1.0, from_speed=3.0)), "a window is one of time"),
        (lambda: driven(Damper(coefficient=1.0, until_speed=3.0)), "a window is one of time"),
        (
            lambda: machine(KINDS["time"][0], until="settled"),
            r"force\[1\], a time_table depends on time",
        ),
        (
            lambda: machine(Damper(coefficient=1.0, after=1.0), until="settled"),
            r"force\[1\], a damper with a window acts once",
        ),
        (
            lambda: machine(KINDS["function"][0], until="settled"),
            "depends on time; where it does not, say so by its period",
        ),
        (lambda: machine(KINDS["time"][0], until="0.5 s"), "the run"),
        (lambda: Spring(stiffness=-1.0), "stiffness"),
        (lambda: Damper(coefficient=-1.0), "coefficient"),
        (lambda: Damper(coefficient=1.0, after=2.0, until=1.0), "until must be later than after"),
    ],
)
def test_what_is_refused(scene, says):
    with pytest.raises(InputError, match=says):
        scene()


def test_written_and_read_again(tmp_path):
    forces = [force for kind, (force, _) in KINDS.items() if kind != "function"]
    windows = {"after": 0.05, "until": 0.2, "from_speed": 29.0, "until_speed": 20.0}
    scene = machine(*forces, replace(forces[0], cylinder=2, **windows), layout=TWO)
    for name, text in scene_files(scene, "mine").items():
        (tmp_path / name).write_text(text)
    again = load_scene(tmp_path / "mine.toml")
    assert len(again.force) == len(scene.force)
    ours, theirs = (simulate(one).data for one in (scene, again))
    np.testing.assert_allclose(ours["applied_force"], theirs["applied_force"], rtol=1e-9, atol=1e-9)
    assert [force.kind for force in again.force] == [force.kind for force in scene.force]
    assert again.force[-1] == scene.force[-1]


def test_saved_and_loaded(tmp_path):
    result = simulate(machine(*(force for force, _ in KINDS.values())))
    loaded = Result.load(result.save(tmp_path / "kept"))
    assert loaded.data.identical(result.data)
    assert loaded.scene.force[:-1] == result.scene.force[:-1]
    with pytest.raises(InputError, match="function"):
        simulate(loaded.scene)


def test_rigid_bodies_feel_the_same():
    """Every kind at a prescribed speed."""
    forces = [replace(force, cylinder=2) for force, _ in KINDS.values()]
    scene = driven(*forces, until="0.1 s", layout=TWO)
    bodies, exact = (simulate(scene, formulation=by).data for by in ("multibody", "kinetostatic"))
    for name in ("applied_force", "piston_pin_force_x", "external_torque"):
        peak = np.max(np.abs(exact[name].values))
        np.testing.assert_allclose(bodies[name].values, exact[name].values, atol=1e-3 * peak)


def test_free_rigid_bodies_feel_the_same():
    forces = [replace(KINDS[kind][0], cylinder=2) for kind in ("damper", "angle", "both ways")]
    scene = machine(*forces, until="0.1 s", layout=TWO)
    bodies, exact = (simulate(scene, formulation=name).data for name in ("multibody", "minimal"))
    np.testing.assert_allclose(bodies["crank_angle"].values, exact["crank_angle"].values, atol=1e-4)


def test_a_figure_shows_the_force_over_the_angle():
    result = simulate(driven(KINDS["both ways"][0], until="2 rev", every="1 deg"))
    above, below = result.plot("forces").axes
    assert "applied force" in above.get_ylabel()
    assert "wall" in below.get_ylabel()
    curve = max(above.lines, key=lambda line: len(line.get_ydata())).get_ydata()
    size = 1e3 if "[kN]" in above.get_ylabel() else 1.0
    applied = np.abs(result.data["applied_force"].values)
    assert size * np.nanmax(np.abs(curve)) == pytest.approx(np.max(applied), rel=1e-9)
