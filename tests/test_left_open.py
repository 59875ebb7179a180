"""What a run leaves open: a starter that never lets go, an engine that does not start, a governor
that hunts."""

from dataclasses import replace

import pytest
from test_fuel import FOUR, GOVERNOR, RPM, fuelled

from crankmbs import Constant, Extent, Fuel, Run, Viscous, simulate

STARTER = Constant(torque=60.0, until_speed=400 * RPM)


def said(scene, status=0):
    result = simulate(scene)
    assert result.status == status, result.message
    return result.message


def test_an_engine_that_does_not_start_and_a_starter_that_never_lets_go():
    weak = replace(STARTER, torque=60.0), Viscous(coefficient=4.0)
    slow = replace(FOUR.start, speed=80 * RPM)
    scene = fuelled(Fuel(from_speed=150 * RPM), start=slow, torque=weak, cycles=1.0)
    text = said(scene, status=1)
    assert text.startswith("came to rest at")
    assert "fuel: from_speed, 150 rpm, was not met where shares are decided, and the" in text
    assert "torque[1]: until_speed, 400 rpm, was not met, and the load never let go" in text


def test_a_load_that_never_set_in():
    late = Viscous(coefficient=0.1, from_speed=9000 * RPM)
    text = said(replace(FOUR, torque=(*FOUR.torque, late), run=Run(until="1 cycle")))
    assert text.endswith("torque[2]: from_speed, 9000 rpm, was not met, and the load never set in")


def test_a_load_that_waits_for_a_time_behind_the_end():
    late = Viscous(coefficient=0.1, after=9.0)
    text = said(replace(FOUR, torque=(*FOUR.torque, late), run=Run(until="0.05 s")))
    assert text.endswith(
        "torque[2]: after, 9 s, is not before the end of the run, 0.05 s, and the load never set in"
    )
    soon = replace(late, after=0.01)
    assert "never" not in said(replace(FOUR, torque=(soon,), run=Run(until="0.05 s")))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gains", "hunts"), [({"kp": 1.0, "max": 5.0}, True), ({}, False), ({"max": 0.5}, False)]
)
def test_a_governor_that_hunts(gains, hunts):
    scene = fuelled(Fuel(governor=replace(GOVERNOR, **gains)), cycles=30.0)
    run = replace(scene.run, every=Extent(value=0.2, unit="rad"))
    assert ("the governor hunts" in said(replace(scene, run=run))) == hunts


def test_a_run_that_leaves_nothing_open_says_nothing():
    assert said(fuelled(Fuel(), cycles=1.0)) == "reached the end of the run"
