"""A run is held against exudyn's rigid bodies; two runs are compared at the samples of both."""

from __future__ import annotations

from dataclasses import replace

import pytest

from crankmbs.compare.confirm import confirm
from crankmbs.errors import InputError
from crankmbs.scene.forces import Spring
from crankmbs.scene.read import load_scene
from crankmbs.simulate import simulate
from validation.random_changes import random_changes
from validation.random_forces import random_forces
from validation.random_friction import random_friction
from validation.random_scenes import random_scene
from validation.random_unlike import random_unlike

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("coasting", {}),
        ("propeller", {"run__until": "settled"}),
        ("v_twin", {"run__until": "2 cycles", "run__every": "7 deg"}),
        ("misfire", {"run__until": "3 cycles"}),
        ("friction", {}),
        ("turning_moment", {}),
    ],
)
def test_exudyn_agrees_over_the_last_cycle_and_at_states_of_the_run(
    name: str, change: dict[str, str]
) -> None:
    found = confirm(simulate(load_scene(name).with_(**change)))
    assert found.holds
    assert found.difference <= found.error <= 1e-5
    assert found.at_states <= 1e-9
    assert found.missing == ()
    assert found.sentence.startswith("exudyn's rigid bodies agree to ")


@pytest.mark.parametrize("name", ["run_up", "run_down"])
def test_a_crank_that_friction_holds_is_confirmed_too(name: str) -> None:
    found = confirm(simulate(load_scene(name)))
    assert found.holds
    assert found.at_states <= 1e-9
    assert "while it holds the crank at rest" in found.missing[0]


def test_forces_from_outside_are_the_run_s_where_the_speed_is_prescribed() -> None:
    driven = load_scene("compressor").with_(run__until="1 rev")
    assert driven.motion is not None
    pushed = replace(driven, force=(Spring(stiffness=2000.0),))
    found = [confirm(simulate(scene)) for scene in (driven, pushed)]
    assert [len(each.missing) for each in found] == [0, 1]
    assert "not they themselves" in found[1].missing[0]
    assert all(each.difference < 1e-9 for each in found)


@pytest.mark.parametrize("seed", [19, 36])
def test_between_samples_the_run_errs_by_what_its_passes_differ_by(seed: int) -> None:
    assert confirm(simulate(random_forces(seed))).holds


def test_a_crank_that_turns_back_is_integrated_from_the_last_decision_on() -> None:
    result = simulate(random_changes("fuel", 16))  # 800 degrees forwards, then 159 back
    found = confirm(result)
    assert found.holds
    assert found.difference < 1e-6
    decided = result.events["time"].values[result.events["kind"].values == "fuel"]
    assert found.window[0] == pytest.approx(decided[-1], rel=1e-9)


def test_a_stretch_shorter_than_a_step_is_run_no_further_than_its_end() -> None:
    """Two rows of the pressure nearly meet: beyond them their cubic is worth nothing."""
    assert confirm(simulate(random_changes("windows", 22))).holds


@pytest.mark.parametrize(("kind", "seed"), [("all", 17), ("pressures", 7), ("functions", 13)])
def test_two_answers_that_agree_by_chance_are_checked_by_the_one_before(
    kind: str, seed: int
) -> None:
    """From step to step the error of an answer changes its sign, or grows."""
    found = confirm(simulate(random_changes(kind, seed)))
    assert max(row.share for row in found.period) <= 1.0


@pytest.mark.parametrize("seed", [1, 16])
def test_runs_over_a_jump_that_is_not_declared_are_checked_by_three_before(seed: int) -> None:
    assert confirm(simulate(random_changes("all", seed))).holds


def test_a_run_is_cut_at_every_jump_of_many() -> None:
    """116 steps of the pressure in a period: run over, they left 6e-4 of the peak."""
    found = confirm(simulate(random_changes("windows", 5)))
    assert found.holds
    assert found.error < 1e-5


def test_a_stretch_shorter_than_any_step_is_run_alike_at_all_of_them() -> None:
    """0.03 degrees between two knots: in steps of its own at some step sizes and not at others it
    left 1.5e-5 of the peak, 4e-6 stated."""
    found = confirm(simulate(random_friction(26)))
    assert max(row.share for row in found.period) <= 1.0


def test_a_period_whose_first_step_exudyn_fails_is_begun_again() -> None:
    """0.7 s after the begin of the run: what is left out of a run counts from its own begin."""
    assert confirm(simulate(random_scene(31))).holds


def test_a_soft_bend_over_the_travel_at_which_no_run_is_cut_is_passed() -> None:
    """One piston passes a row of its force where the slope changes by half of the force in a
    radian, on the way from a dead centre to where the force of the other is cut."""
    found = confirm(simulate(random_unlike(3)))
    assert found.holds
    assert found.difference < 1e-5


@pytest.mark.parametrize(
    ("change", "least"),
    [
        ({"piston__mass": 1.001}, 1e-5),
        ({"rod__length": 1.0001}, 1e-6),
        ({"crank__inertia": 1.001}, 1e-6),
        ({"gravity__acceleration": 1.01}, 1e-6),
    ],
)
def test_a_shifted_parameter_is_seen(change: dict[str, float], least: float) -> None:
    result = simulate(load_scene("coasting"))
    (key, factor) = next(iter(change.items()))
    part, name = key.split("__")
    value = getattr(getattr(result.scene, part), name)
    found = confirm(replace(result, scene=result.scene.with_(**{key: factor * value})))
    assert not found.holds
    assert max(found.difference, found.at_states) > least


def test_a_run_that_swings_says_over_what_it_was_compared() -> None:
    swing = load_scene("coasting").with_(start__speed="0 rpm", run__until="0.5 s")
    found = confirm(simulate(swing))
    assert not found.whole
    assert "joint force from " in found.sentence
    assert "cycle" not in found.sentence


def test_a_run_of_multibody_is_not_confirmed_by_itself() -> None:
    scene = load_scene("coasting").with_(run__until="0.01 s")
    with pytest.raises(InputError, match="not confirmed by itself"):
        confirm(simulate(scene, formulation="multibody"))
