"""The bridge from scenes to the oracles: same machine, same floats, same names and signs."""

from dataclasses import replace
from math import atan2, hypot, pi

import numpy as np
import pytest
from scene_texts import INDICATED

from crankmbs import (
    Constant,
    Crank,
    Cylinder,
    Extent,
    Gas,
    Gravity,
    Layout,
    Piston,
    Quadratic,
    Rod,
    Run,
    Scene,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    Viscous,
    load_scene,
    simulate,
)
from crankmbs.mechanics.pressure import pressures_of
from validation.adapter import machine_of, reference_motion, reference_variables
from validation.oracles import end_states
from validation.oracles.arithmetic import distance
from validation.oracles.free_motion import free_motion
from validation.oracles.known_machines import V_TWIN
from validation.oracles.machine import Loads, LoadTable
from validation.oracles.pressure import evaluate_pressure
from validation.random_scenes import random_scene

TORQUES = (
    Constant(torque=3.0),
    Viscous(coefficient=0.5),
    Quadratic(coefficient=0.25),
    TimeTable(file=Table((0.0, 1.0, 1.0, 9.0), (0.0, 2.0, 5.0, 5.0))),
    SpeedTable(file=Table((-10.0, 10.0), (1.0, -1.0))),
)


def v_twin() -> Scene:
    """The oracles' machine with every feature, as a scene (its period must be 720 degrees)."""
    return Scene(
        crank=Crank(radius=0.05, inertia=0.04, mass=6.0, center_of_mass=-0.012),
        rod=Rod(length=0.17, mass=1.1, center_of_mass=0.045, inertia=0.004),
        piston=Piston(mass=0.9, area=0.006, offset=0.002),
        layout=Layout(cylinders=(Cylinder(bank=-0.4), Cylinder(phase=2.0, bank=0.5))),
        gas=Gas(
            pressure=Table((0.3, 5.1, 8.0, 12.0, 0.3 + 4 * pi), (2e5, 5e5, 3e5, 7e4, 2e5)),
            ambient=1e5,
            zero="firing_tdc",
        ),
        gravity=Gravity(acceleration=hypot(-9.0, 2.0), angle=atan2(2.0, -9.0)),
        start=Start(angle=0.1, speed=60.0),
        torque=TORQUES,
        run=Run(until=Extent(value=0.05, unit="s"), rtol=1e-11),
    )


def test_every_field_reaches_the_machine() -> None:
    machine = machine_of(v_twin())
    changed = {"pressure", "gravity", "loads"}
    for name in vars(V_TWIN).keys() - changed:
        assert getattr(machine, name) == getattr(V_TWIN, name), name
    assert machine.gravity == pytest.approx((-9.0, 2.0), rel=1e-15)
    table = machine.pressure
    assert table.angles == tuple(angle + 2 * pi for angle in (0.3, 5.1, 8.0, 12.0))
    assert table.pressures == (1e5, 4e5, 2e5, -3e4)
    assert (table.period, table.interpolation) == (4 * pi, "pchip")
    assert machine.loads == Loads(
        constant=3.0,
        viscous=0.5,
        quadratic=0.25,
        time_tables=(LoadTable((0.0, 1.0, 1.0, 9.0), (0.0, 2.0, 5.0, 5.0)),),
        speed_tables=(LoadTable((-10.0, 10.0), (1.0, -1.0)),),
    )


@pytest.mark.slow
@pytest.mark.parametrize(("name", "tolerance"), [("coasting", 1e-14), ("propeller", 5e-12)])
def test_stored_end_states(name: str, tolerance: float) -> None:
    """The scene's floats instead of exact decimals, and the crank-angle run: radians, rad/s."""
    scene, stored = load_scene(name), end_states.stored()[name]
    result = simulate(scene)
    assert result.formulation == "crank_angle"
    at_end = free_motion(
        machine_of(scene), scene.start.angle, scene.start.speed, times=[scene.run.until.value]
    )
    ours = (result.data["crank_angle"].values[-1], result.data["crank_speed"].values[-1])
    of_scene = (at_end.theta[-1], at_end.omega[-1])
    for mine, theirs, digits in zip(ours, of_scene, stored, strict=True):
        assert distance(theirs, digits) < tolerance * float(theirs)
        assert distance(mine, theirs) < 1e-11 * float(theirs)


def test_only_an_end_at_an_angle_is_compared_at_an_equal_angle() -> None:
    """Of a run that is sampled in time; the run is so rough that the times tell."""
    scene = replace(load_scene("coasting"), run=Run(until="1 rev", every="0.01 s", rtol=1e-4))
    result = simulate(scene, formulation="minimal")
    motion, data = reference_motion(result), result.data
    late = np.asarray(motion.time - data["time"].values, dtype=float)
    ahead = np.asarray(motion.theta - data["crank_angle"].values, dtype=float)
    assert np.all(late[:-1] == 0.0)
    assert late[-1] != 0.0
    assert np.abs(ahead[1:-1]).min() > 1e3 * abs(ahead[-1])


@pytest.mark.slow
def test_samples_where_it_turns_are_compared_at_equal_times() -> None:
    """It swings, and where it turns back is the only angle that is sampled."""
    result = simulate(random_scene(4960), formulation="minimal")
    motion = reference_motion(result)
    assert np.abs(motion.omega[:-1] - result.data["crank_speed"].values[:-1]).max() < 1e-5


def test_names_and_signs() -> None:
    """A run with every feature: each variable of the result meets the oracle's."""
    scene = v_twin()
    result = simulate(scene)
    motion = reference_motion(result)
    assert distance(motion.theta[0], 0.1) < 1e-17
    oracle = reference_variables(scene, motion.theta, motion.omega, motion.alpha)
    assert oracle.keys() == set(result.data.data_vars) - {
        "crank_speed",
        "crank_acceleration",
        "energy_residual",
    }
    for name, values in oracle.items():
        ours = result.data[name].values
        np.testing.assert_allclose(ours, values.astype(float), atol=1e-9 * np.abs(ours).max())


def test_indicator_goes_over_piece_by_piece(read) -> None:
    scene = read(INDICATED)
    angle = np.linspace(-20.0, 20.0, 1001)
    ours = pressures_of(scene)[0](angle)
    theirs = evaluate_pressure(machine_of(scene).pressure, angle.astype(np.longdouble))
    np.testing.assert_allclose(ours, theirs.astype(float), rtol=1e-11)
