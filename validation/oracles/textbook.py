"""Textbook and test-set states of a crank at constant speed, exact: what they are computed here."""

from dataclasses import replace

from validation.oracles.arithmetic import Arithmetic, Number, multiprecision
from validation.oracles.known_machines import (
    KHURMI_15_3,
    KHURMI_15_7,
    KHURMI_15_8,
    TEST_SET_CRANK,
)
from validation.oracles.machine import Machine, PressureTable
from validation.oracles.newton_euler import Reactions, newton_euler


def computed(digits: int = 30) -> dict[tuple[str, str], Number]:
    """By machine and quantity, in the unit of reference/printed.csv, with so many digits."""
    arithmetic = multiprecision(digits)
    return {
        **_largest_speed(arithmetic),
        **_forces(arithmetic),
        **_rigid_crank(arithmetic),
    }


def _largest_speed(arithmetic: Arithmetic) -> dict[tuple[str, str], Number]:
    """Khurmi 15.3, where the piston's acceleration passes zero, by bisection."""
    degree, omega = arithmetic.pi / 180, 200 * arithmetic.pi / 30
    low, high = 70 * degree, 80 * degree
    while high - low > 100 * arithmetic.epsilon:
        middle = (low + high) / 2
        slows = _state(KHURMI_15_3, middle, omega, arithmetic).piston_acceleration[0, 0] > 0
        low, high = (low, middle) if slows else (middle, high)
    velocity = _state(KHURMI_15_3, low, omega, arithmetic).piston_velocity[0, 0]
    return {
        ("khurmi_speed", "crank_angle_of_largest_speed"): low / degree,
        ("khurmi_speed", "largest_piston_speed"): -velocity,
    }


def _forces(arithmetic: Arithmetic) -> dict[tuple[str, str], Number]:
    """Khurmi 15.7: 60 degrees after the dead centre, under a constant pressure."""
    turn = 2 * arithmetic.pi
    pressure = PressureTable((0, turn / 3, 2 * turn / 3), ("0.35e6",) * 3, turn, "linear")
    area = arithmetic.pi / 4 * arithmetic.number("0.5") ** 2
    machine = replace(KHURMI_15_7, piston_area=area, pressure=pressure)
    angle, omega = turn / 6, 250 * arithmetic.pi / 30
    state = _state(machine, angle, omega, arithmetic)
    x, y = state.crank_pin_force_x[0, 0], state.crank_pin_force_y[0, 0]
    torque = state.crank_torque[0, 0]
    found = {
        "side_thrust": state.side_force[0, 0],
        "rod_thrust": (x * x + y * y) ** arithmetic.number("0.5"),
        "tangential_force": torque / arithmetic.number(machine.crank_radius),
        "crank_torque": torque,
    }
    return {("khurmi_forces", name): value / 1000 for name, value in found.items()}


def steam_engine(digits: int = 30) -> Number:
    """Khurmi 15.8: the turning moment [N m] of the vertical steam engine 125 degrees after its top
    dead centre, 30 kPa above and 1.5 kPa below the piston."""
    arithmetic = multiprecision(digits)
    turn, quarter_pi = 2 * arithmetic.pi, arithmetic.pi / 4
    rows = (0, turn / 3, 2 * turn / 3)
    above, below = (
        PressureTable(rows, (pressure,) * 3, turn, "linear") for pressure in ("30e3", "1.5e3")
    )
    area, rod = (quarter_pi * arithmetic.number(d) ** 2 for d in ("0.3", "0.05"))
    machine = replace(
        KHURMI_15_8,
        piston_area=area,
        pressure=above,
        crank_ends=(below,),
        crank_end_area=area - rod,
    )
    angle, omega = 125 * turn / 360, 200 * arithmetic.pi / 30
    return _state(machine, angle, omega, arithmetic).crank_torque[0, 0]


def _rigid_crank(arithmetic: Arithmetic) -> dict[tuple[str, str], Number]:
    """The IVP test set's crank with a rigid rod, in the test set's signs, at 0.1 s."""
    state = _state(TEST_SET_CRANK, arithmetic.number(15), arithmetic.number(150), arithmetic)
    found = {
        "rod_angle": -state.rod_angle[0, 0],
        "piston_position": state.piston_position[0, 0],
        "piston_acceleration": state.piston_acceleration[0, 0],
    }
    return {("ivp_crank", name): value for name, value in found.items()}


def _state(machine: Machine, theta: Number, omega: Number, arithmetic: Arithmetic) -> Reactions:
    at, rate, steady = (arithmetic.array([value]) for value in (theta, omega, 0))
    return newton_euler(machine, at, rate, steady, arithmetic)
