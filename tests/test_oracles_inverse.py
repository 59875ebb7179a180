"""The oracles' pressures and joint forces: SciPy, two arithmetics, balances of power and force."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from validation.oracles.arithmetic import LONG, Array, Number, distance, multiprecision
from validation.oracles.energy import gravity_potential, kinetic_energy
from validation.oracles.known_machines import V_TWIN
from validation.oracles.machine import Machine
from validation.oracles.newton_euler import Reactions, newton_euler
from validation.oracles.pressure import evaluate_pressure

WIDE = multiprecision(40)
TABLE = V_TWIN.pressure
STATE = ([0.4, -3.3, 17.0], [300.0, -80.0, 2.0], [-2e4, 5e3, 100.0])


@pytest.mark.parametrize("kind", ["pchip", "cubic"])
def test_smooth_interpolation_is_scipys(kind: str) -> None:
    angles, pressures = np.array(TABLE.angles), np.array(TABLE.pressures)
    at = np.linspace(-9.0, 15.0, 500)
    if kind == "pchip":
        tiled = np.concatenate([angles + k * TABLE.period for k in range(-3, 5)])
        expected = PchipInterpolator(tiled, np.tile(pressures, 8))(at)
    else:
        closed = np.append(angles, angles[0] + TABLE.period)
        expected = CubicSpline(closed, np.append(pressures, pressures[0]), bc_type="periodic")(at)
    ours = evaluate_pressure(replace(TABLE, interpolation=kind), LONG.array(at))
    assert np.abs(ours - expected).max() < 1e-14 * 6e5 * 10


def test_linear_and_step_interpolation() -> None:
    at = LONG.array([0.2, 0.3, 0.7, 5.2, 5.4999, 5.5, 0.3 + TABLE.period])
    linear = evaluate_pressure(replace(TABLE, interpolation="linear"), at)
    tiled = (
        np.array([5.5 - TABLE.period, *TABLE.angles, 0.3 + TABLE.period]),
        np.array([6e5, *TABLE.pressures, 1e5]),
    )
    assert np.abs(linear - np.interp(at.astype(float), *tiled)).max() < 1e-9
    step = evaluate_pressure(replace(TABLE, interpolation="step"), at)
    assert step.tolist()[:6] == [6e5, 1e5, 1e5, -3e4, -3e4, 6e5]


@pytest.mark.parametrize("kind", ["linear", "step", "pchip", "cubic"])
def test_interpolation_agrees_in_both_arithmetics(kind: str) -> None:
    table, at = replace(TABLE, interpolation=kind), np.linspace(-9.0, 15.0, 50)
    long = evaluate_pressure(table, LONG.array(at))
    wide = evaluate_pressure(table, WIDE.array(at), WIDE)
    assert max(map(distance, long, wide)) < 2e-18 * 6e5


def fields(reactions: Reactions) -> dict[str, Array]:
    return vars(reactions)


def test_reactions_agree_in_both_arithmetics() -> None:
    long, wide = newton_euler(V_TWIN, *STATE), newton_euler(V_TWIN, *STATE, WIDE)
    for name, values in fields(wide).items():
        errors = map(distance, fields(long)[name].ravel(), values.ravel())
        assert max(errors) <= 2e-18 * float(np.abs(values).max()), name


def differentiate(function: Callable[[Array, Array], Array], state: int, order: int) -> Number:
    """The time derivative of a function of theta(t), omega(t) at one of the states."""
    theta, omega, alpha = (WIDE.number(column[state]) for column in STATE)

    def along(time: Number) -> Number:
        at = theta + omega * time + alpha * time * time / 2
        return function(np.array([at]), np.array([omega + alpha * time]))[0]

    return theta.context.diff(along, 0, order, h=WIDE.number("1e-10"))


def position(angle: Array, rate: Array, machine: Machine) -> Reactions:
    return newton_euler(machine, angle, rate, rate * 0, WIDE)


@pytest.mark.slow
@pytest.mark.parametrize("state", range(3))
def test_power_balance(state: int) -> None:
    """The power of torque, gas and gravity is the rate of the kinetic energy."""
    result = newton_euler(V_TWIN, *STATE, WIDE)
    stored = differentiate(
        lambda theta, omega: (
            kinetic_energy(V_TWIN, theta, omega, WIDE) + gravity_potential(V_TWIN, theta, WIDE)
        ),
        state,
        1,
    )
    gas = -(result.gas_force[state] * result.piston_velocity[state]).sum()
    power = result.external_torque[state] * WIDE.number(STATE[1][state]) + gas
    assert distance(power, stored) < 1e-12 * abs(float(stored))


@pytest.mark.slow
@pytest.mark.parametrize("state", range(3))
@pytest.mark.parametrize("cylinder", range(2))
def test_pin_forces_accelerate_rod_and_piston(state: int, cylinder: int) -> None:
    """Second differences of the positions give the resultants on piston and on rod + piston."""
    m, result = V_TWIN, newton_euler(V_TWIN, *STATE, WIDE)
    phase, bank = m.cylinders[cylinder]
    pull = complex(*m.gravity) * np.exp(-1j * bank)
    share = WIDE.number(m.rod_center_of_mass) / WIDE.number(m.rod_length)

    def rod(axis: int, theta: Array, omega: Array) -> Array:
        motion = position(theta, omega, m)
        throw = theta + WIDE.number(phase)
        pin = (WIDE.cos(throw), WIDE.sin(throw))[axis] * WIDE.number(m.crank_radius)
        end = (motion.piston_position[:, cylinder], WIDE.number(m.offset))[axis]
        return pin + share * (end - pin)

    def piston(theta: Array, omega: Array) -> Array:
        return position(theta, omega, m).piston_position[:, cylinder]

    def force(name: str) -> float:
        return float(fields(result)[name][state, cylinder])

    rod_x, rod_y = (float(differentiate(lambda *s, a=a: rod(a, *s), state, 2)) for a in (0, 1))
    piston_x = float(differentiate(piston, state, 2))
    wall = m.piston_mass * piston_x + force("gas_force") - m.piston_mass * pull.real
    peak = 1e-11 * abs(force("crank_pin_force_x")) + 1e-9
    assert abs(force("piston_pin_force_x") - wall) < peak
    assert abs(force("piston_pin_force_y") + force("side_force") + m.piston_mass * pull.imag) < peak
    for axis, second, component in (("x", rod_x, pull.real), ("y", rod_y, pull.imag)):
        resultant = force(f"crank_pin_force_{axis}") - force(f"piston_pin_force_{axis}")
        assert abs(resultant + m.rod_mass * (component - second)) < peak


def test_main_bearing_carries_crank_and_rods() -> None:
    """Bearing force = crank-pin forces in the engine's frame + m (a - g) of the crank."""
    m, result = V_TWIN, newton_euler(V_TWIN, *STATE)
    theta, omega, alpha = map(np.array, STATE)
    center = m.crank_center_of_mass * np.exp(1j * theta)
    expected = m.crank_mass * ((1j * alpha - omega**2) * center - complex(*m.gravity))
    for k, (_, bank) in enumerate(m.cylinders):
        pin = result.crank_pin_force_x[:, k] + 1j * result.crank_pin_force_y[:, k]
        expected = expected + pin * np.exp(1j * bank)
    ours = result.main_bearing_force_x + 1j * result.main_bearing_force_y
    assert np.abs(ours - expected).max() < 1e-14 * np.abs(expected).max()


def test_torque_is_the_sum_over_the_throws() -> None:
    """External torque + rods' torques + gravity's moment = inertia about the axis times alpha."""
    m, result = V_TWIN, newton_euler(V_TWIN, *STATE)
    theta, _, alpha = map(np.array, STATE)
    lever = m.crank_mass * m.crank_center_of_mass
    gravity = lever * (np.cos(theta) * m.gravity[1] - np.sin(theta) * m.gravity[0])
    total = result.external_torque + result.crank_torque.sum(axis=1) + gravity
    assert np.abs(total - m.crank_inertia * alpha).max() < 1e-13 * np.abs(total).max()
