"""Prescribed speeds: exact samples, the drive's torque, and where a law stops short."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

from crankmbs import (
    Crank,
    InputError,
    Motion,
    Oscillation,
    Piston,
    Ramp,
    Rod,
    Run,
    SpeedFile,
    Table,
    load_scene,
    simulate,
)
from validation.adapter import reference_variables

BASE = load_scene("yi_diesel")
SPEEDS = {
    "constant": 300.0,
    "backwards": -300.0,
    "oscillation": Oscillation(mean=300.0, amplitude=20.0, order=2.0, phase=0.4),
    "ramp": Ramp(start=200.0, to=400.0, over=0.02),
    "table": SpeedFile(file=Table((0.0, 0.01, 0.03, 0.2), (200.0, 300.0, 250.0, 400.0))),
    "reversing": Ramp(start=300.0, to=-300.0, over=0.04),
}


def scene(speed, until="40 ms", every="1 ms"):
    return replace(BASE, motion=Motion(speed=speed), run=Run(until=until, every=every))


@pytest.mark.parametrize("name", SPEEDS)
def test_every_variable_and_its_error(name):
    """Against the oracle at the same motion; the stated error covers what rounding leaves."""
    result = simulate(scene(SPEEDS[name]))
    assert (result.status, result.formulation) == (0, "kinetostatic")
    motion = ("crank_angle", "crank_speed", "crank_acceleration")
    state = [result.data[part].values for part in motion]
    for variable, exact in reference_variables(result.scene, *state).items():
        ours = result.data[variable]
        error = np.abs(ours.values - exact.astype(float)).max()
        assert error <= 2.0 * ours.attrs["error_estimate"], variable
        assert ours.attrs["error_estimate"] <= 1e-11 * np.abs(ours.values).max(), variable
    assert result.error.estimated < 1e-11


@pytest.mark.parametrize("name", SPEEDS)
def test_energy_closes(name):
    data = simulate(scene(SPEEDS[name])).data
    work = np.ptp(data["kinetic_energy"].values) + data["kinetic_energy"].values.max()
    assert np.abs(data["energy_residual"].values).max() < 1e-11 * work


def test_a_reversing_crank_is_sampled_in_angle_on_both_ways():
    angle = simulate(scene(SPEEDS["reversing"], every="30 deg")).data["crank_angle"].values
    turn = int(np.argmax(angle))
    assert 0 < turn < len(angle) - 1
    np.testing.assert_allclose(angle[:turn], angle[-1 : turn + 1 : -1][:turn], atol=1e-9)


@pytest.mark.parametrize(
    ("mean", "phase"), [(553.0, 30.0), (553.0, 88.0), (553.0, 142.0), (-553.0, 77.0)]
)
def test_the_sample_at_the_start_comes_once(mean, phase):
    """The law's own angle at time 0 rounds to a hair before it."""
    law = Oscillation(mean=f"{mean} rpm", amplitude="24 rpm", order=4.0, phase=f"{phase} deg")
    data = simulate(scene(law, until="0.5 rev", every="1 deg")).data
    assert data.sizes["time"] == 181
    assert np.all(np.diff(data["time"]) > 0.0)


@pytest.mark.parametrize(("speed", "degrees"), [(100.0, 218.0), (250.0, 250.0), (300.0, 274.0)])
def test_a_sample_on_which_the_crank_turns_back_comes_once(speed, degrees):
    law = Ramp(start=speed, to=-speed, over=4.0 * np.radians(degrees) / speed)
    data = simulate(scene(law, until=f"{law.over} s", every="1 deg")).data
    assert np.diff(data["time"]).min() > np.radians(0.9) / speed


def test_a_speed_that_comes_to_rest_ends_the_run():
    result = simulate(scene(Ramp(start=300.0, to=0.0, over=0.02), until="3 rev", every="10 deg"))
    assert result.status == 1
    assert "the prescribed speed comes to rest at 171.887 degrees" in result.message
    assert result.data["crank_angle"].values[-1] == pytest.approx(3.0, rel=1e-14)


MASSLESS = [Crank(radius=0.05, inertia=0.0), Crank(radius=0.05)]


@pytest.mark.parametrize("crank", MASSLESS, ids=["0", "left out"])
@pytest.mark.parametrize(("formulation", "close"), [("kinetostatic", 1e-13), ("multibody", 1e-6)])
def test_a_driven_piston_alone_needs_no_inertia(crank, formulation, close):
    """The textbook's machine: F = m r omega^2 (1 + lambda) at the top dead centre."""
    bare = replace(BASE, crank=crank, rod=Rod(length=0.2), piston=Piston(mass=1.0), gas=None)
    run = Run(until="1 rev", rtol=1e-5)
    result = simulate(replace(bare, motion=Motion(speed=300.0), run=run), formulation=formulation)
    assert result.status == 0
    force, torque = result.data["main_bearing_force_x"], result.data["external_torque"]
    assert force.values[0] == pytest.approx(-0.05 * 300.0**2 * 1.25, rel=close)
    assert 0.0 < torque.attrs["error_estimate"] < 1e-6 * np.abs(torque.values).max()


def test_a_table_that_ends_before_the_run():
    with pytest.raises(InputError, match=r"the speed table ends at 0.2 s, before the run does"):
        simulate(scene(SPEEDS["table"], until="30 rev"))


@pytest.mark.parametrize("every", ["1 deg", "1 ms"])
def test_at_rest_for_a_time(every):
    result = simulate(scene(0.0, until="10 ms", every=every))
    assert result.status == 0
    assert result.data["time"].values[-1] == 0.01
    assert np.all(result.data["crank_angle"] == 0.0)


@pytest.mark.parametrize(("until", "samples"), [("7.3 rev", 361), ("0.31 s", 362)])
def test_the_last_cycle_alone_is_that_of_the_whole_run(until, samples):
    scene = load_scene("compressor")
    last, whole = (
        simulate(replace(scene, run=Run(until=until, every=every))).data
        for every in ("none", "1 deg")
    )
    kept = whole.isel(time=slice(-last.sizes["time"], None))
    assert last.sizes["time"] == samples
    for name in ("time", "crank_angle", "crank_speed", "side_force"):
        np.testing.assert_allclose(last[name], kept[name], rtol=1e-12, atol=1e-9)


def test_a_hundred_thousand_cycles_take_no_more_memory_than_one():
    run = Run(until="100000 cycles", every="none")
    scene = replace(
        load_scene("propeller"), start=None, motion=Motion(speed=1000.0), torque=(), run=run
    )
    assert simulate(scene).data.sizes["time"] == 721


@pytest.mark.parametrize("until", ["3 rev", "1000 rev"])
@pytest.mark.parametrize(("amplitude", "angle"), [(20.0, 0.0), (20.0, 1e4), (99.99999, 0.0)])
def test_an_oscillating_speed_errs_by_no_more_than_it_states_however_far_it_turns(
    amplitude, angle, until
):
    """At the angles of the samples the law is known in any number of digits."""
    law = Oscillation(mean=100.0, amplitude=amplitude, order=3.7, phase=1.0)
    motion = Motion(speed=law, angle=angle)
    scene = BASE.with_(gas=None, motion=motion, run__until=until, run__every="197 deg")
    data = simulate(scene).data
    with mpmath.workdps(30):
        psi = [mpmath.mpf(law.order) * mpmath.mpf(at) + 1 for at in data["crank_angle"].values]
        speed = [law.mean + law.amplitude * mpmath.cos(each) for each in psi]
        rate = [
            -law.amplitude * law.order * mpmath.sin(each) * now
            for each, now in zip(psi, speed, strict=True)
        ]
    for name, exact in (("crank_speed", speed), ("crank_acceleration", rate)):
        off = np.abs(data[name].values - np.array(exact, dtype=float)).max()
        assert off <= 2.0 * data[name].attrs["error_estimate"], name
