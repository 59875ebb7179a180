"""Between its samples a result is told to its stated error; where that cannot be it is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crankmbs import (
    Constant,
    Fuel,
    InputError,
    Result,
    Run,
    Table,
    TimeTable,
    load_scene,
    simulate,
)

CASES = {
    "propeller": ("1 cycles", "5 deg", "0.77 deg"),
    "v_twin": ("0.5 cycles", "2 deg", "0.77 deg"),
    "torque_driven": ("0.5 s", "1 deg", "0.77 deg"),
    "yi_diesel": ("1 rev", "5 deg", "0.77 deg"),
    "misfire": ("1 cycles", "2 deg", "0.77 deg"),
}


def asked(scene_named):
    """What was run with these samples, and what was run with others between them."""
    until, every, odd = CASES[scene_named]
    scene = load_scene(scene_named).with_(run__until=until)
    return simulate(scene.with_(run__every=every)), simulate(scene.with_(run__every=odd)).data


@pytest.fixture(scope="module", params=CASES)
def runs(request):
    return asked(request.param)


def worst_share(found, true):
    """Of the true errors in the sum of both stated ones, and how many variables there are."""
    shares = []
    for name, one in found.variables.items():
        if "error_estimate" in one.attrs:
            stated = one.attrs["error_estimate"] + true[name].attrs["error_estimate"]
            missed = np.max(np.abs(one.values - true[name].values))
            shares.append(0.0 if missed == 0.0 else missed / stated)
    return max(shares), len(shares)


def test_at_any_time_the_true_error_is_within_the_stated_one(runs):
    result, true = runs
    time = np.minimum(true["time"].values, result.data["time"].values[-1])
    share, count = worst_share(result.interp(time=time), true)
    assert share < 1.0
    assert count == len(result.data.variables) - 2  # cylinder, energy_residual


def test_at_any_angle_too(runs):
    result, true = runs
    share, _ = worst_share(result.interp(crank_angle=true["crank_angle"].values), true)
    assert share < 1.0


def test_lines_between_the_samples_would_be_far_off(runs):
    result, true = runs
    found = result.interp(time=np.minimum(true["time"].values, result.data["time"].values[-1]))
    line = np.interp(
        true["time"].values,
        result.data["time"].values,
        result.data["piston_pin_force_x"].values[:, 0],
    )
    stated = found["piston_pin_force_x"].attrs["error_estimate"]
    assert np.max(np.abs(line - true["piston_pin_force_x"].values[:, 0])) > 10.0 * stated


@pytest.fixture(scope="module")
def short():
    return simulate(load_scene("propeller").with_(run__until="1 rev"))


def test_at_a_sample_it_is_the_sample(short):
    middle = short.data.isel(time=[100])
    for found in (
        short.interp(time=middle["time"].values),
        short.interp(crank_angle=float(middle["crank_angle"].values[0])),
    ):
        for name in ("crank_speed", "main_bearing_force_y", "side_force"):
            stated = found[name].attrs["error_estimate"]
            np.testing.assert_allclose(found[name], middle[name], rtol=0.0, atol=stated)


def test_the_order_asked_for_is_kept(short):
    times = [0.01, 0.002, 0.005]
    assert short.interp(time=times)["time"].values.tolist() == times


def test_a_loaded_result_tells_the_same(short, tmp_path):
    again = Result.load(short.save(tmp_path))
    assert again.interp(time=[0.0123]).equals(short.interp(time=[0.0123]))


def test_backwards_an_angle_is_found_too():
    scene = load_scene("propeller").with_(run__until="1 rev", start__speed="-3000 rpm")
    result = simulate(scene)
    found = result.interp(crank_angle=[-1.0, -2.0])
    np.testing.assert_allclose(found["crank_angle"], [-1.0, -2.0], atol=1e-9)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "exactly one of the two; neither came"),
        ({"time": 0.0, "crank_angle": 0.0}, "exactly one of the two; both came"),
        ({"time": "noon"}, r'time must be numbers \[s\]; "noon" came'),
        ({"time": [0.001, math.nan]}, r"time must be finite numbers \[s\] in a row"),
        ({"time": [[0.001]]}, r"in a row; \[\[0.001\]\] came"),
        ({"time": []}, r"in a row; \[\] came"),
        ({"time": 9.0}, r"within what is kept of the run, 0 to 0.0\d+ s; 9 s came"),
        ({"crank_angle": -1.0}, r"within what is kept of the run, 0 to 6.2831\d+ rad; -1 rad came"),
    ],
)
def test_what_cannot_be_is_refused(short, given, said):
    with pytest.raises(InputError, match=said):
        short.interp(**given)


@pytest.mark.parametrize("every", ["3 rev", "0.01 s"])
def test_it_does_not_depend_on_the_samples(every):
    """Not even where these are revolutions apart."""
    wide, fine = (
        simulate(load_scene("torque_driven").with_(run=Run(until="9 rev", every=step)), rtol=rtol)
        for step, rtol in ((every, 1e-8), ("0.9 deg", 1e-13))
    )
    time = np.minimum(fine.data["time"].values, wide.data["time"].values[-1])
    share, _ = worst_share(wide.interp(time=time), fine.data)
    assert share < 1.0


def test_an_event_between_two_samples_is_where_it_is(short):
    brake = Constant(torque=-5.0, after=0.010001)
    result = simulate(short.scene.with_(torque=(brake,), run__every="30 deg"))
    torque = result.interp(time=[0.01 + 0.9e-6, 0.01 + 1.1e-6])["external_torque"].values
    assert torque[0] == 0.0
    assert torque[1] == -5.0


def test_a_share_that_is_decided_between_two_samples_is_decided_where_it_is():
    scene = replace(load_scene("misfire"), fuel=Fuel(scatter=0.3)).with_(run__until="1.5 cycles")
    result = simulate(scene.with_(run__every="7 deg"))
    true = simulate(scene.with_(run__every="0.77 deg")).data
    found = result.interp(time=np.minimum(true["time"].values, result.data["time"].values[-1]))
    apart = np.abs(found["fuel"].values - true["fuel"].values)
    assert np.max(apart) <= found["fuel"].attrs["error_estimate"] < 1e-12


@pytest.mark.parametrize(
    "load",
    [
        Constant(torque=-20.0, after=0.05),
        Constant(torque=-20.0, until=0.05),
        TimeTable(file=Table((0.0, 0.05, 0.05, 0.1), (0.0, 0.0, -20.0, -20.0))),
    ],
    ids=["sets in", "ends", "jumps"],
)
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_at_the_time_of_a_sample_it_is_the_sample(load, formulation):
    """Also where a load jumps at that time: what comes after counts."""
    scene = load_scene("coasting").with_(torque=(load,), run__until="0.1 s", run__every="0.01 s")
    data = simulate(scene, formulation=formulation)
    there = data.interp(time=data.data.time.values)
    for name in ("external_torque", "crank_acceleration", "main_bearing_force_x"):
        apart = np.abs(there[name].values - data.data[name].values).max()
        assert apart <= there[name].error_estimate
