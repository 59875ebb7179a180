"""Time as the variable: at rest, backwards, through stops, and the errors it states."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest
from references import reference_of, true_errors, worst_ratio

from crankmbs import (
    Constant,
    Gas,
    Quadratic,
    Run,
    SpeedTable,
    Start,
    Table,
    TimeTable,
    load_scene,
    simulate,
)
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.torque import branch_of
from crankmbs.mechanics.train import crank_train
from crankmbs.motion.minimal.equation import Equation
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.mode import begun
from validation.random_scenes import random_scene

COASTING, PROPELLER = load_scene("coasting"), load_scene("propeller")
HEAVY = replace(COASTING.crank, inertia=3e3)


def scene(base=COASTING, **changes):
    return replace(base, **changes)


RAMPS = TimeTable(file=Table((0.0, 0.013, 0.04, 0.06, 0.08), (1e6, 1.4e7, 5e6, -4e6, 2e7)))
EDGES = SpeedTable(file=Table((-168.0, -52.0, -52.0, -10.0), (1.4e6, 1.4e7, 4.5e6, 5.3e6)))
HARD = {
    # the work done is a polynomial here, and its error estimate far above the one of the speed
    "flywheel": scene(
        crank=HEAVY,
        start=Start(angle=4.7, speed=-185.0),
        torque=(RAMPS, EDGES),
        run=Run(until="0.078 s", every="5 ms", rtol=4e-8),
    ),
    # a step or two from row to row, whatever the tolerance
    "few steps": scene(
        gravity=None,
        start=Start(angle=5.3, speed=0.0),
        torque=(
            TimeTable(file=Table((0.0, 0.013, 0.031, 0.031, 0.04), (-0.1, -0.2, -0.0, -0.1, 0.1))),
            Quadratic(coefficient=4e-6),
        ),
        run=Run(until="0.039 s", every="2 ms", rtol=2e-5),
    ),
    # whatever rounds the angle first grows a thousand million times
    "beside dead centre": scene(
        PROPELLER,
        gravity=None,
        start=Start(angle=2.0 * pi + 1e-9, speed=0.0),
        torque=(),
        run=Run(until="0.2 s", every="30 deg"),
    ),
    "a load sets in backwards, at rest in dead centre on a step of the pressure": scene(
        gravity=None,
        gas=Gas(
            pressure=Table((0.0, 1.0, 4.0), (2e5, -1e5, 3e5)),
            absolute=False,
            stroke=2,
            interpolation="step",
        ),
        piston=replace(COASTING.piston, area=1e-3),
        start=Start(angle=0.0, speed=0.0),
        torque=(TimeTable(file=Table((0.0, 0.02, 0.2, 1.0), (0.0, 0.0, -0.05, -0.05))),),
        run=Run(until="0.3 s", every="30 deg"),
    ),
    "stall and swing back": scene(
        PROPELLER, start=Start(angle=0.0, speed="60 rpm"), run=Run(until="2 s", every="30 deg")
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HARD)
def test_the_error_is_honest(name):
    result = simulate(HARD[name], formulation="minimal")
    assert result.status == 0
    assert result.error.estimated <= 1e-4
    errors = true_errors(result, reference_of(result))
    ratios = {variable: error.ratio for variable, error in errors.items()}
    assert max(ratios.values()) <= 2.0, ratios


@pytest.mark.parametrize("speed", [335.0, -335.0])
def test_on_a_step_of_the_pressure_the_value_after_it_counts(speed):
    """In the acceleration as in the gas force, so the two answer to one another."""
    stepped = scene(
        PROPELLER,
        gas=replace(PROPELLER.gas, interpolation="step"),
        start=Start(angle=0.0, speed=speed),
        run=Run(until="720 deg", every="10 deg"),
    )
    found = simulate(stepped, formulation="minimal").data
    names = ("crank_angle", "crank_speed", "crank_acceleration")
    needed = reactions(crank_train(stepped), *(found[name].values for name in names))
    scale = np.abs(found["crank_torque"]).max().item()
    assert np.abs(needed["external_torque"] - found["external_torque"]).max() < 1e-12 * scale


@pytest.mark.parametrize("rtol", [1e-4, 1e-9])
def test_a_start_that_soon_turns_passes_its_first_angle_again(rtol):
    """However long the first step, the reversal in it is found."""
    load = TimeTable(file=Table((0.0, 0.02, 9.0), (-1e-2, 1e-2, 1e-2)))
    begin = scene(gravity=None, start=Start(angle=0.5, speed=0.0), torque=(load,))
    run = Run(until="1 s", every="30 deg", rtol=rtol)
    found = simulate(replace(begin, run=run), formulation="minimal").data
    assert found["crank_angle"].values[:2].tolist() == [0.5, 0.5]
    assert found["time"].values[1] == pytest.approx(0.03, rel=0.3)


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
def test_the_tolerance_is_kept(rtol):
    result = simulate(HARD["stall and swing back"], formulation="minimal", rtol=rtol)
    assert 0.0 < result.error.estimated <= rtol


@pytest.mark.parametrize("state", [(0.3, 1e160), (1e160, 1e160), (0.3, inf), (1e300, 1.0)])
def test_a_trial_step_far_too_long_is_no_number(state):
    train = crank_train(PROPELLER)
    pieces = Reduced(train).at(begun(train))
    branch = branch_of(PROPELLER.torque, 0.0, 1.0, rising=True)
    equation = Equation(pieces, pieces.around(0.3, 1.0), branch)
    slopes = equation.slopes(0.0, np.array([*state, 0.0]))
    assert not np.isfinite(slopes).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "begins"),
    [
        ({"gravity": None, "start": Start(angle=0.5, speed=0.0)}, "at rest at 28.6479 degrees"),
        (
            {
                "gravity": None,
                "start": Start(angle=0.5, speed=0.0),
                "torque": (
                    SpeedTable(file=Table((-9.0, 0.0, 0.0, 9.0), (5.0, 5.0, -5.0, -5.0))),
                    Constant(torque=4.0),
                ),
            },
            "held at 0 rpm",
        ),
        ({"torque": (Quadratic(coefficient=1.0),)}, "swings without reaching the end"),
    ],
)
def test_physical_ends(changes, begins):
    result = simulate(scene(**changes, run=Run(until="3 rev", rtol=1e-6)), formulation="minimal")
    assert result.status == 1
    assert result.message.startswith(begins)
    assert np.isfinite(result.data["main_bearing_force_x"]).all()


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_a_pressure_step_just_before_a_reversal_counts(formulation):
    """Two thousandths of a radian behind it the crank turns back, within the same long step."""
    result = simulate(random_scene(848), formulation=formulation)
    assert worst_ratio(result) <= 2.0
