"""The crank train reduced to one rotation: a loop over angles, compiled by numba
(`crankmbs.numerics.kernels`), which `crankmbs.mechanics.tabulated` calls."""

from __future__ import annotations

import math

from crankmbs.mechanics.knots import KNOT
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.kernels import kernel

__all__ = ["reduced"]

Numbers = tuple[
    tuple[float, float, float, float],
    tuple[float, float, float, float, float],
    tuple[float, float],
    Array,
]
Gas = tuple[float, Index, Array, Array, Array]


@kernel
def reduced(
    theta: Array,
    numbers: Numbers,
    gas: Gas,
    found: Array,
) -> None:
    """Fill ``found``, shape (3, n), with J, dJ/dtheta and the torque of gas and weights.

    numbers, gas : as `crankmbs.mechanics.tabulated` describes them
    """
    (r, l, a, e), (i_crank, i_rod, m_rod, m_piston, unbalance), (gx, gy), cylinders = numbers
    area, places, firsts, starts, coefficients = gas
    spare, far = max(l - r - abs(e), 0.0), abs(e)
    for i in range(len(theta)):
        inertia, slope = i_crank, 0.0
        torque = unbalance * (gy * math.cos(theta[i]) - gx * math.sin(theta[i]))
        for j in range(len(cylinders)):
            phi, along, across = theta[i] + cylinders[j, 0], cylinders[j, 1], cylinders[j, 2]
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
            inertia += m_piston * x1 * x1
            slope += 2.0 * m_piston * x1 * x2
            if m_rod != 0.0 or i_rod != 0.0:
                inertia += m_rod * (gx1 * gx1 + gy1 * gy1) + i_rod * b1 * b1
                slope += 2.0 * (m_rod * (gx1 * gx2 + gy1 * gy2) + i_rod * b1 * b2)
            torque += m_piston * along * x1 + m_rod * (along * gx1 + across * gy1)
            if area > 0.0:
                begin, end = places[j, 0], places[j, 1]
                first, period = firsts[j, 0], firsts[j, 1]
                behind = (phi - first + KNOT) % period
                low, high = begin, end
                while high - low > 1:
                    middle = (low + high) // 2
                    low, high = (middle, high) if starts[middle] <= behind else (low, middle)
                d = behind - KNOT - starts[low]
                cubic = (coefficients[0, low] * d + coefficients[1, low]) * d
                torque -= area * ((cubic + coefficients[2, low]) * d + coefficients[3, low]) * x1
        found[0, i], found[1, i], found[2, i] = inertia, slope, torque
