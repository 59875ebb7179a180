"""The multibody model against known end states, computed figures and the independent oracle."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from crankmbs.mechanics.variables import SUMS
from crankmbs.result import Result
from crankmbs.scene.drives import Motion, Oscillation, Ramp, Start
from crankmbs.scene.parts import Cylinder, Gravity, Layout
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.simulate import simulate
from validation.adapter import at_jumps, reference_motion, reference_variables

pytestmark = pytest.mark.slow

COASTING = load_scene("coasting")
END_STATES = {
    "coasting": (49.22808714458433140007, 94.47401803965801494427),
    "propeller": (245.2443994013520719602, 311.8789454353481041818),
}


def brief(until: float, unit: str = "s", every: float = 0.05, every_unit: str = "rad") -> Run:
    return Run(until=Extent(value=until, unit=unit), every=Extent(value=every, unit=every_unit))


# unbalanced crank, offset, two banks, strong gravity askew: every sign and frame counts
ASKEW = replace(
    COASTING,
    crank=replace(COASTING.crank, center_of_mass=-0.01),
    piston=replace(COASTING.piston, offset=0.004),
    layout=Layout(cylinders=(Cylinder(phase=0.3, bank=-0.5), Cylinder(phase=2.0, bank=0.6))),
    gravity=Gravity(acceleration=200.0, angle=2.5),
    run=brief(0.06),
)
SWUNG = Motion(speed=Oscillation(mean=100.0, amplitude=20.0, order=2.0), angle=0.4)
SCENES = {
    "askew": ASKEW,
    "backwards, sampled in time": replace(
        ASKEW, start=Start(angle=0.3, speed=-90.0), run=brief(0.06, "s", 1e-3, "s")
    ),
    "fired, with pressure jumps": replace(load_scene("v_twin"), run=brief(1.5, "cycle")),
    "swings back": replace(COASTING, start=Start(angle=0.3, speed=3.0), run=brief(0.9)),
    "driven": replace(ASKEW, start=None, motion=SWUNG),
    "driven and fired": replace(load_scene("grega_lecture"), run=brief(0.6, "cycle")),
    "massless rod and piston": replace(
        COASTING,
        rod=replace(COASTING.rod, mass=0.0, inertia=0.0, center_of_mass=0.0),
        piston=replace(COASTING.piston, mass=0.0),
        run=brief(0.05),
    ),
}


@cache
def solved(name: str) -> Result:
    return simulate(SCENES[name], formulation="multibody", rtol=1e-5, cost_cap=60.0)


def true_errors(result: Result, scene: Scene) -> dict[str, tuple[float, float, float]]:
    """Largest true error, stated error and peak of every variable, by the independent oracle."""
    motion = reference_motion(result, scene)
    known = reference_variables(scene, motion.theta, motion.omega, motion.alpha)
    known |= {
        "time": motion.time,
        "crank_angle": motion.theta,
        "crank_speed": motion.omega,
        "crank_acceleration": motion.alpha,
        "energy_residual": np.zeros(len(motion.time)),
    }
    smooth = ~at_jumps(scene, result.data["crank_angle"].values)
    found = {}
    for name, variable in result.data.variables.items():
        if name in known:
            off = np.abs(variable.values - np.asarray(known[name], dtype=float))[smooth]
            stated = float(variable.attrs["error_estimate"])
            found[str(name)] = (float(off.max()), stated, float(np.abs(variable.values).max()))
    return found


@pytest.mark.parametrize(("name", "rtol"), [("coasting", 1e-5), ("propeller", 1e-3)])
def test_meets_the_end_state_of_a_benchmark_within_its_stated_error(name: str, rtol: float) -> None:
    result = simulate(load_scene(name), formulation="multibody", rtol=rtol, cost_cap=60.0)
    assert result.status == 0
    for variable, known in zip(("crank_angle", "crank_speed"), END_STATES[name], strict=True):
        data = result.data[variable]
        assert abs(data.values[-1] - known) <= 2.0 * data.attrs["error_estimate"]


def test_meets_the_computed_figures_of_the_torque_driven_slider_crank() -> None:
    scene = replace(load_scene("torque_driven"), run=brief(1.0, "s", 0.25, "s"))
    result = simulate(scene, formulation="multibody", rtol=1e-6, cost_cap=60.0)
    for name, figure in {
        "crank_angle": 14.1278922178,
        "crank_speed": 20.5374828514,
        "crank_acceleration": 123.421388171,
        "piston_position": 0.283771692112,
        "piston_pin_force_x": 0.8545563871,
        "piston_pin_force_y": 1.1996653402,
        "crank_pin_force_x": -0.2050844426,
        "crank_pin_force_y": -3.0065884395,
    }.items():
        value = float(result.data[name].values.ravel()[-1])
        assert value == pytest.approx(figure, rel=1e-6), name
        stated = float(result.data[name].attrs["error_estimate"])
        assert abs(value - figure) <= 2.0 * stated + 1e-10 * abs(figure), name


@pytest.mark.parametrize("name", SCENES)
def test_every_error_is_honest_and_no_idle_caution(name: str) -> None:
    assert solved(name).status == 0
    errors = true_errors(solved(name), SCENES[name])
    assert len(errors) >= 20
    for variable, (true, stated, peak) in errors.items():
        rounded = 1e-13  # the oracle rounds, too
        assert true <= 2.0 * stated + rounded, variable
        calm = variable not in SUMS and name != "swings back"  # the next term may be small, too
        if calm:
            assert stated <= 100.0 * true or true <= 1e-12 * peak + rounded, variable


@pytest.mark.parametrize("name", SCENES)
def test_meets_what_is_asked(name: str) -> None:
    assert solved(name).error.estimated <= 1e-5


@pytest.mark.parametrize(
    ("part", "change"),
    [
        ("rod", {"length": COASTING.rod.length * (1.0 + 1e-5)}),
        ("piston", {"mass": COASTING.piston.mass * (1.0 + 1e-4)}),
        ("gravity", {"angle": -2.5}),
    ],
)
def test_a_shifted_parameter_is_seen(part: str, change: dict[str, float]) -> None:
    scene = SCENES["backwards, sampled in time"]
    mutant = replace(scene, **{part: replace(getattr(scene, part), **change)})
    errors = true_errors(solved("backwards, sampled in time"), mutant)
    assert any(true > 2.0 * stated for true, stated, _ in errors.values())


def test_a_corner_of_the_prescribed_speed_and_a_rest_at_its_end() -> None:
    ramp = Motion(speed=Ramp(start=60.0, to=100.0, over=0.03), angle=0.4)
    stop = Motion(speed=Ramp(start=60.0, to=0.0, over=0.03), angle=0.4)
    for motion, run, status in ((ramp, brief(0.05), 0), (stop, brief(9.0, "rad"), 1)):
        scene = replace(ASKEW, start=None, motion=motion, run=run)
        result = simulate(scene, formulation="multibody")
        exact = simulate(scene, formulation="kinetostatic")
        assert result.status == exact.status == status
        for name, variable in result.data.variables.items():
            if name != "cylinder":
                off = np.max(np.abs(variable.values - exact.data[name].values))
                assert off <= 2.0 * variable.attrs["error_estimate"], name


def test_samples_lie_on_the_grid_and_the_last_at_the_end() -> None:
    in_angle, in_time = solved("askew").data, solved("backwards, sampled in time").data
    angle, time = in_angle["crank_angle"].values, in_time["time"].values
    np.testing.assert_allclose(angle[:-1], 0.3 + 0.05 * np.arange(len(angle) - 1), rtol=1e-14)
    np.testing.assert_allclose(time, 1e-3 * np.arange(61), rtol=0.0, atol=1e-17)
    assert in_angle["time"].values[-1] == 0.06
    for name in SCENES:
        assert np.all(np.diff(solved(name).data["time"].values) > 0.0)


def test_without_output_spacing_the_last_cycle_is_kept_degree_by_degree() -> None:
    run = Run(until=Extent(value=30.0, unit="rad"), every=None)
    angle = simulate(replace(COASTING, run=run), formulation="multibody").data["crank_angle"].values
    assert angle[-1] == 30.3
    assert angle[0] <= 30.3 - 4.0 * np.pi < angle[1]
    np.testing.assert_allclose(np.diff(angle)[:-1], np.pi / 180.0)


def test_exudyn_prints_nothing_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    simulate(replace(COASTING, run=brief(0.01)), formulation="multibody")
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")
