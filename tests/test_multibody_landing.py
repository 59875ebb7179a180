"""Where a load bends or jumps, over time or over the speed, the multibody model lands on it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from references import assert_within_stated

from crankmbs.errors import FormulationError
from crankmbs.result import Result
from crankmbs.scene.drives import Start
from crankmbs.scene.loads import SpeedTable, TimeTable
from crankmbs.scene.read import load_scene
from crankmbs.scene.run import Extent, Run
from crankmbs.scene.scene import Scene
from crankmbs.scene.tables import Table
from crankmbs.scene.torque import Torque
from crankmbs.simulate import simulate

pytestmark = pytest.mark.slow

COASTING = replace(
    load_scene("coasting"),
    run=Run(until=Extent(value=0.05, unit="s"), every=Extent(value=0.05, unit="rad")),
)
BENT = TimeTable(file=Table((0.0, 0.013, 0.031, 0.1), (0.0, 60.0, -90.0, 10.0)))
OVER_SPEED = {
    "bend": SpeedTable(file=Table((0.0, 101.0, 120.0, 200.0), (5.0, 5.0, -40.0, -40.0))),
    "jump": SpeedTable(file=Table((0.0, 101.0, 101.0, 200.0), (5.0, 5.0, 20.0, 20.0))),
}


def loaded(*torque: Torque) -> Scene:
    return replace(COASTING, torque=torque)


@pytest.mark.parametrize("load", [BENT, *OVER_SPEED.values()], ids=["in time", *OVER_SPEED])
def test_errors_are_honest_there(load: Torque) -> None:
    scene = loaded(load)
    result = simulate(scene, formulation="multibody", rtol=1e-5, cost_cap=60.0)
    exact = simulate(scene, rtol=1e-11)
    assert result.error.estimated <= 1e-5
    assert_within_stated(result, exact)


def held(start: float) -> Scene:
    """A jump that brakes above 100 rad/s and drives below it."""
    load = SpeedTable(file=Table((0.0, 100.0, 100.0, 200.0), (900.0, 900.0, -900.0, -900.0)))
    return replace(loaded(load), start=Start(angle=0.3, speed=start))


def test_a_speed_held_by_a_jump_ends_the_run() -> None:
    def run(**how: object) -> Result:
        return simulate(held(110.0), **how)

    result, exact = run(formulation="multibody", cost_cap=60.0), run()
    assert result.status == exact.status == 1
    assert result.message.startswith("held at 954.93 rpm at 18.67")
    for name in ("time", "crank_angle", "crank_speed"):
        data = result.data[name]
        off = abs(float(data.values[-1] - exact.data[name].values[-1]))
        assert off <= 2.0 * data.attrs["error_estimate"] + 1e-12, name


def test_a_speed_held_from_the_start_is_refused() -> None:
    with pytest.raises(FormulationError, match="drives the speed back from both sides"):
        simulate(held(100.0), formulation="multibody")
