"""Crank trains as bodies of MuJoCo: stored is what it gives, and a claim sees what is off."""

import importlib.util
import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import load_scene
from validation.adapter import machine_of, reference_variables
from validation.case import load_cases
from validation.checks import mujoco as check
from validation.mujoco.bodies import Bodies
from validation.mujoco.motion import stored_motion
from validation.mujoco.stored import read_stored, write_stored

CASES = {case.name: case for case in load_cases() if case.check.startswith("mujoco.")}
installed = pytest.mark.skipif(
    importlib.util.find_spec("mujoco") is None, reason="MuJoCo, of the extra bench"
)


@installed
@pytest.mark.parametrize("name", ["propeller", "v_twin", "grega_lecture"])
def test_multipliers_and_forces_between_bodies_are_those_of_newton_and_euler(name):
    scene = load_scene(name)
    theta, omega = np.array([[0.4, 2.0, -9.0], [310.0, -80.0, 200.0]])
    exact = reference_variables(scene, theta, omega, np.array([900.0, -4e3, 0.0]))
    exact = {name: values.astype(float) for name, values in exact.items()}
    bodies = Bodies(machine_of(scene))
    for k, (angle, speed) in enumerate(zip(theta.tolist(), omega.tolist(), strict=True)):
        forces = exact["gas_force"][k].tolist()
        found = bodies.turned(angle, speed, forces, float(exact["external_torque"][k]))
        size = np.abs(exact["crank_pin_force_x"][k]).max()
        assert found.alpha == pytest.approx([900.0, -4e3, 0.0][k], rel=1e-11, abs=1e-8)
        for joint in ("main_bearing", "crank_pin", "piston_pin"):
            vectors = [exact[f"{joint}_force_{axis}"][k] for axis in "xy"]
            ours = getattr(found, joint).T
            np.testing.assert_allclose(ours, vectors, rtol=0.0, atol=1e-11 * size)
        np.testing.assert_allclose(found.side, exact["side_force"][k], rtol=0.0, atol=1e-11 * size)
        np.testing.assert_allclose(found.position, exact["piston_position"][k], rtol=1e-13)


@installed
@pytest.mark.slow
@pytest.mark.parametrize(
    ("claim", "name"),
    [("mujoco_unlike", "unlike 3"), ("mujoco_forces", "forces 1"), ("mujoco_double", "double 2")],
)
def test_what_is_stored_is_what_mujoco_gives(claim, name):
    scene, stored = dict(check.scenes_of(CASES[claim]))[name], read_stored()[name]
    found = stored_motion(scene, len(stored.samples))
    assert found.samples == stored.samples
    for variable, values in found.numbers.items():
        allowed = stored.errors[variable] + found.errors[variable]
        allowed += 1e-11 * np.abs(values).max()
        assert np.abs(values - stored.numbers[variable]).max() <= allowed, variable


def test_what_is_stored_comes_back(tmp_path):
    stored = {name: read_stored()[name] for name in ("v_twin", "press")}
    write_stored(stored, tmp_path)
    again = read_stored(tmp_path)
    assert list(again) == ["press", "v_twin"]
    assert read_stored(tmp_path / "elsewhere") == {}
    for name, one in stored.items():
        assert (again[name].version, again[name].samples) == (one.version, one.samples)
        assert again[name].errors == one.errors
        for variable, values in one.numbers.items():
            np.testing.assert_array_equal(again[name].numbers[variable], values)


@pytest.mark.parametrize("variable", ["crank_angle", "side_force", "main_bearing_force_y"])
def test_one_number_that_is_off_is_seen(variable, monkeypatch):
    stored = read_stored()["press"]
    assert check.machine(CASES["mujoco_press"]).error <= 1.0
    values = stored.numbers[variable].copy()
    values[7] += 1e-6 * np.abs(values).max()
    off = replace(stored, numbers={**stored.numbers, variable: values})
    monkeypatch.setattr(check, "read_stored", lambda: {"press": off})
    found = check.machine(CASES["mujoco_press"])
    assert found.error > 1.0
    assert variable in found.detail


def test_a_run_that_ends_before_its_samples_is_seen(monkeypatch):
    stored = read_stored()["press"]
    late = replace(stored, samples=(*stored.samples[:-1], 1000))
    monkeypatch.setattr(check, "read_stored", lambda: {"press": late})
    assert check.machine(CASES["mujoco_press"]).error == math.inf


def test_scenes_without_stored_numbers_are_named_and_many_of_them_are_refused(monkeypatch):
    case = replace(
        CASES["mujoco_forces"], parameters=CASES["mujoco_forces"].parameters | {"count": 1}
    )
    assert "not by MuJoCo" not in check.drawn(case).detail
    monkeypatch.setattr(check, "read_stored", dict)
    with pytest.raises(RuntimeError, match=r"no stored numbers: \['forces 0'\]"):
        check.drawn(case)
