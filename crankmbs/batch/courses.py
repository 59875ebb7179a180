"""What motions of one machine go through at the nodes, and what they add up to over a period: a
loop over cases, compiled by numba (`crankmbs.numerics.kernels`)."""

from __future__ import annotations

import math

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["follow"]


@kernel
def follow(
    sense: float,
    of_angle: tuple[Array, Array, Array, Array],
    about: tuple[Array, Array],
    motions: tuple[Array, Array],
    found: tuple[Array, Array, Array],
) -> None:
    """Fill what every case goes through, and its duration [s], greatest and least energy [J], mean
    torques of all rods and from outside [N m].

    sense, of_angle, motions : as `crankmbs.batch.walk.walk` has them
    about : width times weight of the n nodes [rad], shape (n,); A, B and C of the torque of all
        rods, shape (3, n)
    found : filled; omega^2, alpha and omega, shape (k, 3, n), 1 / |omega|, shape (k, n), no numbers
        where there is no motion; and, where there is one, the columns of `crankmbs.batch.walk.walk`
    """
    (cases, energy), (courses, slow, columns) = motions, found
    lanes = energy.shape[3]
    for k in range(len(columns)):
        g, l = k // lanes, k % lanes
        case = (cases[g, 0, l], cases[g, 1, l], cases[g, 2, l], cases[g, 3, l])
        _course(sense, case, of_angle, energy[g, :, :, l], (courses[k], slow[k]))
        if energy[g, 0, 0, l] == energy[g, 0, 0, l]:
            _sums(of_angle, case, (courses[k], slow[k], *about), columns[k])


@kernel
def _course(
    sense: float,
    case: tuple[float, float, float, float],
    of_angle: tuple[Array, Array, Array, Array],
    energy: Array,
    found: tuple[Array, Array],
) -> None:
    """Fill omega^2, alpha, omega and 1 / |omega| at the nodes."""
    (_, inertia, slope, torque), (mass, c0, c1, c2) = of_angle, case
    (m, s), (course, slow) = inertia.shape, found
    square, alpha, omega = course[0], course[1], course[2]
    for c in range(m):
        for j in range(s):
            slow[c * s + j] = energy[c, j]
    of_i, of_s, of_t = inertia.ravel(), slope.ravel(), torque.ravel()
    for i in range(m * s):
        square[i] = 2.0 * slow[i] / (of_i[i] + mass)
    for i in range(m * s):
        omega[i] = sense * math.sqrt(square[i])
    for i in range(m * s):
        slow[i] = 1.0 / abs(omega[i])
    for i in range(m * s):
        load = c0 + c1 * omega[i] + c2 * square[i]
        alpha[i] = (of_t[i] + load - 0.5 * of_s[i] * square[i]) / (of_i[i] + mass)


@kernel
def _sums(
    of_angle: tuple[Array, Array, Array, Array],
    case: tuple[float, float, float, float],
    about: tuple[Array, Array, Array, Array],
    out: Array,
) -> None:
    """Fill duration, greatest and least energy, mean torques of all rods and from outside."""
    (width, inertia, _, _), (mass, c0, c1, c2) = of_angle, case
    (m, s), (course, slow, share, rods) = inertia.shape, about
    time = work = outside = turned = most = 0.0
    least = math.inf
    for c in range(m):
        of_time = of_work = of_load = 0.0
        for j in range(s):
            i = c * s + j
            w2, rate, w = course[0, i], course[1, i], course[2, i]
            of_time += share[i] * slow[i]
            of_load += share[i] * (c0 + c1 * w + c2 * w2)
            of_work += share[i] * (rods[0, i] * w2 + rods[1, i] * rate + rods[2, i])
            energy = 0.5 * w2 * (inertia[c, j] + mass)
            most, least = max(most, energy), min(least, energy)
        time, work, outside = time + of_time, work + of_work, outside + of_load
        turned += width[c]
    out[2], out[3], out[4] = time, most, least
    out[7], out[8] = work / turned, outside / turned
