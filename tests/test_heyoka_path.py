"""The compiled oracle against the other, on known machines and on stored random scenes."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from make_random_references import stored

from validation import judge_scene
from validation.adapter import machine_of
from validation.oracles import end_states
from validation.oracles.arithmetic import distance, multiprecision
from validation.oracles.free_motion import series_path
from validation.oracles.known_machines import COASTING, V_TWIN
from validation.oracles.machine import Loads, LoadTable, Machine
from validation.random_scenes import random_scene

pytestmark = pytest.mark.slow

EXACT = stored()
RETURNING = {117, 275, 290}  # to the knot that a step started on
FLYWHEEL = Machine(crank_radius=0.1, crank_inertia=0.5, rod_length=0.3)


def heyoka_path(machine, theta, omega):
    """The compiled oracle, where heyoka is installed."""
    pytest.importorskip("heyoka", reason="of the extra bench")
    oracle = import_module("validation.oracles.heyoka_path")
    return oracle.heyoka_path(machine, theta, omega)


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        ("coasting", 3e-18),
        ("engine_1a", 3e-18),
        ("torque_driven_1s", 1e-17),
        ("torque_driven_3s", 4e-15),
        ("propeller", 2e-17),
    ],
)
def test_end_states_are_reproduced(name, tolerance):
    case, (theta, omega) = end_states.CASES[name], end_states.stored()[name]
    path = heyoka_path(case.machine, case.theta0, case.omega0)
    motion = path.at_times(np.array([np.longdouble(case.time)]))
    assert distance(motion.theta[-1], theta) < tolerance * float(theta)
    assert distance(motion.omega[-1], omega) < tolerance * float(omega)


@pytest.mark.parametrize("seed", sorted({*list(EXACT)[::20], *RETURNING}))
def test_stored_motions_of_random_scenes_are_met(seed):
    """To the last digits stored, those of the times among them."""
    scene, exact = random_scene(seed), EXACT[seed].motion
    path = heyoka_path(machine_of(scene), scene.start.angle, scene.start.speed)
    motion = path.at_times(exact.time.astype(np.longdouble))
    theta, omega = motion.theta - exact.theta, motion.omega - exact.omega
    digit = np.spacing(exact.time)
    assert np.all(np.abs(theta) <= np.abs(exact.omega) * digit + np.spacing(np.abs(exact.theta)))
    assert np.all(np.abs(omega) <= np.abs(exact.alpha) * digit + np.spacing(np.abs(exact.omega)))


def test_every_feature_at_once_in_all_digits():
    table = LoadTable((0.0, 0.05, 0.05, 0.2), (2.0, -3.0, 4.0, 1.0))
    by_speed = LoadTable((-5.0, 20.0, 20.0, 60.0), (1.0, -2.0, -9.0, 3.0))
    loads = Loads(-1.0, 0.02, 1e-3, (table,), (by_speed,))
    machine, times = replace(V_TWIN, loads=loads), np.linspace(0.0, 0.2, 41, dtype=np.longdouble)
    fast, slow = (find(machine, 2.5, 25.0).at_times(times) for find in (heyoka_path, series_path))
    assert slow.omega.min() < 0 < slow.omega.max()
    assert np.abs(fast.theta - slow.theta).max() < 1e-16
    assert np.abs(fast.omega - slow.omega).max() < 1e-14
    assert np.abs(fast.alpha - slow.alpha).max() < 1e-12


def test_an_acceleration_is_as_exact_as_its_equation():
    """Beside a far heavier flywheel a rod of half a milligram: 5e-10 rad/s2 at 19 rad/s. The second
    derivative of a step's series would be 1e-19 off."""
    scene, wide = random_scene(8268), multiprecision(50)
    machine, start = machine_of(scene), (scene.start.angle, scene.start.speed)
    times = np.linspace(0.03, 0.6, 16, dtype=np.longdouble)
    rounded = np.finfo(np.longdouble).eps * start[1] ** 2
    exact = series_path(machine, *start, arithmetic=wide).at_times(wide.array(times)).alpha
    for find, most in ((heyoka_path, 1e-9 * rounded), (series_path, 4.0 * rounded)):
        alpha = find(machine, *start).at_times(times).alpha
        assert max(map(distance, alpha, exact)) < most


@pytest.mark.parametrize("find", [heyoka_path, series_path])
def test_no_run_is_blamed_for_what_an_oracle_rounds(find):
    scene = random_scene(8268)
    path = find(machine_of(scene), scene.start.angle, scene.start.speed)
    ratio, said = judge_scene.judge(scene, "crank_angle", [path])
    assert ratio < 1.0, said


def test_a_path_is_looked_up_again_and_further():
    path = heyoka_path(COASTING, 0.3, 100)
    late, early, later = (path.at_times(np.array([t], np.longdouble)) for t in (0.2, 0.1, 0.3))
    whole = heyoka_path(COASTING, 0.3, 100).at_times(np.array([0.1, 0.2, 0.3], np.longdouble))
    assert [early.theta[0], late.theta[0], later.theta[0]] == whole.theta.tolist()


def test_a_jump_that_holds_the_speed_is_refused():
    governor = LoadTable((0, 10, 10, 20), (1, 1, -1, -1))
    path = heyoka_path(replace(FLYWHEEL, loads=Loads(speed_tables=(governor,))), 0, 0)
    for _ in range(2):
        with pytest.raises(ArithmeticError):
            path.at_times(np.array([9.0], np.longdouble))
