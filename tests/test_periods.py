"""Whole periods at once: the same motion as period by period, and no drift."""

import dataclasses

import numpy as np
import pytest

from crankmbs import Constant, Quadratic, Run, Start, load_scene, simulate

LOADS = {
    "none": (),
    "braked": (Quadratic(coefficient=1e-5), Constant(torque=-0.02)),
}


@pytest.mark.parametrize("loads", LOADS)
@pytest.mark.parametrize("speed", [150.0, -150.0])
@pytest.mark.parametrize("until", ["60 rev", "3 s"])
def test_the_last_period_is_the_same_whether_the_others_are_kept_or_not(
    loads: str, speed: float, until: str
) -> None:
    scene = dataclasses.replace(
        load_scene("coasting"), torque=LOADS[loads], start=Start(angle=0.4, speed=speed)
    )
    every, only_last = (
        simulate(dataclasses.replace(scene, run=Run(until=until, every=e, rtol=1e-9)))
        for e in ("1 deg", "none")
    )
    kept = only_last.data.sizes["time"]
    assert kept >= 361
    assert every.data.sizes["time"] > 10 * kept
    for name in ("time", "crank_angle", "crank_speed", "crank_acceleration", "side_force"):
        a, b = (np.asarray(r.data[name])[-kept + 1 :] for r in (every, only_last))
        scale = np.max(np.abs(np.asarray(every.data[name])))
        assert np.max(np.abs(a - b)) < 1e-12 * scale, name


def test_a_hundred_thousand_turns_keep_their_energy() -> None:
    scene = dataclasses.replace(
        load_scene("coasting"), run=Run(until="100000 rev", every="none", rtol=1e-9)
    )
    result = simulate(scene)
    assert scene.start is not None
    assert abs(float(result.data.crank_speed[-1]) / scene.start.speed - 1.0) < 1e-11
    assert result.cost.steps > 1e7


@pytest.mark.slow
def test_a_brake_stops_the_crank_after_many_turns_at_the_same_place() -> None:
    scene = dataclasses.replace(load_scene("coasting"), torque=(Constant(torque=-0.3),))
    every, only_last = (
        simulate(dataclasses.replace(scene, run=Run(until="40 s", every=e, rtol=1e-9)))
        for e in ("1 deg", "none")
    )
    assert every.status == only_last.status
    assert every.message == only_last.message
    assert float(every.data.time[-1]) == pytest.approx(float(only_last.data.time[-1]), rel=1e-9)
    assert float(every.data.crank_angle[-1]) == pytest.approx(
        float(only_last.data.crank_angle[-1]), rel=1e-9
    )
