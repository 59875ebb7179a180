"""Laws of mechanics that every run obeys, on random machines."""

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_scenes import scenes
from hypothesis import given, settings
from hypothesis import strategies as st

from crankmbs import Constant, Layout, Motion, Oscillation, Quadratic, Run, Start, Viscous, simulate
from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.pressure import pressures_of
from crankmbs.mechanics.reactions import reactions
from crankmbs.mechanics.train import CrankTrain, crank_train
from crankmbs.scene.run import Extent
from validation.random_scenes import random_scene

SENSES = st.sampled_from([1.0, -1.0])
few = settings(max_examples=12, deadline=None, derandomize=True, database=None)
RATE = 150.0  # rad/s: fast enough for these machines to turn through


@st.composite
def machines(draw, rtol=1e-10, **changes):
    """Random machines that turn through, with smooth loads, sampled at a few angles."""
    scene = draw(scenes())
    inertia, _, torque = reduce(crank_train(scene), np.linspace(0.0, 4 * np.pi, 500))
    speed = draw(SENSES) * max(RATE, 8.0 * math.sqrt(np.abs(torque).max() / inertia.min()))
    brake = 0.02 * inertia.min()
    loads = (
        Constant(torque=0.01 * inertia.min() * speed**2),
        Viscous(coefficient=brake * abs(speed)),
        Quadratic(coefficient=brake),
    )
    run = Run(until=Extent(value=2 * np.pi, unit="rad"), every="31 deg", rtol=rtol)
    start = Start(angle=0.3, speed=speed)
    return replace(scene, start=start, torque=loads, run=run, **changes)


def peak(values):
    return float(np.max(np.abs(values)))


def motion_of(data):
    return [data[name].values for name in ("crank_angle", "crank_speed", "crank_acceleration")]


@few
@given(machines(rtol=1e-8), st.sampled_from(["crank_angle", "minimal"]))
def test_energy_closes(scene, formulation):
    data = simulate(scene, formulation=formulation).data
    assert peak(data["energy_residual"]) < 1e-8 * peak(data["kinetic_energy"])


@pytest.mark.slow
@few
@given(machines(), st.sampled_from(["crank_angle", "minimal"]))
def test_inverse_after_forward_is_the_identity(scene, formulation):
    """The torque from outside that the motion needs is the one that the loads gave."""
    data = simulate(scene, formulation=formulation).data
    theta, omega, alpha = motion_of(data)
    constant, viscous, quadratic = scene.torque
    given_torque = (
        constant.torque - viscous.coefficient * omega - quadratic.coefficient * omega * abs(omega)
    )
    needed = reactions(crank_train(scene), theta, omega, alpha)
    scale = peak(needed["crank_torque"]) + peak(alpha) * scene.crank.inertia + peak(given_torque)
    assert peak(needed["external_torque"] - given_torque) < 1e-12 * scale
    assert peak(data["external_torque"].values - given_torque) < 1e-12 * scale


@few
@given(machines(), SENSES)
def test_forward_after_inverse_is_the_identity(scene, sense):
    """The acceleration that the drive torque gives is the prescribed one, sample by sample."""
    speed = Oscillation(mean=sense * RATE, amplitude=40.0, order=2.0)
    scene = replace(scene, start=None, torque=(), motion=Motion(speed=speed, angle=1.0))
    data = simulate(scene).data
    theta, omega, alpha = motion_of(data)
    inertia, slope, torque = reduce(crank_train(scene), theta)
    forward = (data["external_torque"].values + torque - 0.5 * slope * omega**2) / inertia
    scale = peak(alpha) + peak(torque / inertia) + peak(slope * omega**2 / inertia)
    assert peak(forward - alpha) < 1e-12 * scale


@few
@given(machines())
def test_power_flows(scene):
    """The rate of the kinetic energy is the power of gas, weight and outside at every instant."""
    pressure = pressures_of(scene)
    theta, omega, alpha = np.linspace(0.0, 6.0, 9), np.linspace(-200.0, 200.0, 9), 3e3
    found = reactions(CrankTrain(scene, pressure), theta, omega, alpha + 0.0 * theta)
    inertia, slope, _ = reduce(CrankTrain(scene, pressure), theta)
    rate = inertia * omega * alpha + 0.5 * slope * omega**3
    gas = (found["gas_force"] * found["piston_velocity"]).sum(axis=1)
    weight = reduce(CrankTrain(scene, None), theta)[2] * omega
    outside = found["external_torque"] * omega
    scale = peak(rate) + peak(gas) + peak(weight) + peak(outside)
    assert peak(rate - gas - weight - outside) < 1e-12 * scale
    np.testing.assert_allclose(found["kinetic_energy"], 0.5 * inertia * omega**2, rtol=1e-13)


@few
@given(machines(gravity=None))
def test_joint_forces_do_no_net_work(scene):
    """What the crank gives to the rods, the pistons take, less what rods and weights keep."""
    rod = replace(scene.rod, mass=0.0, inertia=0.0)
    scene = replace(scene, rod=rod)
    theta, omega = np.linspace(0.0, 6.0, 9), np.linspace(-200.0, 200.0, 9)
    found = reactions(crank_train(scene), theta, omega, 2e3 + 0.0 * theta)
    into_rods = -found["crank_torque"] * omega[:, None]
    out_of_rods = -found["piston_pin_force_x"] * found["piston_velocity"]
    np.testing.assert_allclose(into_rods, out_of_rods, atol=1e-12 * peak(into_rods) + 1e-300)


@few
@given(machines(gravity=None, gas=None, layout=Layout(firing_order=(1,))))
def test_mirror(scene):
    """Without offset and gravity a machine run backwards from -theta is the mirrored one."""
    scene = replace(scene, piston=replace(scene.piston, offset=0.0))
    start = Start(angle=-scene.start.angle, speed=-scene.start.speed)
    push = Constant(torque=-scene.torque[0].torque)
    mirrored = replace(scene, start=start, torque=(push, *scene.torque[1:]))
    one, other = simulate(scene).data, simulate(mirrored).data
    np.testing.assert_allclose(one["time"], other["time"], rtol=1e-9)
    for name, sign in (("crank_angle", -1), ("side_force", -1), ("crank_pin_force_x", 1)):
        difference = one[name].values - sign * other[name].values
        assert peak(difference) <= 1e-9 * peak(one[name])


@few
@given(machines(gas=None), st.floats(0.1, 10.0))
def test_scaling_of_mass(scene, factor):
    """All masses, pressures and loads times a factor: the same motion, forces times the factor."""
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    spin = rod.inertia if rod.inertia == "two-mass" else factor * rod.inertia
    constant, viscous, quadratic = scene.torque
    heavier = replace(
        scene,
        crank=replace(crank, mass=factor * crank.mass, inertia=factor * crank.inertia),
        rod=replace(rod, mass=factor * rod.mass, inertia=spin),
        piston=replace(piston, mass=factor * piston.mass),
        torque=(
            Constant(torque=factor * constant.torque),
            Viscous(coefficient=factor * viscous.coefficient),
            Quadratic(coefficient=factor * quadratic.coefficient),
        ),
    )
    one, other = simulate(scene).data, simulate(heavier).data
    np.testing.assert_allclose(one["time"], other["time"], rtol=1e-9)
    for name in ("main_bearing_force_x", "crank_pin_force_y", "kinetic_energy"):
        assert peak(factor * one[name].values - other[name].values) <= 2e-9 * peak(other[name])


@few
@given(machines(gravity=None, gas=None), st.floats(0.1, 10.0))
def test_scaling_of_length(scene, factor):
    """All lengths times f, inertias times f^2, no weight: forces f, torques f^2 times as large."""
    motion = np.linspace(0, 6, 9), 100.0, 2e3
    crank, rod, piston = scene.crank, scene.rod, scene.piston
    spin = rod.inertia if rod.inertia == "two-mass" else factor**2 * rod.inertia
    larger = replace(
        scene,
        crank=replace(
            crank,
            radius=factor * crank.radius,
            inertia=factor**2 * crank.inertia,
            center_of_mass=factor * crank.center_of_mass,
        ),
        rod=replace(
            rod,
            length=factor * rod.length,
            center_of_mass=factor * rod.center_of_mass,
            inertia=spin,
        ),
        piston=replace(piston, offset=factor * piston.offset),
    )
    one, other = (
        reactions(CrankTrain(s, None), *np.broadcast_arrays(*motion)) for s in (scene, larger)
    )
    for name, power in (("crank_pin_force_x", 1), ("side_force", 1), ("external_torque", 2)):
        assert peak(factor**power * one[name] - other[name]) <= 1e-9 * peak(other[name]), name


@pytest.mark.parametrize("ratio", [1e-3, 1e-5])
def test_a_long_rod_gives_the_harmonic_slider(ratio):
    """x = l + r cos(phi) up to r^2 / (2 l), whatever the rod weighs at its big end."""
    scene = replace(random_scene(0), gravity=None, gas=None)
    r = scene.crank.radius
    rod = replace(scene.rod, length=r / ratio, mass=0.0, inertia=0.0)
    scene = replace(scene, rod=rod, piston=replace(scene.piston, offset=0.0))
    theta = np.linspace(0.0, 6.0, 50)
    phi = theta[:, None] + np.array([c.phase for c in scene.cylinders])
    found = reactions(CrankTrain(scene, None), theta, 10.0 + 0.0 * theta, 0.0 * theta)
    assert peak(found["piston_position"] - r / ratio - r * np.cos(phi)) <= 0.5 * ratio * r * 1.01
    harmonic = 100.0 * r * np.cos(phi)
    assert peak(found["piston_acceleration"] - harmonic) <= 100.0 * r * ratio * 1.01
    assert peak(found["piston_acceleration"] - harmonic) >= 100.0 * r * ratio * 0.9


@pytest.mark.slow
@few
@given(machines(), st.sampled_from(["crank_angle", "minimal"]))
def test_time_reversal(scene, formulation):
    """Without losses a machine stopped and sent back runs back to where it came from."""
    scene = replace(scene, torque=scene.torque[:1])
    there = simulate(scene, formulation=formulation).data.isel(time=-1)
    back = Start(angle=there["crank_angle"].item(), speed=-there["crank_speed"].item())
    again = simulate(replace(scene, start=back), formulation=formulation).data.isel(time=-1)
    assert again["crank_angle"].item() == pytest.approx(scene.start.angle, abs=1e-12)
    assert again["time"].item() == pytest.approx(there["time"].item(), rel=1e-8)
    assert again["crank_speed"].item() == pytest.approx(-scene.start.speed, rel=1e-8)
