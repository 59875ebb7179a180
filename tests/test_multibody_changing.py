"""Windows, pressures by cylinder and functions of Python, confirmed by multibody: exudyn's own
coordinates against the oracle that goes from event to event."""

from dataclasses import replace

import pytest

from crankmbs import Constant, Extent, Gas, Load, Quadratic, Run, Table, load_scene, simulate
from crankmbs.scene.scene import Scene
from validation.checks.changing import compared
from validation.oracles.changes import Line, Pull
from validation.random_changes import function_with

pytestmark = pytest.mark.slow

TWIN = load_scene("v_twin")
SHORT = Run(until=Extent(value=0.012, unit="s"), every=Extent(value=0.001, unit="s"), rtol=1e-5)
ROWS = (0.0, 3.0, 5.5, 6.2, 6.8, 8.0, 10.0)


def table(share):
    return Table(ROWS, tuple(share * p for p in (1e5, 1e5, 8e5, 4e6, 2e6, 4e5, 1.5e5)))


def bent(t, theta, omega):
    return -8000.0 * abs(t - 0.0053)


BENT = function_with(
    bent,
    Pull(
        over_time=Line(
            (0.0053,), (lambda t: 8000.0 * (t - 0.0053), lambda t: -8000.0 * (t - 0.0053))
        )
    ),
)
CASES = {
    "windows": {
        "torque": (
            Constant(torque=-60.0, after=0.004, until=0.0091),
            Quadratic(coefficient=3e-4, from_speed=417.0, until_speed=410.0),
        )
    },
    "windows that open at one time": {
        "torque": (
            Constant(torque=-60.0, after=0.005),
            Constant(torque=40.0, until=0.005),
            Constant(torque=-20.0, after=0.005, until=0.009),
        )
    },
    "pressures by cylinder": {
        "gas": Gas(pressure=(table(1.0), table(1.4)), ambient="1 bar"),
    },
    "a function of Python": {"torque": (Load(BENT, kink_times=(0.0053,)),)},
}


@pytest.mark.parametrize("name", CASES)
def test_multibody_confirms(name):
    scene: Scene = replace(TWIN, gas=CASES[name].get("gas"), run=SHORT)
    scene = replace(scene, torque=CASES[name].get("torque", TWIN.torque))
    result = simulate(scene, formulation="multibody", cost_cap=120.0)
    assert result.status == 0, result.message
    for variable, error in compared(result, scene).items():
        assert error.low() <= 2.0, (variable, error)
        if "acceleration" not in variable:
            assert error.stated <= 1e-3 * error.peak, (variable, error)
