"""Every quantity at one crank angle: the formulation's own, with the lectures' names."""

import math
from dataclasses import replace

import numpy as np
import pytest
from command_line import crankmbs_, refused

from crankmbs import (
    Motion,
    Oscillation,
    Run,
    at_angle,
    lecture,
    load_scene,
    simulate,
)
from crankmbs.errors import InputError
from crankmbs.report.readings import reading_remarks

DIESEL = load_scene("yi_diesel")


def by_name(found, cylinder=None):
    return {r.quantity: r for r in found.readings if r.cylinder == cylinder}


@pytest.mark.slow
@pytest.mark.parametrize("formulation", ["crank_angle", "minimal"])
def test_it_is_the_sample_that_lies_there(formulation):
    """At an angle that the samples have, to their errors."""
    scene = replace(load_scene("yi_diesel_free"), run=Run(until="1.5 cycles", every="1 deg"))
    result = simulate(scene, formulation=formulation)
    found = at_angle(result, "-660 deg")
    assert found.crank_angle == pytest.approx(math.radians(780.0), abs=1e-12)
    k = int(np.argmin(np.abs(result.data["crank_angle"].values - found.crank_angle)))
    assert found.time == pytest.approx(result.data["time"].values[k], rel=1e-9)
    for reading in found.readings:
        if reading.quantity in result.data:
            at = result.data[reading.quantity]
            value = at.values[k] if reading.cylinder is None else at.values[k, reading.cylinder - 1]
            allowed = 2.0 * (reading.error + at.attrs["error_estimate"])
            assert abs(reading.value - value) <= allowed, reading


def test_an_angle_between_the_samples_is_exact():
    law = Oscillation(mean=300.0, amplitude=30.0, order=2.0, phase=0.4)
    run = Run(until="2 cycles", every="45 deg")
    scene = replace(DIESEL, motion=Motion(speed=law, angle=0.2), run=run)
    found = at_angle(simulate(scene), 1.2345)
    theta = 1.2345 + scene.period  # the cycle is from 2.2 to 4.2 times 2 pi
    assert found.crank_angle == pytest.approx(theta, abs=1e-12)
    speed = by_name(found)["crank_speed"]
    assert speed.value == pytest.approx(300.0 + 30.0 * math.cos(2.0 * theta + 0.4), rel=1e-13)
    assert speed.units == "rad/s"


def test_the_lectures_forces_go_together_as_is_said():
    """Of a crank that speeds up, with a rigid rod, and with one of two masses without weight."""
    free = load_scene("yi_diesel_free").with_(run__until="1 cycle", gravity=None)
    for scene in free, free.with_(rod=replace(free.rod, inertia="two-mass")):
        state = simulate(scene).at("375 deg")
        found = {name: each.value for name, each in by_name(state, 1).items()}
        alpha = by_name(state)["crank_acceleration"].value
        rod, r = scene.rod, scene.crank.radius
        mass = rod.mass * (1.0 - rod.center_of_mass / rod.length)
        assert abs(alpha) > 100.0
        torque = found["tangential force"] * r - mass * r**2 * alpha
        assert found["torque"] == pytest.approx(torque, rel=1e-11)
        (line,) = (each for each in reading_remarks(state) if "M_k = F_T r - m r^2 alpha" in each)
        assert f"m = {mass:.6g} kg" in line
    across = found["tangential force"], found["radial force"]
    along = found["net force"] / math.cos(found["rod_angle"])
    assert [abs(found["rod force"]), abs(along)] == pytest.approx([math.hypot(*across)] * 2)


@pytest.mark.parametrize("angle", ["0 deg", "720 deg", -4.0 * math.pi, 1e-11])
def test_the_end_of_the_cycle_counts_and_not_its_beginning(angle):
    result = simulate(replace(DIESEL, run=Run(until="2 cycles", every="30 deg")))
    assert at_angle(result, angle).crank_angle == pytest.approx(8.0 * math.pi, abs=1e-9)


def test_the_lectures_forces_of_a_two_mass_rod_are_the_lectures():
    """F_v = gas and inertia of m_A, N = F_v tan(beta), F_T and F_R: exact for that rod."""
    rod = replace(DIESEL.rod, inertia="two-mass")
    found = at_angle(simulate(replace(DIESEL, rod=rod, gravity=None)), "400 deg")
    one = by_name(found, 1)
    masses = lecture.two_mass_rod(
        rod_mass=rod.mass, rod_length=rod.length, center_of_mass=rod.center_of_mass
    )
    swung = DIESEL.piston.mass + masses.piston_pin
    net = one["gas_force"].value - swung * one["piston_acceleration"].value
    beta, phi = one["rod_angle"].value, math.radians(400.0)
    expected = {
        "net force": (net, "F_v"),
        "side thrust": (net * math.tan(beta), "N"),
        "rod force": (net / math.cos(beta), "F_oj"),
        "tangential force": (net * math.sin(phi + beta) / math.cos(beta), "F_T"),
        "radial force": (net * math.cos(phi + beta) / math.cos(beta), "F_R"),
        "torque": (net * math.sin(phi + beta) / math.cos(beta) * DIESEL.crank.radius, "M_k"),
    }
    for name, (value, symbol) in expected.items():
        assert one[name].value == pytest.approx(value, rel=1e-11), name
        assert one[name].symbol == symbol
        assert 0.0 < one[name].error < 1e-6 * abs(value)


@pytest.mark.parametrize("degrees", [60.0, 720.0])
def test_of_a_settled_motion_it_is_the_settled_one(degrees):
    free = load_scene("yi_diesel_free")
    result = simulate(replace(free, run=Run(until="settled")))
    found = at_angle(result, math.radians(degrees))
    (speed,) = (one for one in found.readings if one.quantity == "crank_speed")
    k = round(degrees)  # a sample a degree
    assert found.time == pytest.approx(result.data["time"].values[k], rel=1e-12)
    assert speed.value == pytest.approx(result.data["crank_speed"].values[k], rel=1e-12)


def test_what_cannot_be_looked_up_is_refused():
    short = simulate(replace(DIESEL, run=Run(until="1 rev")))
    with pytest.raises(InputError, match="last whole cycle"):
        at_angle(short, 0.0)
    result = simulate(DIESEL)
    rounded = "rounded away"
    refusals = {math.nan: rounded, "1e300 deg": rounded, "60 mm": "angle", "60": "unit"}
    for angle, said in refusals.items():
        with pytest.raises(InputError, match=said):
            at_angle(result, angle)


@pytest.mark.slow
@pytest.mark.parametrize("angle", [["30 deg", "60 deg"], None, True, 1.0j])
def test_what_is_no_angle_is_refused_in_a_sentence(angle):
    result = simulate(load_scene("propeller").with_(run__until="1 cycles"))
    with pytest.raises(InputError, match=r'one number \[rad\], or text .* "60 deg"; .* came; of'):
        result.at(angle)
    assert result.at(np.float64(1.0)).readings == result.at(1.0).readings


def test_where_the_crank_turns_back_an_angle_has_no_one_time():
    with pytest.raises(InputError, match="rests or turns back"):
        at_angle(simulate(load_scene("run_down")), "60 deg")


@pytest.mark.slow
def test_on_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = ("--no-figures", "--orders", "--at", "60 deg", "--at", "1 rad")
    done = crankmbs_("run", "yi_diesel", *options)
    assert done.exit_code == 0
    for text in (
        "at 60 deg of the",
        "at 57.2957795 deg",
        "F_oj",
        "crank speed [rpm]",
        "orders over",
    ):
        assert text in done.stdout
    written = tmp_path / "results" / "yi_diesel" / "orders.csv"
    rows = np.genfromtxt(written, delimiter=",", skip_header=1)
    assert rows.shape == (24, 19)
    assert "--at: " in refused("run", "yi_diesel", "--at", "60 mm")
    assert "--at: the crank angle" in refused("run", "yi_diesel", "--at", "1e300 deg")
