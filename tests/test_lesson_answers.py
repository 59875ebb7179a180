"""The answers on the lesson pages against closed forms, oracles and an own integration."""

import dataclasses
import functools
import math
import re
from importlib import import_module

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from crankmbs import load_scene, simulate
from crankmbs.scene.run import SETTLED
from validation.adapter import reference_variables

pytestmark = pytest.mark.slow

_DATA = re.compile(r'<data id="(\w+)" value="([^"]+)"(?: data-error="([^"]+)")?>')


@functools.cache
def lesson(name):
    module = import_module(f"crankmbs.lessons.{name}")
    return module.lesson(load_scene(module.SCENE))


@functools.cache
def answers(name):
    """The numbers of a lesson's answers and captions: id -> value in the unit shown."""
    made = lesson(name)
    found = [match for text in made.texts for match in _DATA.findall(text)]
    said = {match[:2] for match in found}
    assert len({key for key, _ in said}) == len(said)  # a number has one value wherever it stands
    return {key: float(value) for key, value, _ in found}


def position(phi, ratio):
    """Piston displacement of a central gear over its crank radius, in mpmath."""
    return 1 - mpmath.cos(phi) + (1 - mpmath.sqrt(1 - (ratio * mpmath.sin(phi)) ** 2)) / ratio


def test_displacement():
    said, r, l = answers("displacement"), 40.0, 140.0
    exact = l - math.sqrt(l * l - r * r)
    assert said["brix_exact"] == pytest.approx(exact, rel=1e-12)
    assert said["brix_simulated"] == pytest.approx(exact, rel=1e-12)
    assert said["brix_series"] == pytest.approx(r * r / l / 2.0)
    half = mpmath.findroot(lambda phi: position(phi, r / l) - 1, 1.4)
    assert said["half_angle"] == pytest.approx(math.degrees(half))
    assert said["half_stroke"] == pytest.approx(r, rel=1e-12)
    rod = mpmath.findroot(lambda x: x - mpmath.sqrt(x * x - r * r) - 0.02 * 2 * r, 500)
    assert said["rod_exact"] == pytest.approx(float(rod))
    assert said["rod_series"] == pytest.approx(500.0)
    assert said["share"] == pytest.approx(2.0, rel=1e-12)


def test_acceleration():
    said, r, ratio, omega = answers("acceleration"), 0.04, 40 / 140, 100.0 * math.pi
    third = lambda phi: mpmath.diff(lambda x: position(x, ratio), phi, 3)  # noqa: E731
    at = mpmath.findroot(third, 2.7)
    assert said["minimum_exact"] == pytest.approx(math.degrees(at))
    assert said["minimum"] == pytest.approx(math.degrees(at), abs=0.011)
    assert said["minimum_series"] == pytest.approx(math.degrees(math.acos(-0.25 / ratio)))
    second = lambda phi: float(mpmath.diff(lambda x: position(x, ratio), phi, 2))  # noqa: E731
    assert said["least"] == pytest.approx(r * omega**2 * second(at), rel=1e-10)
    assert said["at_bottom"] == pytest.approx(-r * omega**2 * (1.0 - ratio))
    fastest = mpmath.findroot(lambda phi: mpmath.diff(lambda x: position(x, ratio), phi, 2), 1.3)
    speed = float(mpmath.diff(lambda x: position(x, ratio), fastest)) * r * omega
    assert said["speed"] == pytest.approx(speed, rel=1e-8)
    assert said["speed_exact"] == pytest.approx(speed)
    assert said["speed_angle"] == pytest.approx(math.degrees(fastest))
    assert said["fastest_at"] == pytest.approx(math.degrees(fastest), abs=0.011)
    limit = mpmath.findroot(lambda x: mpmath.diff(lambda phi: position(phi, x), mpmath.pi, 4), 0.26)
    assert float(limit) == pytest.approx(0.26376, abs=1e-5)
    assert said["rod_exact"] == pytest.approx(40.0 / float(limit))
    assert said["limit_angle"] == pytest.approx(180.0, abs=0.011)


def test_forces():
    said, scene = answers("forces"), load_scene("yi_diesel")
    theta = np.radians(np.arange(0.0, 720.0, 0.25))
    speed = np.full_like(theta, scene.motion.speed)
    still = np.zeros_like(theta)
    lumped = dataclasses.replace(scene, rod=dataclasses.replace(scene.rod, inertia="two-mass"))
    rigid, two = (reference_variables(s, theta, speed, still) for s in (scene, lumped))
    side, side_two = (v["side_force"][:, 0].astype(float) * 1e-3 for v in (rigid, two))
    assert said["side_peak"] == pytest.approx(side.max(), rel=2e-5)
    assert said["side_angle"] == pytest.approx(np.argmax(side) * 0.25, abs=0.3)
    assert said["side_two_masses"] == pytest.approx(side_two.max(), rel=2e-5)
    assert said["side_two_angle"] == pytest.approx(np.argmax(side_two) * 0.25, abs=0.3)
    missing = np.abs(side_two - side) * 1e3
    for key in ("missing", "missing_formula"):
        assert said[key] == pytest.approx(missing.max(), rel=1e-6)
    assert said["missing_angle"] == pytest.approx(np.argmax(missing) * 0.25 % 360.0)
    assert said["torque_peak"] == pytest.approx(rigid["crank_torque"].max(), rel=2e-4)
    assert said["torque_two"] == pytest.approx(two["crank_torque"].max(), rel=2e-4)
    table = scene.gas.pressure
    pressure = CubicSpline(table.x, table.y, bc_type="periodic")
    sine = (0.046 * np.sin(theta) - scene.piston.offset) / scene.rod.length
    travel = -0.046 * np.cos(theta) - scene.rod.length * np.sqrt(1.0 - sine**2)
    volume = scene.piston.gas_area * CubicSpline(theta, travel)(theta, 1)
    work = np.mean(pressure(theta) * volume)  # per radian: the mean torque
    assert said["mean"] == pytest.approx(work, rel=1e-4)
    assert said["mean_two"] == pytest.approx(work, rel=1e-4)


def swing(inertia):
    """Coefficient of fluctuation of yi_diesel_free, settled, from an own integration.

    d(omega)/d(theta) from Lagrange's equation in the crank angle; positions by finite sums.
    """
    scene = load_scene("yi_diesel_free")
    r, l, e, a = 0.046, scene.rod.length, scene.piston.offset, scene.rod.center_of_mass
    step = 4.0 * math.pi / 7200
    phi = np.arange(7200) * step
    beta = np.arcsin((r * np.sin(phi) - e) / l)
    periodic = lambda y: CubicSpline(  # noqa: E731
        np.append(phi, 4.0 * math.pi), np.append(y, y[0]), bc_type="periodic"
    )
    along, across, swung = (
        periodic(y)(phi, 1)
        for y in (
            r * np.cos(phi) + a * np.cos(beta),
            r * np.sin(phi) - a * np.sin(beta),
            beta,
        )
    )
    piston = periodic(r * np.cos(phi) + l * np.cos(beta))(phi, 1)
    one = (
        scene.rod.mass * (along**2 + across**2)
        + scene.rod.moment_of_inertia * swung**2
        + scene.piston.mass * piston**2
    )
    table = scene.gas.pressure
    gauge = CubicSpline(table.x, table.y, bc_type="periodic")(phi) - scene.gas.ambient
    push = -gauge * scene.piston.gas_area * piston
    four = [sum(np.roll(y, k * 1800) for k in range(4)) for y in (one, push)]  # evenly fired
    moved, drive = periodic(inertia + four[0]), periodic(four[1])
    load = scene.torque[0].coefficient

    def slope(theta, energy):
        return drive(theta) - load * 2.0 * energy / moved(theta)

    angles = np.linspace(0.0, 4.0 * math.pi, 14401)

    def cycle(start):
        done = solve_ivp(
            slope, (0.0, 4.0 * math.pi), [start], "DOP853", angles, rtol=1e-10, max_step=0.05
        )
        return done.y[0]

    begin = 0.5 * moved(0.0) * scene.start.speed**2
    ends = [cycle(factor * begin)[-1] for factor in (1.0, 1.1)]
    growth = (ends[1] - ends[0]) / (0.1 * begin)  # over a cycle the energy goes through a line
    energy = cycle((ends[0] - growth * begin) / (1.0 - growth))
    omega = np.sqrt(2.0 * energy / moved(angles))
    return np.ptp(omega) * np.mean(1.0 / omega)  # mean over time: angle over the time it takes


def test_fluctuation():
    said = answers("fluctuation")
    assert said["fluctuation"] == pytest.approx(100.0 * swing(0.15), rel=2e-5)
    assert swing(said["inertia"]) == pytest.approx(0.01, rel=1e-4)
    assert said["formula"] == pytest.approx(said["fluctuation"], rel=0.01)
    assert said["inertia_formula"] == pytest.approx(said["inertia"], rel=0.01)
    # four pistons move with half their mass on average, rods' big ends turn with the crank
    assert said["moving"] == pytest.approx(
        4 * 0.046**2 * (0.5 * 1.542292 * (1 + 0.3**2 / 4) + 0.75 * 1.602847), rel=0.02
    )


def pin_force(variables):
    return np.hypot(*(variables[f"crank_pin_force_{axis}"][:, 0].astype(float) for axis in "xy"))


def test_fluctuation_loads_are_the_oracles():
    said = answers("fluctuation")
    scene = load_scene("yi_diesel_free")
    crank = dataclasses.replace(scene.crank, inertia=0.025)
    run = dataclasses.replace(scene.run, until=SETTLED)
    result = simulate(dataclasses.replace(scene, crank=crank, run=run))
    names = ("crank_angle", "crank_speed", "crank_acceleration")

    def largest(quantity):
        """Of the last cycle, between its samples too."""
        motion = [result.data[name].values[-721:] for name in names]
        k = int(np.argmax(quantity(reference_variables(result.scene, *motion))))
        fine = result.interp(crank_angle=np.linspace(*motion[0][[k - 1, k + 1]], 401))
        motion = [fine[name].values for name in names]
        return quantity(reference_variables(result.scene, *motion)).max()

    most = largest(lambda exact: exact["piston_acceleration"][:, 0].astype(float))
    assert said["acceleration_free"] == pytest.approx(most, rel=1e-8)
    assert said["crank_pin_free"] == pytest.approx(largest(pin_force) * 1e-3, rel=1e-8)


def harmonic(order, ratio=40 / 140, of=lambda phi, ratio: position(phi, ratio)):
    """Amplitude of an order of s''/r of a central gear."""
    count = 64
    phis = [2 * mpmath.pi * k / count for k in range(count)]
    shape = [float(mpmath.diff(lambda x: of(x, ratio), phi, 2)) for phi in phis]
    return 2.0 * abs(np.fft.rfft(shape)[order]) / count


def test_balance():
    said = answers("balance")
    mass, r, ratio, omega = 0.42 + 0.56 * 40 / 140, 0.04, 40 / 140, 100.0 * math.pi
    unit = mass * r * omega**2
    assert said["first"] == pytest.approx(0.0, abs=1e-8)
    assert said["second"] == pytest.approx(4e-3 * unit * harmonic(2), rel=1e-10)
    series = ratio + ratio**3 / 4 + 15 * ratio**5 / 128 + 35 * ratio**7 / 512
    assert harmonic(2) == pytest.approx(series, rel=1e-4)
    assert said["second_lecture"] == pytest.approx(4e-3 * unit * ratio)
    assert said["counterweight"] == pytest.approx(mass)
    assert said["twin_before"] == pytest.approx(1e-3 * unit, rel=1e-10)
    assert said["twin_after"] == pytest.approx(0.0, abs=1e-8)
    assert said["twin_second"] == pytest.approx(math.sqrt(2) * 1e-3 * unit * harmonic(2), rel=1e-10)
    spacing = 1.1 * 0.08
    assert said["couple_first"] == pytest.approx(math.sqrt(3) * unit * spacing, rel=1e-9)
    assert said["couple_lecture"] == pytest.approx(math.sqrt(3) * unit * spacing)
    assert said["twin_lecture"] == pytest.approx(math.sqrt(2) * 1e-3 * unit * ratio)


def test_balance_torque_is_gas_and_inertia():
    said = answers("balance")
    scene = load_scene("grega_lecture")
    bare = dataclasses.replace(scene, gas=None)
    still = dataclasses.replace(
        scene,
        rod=dataclasses.replace(scene.rod, mass=0.0, inertia=0.0),
        piston=dataclasses.replace(scene.piston, mass=0.0),
    )
    theta = np.arange(1440) * (4.0 * math.pi / 1440)
    speed = np.full_like(theta, scene.motion.speed)
    for key, machine in (("both", scene), ("gas", still), ("inertia", bare)):
        torque = reference_variables(machine, theta, speed, 0.0 * theta)["crank_torque"]
        second = 2.0 * abs(np.fft.rfft(torque.sum(axis=1).astype(float))[4]) / len(theta)
        assert said[f"torque_{key}"] == pytest.approx(second, abs=0.02)


def test_omega_balances_the_energy():
    said, scene = answers("omega"), load_scene("yi_diesel_free")
    assert said["fluctuation"] == pytest.approx(100.0 * swing(0.15), rel=2e-5)
    run = dataclasses.replace(scene.run, until=SETTLED)
    result = simulate(dataclasses.replace(scene, run=run)).data
    speed = result["crank_speed"].values
    power = (result["gas_force"].values * result["piston_velocity"].values).sum(axis=1)
    torque = CubicSpline(
        result["crank_angle"].values, power / speed + result["external_torque"].values
    )
    work = torque.antiderivative()(result["crank_angle"].values)  # beyond the energy at the start
    assert said["swing"] == pytest.approx(np.ptp(work), rel=1e-4)
    stored = np.mean(result["kinetic_energy"].values)
    assert said["from_energy"] == pytest.approx(50.0 * np.ptp(work) / stored, rel=1e-3)


def test_polar_peaks_are_the_oracles():
    said, scene = answers("polar"), load_scene("propeller")
    fine = np.radians(np.arange(0.0, 720.0, 0.05))
    speed = np.full_like(fine, scene.start.speed)
    exact = reference_variables(scene, fine, speed, 0.0 * fine)
    bearing = np.hypot(*(exact[f"main_bearing_force_{axis}"].astype(float) for axis in "xy"))
    assert said["bearing_peak"] == pytest.approx(1e-3 * bearing.max(), rel=1e-5)
    assert said["bearing_mean"] == pytest.approx(1e-3 * bearing.mean(), rel=1e-4)
    pin = pin_force(exact)
    assert said["pin_peak"] == pytest.approx(1e-3 * pin.max(), rel=1e-5)
    assert said["pin_angle"] == pytest.approx(0.05 * np.argmax(pin), abs=0.1)
