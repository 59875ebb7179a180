"""The oracles' free motion: others' figures, conservation laws, closed forms, two orders."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from validation.oracles import end_states
from validation.oracles.arithmetic import LONG, Number, distance, multiprecision
from validation.oracles.energy import gravity_potential, kinetic_energy
from validation.oracles.free_motion import Motion, free_motion
from validation.oracles.known_machines import (
    COASTING,
    ENGINE_1A,
    PROPELLER,
    TORQUE_DRIVEN,
    V_TWIN,
)
from validation.oracles.machine import Loads, LoadTable, Machine, PressureTable
from validation.oracles.newton_euler import newton_euler

TABLE = V_TWIN.pressure
FLYWHEEL = Machine(crank_radius=0.1, crank_inertia=0.5, rod_length=0.3)


def end(machine: Machine, theta0: Number, omega0: Number, time: Number, **how: int) -> Motion:
    return free_motion(machine, theta0, omega0, times=[time], **how)


def test_pi_has_all_its_digits() -> None:
    assert distance(LONG.pi, "3.14159265358979323846") < 2e-19


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        ("coasting", 5e-18),
        ("engine_1a", 5e-18),
        ("torque_driven_1s", 1e-17),
        ("torque_driven_3s", 4e-15),
        ("propeller", 4e-16),
    ],
)
def test_end_states_are_reproduced(name: str, tolerance: float) -> None:
    """80-bit runs against those of 25 and 30 digits: rounding, times what the motion makes of it.

    The last two turn 20 and 40 times, with steep changes of speed and of pressure in each.
    """
    case, (theta, omega) = end_states.CASES[name], end_states.stored()[name]
    motion = end(case.machine, case.theta0, case.omega0, case.time)
    assert distance(motion.theta[-1], theta) < tolerance * float(theta)
    assert distance(motion.omega[-1], omega) < tolerance * float(omega)


@pytest.mark.slow
def test_coasting_meets_the_digits_of_another_quadrature() -> None:
    motion = end(COASTING, "0.3", 100, "0.5")
    assert distance(motion.theta[-1], "49.22808714458433140007") < 1e-16
    assert distance(motion.omega[-1], "94.47401803965801494427") < 2e-16


@pytest.mark.slow
def test_coasting_meets_the_energy_quadrature() -> None:
    """The stored angle is reached at 0.5 s by t = int dtheta / omega, omega from the energy.

    The trapezoidal rule over the seven whole turns, Gauss over the rest: no time stepping.
    """
    digits = multiprecision(25)
    one = digits.array([1])
    first, last = digits.number("0.3"), digits.number(end_states.stored()["coasting"][0])

    def potential(theta: Number) -> Number:
        return gravity_potential(COASTING, np.array([theta]), digits)[0]

    def inertia(theta: Number) -> Number:
        return 2 * kinetic_energy(COASTING, np.array([theta]), one, digits)[0]

    energy = inertia(first) * 100**2 / 2 + potential(first)

    def slowness(theta: Number) -> Number:
        return (inertia(theta) / (2 * (energy - potential(theta)))) ** digits.number("0.5")

    nodes = [2 * digits.pi * k / 64 for k in range(64)]
    turn = sum(slowness(theta) for theta in nodes) * 2 * digits.pi / 64
    seventh = first + 14 * digits.pi
    rest = first.context.quad(slowness, [seventh, (seventh + last) / 2, last])
    assert distance(7 * turn + rest, "0.5") < 1e-20
    assert distance(1 / slowness(last), end_states.stored()["coasting"][1]) < 1e-17


@pytest.mark.slow
def test_propeller_meets_the_collocation() -> None:
    """Independent Gauss collocation over theta, whose table has its knots rounded to double."""
    table = replace(PROPELLER.pressure, angles=tuple(map(float, PROPELLER.pressure.angles)))
    motion = end(replace(PROPELLER, pressure=table), 0, "335.1", "0.75")
    assert distance(motion.theta[-1], "245.2443994013520719602") < 2e-14
    assert distance(motion.omega[-1], "311.8789454353481041818") < 1e-12


@pytest.mark.slow
def test_torque_driven_meets_another_integration() -> None:
    """At the digits to which that one goes; exudyn's own file prints others (test_printed)."""
    motion = free_motion(TORQUE_DRIVEN, 0, 0, times=[1, 3])
    force = newton_euler(TORQUE_DRIVEN, motion.theta, motion.omega, motion.alpha)
    computed = [
        (motion.theta[0], "14.1278922178"),
        (motion.omega[0], "20.5374828514"),
        (motion.alpha[0], "123.421388171"),
        (force.piston_position[0, 0], "0.283771692112"),
        (force.piston_pin_force_x[0, 0], "0.8545563871"),
        (force.piston_pin_force_y[0, 0], "1.1996653402"),
        (force.crank_pin_force_x[0, 0], "-0.2050844426"),
        (force.crank_pin_force_y[0, 0], "-3.0065884395"),
        (motion.theta[1], "121.88627751"),
        (motion.omega[1], "101.36564511"),
    ]
    for value, text in computed:
        last_digit = 10.0 ** -len(text.split(".")[1])
        assert distance(value, text) <= 0.5 * last_digit, text


def test_engine_1a_has_the_masses_of_the_model() -> None:
    """The ten digits that an evaluation of the model's bodies elsewhere gave."""
    assert distance(ENGINE_1A.crank_inertia, "1.0114306736") <= 0.5e-10
    assert distance(ENGINE_1A.crank_mass, "1.314280927") <= 0.5e-9
    assert distance(ENGINE_1A.piston_mass, "6.047565858") <= 0.5e-9


def test_engine_1a_meets_another_integration() -> None:
    """One in double precision, which over 5 s keeps twelve digits."""
    theta, omega = end_states.stored()["engine_1a"]
    assert distance(theta, "53.415044598428") <= 2e-11
    assert distance(omega, "11.640327828374") <= 1e-11


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        {"rod_length": "0.15333333330001"},
        {"piston_mass": "1.14160000001"},
        {"gravity": ("9.81", "0")},
        {"rod_inertia": "0.00550000000001"},
        {"offset": "1e-12"},
        {"crank_center_of_mass": "1e-12"},
    ],
)
def test_a_shifted_parameter_is_seen(change: dict[str, Number]) -> None:
    motion = end(replace(COASTING, **change), "0.3", 100, "0.5")
    assert distance(motion.omega[-1], end_states.stored()["coasting"][1]) > 1e-14


def test_energy_is_conserved_under_gravity() -> None:
    machine = replace(V_TWIN, pressure=None)
    motion = free_motion(machine, 0.3, 40, times=np.linspace(0, 0.5, 50))
    energy = kinetic_energy(machine, motion.theta, motion.omega)
    energy = energy + gravity_potential(machine, motion.theta)
    assert np.abs(energy - energy[0]).max() < 2e-17 * energy[0]


@pytest.mark.parametrize("kind", ["linear", "step", "pchip", "cubic"])
def test_motion_runs_back_through_knots_and_reversals(kind: str) -> None:
    """Gas as a spring: the crank swings across a knot; run back in time, it returns."""
    machine = replace(V_TWIN, pressure=replace(TABLE, interpolation=kind))
    there = free_motion(machine, 2.5, 20, times=np.linspace(0, 0.15, 40))
    knot = TABLE.angles[4] - V_TWIN.cylinders[1][0]
    assert there.theta.min() < 2.5 < knot < there.theta.max()
    assert there.omega.min() < 0 < there.omega.max()
    back = end(machine, there.theta[-1], -there.omega[-1], 0.15)
    assert distance(back.theta[-1], 2.5) < 5e-17
    assert distance(back.omega[-1], -20) < 2e-15


@pytest.mark.slow
def test_two_orders_agree_on_a_loaded_run() -> None:
    loads = Loads(-3.0, 0.02, 1e-3, (LoadTable((0, 0.1, 0.1, 1), (0, 5, -5, 2)),))
    machine = replace(V_TWIN, loads=loads)
    runs = [end(machine, 0.0, 100, "0.4", order=order) for order in (22, 31)]
    assert runs[0].steps > runs[1].steps
    assert distance(runs[0].theta[-1], runs[1].theta[-1]) < 1e-16 * 100
    assert distance(runs[0].omega[-1], runs[1].omega[-1]) < 1e-15 * 100


def test_inverse_after_forward_gives_the_loads() -> None:
    machine = replace(V_TWIN, loads=Loads(constant=4.0, viscous=0.03, quadratic=2e-3))
    motion = free_motion(machine, 0.0, 90, times=np.linspace(0, 0.2, 60))
    needed = newton_euler(machine, motion.theta, motion.omega, motion.alpha).external_torque
    speed = motion.omega
    given = 4 - LONG.number(0.03) * speed - LONG.number(2e-3) * speed * np.abs(speed)
    scale = float(np.abs(motion.alpha).max()) * 0.04
    assert np.abs(needed - given).max() < 1e-17 * scale * 100


def test_angles_and_times_are_inverse() -> None:
    by_time = free_motion(PROPELLER, 0, 335, times=["0.01", "0.02", "0.03"])
    by_angle = free_motion(PROPELLER, 0, 335, angles=by_time.theta)
    assert np.abs(by_angle.time - by_time.time).max() < 1e-19
    assert np.abs(by_angle.omega - by_time.omega).max() < 1e-15


def test_a_flywheel_reverses_against_a_quadratic_load() -> None:
    """omega = -k tan(s) up to the stop and -k tanh(s) after it, s = sqrt(T c) (t - stop) / J."""
    load, brake, inertia, start = 2.0, 0.05, 0.5, 12.0
    machine = replace(FLYWHEEL, loads=Loads(constant=-load, quadratic=brake))
    brake_long = LONG.number(brake)
    top, rate = np.sqrt(load / brake_long), np.sqrt(load * brake_long) / inertia
    stop = np.arctan(start / top) / rate
    motion = free_motion(machine, 0, start, times=[stop / 2, stop, 3 * stop])
    late = np.tanh(rate * (motion.time - stop))
    exact = np.where(motion.time < stop, -top * np.tan(rate * (motion.time - stop)), -top * late)
    assert np.abs(motion.omega - exact).max() < 1e-17


def test_a_flywheel_follows_its_tables() -> None:
    """Linear in time: a parabola. Linear in speed: an exponential, then the end is held."""
    ramp = LoadTable((0, 1, 1, 2), (0, 4, 1, 1))
    motion = free_motion(replace(FLYWHEEL, loads=Loads(time_tables=(ramp,))), 0, 0, times=[1, 2])
    assert motion.omega.tolist() == [4, 6]
    assert motion.alpha.tolist() == [2, 2]
    fall = LoadTable((0, 10, 10, 20), (5, 5, 3, 1))
    machine = replace(FLYWHEEL, loads=Loads(speed_tables=(fall,)))
    late = free_motion(machine, 0, 0, times=[1, 2])
    assert late.omega[0] == 10
    decay = np.exp(-LONG.number(2) / 5)
    assert abs(late.omega[1] - (25 - 15 * decay)) < 1e-17


def test_a_jump_that_holds_the_speed_is_refused() -> None:
    governor = LoadTable((0, 10, 10, 20), (1, 1, -1, -1))
    machine = replace(FLYWHEEL, loads=Loads(speed_tables=(governor,)))
    with pytest.raises(ArithmeticError, match="holds the motion"):
        end(machine, 0, 0, 9)


def test_a_time_table_must_cover_the_run() -> None:
    machine = replace(FLYWHEEL, loads=Loads(time_tables=(LoadTable((0, 1), (0, 1)),)))
    with pytest.raises(ValueError, match="cover"):
        end(machine, 0, 0, 2)


@pytest.mark.parametrize(("pressures", "direction"), [((0, 1e5), 1), ((-1e5, -5e4), -1)])
def test_start_on_a_knot_from_rest(pressures: tuple[float, float], direction: int) -> None:
    """At rest on a knot, the side that the crank accelerates into is the one that counts."""
    knot = 1.0
    table = PressureTable((-1.0, knot, 2.0), (*pressures, 0.0), 2 * pi, "step")
    machine = replace(COASTING, piston_area=0.005, pressure=table, gravity=(0, 0))
    motion = free_motion(machine, knot, 0, times=[0, 0.01])
    assert direction * (motion.theta[-1] - knot) > 0
    assert direction * motion.alpha[0] > 0


def test_pressures_that_hold_the_crank_on_a_knot_are_refused() -> None:
    table = PressureTable((-1.0, 1.0, 2.0), (1e5, -1e5, 0.0), 2 * pi, "step")
    machine = replace(COASTING, piston_area=0.005, pressure=table, gravity=(0, 0))
    with pytest.raises(ArithmeticError, match="holds the motion"):
        end(machine, 1.0, 0, 0.01)
