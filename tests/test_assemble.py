"""From two answers to variables with errors, and to a labelled dataset."""

from dataclasses import replace

import numpy as np
import pytest

from crankmbs import load_scene
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import COORDINATES, VARIABLES, dataset, variables_of
from crankmbs.motion.assemble import assemble, labelled
from crankmbs.motion.base import Samples, Solution

SCENE = load_scene("v_twin")
TIME = np.linspace(0.0, 0.1, 11)
OMEGA = 100.0 + np.cos(TIME)


def samples(theta_off=0.0, time_off=0.0):
    return Samples(TIME + time_off, 100.0 * TIME + theta_off, OMEGA, -np.sin(TIME), 0.0 * TIME)


def solution(better=None, **more):
    return Solution(samples(), 0, "done", 1, 1, better, **more)


def test_every_variable_has_its_name_shape_and_labels():
    data = dataset(labelled(assemble(CrankTrain(SCENE, None), solution())), COORDINATES)
    assert set(data.variables) == variables_of(SCENE).keys() | {"cylinder"}
    for name, about in variables_of(SCENE).items():
        assert data[name].dims == (("time", "cylinder") if about.per_cylinder else ("time",))
        assert data[name].attrs["units"] == about.units
        assert data[name].attrs["long_name"] == about.long_name
        assert isinstance(data[name].attrs["error_estimate"], float)
    assert data["cylinder"].values.tolist() == [1, 2]


def test_an_exact_answer_errs_by_rounding_only():
    assembled = assemble(CrankTrain(SCENE, None), solution())
    assert 0.0 < assembled.relative_error < 1e-13


def test_the_difference_to_the_better_answer_is_the_error():
    assembled = assemble(CrankTrain(SCENE, None), solution(samples(theta_off=1e-6)))
    assert assembled.errors["crank_angle"] == pytest.approx(1e-6, rel=1e-6)
    loop = assembled.variables["piston_velocity"] / OMEGA[:, None]
    moved = 1e-6 * np.abs(loop).max()
    assert assembled.errors["piston_position"] == pytest.approx(moved, rel=1e-2)
    assert assembled.errors["time"] < 1e-14
    assert assembled.relative_error > 1e-7


def test_errors_that_cancel_at_one_sample_are_stated():
    """Ahead, and slower by as much as keeps the kinetic energy: that is chance."""
    last = samples().select(slice(10, 11))
    inertia, slope, _ = reduce(CrankTrain(SCENE, None), last.theta)
    ahead = 1e-6
    slower = -0.5 * slope * last.omega * ahead / inertia
    better = replace(last, theta=last.theta + ahead, omega=last.omega + slower)
    assembled = assemble(CrankTrain(SCENE, None), Solution(last, 0, "done", 1, 1, better))
    each = abs(float(0.5 * slope[0] * last.omega[0] ** 2 * ahead))
    check = assemble(CrankTrain(SCENE, None), Solution(better, 0, "done", 1, 1)).variables[
        "kinetic_energy"
    ]
    assert abs(float(check[0] - assembled.variables["kinetic_energy"][0])) < 1e-3 * each
    assert assembled.errors["kinetic_energy"] == pytest.approx(2.0 * each, rel=1e-2)


def test_what_differs_at_an_end_in_time_is_stated():
    """Also where an angle that errs as much as before would cancel what the speed there makes: of
    few samples both are added up."""
    ahead = 1e-6
    late = np.append(np.full(10, -ahead / 100.0), 0.0)
    inertia, slope, _ = reduce(CrankTrain(SCENE, None), samples().theta[-1])
    slower = -0.5 * slope * OMEGA[-1] * ahead / inertia
    better = samples(time_off=late)
    better.theta[-1] += 1e-9 * ahead
    better = replace(better, omega=np.append(OMEGA[:-1], OMEGA[-1] + slower))
    assembled = assemble(CrankTrain(SCENE, None), solution(better))
    made = float(inertia * OMEGA[-1] * abs(slower))
    assert assembled.errors["kinetic_energy"] == pytest.approx(2.0 * made, rel=1e-2)


def test_an_end_at_an_angle_that_both_pass_at_one_time_is_exact():
    late = np.append(np.full(10, 1e-8), 0.0)
    assembled = assemble(CrankTrain(SCENE, None), solution(samples(time_off=late)))
    assert assembled.errors["crank_angle"] > 1e-7
    assert assembled.errors["piston_position"] < 1e-13


def test_the_crank_angle_errs_at_equal_time():
    """A sample on a crank angle that is passed too late is an error of time and of angle."""
    assembled = assemble(CrankTrain(SCENE, None), solution(samples(time_off=1e-6)))
    assert assembled.errors["time"] == pytest.approx(1e-6, rel=1e-6)
    assert assembled.errors["crank_angle"] == pytest.approx(1e-6 * OMEGA.max(), rel=1e-6)


def test_errors_that_a_formulation_states_are_taken():
    stated = dict.fromkeys(VARIABLES, 0.25)
    assert assemble(CrankTrain(SCENE, None), solution(errors=stated)).errors == stated


def test_what_a_formulation_computed_itself_is_taken():
    own = replace(samples(), computed={"external_torque": 7.0 + 0.0 * TIME})
    variables = assemble(CrankTrain(SCENE, None), Solution(own, 0, "done", 1, 1)).variables
    assert np.all(variables["external_torque"] == 7.0)


def test_a_run_that_did_not_move_has_no_error():
    first = samples().select(slice(1))
    assert (
        assemble(CrankTrain(SCENE, None), Solution(first, 1, "stuck", 0, 0)).relative_error == 0.0
    )
