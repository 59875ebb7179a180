"""From runs at halved steps to an answer and its error: what is clean, erratic or rounding."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs.mechanics.train import crank_train
from crankmbs.motion.multibody.beside import errors_beside_jumps
from crankmbs.motion.multibody.error import Convergence
from crankmbs.motion.multibody.held import held_by
from crankmbs.motion.multibody.problem import problem_of
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Run

pytestmark = pytest.mark.slow

X = np.linspace(0.0, 3.0, 50)
EXACT = np.sin(X)
SMOOTH = 3  # the least order of what is erratic; 2 with bends, 1 with jumps within the steps
Variables = dict[str, np.ndarray]


def run(off: np.ndarray, beside: np.ndarray | None = None) -> Variables:
    other = EXACT + (off if beside is None else beside)
    return {"crank_speed": EXACT + off, "ahead": other, "crank_angle": EXACT}


def at(step: float, bend: np.ndarray) -> Variables:
    return run(bend * step**2 + 0.1 * bend * step**4)


def after_each(runs: list[Variables], order: int) -> list[tuple[float, float]]:
    """True and stated error of the crank speed after each run."""
    convergence, found = Convergence(order), []
    for k in range(len(runs)):
        answer, errors = convergence.answer(runs[max(k - 2, 0) : k + 1])
        found.append((float(np.max(np.abs(answer["crank_speed"] - EXACT))), errors["crank_speed"]))
    return found


def test_a_clean_order_is_extrapolated() -> None:
    runs = [at(h, np.cos(X)) for h in (0.2, 0.1, 0.05, 0.025)]
    found = after_each(runs, SMOOTH)
    for (true, stated), step in zip(found[2:], (0.05, 0.025), strict=True):
        assert true < 0.01 * step**2
        assert true <= stated <= 50.0 * true


def test_an_erratic_one_is_not() -> None:
    generator = np.random.default_rng(5)
    runs = [at(h, generator.uniform(-1.0, 1.0, 50)) for h in (0.2, 0.1, 0.05)]
    true, stated = after_each(runs, SMOOTH)[-1]
    assert true == np.max(np.abs(runs[-1]["crank_speed"] - EXACT))
    assert stated >= np.max(np.abs(runs[-1]["crank_speed"] - runs[-2]["crank_speed"]))


def test_nothing_is_extrapolated_over_jumps_within_a_step() -> None:
    runs = [at(h, np.cos(X)) for h in (0.2, 0.1, 0.05)]
    true, stated = after_each(runs, 1)[-1]
    assert true == np.max(np.abs(runs[-1]["crank_speed"] - EXACT))
    assert stated >= 0.5 * np.max(np.abs(runs[1]["crank_speed"] - runs[0]["crank_speed"]))


def over_bends(places: np.ndarray, *, bent: bool) -> float:
    """True over stated error of an acceleration whose samples lie on bends, as their steps do."""
    convergence, runs = Convergence(2, bent=bent), []
    for step in (0.2 / 2**k for k in range(5)):
        x = (np.resize(places, 50) / step) % 1.0  # a line over a bend misses x (1 - x) of a step
        runs.append(
            run(np.full(50, step**2)) | {"crank_acceleration": EXACT + x * (1.0 - x) * step}
        )
        answer, errors = convergence.answer(runs[-3:])
    true = float(np.max(np.abs(answer["crank_acceleration"] - EXACT)))
    return true / errors["crank_acceleration"]


def test_accelerations_err_by_the_first_power_of_the_step_over_bends() -> None:
    places = np.random.default_rng(3).uniform(0.0, 3.0, (301, 3))[1:]
    blind, seen = (max(over_bends(each, bent=bent) for each in places) for bent in (False, True))
    assert seen < 1.0 < 2.0 < blind


def test_of_one_run_alone_the_error_is_unknown_and_of_two_stated_with_care() -> None:
    (_, one), (true, two) = after_each([at(h, np.cos(X)) for h in (0.2, 0.1)], SMOOTH)
    assert one == math.inf
    assert two == pytest.approx(15.0 * true, rel=0.1)


@pytest.mark.parametrize("order", [SMOOTH, 2])
def test_a_correction_that_hardly_changes_by_chance_is_not_believed(order: int) -> None:
    places = (0.0, 0.05, 0.08, 0.1, 0.18)  # of a bend in its step: the last two answers err alike
    steps = [0.2 / 2**k for k in range(5)]
    runs = [run((1.0 + x) * h**2 * np.cos(X)) for h, x in zip(steps, places, strict=True)]
    (before, _), (true, stated) = after_each(runs, order)[-2:]
    assert true == pytest.approx(before, rel=1e-6)
    assert true <= 2.0 * stated


def test_the_first_correction_is_measured_by_those_of_the_other_variables() -> None:
    runs = [run(h**2 * np.cos(X), (h**2 + h**3) * np.cos(X)) for h in (0.2, 0.1, 0.05)]
    convergence = Convergence(SMOOTH)
    for k in range(1, 4):
        _, errors = convergence.answer(runs[:k])
    assert errors["crank_speed"] > 0.01 * errors["crank_angle"] > 0.0


def test_rounding_that_grows_is_stated_twice() -> None:
    noise = [0.0, 0.0, 1e-6, 4e-6, 1.2e-5]
    runs = [
        run(0.01 * (0.2 / 2**k) ** 2 * np.cos(X) + size * (-1.0) ** np.arange(50))
        for k, size in enumerate(noise)
    ]
    true, stated = after_each(runs, SMOOTH)[-1]
    assert true <= stated <= 10.0 * true


def test_what_depends_on_the_angle_alone_errs_by_its_interpolation() -> None:
    names = ("rod_angle", "crank_speed")
    convergence = Convergence(SMOOTH)
    runs = [
        dict.fromkeys(names, EXACT + h**6 * np.cos(X)) | {"ahead": EXACT, "crank_angle": EXACT}
        for h in (0.2, 0.1, 0.05)
    ]
    for k in range(1, 4):
        _, errors = convergence.answer(runs[:k])
    true = 0.05**6
    assert true <= errors["rod_angle"] <= 20.0 * true
    assert errors["crank_speed"] > 60.0 * true


def test_a_jump_of_the_gas_within_reach_of_a_sample_is_an_error() -> None:
    scene = replace(load_scene("v_twin"), run=Run(until="0.01 s", every="0.002 s"))
    problem = problem_of(crank_train(scene))
    jump = problem.gas.stretch(0.1, 1.0).high
    rise = float(np.max(np.abs(problem.gas.stretch(0.1, 1.0).rises[1])))
    names = ("gas_force", "gas_pressure", *held_by(scene, np.zeros((1, 2)), np.zeros(1)))
    for off, least in ((1e-6, 0.9 * rise), (1e-3, 0.0)):
        answer = {"crank_angle": np.array([jump - off])}
        errors = dict.fromkeys(names, 0.0) | {"crank_angle": 1e-6}
        found = errors_beside_jumps(problem, answer, errors)
        assert least <= found["gas_force"] <= 1.1 * least + 0.01 * rise
        assert least <= found["piston_pin_force_x"]
