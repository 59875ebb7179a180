"""Taylor series of the free motion about one instant, from the absolute-coordinate equations."""

from dataclasses import dataclass

import numpy as np

from validation.oracles.arithmetic import Arithmetic, Array, Number
from validation.oracles.bodies import ALPHA, PER_CYLINDER, ROD_SPIN, System
from validation.oracles.linear import solve
from validation.oracles.loads import LoadPiece


@dataclass(frozen=True)
class GasPiece:
    """Gas force of each cylinder: cubic coefficients (cylinders, 4) in theta - origin."""

    coefficients: Array
    origin: Array


def evaluate(series: Array, at: Number) -> Number:
    """Horner's rule along the first axis; `at` a number or an array."""
    total = series[-1] + at * 0
    for coefficient in series[-2::-1]:
        total = total * at + coefficient
    return total


def derivative(series: Array) -> Array:
    """The series of the derivative, one term shorter; series along the first axis."""
    result: Array = (series[1:].T * np.arange(1, len(series))).T
    return result


def motion_series(
    system: System,
    angle: Array,
    rate: Array,
    load: LoadPiece,
    gas: GasPiece | None,
    order: int,
    arithmetic: Arithmetic,
) -> Array:
    """Coefficients 0 .. order of theta(t) about now, for bodies at `angle` turning at `rate`.

    The unknown accelerations and forces obey matrix(t) z(t) = right(t). With the coefficients of
    matrix and right known up to order k (they need the motion up to order k + 1 only),
    matrix_0 z_k = right_k - sum over j = 1 .. k of matrix_j z_(k-j) gives the next ones. Cosines
    and sines come from (cos a)' = -a' sin a and (sin a)' = a' cos a. Exact but for truncation
    and rounding.
    """
    bodies, cylinders = len(angle), (len(angle) - 1) // 2
    turn = arithmetic.zeros(order + 1, bodies)  # angles
    speed, speed2 = (arithmetic.zeros(order, bodies) for _ in range(2))  # rates, their squares
    trig = arithmetic.zeros(order, 2, bodies)  # cosines and sines
    entry, factor = (arithmetic.zeros(order, len(system.entry_row)) for _ in range(2))
    origin, tables = load.origin, len(load.origin)
    if gas is not None:
        origin = np.concatenate([origin, gas.origin])
    local, square, cube = (arithmetic.zeros(order, len(origin)) for _ in range(3))  # its powers

    turn[0], speed[0] = angle, rate
    trig[0] = arithmetic.cos(angle), arithmetic.sin(angle)
    size = len(system.right)
    identity = arithmetic.zeros(size, size)
    identity[np.arange(size), np.arange(size)] += 1
    inverse = solve(system.matrix(trig[:1, 0], trig[:1, 1]), identity[None])[0]
    accelerating = [ALPHA] * (1 + cylinders) + [
        ROD_SPIN + PER_CYLINDER * k for k in range(cylinders)
    ]
    still, per = system.right * 0, load.cubics.T

    for k in range(order - 1):
        if k > 0:
            turned = _product(trig, speed[:, None], k - 1) / k
            trig[k] = -turned[1], turned[0]
        speed2[k] = _product(speed, speed, k)
        entry[k] = system.entries(*trig[k])

        right = system.right.copy() if k == 0 else still.copy()
        np.add.at(right, system.turn_row, system.turning(*_product(trig, speed2[:, None], k)))
        torque = load.per_speed * speed[k, 0] + load.per_speed2 * speed2[k, 0]
        torque += load.constant if k == 0 else (load.per_time if k == 1 else 0)
        if len(origin):
            local[k] = turn[0, 0] - origin if k == 0 else turn[k, 0]
            square[k] = _product(local, local, k)
            cube[k] = _product(local, square, k)
        if tables:
            x, x2, x3 = (power[k, :tables] for power in (local, square, cube))
            torque += (per[1] * x + per[2] * x2 + per[3] * x3).sum()
            torque += per[0].sum() if k == 0 else 0
        right[system.given_row] += torque
        if gas is not None:
            x, x2, x3 = (power[k, tables:] for power in (local, square, cube))
            terms = gas.coefficients
            force = terms[:, 1] * x + terms[:, 2] * x2 + terms[:, 3] * x3
            right[system.gas_row] -= force + terms[:, 0] if k == 0 else force
        if k > 0:
            np.subtract.at(right, system.entry_row, _product(entry[1:], factor, k - 1))
        unknown = inverse @ right
        factor[k] = unknown[system.entry_column]

        turn[k + 1] = speed[k] / (k + 1)
        speed[k + 1] = unknown[accelerating] / (k + 1)
    turn[order] = speed[order - 1] / order
    theta: Array = turn[:, 0]
    return theta


def _product(a: Array, b: Array, k: int) -> Array:
    """Coefficient k of the product of two series."""
    result: Array = np.add.reduce(a[: k + 1] * b[k::-1])
    return result
