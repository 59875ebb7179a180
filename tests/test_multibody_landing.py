"""Where a load bends or jumps, over time or over the speed, the multibody model lands on it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from references import assert_within_stated

from crankmbs.errors import FormulationError
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.multibody.landing import LEAST_STEPS, Bounds, Watch
from crankmbs.motion.multibody.problem import erratic_order, kink_times, problem_of
from crankmbs.motion.multibody.stepped import Stepped, coarsest_step, model_of, solve
from crankmbs.result import Result
from crankmbs.scene.drives import Motion, SpeedFile, Start
from crankmbs.scene.gas import Gas
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


def paths(scene: Scene, halvings: int) -> list[Stepped]:
    problem = problem_of(crank_train(scene))
    model = model_of(problem)
    step, _ = coarsest_step(problem, model)
    found = [solve(problem, model, step, k, lambda: True) for k in range(halvings)]
    model.close()
    return found


def speed_at_end(path: Stepped) -> float:
    last = path.tables[-1]
    return float(last.one_at("crank_speed", np.array([last.until]))[0])


@pytest.mark.parametrize("load", [BENT, *OVER_SPEED.values()], ids=["in time", *OVER_SPEED])
def test_order_two_stays_clean_over_bends_and_jumps(load: Torque) -> None:
    runs = paths(loaded(load), 4)
    assert len({len(run.tables) for run in runs}) == 1
    assert len(runs[0].tables) > 1
    first, second, third = np.diff([speed_at_end(run) for run in runs])
    assert first / second == pytest.approx(4.0, abs=0.1)
    assert second / third == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("load", [BENT, *OVER_SPEED.values()], ids=["in time", *OVER_SPEED])
def test_errors_are_honest_there(load: Torque) -> None:
    scene = loaded(load)
    result = simulate(scene, formulation="multibody", rtol=1e-5, cost_cap=60.0)
    exact = simulate(scene, rtol=1e-11)
    assert result.error.estimated <= 1e-5
    assert_within_stated(result, exact)


def test_stretches_meet_at_the_speed_of_a_row() -> None:
    (run,) = paths(loaded(OVER_SPEED["jump"]), 1)
    for table in run.tables[:-1]:
        speed = float(table.one_at("crank_speed", np.array([table.until]))[0])
        assert speed == pytest.approx(101.0, rel=1e-12)


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


def test_rows_over_time_are_landed_on_where_they_are_few() -> None:
    assert kink_times(problem_of(crank_train(loaded(BENT)))) == [0.013, 0.031]
    t = np.linspace(0.0, 0.1, 60)
    many = TimeTable(file=Table(t.tolist(), np.sin(99.0 * t).tolist()))
    problem = problem_of(crank_train(loaded(many)))
    assert kink_times(problem) == []
    assert erratic_order(problem) == 2


@pytest.mark.parametrize(
    ("interpolation", "rows", "order"),
    [("cubic", 12, 3), ("linear", 12, 2), ("step", 12, 3), ("step", 72, 1)],
)
def test_the_erratic_order_of_a_pressure(interpolation: str, rows: int, order: int) -> None:
    angle = np.arange(rows) * 2.0 * math.pi / rows
    table = Table(angle.tolist(), (1e5 * np.sin(angle)).tolist())
    gas = Gas(pressure=table, absolute=False, stroke=2, interpolation=interpolation)
    piston = replace(COASTING.piston, area=1e-3)
    assert (
        erratic_order(problem_of(crank_train(replace(COASTING, gas=gas, piston=piston)))) == order
    )


def test_the_erratic_order_of_a_speed_over_time() -> None:
    table = Table((0.0, 0.02, 0.04, 0.2), (100.0, 90.0, 120.0, 100.0))
    motion = Motion(speed=SpeedFile(file=table))
    assert erratic_order(problem_of(crank_train(replace(COASTING, start=None, motion=motion)))) == 2


def test_a_speed_that_comes_back_over_its_bound_still_ends_the_stretch() -> None:
    watch = Watch(Bounds((-math.inf, math.inf), (0.0, 100.0)), lambda: True)
    speeds = [100.0, 99.0, 100.1, *[99.9] * 20]
    went_on = [watch(0.0, omega) for omega in speeds]
    assert went_on.index(False) == LEAST_STEPS
    assert not watch.called_off
