"""Known end states and figures of other computations, each to its promised digits."""

import pytest

from crankmbs import load_scene, simulate
from validation.oracles import end_states
from validation.oracles.arithmetic import distance

pytestmark = pytest.mark.slow

COMPUTED = {  # by another integration, to rounding
    "crank_angle": "14.1278922178",
    "crank_speed": "20.5374828514",
    "crank_acceleration": "123.421388171",
    "piston_position": "0.283771692112",
    "piston_pin_force_x": "0.8545563871",
    "piston_pin_force_y": "1.1996653402",
    "crank_pin_force_x": "-0.2050844426",
    "crank_pin_force_y": "-3.0065884395",
}


@pytest.mark.parametrize(
    ("formulation", "rtol", "within"), [("crank_angle", 1e-12, 1e-11), ("minimal", 1e-10, 1e-8)]
)
@pytest.mark.parametrize("name", ["coasting", "propeller"])
def test_end_states(name, formulation, rtol, within):
    end = simulate(load_scene(name), formulation=formulation, rtol=rtol).data.isel(time=-1)
    theta, omega = end_states.stored()[name]
    assert end["time"].item() == float(end_states.CASES[name].time)
    assert distance(end["crank_angle"].item(), theta) < within * float(theta)
    assert distance(end["crank_speed"].item(), omega) < within * float(omega)


@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_computed_figures_of_the_driven_slider_crank(formulation):
    result = simulate(load_scene("torque_driven"), formulation=formulation, rtol=1e-12)
    assert result.status == 0
    end = result.data.isel(time=-1)
    for name, text in COMPUTED.items():
        last_digit = 10.0 ** -len(text.split(".")[1])
        near = last_digit if formulation == "crank_angle" else end[name].attrs["error_estimate"]
        assert distance(end[name].item(), text) <= max(near, last_digit), name
