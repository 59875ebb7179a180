"""A free crank whose firings have shares of the combustion: stretch by stretch from one decision to
the next, each under the pressures that these shares make.

Shares are decided at the start and wherever the throw of a cylinder is half a turn past its axis.
Loads are constant or quadratic, and the crank turns forwards.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from validation.oracles.arithmetic import LONG, Array, Number
from validation.oracles.free_motion import Motion
from validation.oracles.machine import Machine, Pressure, PressurePieces
from validation.oracles.many_turns import many_turns
from validation.oracles.pressure import pressure_pieces

__all__ = ["Governor", "governed_motion", "shared"]

_SAME = 1e-9


@dataclass(frozen=True)
class Governor:
    """speed [rad/s], kp [s/rad], ki [1/rad], least and most share, initial integral."""

    speed: float
    kp: float
    ki: float
    least: float
    most: float
    initial: float


def shared(fired: Pressure, motored: Pressure, share: Number) -> PressurePieces:
    """motored + share (fired - motored), of two tables with the same rows of angles."""
    one, other = pressure_pieces(fired), pressure_pieces(motored)
    if len(one.knots) != len(other.knots) or np.any(one.knots != other.knots):
        raise ValueError("the tables must have the same angles")
    cubics = other.coefficients + share * (one.coefficients - other.coefficients)
    return PressurePieces(tuple(one.knots), tuple(map(tuple, cubics)), fired.period)


def governed_motion(
    machine: Machine,
    motored: Pressure,
    start: tuple[float, float],
    angles: Array,
    governor: Governor | None,
    part: Callable[[int, int], float],
) -> tuple[Motion, Array]:
    """The motion at increasing angles [rad], and the shares there, shape (angles, cylinders).

    machine : with the pressures of a share of 1; start : angle [rad], speed [rad/s]
    part : of cylinder and cycle, both from 1, what the share is multiplied by
    """
    period, count = LONG.whole_turns(machine.period), len(machine.cylinders)
    phases = [LONG.number(phase) for phase, _ in machine.cylinders]
    theta, omega = LONG.number(start[0]), LONG.number(start[1])
    time, before, wanted = LONG.number(0), (LONG.number(0), theta), LONG.array(angles)
    integral = LONG.number(governor.initial if governor else 0)
    shares = [LONG.number(1)] * count
    ahead = [np.ceil((theta + p - LONG.pi) / period + _SAME) * period + LONG.pi - p for p in phases]
    deciding, cycles = list(range(count)), [1] * count
    after = [int(np.floor((theta + p - 2 * LONG.pi) / period + _SAME)) for p in phases]
    rows: list[Motion] = []
    of_each: list[Array] = []
    while theta < wanted[-1]:
        share = LONG.number(1)
        if governor is not None:
            spent = time - before[0]
            error = governor.speed - ((theta - before[1]) / spent if spent else omega)
            more = integral + governor.ki * error * spent
            free = governor.kp * error + more
            share = min(max(free, LONG.number(governor.least)), LONG.number(governor.most))
            integral = integral if (free - share) * error > 0 else more
            before = (time, theta)
        for k in deciding:
            shares[k] = share * part(k + 1, cycles[k])
        end = min(ahead)
        fired = tuple(
            shared(pressure, motored, q)
            for pressure, q in zip(machine.pressures, shares, strict=True)
        )
        here = wanted[(wanted > theta) & (wanted <= end)] if rows else wanted[wanted <= end]
        motion = many_turns(replace(machine, pressure=fired), theta, omega, np.append(here, end))
        rows.append(_part(motion, slice(0, len(here)), time))
        of_each.append(np.tile(np.array(shares), (len(here), 1)))
        last = _part(motion, slice(len(here), None), time)
        time, theta, omega = last.time[0], end, last.omega[0]
        deciding = [k for k in range(count) if abs(ahead[k] - end) < _SAME]
        for k in deciding:
            cycles[k] = int(np.round((ahead[k] + phases[k] - LONG.pi) / period)) - after[k]
            ahead[k] = ahead[k] + period
    time, theta, omega, alpha = (
        np.concatenate([getattr(row, name) for row in rows])
        for name in ("time", "theta", "omega", "alpha")
    )
    steps = sum(row.steps for row in rows)
    return Motion(time, theta, omega, alpha, steps), np.concatenate(of_each)


def _part(motion: Motion, which: slice, late: Number) -> Motion:
    return Motion(
        motion.time[which] + late,
        motion.theta[which],
        motion.omega[which],
        motion.alpha[which],
        motion.steps,
    )
