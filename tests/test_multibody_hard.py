"""Hard cases: the multibody model is right within its stated error, or stops with a sentence."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from references import assert_within_stated

from crankmbs.result import Result
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import Constant, TimeTable, Viscous
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.simulate import simulate

pytestmark = pytest.mark.slow

COASTING = load_scene("coasting")


def brief(until: float, unit: str = "s") -> Run:
    return Run(until=Extent(value=until, unit=unit), every=Extent(value=0.05, unit="rad"))


def multibody(scene: Scene, cost_cap: float = 60.0) -> Result:
    return simulate(scene, formulation="multibody", cost_cap=cost_cap)


def short_rod(excess: float) -> Scene:
    length = COASTING.crank.radius * (1.0 + excess)
    rod = replace(COASTING.rod, length=length, center_of_mass=0.02)
    return replace(COASTING, rod=rod, run=brief(0.05))


@pytest.mark.parametrize(
    "scene",
    [
        short_rod(1e-3),
        replace(COASTING, torque=(Viscous(coefficient=1e4),), run=brief(0.01)),
        replace(
            COASTING,
            torque=(TimeTable(file=Table((0, 0.02, 0.02, 0.1), (0, 50.0, -30.0, 10.0))),),
            run=brief(0.04),
        ),
        replace(COASTING, start=Start(angle=1e-9, speed=0.0), torque=(Constant(torque=5.0),)),
    ],
    ids=["nearly folds", "stiff load", "load jumps", "from rest"],
)
def test_agrees_with_the_reduced_model_within_the_stated_error(scene: Scene) -> None:
    scene = replace(scene, run=scene.run if scene.run.until.value < 0.1 else brief(0.05))
    result, exact = multibody(scene), simulate(scene, rtol=1e-11)
    assert result.status == 0
    assert_within_stated(result, exact)


def test_what_rounding_grows_to_is_stated() -> None:
    """Off a dead centre a crank multiplies what rounding it starts with by 6e7."""
    scene = load_scene("propeller")
    start, run = Start(angle=2.0 * np.pi + 1e-9, speed=0.0), brief(0.06)
    scene = replace(scene, start=start, torque=(), gravity=replace(scene.gravity, acceleration=0.0))
    result = multibody(replace(scene, run=run))
    assert "finer steps err as much by rounding, which grows in this motion" in result.message
    assert_within_stated(result, simulate(replace(scene, run=run), rtol=1e-11))
    assert 1e-6 < result.data["crank_angle"].attrs["error_estimate"] < 1e-4


def test_where_it_folds_is_where_finer_steps_fail_too() -> None:
    result = multibody(short_rod(0.0))
    assert result.status == -1
    assert "exudyn's Newton iteration does not converge" in result.message
    assert result.data["crank_angle"].values[-1] > np.radians(86.0)
    assert result.data["crank_angle"].attrs["error_estimate"] < 1e-4


def test_a_crank_that_nothing_moves_says_so() -> None:
    result = multibody(replace(COASTING, start=Start(angle=0.0, speed=0.0), run=brief(1.0, "rad")))
    assert (result.status, result.data.sizes["time"]) == (1, 1)
    assert result.message.startswith("did not move: at rest at 0 degrees")
    weight = 9.81 * (5.0 + 1.427 + 1.1416)
    assert result.data["main_bearing_force_x"].values[0] == pytest.approx(weight, rel=1e-7)


def test_a_crank_that_comes_to_rest_says_so() -> None:
    scene = replace(
        COASTING, gravity=None, torque=(Viscous(coefficient=2.0),), run=brief(99.0, "rad")
    )
    result = multibody(scene, cost_cap=1.5)
    assert result.status == 1
    assert result.message.startswith("came to rest at ")


def test_a_run_too_long_for_the_cost_cap_stops_and_says_what_it_would_cost() -> None:
    cycles = Run(until=Extent(value=100_000.0, unit="cycle"), every=Extent(value=1.0, unit="rad"))
    result = multibody(replace(COASTING, run=cycles), cost_cap=0.5)
    assert result.status == -1
    assert "the whole run would take about" in result.message
    assert "above the cost cap of 0.5 s" in result.message
    assert 1.0 < result.data["crank_angle"].values[-1] < 1e5


@pytest.mark.parametrize("cost_cap", [1e300, math.inf])
def test_a_cost_cap_of_more_steps_than_exudyn_counts_is_none(cost_cap: float) -> None:
    result = multibody(replace(COASTING, run=brief(6.0, "rad")), cost_cap=cost_cap)
    assert result.status == 0
    assert result.error.estimated <= 1e-5


def test_a_fold_is_never_run_over_in_silence() -> None:
    result = multibody(short_rod(0.0))
    assert result.status != 0
    assert "fold" in result.message
    assert np.all(np.cos(result.data["rod_angle"].values) > 0.0)
