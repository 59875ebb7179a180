"""exudyn's system of a scene, its equations at states, and its runs at one step size."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode, begun
from crankmbs.motion.multibody.forces import Forces, Limits
from crankmbs.motion.multibody.integrate import Path, Stretch, integrate
from crankmbs.motion.multibody.mechanism import closed
from crankmbs.motion.multibody.model import Model
from crankmbs.motion.multibody.runs import Runs
from crankmbs.numerics.arrays import Array
from crankmbs.scene.gas import Gas
from crankmbs.scene.loads import Constant, Quadratic, SpeedTable, TimeTable, Viscous
from crankmbs.scene.parts import Cylinder, Layout
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from crankmbs.simulate import simulate

COASTING = replace(
    load_scene("coasting"),
    run=Run(until=Extent(value=0.05, unit="s"), every=Extent(value=0.05, unit="rad")),
)
ASKEW = replace(
    COASTING,
    crank=replace(COASTING.crank, center_of_mass=-0.01),
    piston=replace(COASTING.piston, offset=0.004),
    layout=Layout(cylinders=(Cylinder(phase=0.3, bank=-0.5), Cylinder(phase=2.0, bank=0.6))),
)
ENDLESS = Limits(math.inf, (-math.inf, math.inf), 0)
V_TWIN = load_scene("v_twin")
BENT = TimeTable(file=Table((0.0, 0.013, 0.031, 0.1), (0.0, 60.0, -90.0, 10.0)))
OVER_SPEED = {
    "bend": SpeedTable(file=Table((0.0, 101.0, 120.0, 200.0), (5.0, 5.0, -40.0, -40.0))),
    "jump": SpeedTable(file=Table((0.0, 101.0, 101.0, 200.0), (5.0, 5.0, 20.0, 20.0))),
}


def loaded(*torque: Torque) -> Scene:
    return replace(COASTING, torque=torque)


def start_of(scene: Scene) -> State:
    assert scene.start is not None
    return State(0.0, scene.start.angle, scene.start.speed, 0.0, begun(crank_train(scene)))


def paths(scene: Scene, step: float, halvings: int) -> list[Path]:
    model = Model(crank_train(scene))
    limits = Limits(0.05, (-math.inf, math.inf), 10**6)
    start = start_of(scene)
    found = [integrate(model, start, limits, step / 2**k) for k in range(halvings)]
    model.close()
    return found


def at(run: Path, time: Array) -> Array:
    """Crank angle and speed at times, by cubics between steps; shape (2, p)."""
    begins = np.array([stretch.begin.time for stretch in run.stretches])
    which = np.searchsorted(begins, time, side="right") - 1
    rows = [run.stretches[k].rows for k in which]
    places = [(t - row[0, 0]) / (row[-1, 0] - row[0, 0]) for t, row in zip(time, rows, strict=True)]
    return np.column_stack(
        [run.stretches[k].at(np.array(x))[1:] for k, x in zip(which, places, strict=True)]
    )


@pytest.mark.parametrize("scene", [COASTING, ASKEW, V_TWIN], ids=["one", "askew", "banks"])
def test_accelerations_and_joint_forces_are_those_of_the_reduced_equations(scene: Scene) -> None:
    train, model = crank_train(scene), Model(crank_train(scene))
    theta, omega = np.linspace(-7.0, 9.0, 50), np.linspace(-90.0, 120.0, 50)
    gas = model.forces.gas(theta, None)["gas_force"]
    found = model.states(theta, omega, gas, np.full(50, 7.0), free=True)
    model.close()
    inertia, slope, torque = reduce(train, theta)
    alpha = (torque + 7.0 - 0.5 * slope * omega**2) / inertia
    np.testing.assert_allclose(
        found.acceleration[:, 2], alpha, rtol=0.0, atol=1e-11 * abs(alpha).max()
    )
    exact = reactions(train, theta, omega, alpha)
    forces = found.hinges[:, 0, 0], found.walls
    for values, name in zip(forces, ("main_bearing_force_x", "side_force"), strict=True):
        size = np.abs(exact[name]).max()
        np.testing.assert_allclose(values, exact[name], rtol=0.0, atol=1e-11 * size)


def test_positions_are_exudyns_own_closed_loop() -> None:
    model = Model(crank_train(ASKEW))
    theta = np.linspace(0.0, 6.0, 30)
    rest = np.zeros((30, 2))
    found = model.states(theta, np.full(30, 3.0), rest, np.zeros(30), free=True)
    np.testing.assert_allclose(found.position, closed(ASKEW, theta), atol=1e-15)
    other = replace(ASKEW, rod=replace(ASKEW.rod, length=1.001 * ASKEW.rod.length))
    model.scene = other  # a wrong loop to begin with: exudyn's constraints mend it
    mended = model.states(theta, np.full(30, 3.0), rest, np.zeros(30), free=True)
    model.close()
    assert np.abs(closed(other, theta) - closed(ASKEW, theta)).max() > 1e-4
    np.testing.assert_allclose(mended.position, found.position, atol=1e-6)


@pytest.mark.parametrize(
    "scene",
    [loaded(), loaded(BENT), *map(loaded, OVER_SPEED.values())],
    ids=["smooth", "in time", *OVER_SPEED],
)
def test_order_two_is_clean_from_the_first_step_over_bends_and_jumps(scene: Scene) -> None:
    runs = paths(scene, 2e-4, 4)
    assert len({len(run.stretches) for run in runs}) == 1
    time = np.array([1e-3, 5e-3, 0.02, 0.05])
    motions = np.array([at(run, time) for run in runs])
    first, second, third = np.diff(motions, axis=0)
    for row in (0, 1):
        np.testing.assert_allclose(first[row] / second[row], 4.0, atol=0.25)
        np.testing.assert_allclose(second[row] / third[row], 4.0, atol=0.15)
    inside = np.array([at(run, np.array([5e-5]))[1] for run in runs])  # the first step
    first, second, third = np.diff(inside, axis=0)
    np.testing.assert_allclose([first / second, second / third], 4.0, atol=0.2)


def test_stretches_meet_at_the_speed_of_a_row() -> None:
    (run,) = paths(loaded(OVER_SPEED["jump"]), 2e-4, 1)
    assert len(run.stretches) > 1
    assert {stretch.begin.omega for stretch in run.stretches[1:]} == {101.0}


def test_a_run_is_the_same_on_every_machine_and_ends_by_its_steps() -> None:
    one, other = (simulate(COASTING, formulation="multibody", cost_cap=60.0) for _ in range(2))
    assert one.cost.steps == other.cost.steps
    np.testing.assert_array_equal(one.data.crank_speed.values, other.data.crank_speed.values)
    short = simulate(COASTING, formulation="multibody", cost_cap=0.01)
    assert short.status == -1
    assert short.cost.steps <= 400


def test_torque_is_the_sum_of_all_loads_that_act() -> None:
    window = Constant(torque=-3.0, after=0.5)
    scene = loaded(
        Constant(torque=2.0), Viscous(coefficient=0.5), Quadratic(coefficient=0.1), window
    )
    forces, mode = Forces(crank_train(scene)), start_of(scene).mode
    bounds = forces.bounds(State(0.0, 0.3, 4.0, 0.0, mode), 1.0, ENDLESS)
    assert bounds.times[1] == 0.5
    assert forces.load(bounds, mode)(0.0, 0.3, 4.0) == pytest.approx(2.0 - 2.0 - 1.6)


def test_forces_go_on_beyond_what_they_are_cut_at() -> None:
    angle = np.radians([0.0, 60.0, 60.0, 200.0, 200.0, 360.0])
    table = Table(tuple(angle.tolist()), (1e5, 2e5, -1e5, 3e5, 0.0, 1e5))
    gas = Gas(pressure=table, absolute=False, stroke=2, interpolation="linear")
    scene = replace(COASTING, gas=gas, piston=replace(COASTING.piston, area=1e-3))
    forces = Forces(crank_train(scene))
    bounds = forces.bounds(State(0.0, 1.0, 5.0, 0.0), 1.0, ENDLESS)
    assert bounds.angles == pytest.approx((math.radians(-160.0), math.radians(60.0)))
    (push,) = forces.pushes(bounds, Mode(), 1.0, 1.0)
    edge, slope = math.radians(60.0), 100.0 / math.radians(60.0)
    assert push(0.0, edge + 0.1, 0.0, 0.0) == pytest.approx(200.0 + 0.1 * slope, rel=1e-6)
    backwards = forces.bounds(State(0.0, edge, -5.0, 0.0), -1.0, ENDLESS)
    forwards = forces.bounds(State(0.0, edge, 5.0, 0.0), 1.0, ENDLESS)
    assert backwards.angles[1] == forwards.angles[0] == pytest.approx(edge)
    assert forces.pushes(forwards, Mode(), edge, 1.0)[0](0.0, edge, 0.0, 0.0) == pytest.approx(
        -100.0
    )
    assert forces.pushes(backwards, Mode(), edge, -1.0)[0](0.0, edge, 0.0, 0.0) == pytest.approx(
        200.0
    )


def run_of(change: Array) -> Path:
    """A run whose angle and speed are off by polynomials of the time."""
    time = np.linspace(0.0, 1.0, 41)
    theta, rate = np.polynomial.Polynomial([0.0, 3.0, *change]), None
    rate = theta.deriv()
    rows = np.column_stack([time, theta(time), rate(time), rate.deriv()(time)])
    begin, end = (State(*row[:3].tolist(), 0.0) for row in rows[[0, -1]])
    return Path((Stretch(begin, rows),), end, Ending.COMPLETE, 40, 40)


@pytest.mark.parametrize(
    ("shares", "clean"),
    [
        ((1.0, 0.25, 0.0625, 0.015625), True),
        ((1.0, 0.5, 0.25, 0.125), False),
        ((1.0, 0.25, 0.0625), False),
    ],
)
def test_four_runs_are_extrapolated_where_their_slopes_agree_to_order_two(
    shares: tuple[float, ...], clean: bool
) -> None:
    model = Model(crank_train(COASTING))
    limits = Limits(1.0, (-math.inf, math.inf), 1000)
    runs = Runs(model, start_of(COASTING), limits)
    model.close()
    runs.paths = [run_of(1e-3 * share * np.array([1.0, 0.5])) for share in shares]
    runs.shaken = runs.paths[0]
    time = np.linspace(0.0, 1.0, 7)
    answer, *checks = (motion.at_times(time)[1] for motion in runs.solved())
    true = np.abs(answer - 3.0 * time).max()
    stated = max(np.abs(check - answer).max() for check in checks)
    assert (true < 1e-15) if clean else (0.02 * stated < true < stated)
