"""The loads on the crank, piece by piece, as a polynomial in speed, time and crank angle."""

from dataclasses import dataclass

from validation.oracles.arithmetic import Arithmetic, Array, Number
from validation.oracles.grid import Grid, merge
from validation.oracles.machine import Loads, LoadTable
from validation.oracles.pressure import evaluate_pressure


@dataclass(frozen=True)
class LoadPiece:
    """constant + per_speed omega + per_speed2 omega**2 + per_time (t - start of the step) + what
    the angle tables give, cubics (tables, 4) in theta - origin."""

    constant: Number
    per_speed: Number
    per_speed2: Number
    per_time: Number
    cubics: Array
    origin: Array


def speed_grid(loads: Loads, arithmetic: Arithmetic) -> Grid:
    """Speeds at which the loads change their formula; 0 for omega |omega|."""
    values = [arithmetic.number(x) for table in loads.speed_tables for x in table.abscissae]
    return merge(values + [arithmetic.number(0)] * bool(loads.quadratic), arithmetic)


def time_grid(loads: Loads, arithmetic: Arithmetic) -> Grid:
    """Times at which the loads change their formula."""
    values = [arithmetic.number(x) for table in loads.time_tables for x in table.abscissae]
    return merge(values, arithmetic)


def load_piece(
    loads: Loads,
    time: Number,
    inside_time: Number,
    inside_speed: Number,
    over_angle: tuple[Array, Array],
    arithmetic: Arithmetic,
) -> LoadPiece:
    """The formula that holds at `inside_time` and `inside_speed`, its time counted from `time`, and
    where the angle tables are these cubics in the angle from their origins."""
    number = arithmetic.number
    constant, per_time = number(loads.constant), number(0)
    per_speed, quadratic = -number(loads.viscous), number(loads.quadratic)
    for table in loads.time_tables:
        span = number(table.abscissae[0]), number(table.abscissae[-1])
        if not span[0] <= inside_time <= span[1]:
            raise ValueError("a time table must cover the run")
        value, slope = _line(table, inside_time, arithmetic)
        constant += value + slope * (time - inside_time)
        per_time += slope
    for table in loads.speed_tables:
        value, slope = _line(table, inside_speed, arithmetic)
        constant += value - slope * inside_speed
        per_speed += slope
    quadratic = quadratic if inside_speed < 0 else -quadratic
    return LoadPiece(constant, per_speed, quadratic, per_time, *over_angle)


def torque_at(
    loads: Loads, time: Array, theta: Array, omega: Array, arithmetic: Arithmetic
) -> Array:
    """The torque at times [s], crank angles [rad] and speeds [rad/s], shape (n,); on a jump the
    value after it.

    A time table goes beyond the last time.
    """
    number = arithmetic.number
    torque: Array = number(loads.constant) - number(loads.viscous) * omega
    torque = torque - number(loads.quadratic) * omega * abs(omega)
    for tables, at in ((loads.time_tables, time), (loads.speed_tables, omega)):
        for table in tables:
            torque = torque + arithmetic.array([_line(table, x, arithmetic)[0] for x in at])
    for turning in loads.angle_tables:
        torque = torque + evaluate_pressure(turning, theta, arithmetic)
    return torque


def _line(table: LoadTable, at: Number, arithmetic: Arithmetic) -> tuple[Number, Number]:
    """Value and slope at a point that is not an abscissa; the ends are held."""
    x, y = arithmetic.array(table.abscissae), arithmetic.array(table.torques)
    if at < x[0]:
        return y[0], arithmetic.number(0)
    if at > x[-1]:
        return y[-1], arithmetic.number(0)
    right = next((i for i in range(len(x)) if x[i] > at), len(x) - 1)  # at its end the last piece
    slope = (y[right] - y[right - 1]) / (x[right] - x[right - 1])
    return y[right - 1] + slope * (at - x[right - 1]), slope
