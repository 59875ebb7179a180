"""How long a crank takes for whole turns where nothing drives or brakes it, from its energy alone.

The kinetic energy and the potential of the weights add up to a constant, so over one turn
t = int sqrt(J / (2 E)) dtheta. The integrand has the period of the turn: the trapezoidal rule at
equal angles errs less than any power of their spacing. Time grows by as much with every turn.
"""

import numpy as np

from validation.oracles.arithmetic import Number, multiprecision
from validation.oracles.energy import gravity_potential, kinetic_energy
from validation.oracles.machine import Loads, Machine

__all__ = ["period_time"]

_DIGITS = 30
_CLOSE = 1e-24  # of the time: so far twice as many angles agree
_MOST = 2048


def period_time(machine: Machine, theta: Number, omega: Number) -> Number:
    """Time of one turn [s] from a crank angle and speed, without gas and loads, as an mpmath
    number.

    Raises
    ------
    ValueError : gas or a load, or twice as many angles do not agree
    """
    if machine.pressures or machine.loads != Loads():
        raise ValueError("gas and loads give or take energy")
    arithmetic = multiprecision(_DIGITS)
    start = arithmetic.array([theta])
    speed = arithmetic.array([omega])
    whole = kinetic_energy(machine, start, speed, arithmetic)[0]
    whole = whole + gravity_potential(machine, start, arithmetic)[0]
    coarse, count = None, 64
    while count <= _MOST:
        angles = start[0] + 2 * arithmetic.pi * arithmetic.array(range(count)) / count
        ones = np.array([arithmetic.number(1)] * count, dtype=object)
        half = kinetic_energy(machine, angles, ones, arithmetic)  # J / 2
        left = whole - gravity_potential(machine, angles, arithmetic)
        time = sum((h / e) ** 0.5 for h, e in zip(half, left, strict=True))
        time = time * 2 * arithmetic.pi / count
        if coarse is not None and abs(time - coarse) <= _CLOSE * time:
            return time
        coarse, count = time, 2 * count
    raise ValueError(f"{_MOST} angles do not suffice")
