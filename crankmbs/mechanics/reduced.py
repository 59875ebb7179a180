"""The crank train at crank angles: loops over them, compiled by numba
(`crankmbs.numerics.kernels`), which `crankmbs.mechanics.tabulated` calls.

They are the formulas of `crankmbs.mechanics.geometry`, `inertia` and `newton_euler`, for one angle
after the other.
"""

from __future__ import annotations

import math

from crankmbs.mechanics.knots import KNOT
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

__all__ = ["balances", "reduced"]

Lengths = tuple[float, float, float, float]
Numbers = tuple[Lengths, tuple[float, float, float, float, float], tuple[float, float], Array]
Gas = tuple[float, Index, Array, Array, Array]


@kernel
def reduced(theta: Array, numbers: Numbers, gas: Gas, found: Array) -> None:
    """Fill ``found``, shape (3, n), with J, dJ/dtheta and the torque of gas and weights.

    numbers, gas : as `crankmbs.mechanics.tabulated` describes them
    """
    lengths, (i_crank, i_rod, m_rod, m_piston, unbalance), (gx, gy), cylinders = numbers
    for i in range(len(theta)):
        inertia, slope = i_crank, 0.0
        torque = unbalance * (gy * math.cos(theta[i]) - gx * math.sin(theta[i]))
        for j in range(len(cylinders)):
            phi, along, across = theta[i] + cylinders[j, 0], cylinders[j, 1], cylinders[j, 2]
            _, (b1, b2), (_, x1, x2), (gx1, gy1, gx2, gy2) = _closed(phi, lengths)
            inertia += m_piston * x1 * x1
            slope += 2.0 * m_piston * x1 * x2
            if m_rod != 0.0 or i_rod != 0.0:
                inertia += m_rod * (gx1 * gx1 + gy1 * gy1) + i_rod * b1 * b1
                slope += 2.0 * (m_rod * (gx1 * gx2 + gy1 * gy2) + i_rod * b1 * b2)
            torque += m_piston * along * x1 + m_rod * (along * gx1 + across * gy1)
            if gas[0] > 0.0:
                torque -= gas[0] * _pressure(phi, j, gas) * x1
        found[0, i], found[1, i], found[2, i] = inertia, slope, torque


@kernel
def balances(
    theta: Array,
    motion: tuple[Array, Array, Array],
    numbers: Numbers,
    more: tuple[float, float, Array, Array],
    gas: Gas,
    found: Array,
) -> None:
    """Fill ``found``, shape (rows, u, n), with the rows of `crankmbs.mechanics.tabulated.rows_of`.

    motion : omega^2, alpha and 1, shape (u, n) or (u, 1) each; more : mass of the crank, top
    position of the piston pin, bank of each cylinder, shape (n,), and its place along the crank, of
    none where they have no places
    """
    lengths, (i_crank, i_rod, m_rod, m_piston, unbalance), (gx, gy), cylinders = numbers
    (m_crank, top, banks, levers), (r, l, a, e) = more, lengths
    (squares, alphas, ones), count, area = motion, len(cylinders), gas[0]
    base = 2 if len(levers) > 0 else 0
    first = base + 7
    journal = first + 15 * count
    for i in range(len(theta)):
        sin_t, cos_t = math.sin(theta[i]), math.cos(theta[i])
        of_weight = unbalance * (cos_t * gy - sin_t * gx)
        at = i if squares.shape[1] > 1 else 0
        one_at = i if ones.shape[1] > 1 else 0
        for u in range(len(squares)):
            square, alpha, one = squares[u, at], alphas[u, at], ones[u, one_at]
            x_tt = unbalance * (-cos_t * square - sin_t * alpha)
            y_tt = unbalance * (-sin_t * square + cos_t * alpha)
            for row in range(base):
                found[row, u, i] = 0.0
            found[base, u, i] = i_crank * alpha - of_weight * one
            found[base + 1, u, i] = x_tt - m_crank * gx * one
            found[base + 2, u, i] = y_tt - m_crank * gy * one
            found[base + 3, u, i] = m_crank * gx * one - x_tt
            found[base + 4, u, i] = m_crank * gy * one - y_tt
            found[base + 5, u, i] = 0.0
            found[base + 6, u, i] = 0.5 * i_crank * square
        for k in range(count):
            phi, along, across = theta[i] + cylinders[k, 0], cylinders[k, 1], cylinders[k, 2]
            (sin_p, cos_p, sin_b, cos_b), (b1, b2), (x, x1, x2), of_rod = _closed(phi, lengths)
            gx1, gy1, gx2, gy2 = of_rod
            pressure = _pressure(phi, k, gas) if area > 0.0 else 0.0
            inertia = m_piston * x1 * x1 + m_rod * (gx1 * gx1 + gy1 * gy1) + i_rod * b1 * b1
            cos_bank, sin_bank = math.cos(banks[k]), math.sin(banks[k])
            beta = math.atan2(sin_b, cos_b)
            for u in range(len(squares)):
                square, alpha, one = squares[u, at], alphas[u, at], ones[u, one_at]
                x_tt, beta_tt = x2 * square + x1 * alpha, b2 * square + b1 * alpha
                felt_x = gx2 * square + gx1 * alpha - along * one  # acceleration minus gravity
                felt_y = gy2 * square + gy1 * alpha - across * one
                felt = x_tt - along * one
                pin_x = m_piston * felt + pressure * area * one
                weight = m_rod * (cos_b * felt_y + sin_b * felt_x)
                pin_y = ((i_rod * beta_tt - a * weight) / l - pin_x * sin_b) / cos_b
                throw_x, throw_y = m_rod * felt_x + pin_x, m_rod * felt_y + pin_y
                side = -pin_y - m_piston * across * one
                shake_x = -m_rod * felt_x - m_piston * felt
                shake_y = -m_rod * felt_y + m_piston * across * one
                torque = r * (sin_p * throw_x - cos_p * throw_y)
                own = (
                    beta * one,
                    b1 * one,
                    beta_tt,
                    x * one,
                    (top - x) * one,
                    -x1 * one,
                    -x_tt,
                    pressure * one,
                    pressure * area * one,
                    side,
                    pin_x,
                    pin_y,
                    throw_x,
                    throw_y,
                    torque,
                )
                for row in range(len(own)):
                    found[first + row * count + k, u, i] = own[row]
                before = found[journal + k - 1, u, i] if k > 0 else 0.0
                found[journal + k, u, i] = before + torque
                found[journal + count + k, u, i] = before + torque - 0.5 * torque
                shake_x, shake_y = (
                    cos_bank * shake_x - sin_bank * shake_y,
                    sin_bank * shake_x + cos_bank * shake_y,
                )
                if base > 0:
                    found[0, u, i] -= levers[k] * shake_y
                    found[1, u, i] += levers[k] * shake_x
                found[base, u, i] -= torque
                found[base + 1, u, i] += cos_bank * throw_x - sin_bank * throw_y
                found[base + 2, u, i] += sin_bank * throw_x + cos_bank * throw_y
                found[base + 3, u, i] += shake_x
                found[base + 4, u, i] += shake_y
                found[base + 5, u, i] -= x * side + e * pressure * area * one
                found[base + 6, u, i] += 0.5 * inertia * square


@kernel
def _closed(
    phi: float, lengths: Lengths
) -> tuple[
    tuple[float, float, float, float],
    tuple[float, float],
    tuple[float, float, float],
    tuple[float, float, float, float],
]:
    """Sines and cosines of phi and beta; derivatives of beta; position of the piston pin and its
    derivatives; those of the rod's centre of mass."""
    r, l, a, e = lengths
    spare, far = max(l - r - abs(e), 0.0), abs(e)
    sin_p, cos_p = math.sin(phi), math.cos(phi)
    sin_b = (r * sin_p - e) / l
    wide = 1.0 + abs(sin_p)
    narrow = cos_p * cos_p / wide
    above, below = (narrow, wide) if sin_p > 0.0 else (wide, narrow)  # 1 -+ sin(phi)
    cos_b = math.sqrt((spare + far + e + r * above) * (spare + far - e + r * below)) / l
    b1 = r * cos_p / (l * cos_b)
    towards = (below if e >= 0.0 else above) / l
    bend = sin_p * (spare / l) * (1.0 + (r + far) / l) + e * r * towards * towards
    b2 = -r * bend / (l * cos_b * cos_b * cos_b)
    x1 = -r * sin_p - l * sin_b * b1
    x2 = -r * cos_p - l * (cos_b * b1 * b1 + sin_b * b2)
    gx1, gy1 = -r * sin_p - a * sin_b * b1, r * cos_p - a * cos_b * b1
    gx2 = -r * cos_p - a * (cos_b * b1 * b1 + sin_b * b2)
    gy2 = -r * sin_p - a * (cos_b * b2 - sin_b * b1 * b1)
    of_pin = (r * cos_p + l * cos_b, x1, x2)
    return (sin_p, cos_p, sin_b, cos_b), (b1, b2), of_pin, (gx1, gy1, gx2, gy2)


@kernel
def _pressure(phi: float, cylinder: int, gas: Gas) -> float:
    """Of a cylinder at its cycle angle [Pa]; at a step the value after it."""
    _, places, firsts, starts, coefficients = gas
    behind = (phi - firsts[cylinder, 0] + KNOT) % firsts[cylinder, 1]
    low, high = places[cylinder, 0], places[cylinder, 1]
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if starts[middle] <= behind else (low, middle)
    d = behind - KNOT - starts[low]
    cubic = (coefficients[0, low] * d + coefficients[1, low]) * d
    return float((cubic + coefficients[2, low]) * d + coefficients[3, low])
