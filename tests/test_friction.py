"""Friction of the pistons: its law, what it does to the joints, motions known in closed form."""

import dataclasses
import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.integrate import quad

from crankmbs import InputError, load_scene, simulate
from crankmbs.compare import budget
from crankmbs.measures import measure
from crankmbs.mechanics.friction import friction_forces, friction_torque
from crankmbs.mechanics.geometry import close_loop, dead_centres
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train, sign_changes
from crankmbs.scene.drives import Motion, Start
from crankmbs.scene.fuel import Fuel
from crankmbs.scene.gas import Gas
from crankmbs.scene.loads import Constant, TimeTable
from crankmbs.scene.parts import Crank, Friction, Layout, Piston, Rod
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table

R, L, E, J, AREA = 0.04, 0.13, 0.006, 0.05, 5e-3
ENGINE = load_scene("yi_diesel_free")
BOTH = pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])


def flywheel(friction: Friction, speed: float = 20.0, until: str = "2 s", **more: object) -> Scene:
    """A crank that alone has inertia: J is constant."""
    return Scene(
        crank=Crank(radius=R, inertia=J),
        rod=Rod(length=L),
        piston=Piston(mass=0.0, offset=E),
        friction=friction,
        start=Start(angle=0.3, speed=speed),
        run=Run(until=until, rtol=1e-10),
        **more,
    )


def position(theta: float) -> float:
    """Of the piston pin, by the theorem of Pythagoras."""
    return R * math.cos(theta) + math.sqrt(L**2 - (R * math.sin(theta) - E) ** 2)


def slope(theta: float) -> float:
    across = R * math.sin(theta) - E
    return -R * math.sin(theta) - across * R * math.cos(theta) / math.sqrt(L**2 - across**2)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_force_is_against_the_velocity_and_grows_with_the_gas(sense):
    friction = Friction(ring_force=30.0, ring_pressure=0.05, viscous=12.0)
    train = crank_train(dataclasses.replace(ENGINE, friction=friction))
    theta = np.linspace(0.1, 12.0, 400)
    omega = np.full_like(theta, 250.0 * sense)
    found = reactions(train, theta, omega, 0.0 * theta)
    velocity, gas = found["piston_velocity"], found["gas_force"]
    expected = -np.sign(velocity) * (30.0 + 0.05 * np.abs(gas)) - 12.0 * velocity
    np.testing.assert_allclose(found["friction_force"], expected, rtol=1e-12)
    power = (found["friction_force"] * velocity).sum(axis=1)
    torque = friction_torque(train, theta, omega, sense)
    np.testing.assert_allclose(torque * omega, power, rtol=1e-12)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_at_a_dead_centre_the_value_after_counts(sense):
    train = crank_train(flywheel(Friction(ring_force=30.0)))
    centres = np.array(dead_centres(R, L, E))
    for turns in (0.0, -7.0, 4000.0):
        theta = centres + 2.0 * math.pi * turns
        found = friction_forces(train, theta, np.full(2, 5.0 * sense))[:, 0]
        assert found.tolist() == [-30.0, 30.0]  # after the top it moves towards the crank
    assert friction_forces(train, centres, np.zeros(2)).tolist() == [[0.0], [0.0]]


def test_the_joints_feel_it_as_they_feel_gas():
    scene = dataclasses.replace(ENGINE, friction=Friction(ring_force=700.0, viscous=80.0))
    theta, omega, alpha = np.linspace(0.0, 12.0, 50), np.full(50, 300.0), np.full(50, -900.0)
    found = reactions(crank_train(scene), theta, omega, alpha)
    without = reactions(crank_train(ENGINE), theta, omega, alpha)
    piston, area = scene.piston, scene.piston.gas_area
    on_piston = found["piston_pin_force_x"] - found["gas_force"] - found["friction_force"]
    np.testing.assert_allclose(on_piston, -piston.mass * found["piston_acceleration"], atol=1e-8)
    needed = found["external_torque"] - without["external_torque"]
    np.testing.assert_allclose(needed, -friction_torque(crank_train(scene), theta, omega, 1.0))
    for name in ("frame_force_x", "frame_force_y"):
        np.testing.assert_allclose(found[name], without[name], atol=1e-8)
    change = found["frame_moment"] - without["frame_moment"]
    np.testing.assert_allclose(change, needed, atol=1e-9)  # what the drive gives the frame holds
    assert area


def test_the_drive_gives_what_friction_takes():
    for name in ("yi_diesel", "grega_lecture", "compressor"):
        friction = Friction(ring_force=40.0, ring_pressure=0.02, viscous=30.0)
        data = simulate(dataclasses.replace(load_scene(name), friction=friction)).data
        peak = float(data.kinetic_energy.max())
        assert float(abs(data.energy_residual).max()) < 1e-13 * peak
        power = float((data.friction_force * data.piston_velocity).max())
        assert power < 1e-9  # beside a dead centre the velocity is its rounding


@BOTH
@pytest.mark.parametrize("speed", [20.0, -20.0])
def test_rings_use_up_the_energy_over_the_way_of_the_piston(formulation, speed):
    """E = E_0 - ring_force times the way: at rest where that is E_0 / ring_force."""
    force, start = 45.0, 0.3
    result = simulate(flywheel(Friction(ring_force=force), speed), formulation=formulation)
    assert result.status == 1
    assert "friction, or a force against the sliding of a piston, holds the crank" in result.message
    theta = result.data.crank_angle.values
    marks = sorted(c + 2.0 * math.pi * n for c in dead_centres(R, L, E) for n in range(-20, 20))

    def way(to: float) -> float:
        low, high = min(start, to), max(start, to)
        points = [low, *(m for m in marks if low < m < high), high]
        return sum(abs(position(b) - position(a)) for a, b in pairwise(points))

    energy = np.array([0.5 * J * speed**2 - force * way(angle) for angle in theta])
    error = result.data.kinetic_energy.attrs["error_estimate"]
    assert np.max(np.abs(result.data.kinetic_energy.values - energy)) < 2.0 * error + 1e-12
    assert abs(energy[-1]) < 1e-8
    assert result.data.crank_speed.values[-1] == 0.0


@BOTH
def test_viscous_friction_takes_speed_over_the_angle(formulation):
    """J d omega / d theta = -c x_1^2."""
    c, start = 30.0, 0.3
    result = simulate(flywheel(Friction(viscous=c), until="2 rev"), formulation=formulation)
    assert result.status == 0
    for k in (100, 400, -1):
        theta = float(result.data.crank_angle[k])
        lost = quad(lambda a: slope(a) ** 2, start, theta, epsabs=1e-13, limit=400)[0]
        speed = float(result.data.crank_speed[k])
        error = result.data.crank_speed.attrs["error_estimate"]
        assert abs(speed - (20.0 - c / J * lost)) < 2.0 * error + 1e-11


@BOTH
def test_a_crank_at_rest_lets_go_when_a_load_exceeds_friction(formulation):
    """A load that grows in time turns it once it is more than ring_force |x_1|."""
    rows = Table([0.0, 1.0, 2.0], [-0.5, 3.0, 3.0])
    scene = flywheel(Friction(ring_force=45.0), 0.0, "1.2 s", torque=(TimeTable(file=rows),))
    scene = dataclasses.replace(
        scene, run=Run(until="1.2 s", every=Extent(value=1e-3, unit="s"), rtol=1e-9)
    )
    result = simulate(scene, formulation=formulation)
    assert result.status == 0
    let_go = (45.0 * abs(slope(0.3)) + 0.5) / 3.5
    time, speed = result.data.time.values, result.data.crank_speed.values
    assert np.all(speed[time < let_go - 1e-9] == 0.0)
    assert np.all(speed[time > let_go + 1e-3] > 0.0)
    held = result.data.sel(time=slice(0.0, let_go - 1e-3))
    balance = held.external_torque - held.friction_force.isel(cylinder=0) * slope(0.3)
    assert float(abs(balance).max()) < 1e-12
    late = time > let_go
    spent = time[late] - let_go  # J omega = integral of the excess, to first order in the angle
    np.testing.assert_allclose(speed[late][:30], 1.75 * spent[:30] ** 2 / J, rtol=2e-2)


@BOTH
def test_what_friction_holds_does_not_move(formulation):
    held = flywheel(Friction(ring_force=45.0), 0.0, torque=(Constant(torque=0.5),))
    result = simulate(held, formulation=formulation)
    assert (result.status, result.data.sizes["time"]) == (1, 1)
    assert "friction, or a force against the sliding of a piston, holds the crank" in result.message
    force = float(result.data.friction_force[0, 0])
    assert force * -slope(0.3) == pytest.approx(-0.5, rel=1e-12)
    assert float(result.data.crank_acceleration[0]) == 0.0


@pytest.mark.parametrize("shares", [(), (0.3,) * 4])
def test_gas_forces_change_their_sign_where_it_is_said(shares):
    friction = Friction(ring_pressure=0.05)
    train = crank_train(dataclasses.replace(ENGINE, friction=friction))
    angles = sign_changes(train, shares)
    assert len(angles) >= 4
    for angle in angles:
        beside = [
            train.pressure[k](angle + c.phase + np.array([-1e-6, 1e-6]))
            for k, c in enumerate(ENGINE.cylinders)
        ]
        assert min(p[0] * p[1] for p in beside) <= 0.0


def test_what_cannot_be_is_refused():
    with pytest.raises(
        InputError, match=r"friction\.ring_pressure: without gas there is no gas force"
    ):
        flywheel(Friction(ring_pressure=0.02))
    with pytest.raises(InputError, match="ring_force"):
        Friction(ring_force=-1.0)
    with pytest.raises(InputError, match="ring_pressure"):
        Friction(ring_pressure=2.0)
    with pytest.raises(InputError, match="here: use N s/m"):
        Friction(viscous="30 N")


def test_a_dead_centre_is_where_the_piston_turns():
    centres = np.array(dead_centres(R, L, E))
    assert np.max(np.abs(close_loop(centres, R, L, E).x_1)) < 1e-16


SCATTERED = dataclasses.replace(
    load_scene("v_twin"),
    fuel=Fuel(scatter=0.3),
    run=Run(until="3 cycles", rtol=1e-8),
)
SETTLED_ENGINE = dataclasses.replace(ENGINE, run=Run(until="settled"))
ALL = Friction(ring_force=20.0, ring_pressure=0.03, viscous=20.0)


@pytest.mark.parametrize("scene", [ENGINE, SCATTERED, load_scene("propeller")])
def test_formulations_agree_within_their_errors(scene):
    """Over the angle, and over time with another code for the signs; with shares that scatter the
    angles at which gas forces change their sign move from firing to firing."""
    run = dataclasses.replace(scene.run, until="3 rev")
    scene = dataclasses.replace(scene, friction=ALL, run=run)
    one, other = (simulate(scene, formulation=f) for f in ("crank_angle", "minimal"))
    assert one.status == other.status == 0
    for name in one.data:
        apart = float(abs(one.data[name] - other.data[name].values).max())
        stated = sum(r.data[name].attrs["error_estimate"] for r in (one, other))
        assert apart <= 2.0 * stated, name


@pytest.mark.parametrize("friction", [Friction(ring_pressure=0.03), ALL])
def test_the_settled_cycle_is_that_of_a_long_run(friction):
    scene = dataclasses.replace(SETTLED_ENGINE, friction=friction)
    settled = simulate(scene)
    assert settled.message.startswith("settled")
    assert settled.decay is not None
    cycles = math.ceil(math.log(1e-12) / math.log(settled.decay.factor))
    run = Run(until=f"{cycles} cycles", every=None)
    long = simulate(dataclasses.replace(scene, run=run))
    speed = settled.data.crank_speed.values[-1]
    assert long.data.crank_speed.values[-1] == pytest.approx(speed, rel=1e-9)


def test_the_budget_names_friction_and_adds_up():
    scene = dataclasses.replace(load_scene("yi_diesel"), friction=ALL)
    for split in budget(simulate(scene)).splits:
        total = sum(cause.curve for cause in split.causes)
        assert np.max(np.abs(total - split.total.curve)) <= 1e-14 * split.peak
        assert split.share(split.cause("solver")) == 0.0
    thrust = budget(simulate(scene)).split("side thrust")
    assert thrust.share(thrust.cause("friction")) > 3.0


@pytest.mark.parametrize("name", ["yi_diesel", "compressor", "yi_diesel_free"])
def test_what_gas_and_drive_give_friction_and_load_take(name):
    scene = dataclasses.replace(load_scene(name), friction=ALL)
    if scene.motion is None:
        scene = dataclasses.replace(scene, run=Run(until="settled"))
    found = measure(simulate(scene))
    assert found.friction_power is not None
    assert found.mechanical_efficiency is not None
    outside = found.external_torque.value * found.mean_speed.value
    given = found.indicated_power.value + outside - found.friction_power.value
    assert abs(given) < 1e-6 * abs(found.indicated_power.value)
    efficiency = found.mechanical_efficiency.value
    taken, paid = sorted((abs(found.indicated_power.value), abs(outside)))
    assert efficiency == pytest.approx(taken / paid, rel=1e-6)
    assert found.friction_power.error < 1e-4 * found.friction_power.value


UNLIKE = {0.0: (3e5, 60e5), 1.9: (2e5, 25e5), math.tau: (7e5, 1e5), 9.1: (4e5, 30e5)}


def unlike(friction: Friction, **more: object) -> Scene:
    """Two cylinders, each with a pressure of its own, of chords between four rows."""
    low, high = (tuple(row[k] for row in UNLIKE.values()) for k in (0, 1))
    run = Run(until="3 cycles", every="1 deg")
    return Scene(
        crank=Crank(radius=R, inertia=J),
        rod=Rod(length=L),
        piston=Piston(mass=0.8, area=AREA, offset=E),
        gas=Gas(
            pressure=[Table(tuple(UNLIKE), low), Table(tuple(UNLIKE), high)],
            absolute=False,
            stroke=4,
            interpolation="linear",
        ),
        layout=Layout(firing_order=(1, 2)),
        friction=friction,
        **({"motion": Motion(speed=250.0), "run": run} | more),
    )


def chords(phi: ArrayLike, number: int) -> np.ndarray:
    """Gas force of a cylinder at its cycle angle."""
    rows = [pair[number] for pair in UNLIKE.values()]
    return AREA * np.interp(phi, list(UNLIKE), rows, period=4.0 * math.pi)


PRESSED = Friction(ring_force=30.0, ring_pressure=0.02, viscous=12.0)


@pytest.mark.parametrize("formulation", ["kinetostatic", "multibody"])
def test_every_piston_is_pressed_by_the_gas_of_its_own_cylinder(formulation):
    scene = unlike(PRESSED, run=Run(until="1 cycle", every="7 deg"))
    data = simulate(scene, formulation=formulation).data
    for k in (0, 1):
        phi = data.crank_angle.values + 2.0 * math.pi * k  # it fires a turn later
        velocity = -250.0 * np.array([slope(angle) for angle in phi])
        limit = 30.0 + 0.02 * np.abs(chords(phi, k))
        expected = -np.sign(velocity) * limit - 12.0 * velocity
        np.testing.assert_allclose(data.friction_force.values[:, k], expected, rtol=1e-6)


def test_a_crank_at_rest_is_held_by_pistons_pressed_unlike():
    theta, share = 0.7, 0.3
    train = crank_train(unlike(PRESSED))
    found = friction_forces(train, np.array([theta]), np.zeros(1), slides=np.array([share]))
    towards = -np.sign([slope(theta + 2.0 * math.pi * k) for k in (0, 1)])
    gas = np.array([chords(theta + 2.0 * math.pi * k, k) for k in (0, 1)])
    np.testing.assert_allclose(found[0], -share * towards * (30.0 + 0.02 * gas), rtol=1e-12)


def test_the_power_of_friction_is_that_of_all_unlike_pistons():
    """Work over the way of each piston between its dead centres and the rows, over the time."""
    found = measure(simulate(unlike(PRESSED)))
    work = 0.0
    for k in (0, 1):
        centres = [c + 2.0 * math.pi * n for c in dead_centres(R, L, E) for n in range(3)]
        marks = sorted({0.0, 4.0 * math.pi, *UNLIKE, *centres})
        marks = [mark for mark in marks if mark <= 4.0 * math.pi]

        def power(phi: float, k: int = k) -> float:
            way = abs(slope(phi))
            return (30.0 + 0.02 * float(chords(phi, k))) * way + 12.0 * 250.0 * way**2

        work += sum(quad(power, *pair, epsabs=1e-12, epsrel=1e-12)[0] for pair in pairwise(marks))
    expected = work * 250.0 / (4.0 * math.pi)
    taken, stated = found.friction_power
    assert abs(taken - expected) <= 2.0 * stated + 1e-12 * expected
    assert stated < 1e-3 * expected


def test_measures_know_a_crank_that_waits():
    rows = Table([0.0, 2.0], [-0.5, 6.5])
    run = Run(until="0.9 s", every=Extent(value=1e-2, unit="s"))
    scene = flywheel(Friction(ring_force=45.0), 0.0, torque=(TimeTable(file=rows),))
    result = simulate(dataclasses.replace(scene, run=run))
    lost = measure(result).friction_power
    way = abs(float(result.data.piston_position[-1, 0] - result.data.piston_position[0, 0]))
    assert lost.value == pytest.approx(45.0 * way / 0.9, rel=1e-4)
