"""Settled motions of one machine under other loads and with other flywheels: a loop over cases,
compiled by numba (`crankmbs.numerics.kernels`).

In a cell the energy obeys dE/dtheta = T + c0 + c1 omega + c2 omega^2, made linear in E about the
last iterate; so a period is an affine map, and Newton's method for the periodic motion takes its
fixed point again and again.
"""

from __future__ import annotations

import math

import numpy as np

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["find_periodic"]

Rule = tuple[Array, Array, Array, Array]  # matrix, weights; two that only a walk needs

_ROUNDS, _SETTLED = 30, 1e-9  # of Newton's method; a change of the energies whose square is nothing


@kernel
def find_periodic(
    sense: float,
    rule: Rule,
    of_angle: tuple[Array, Array, Array],
    cases: Array,
    found: tuple[Array, Array, Array],
) -> None:
    """Find the periodic motion of every case, by Newton's method from a steady speed.

    sense : of rotation
    of_angle : width [rad] of the m cells, and at their s nodes J without the crank's and the
        torque, shape (m, s)
    cases : beside one another as `crankmbs.batch.lanes` lays them, shape (groups, 6, lanes):
        inertia of the crank [kg m2]; c0, c1 and c2 of the loads; a speed near the mean one [rad/s];
        how far above the fixed point the period is to begin, as a part of its greatest energy over
        its damping
    found : filled; energy [J] at the nodes, shape (groups, m, s, lanes), and at the ends of cells,
        shape (groups, m, lanes); energy at the beginning and factor less 1, shape (groups, 2,
        lanes). No numbers where no motion of this sense is periodic.
    """
    (m, s), lanes = of_angle[1].shape, cases.shape[2]
    energy, ends, about = found
    maps, cells = np.empty((2, m, s, lanes)), np.empty((2, m, lanes))
    for g in range(len(cases)):
        _settled(sense, rule, of_angle, cases[g], (maps, cells), (energy[g], ends[g], about[g]))


@kernel
def _settled(
    sense: float,
    rule: Rule,
    of_angle: tuple[Array, Array, Array],
    cases: Array,
    scratch: tuple[Array, Array],
    found: tuple[Array, Array, Array],
) -> None:
    """Those of a group; scratch : gain and shift at all nodes, shape (2, m, s, lanes), growth
    and rise of every cell, shape (2, m, lanes)."""
    (width, inertia, torque), (maps, cells) = of_angle, scratch
    (matrix, weights, _, _), (energy, ends, about) = rule, found
    (m, s), lanes = inertia.shape, cases.shape[1]
    mass, c0, c1, c2, steady, nudge = cases[0], cases[1], cases[2], cases[3], cases[4], cases[5]
    begin, damping = about[0], about[1]
    push, rate = np.empty((s, lanes)), np.empty((s, lanes))
    system, left, now = np.empty((s, s, lanes)), np.ones(lanes), np.empty(lanes)
    room = np.empty((8, lanes))
    growth, rise, lost, at, factor = room[0], room[1], room[2], room[3], room[4]
    change, most, least = room[5], room[6], room[7]
    about[:], ends[:] = math.nan, math.nan
    viscous = c1.any()
    for c in range(m):
        for j in range(s):
            for l in range(lanes):
                energy[c, j, l] = 0.5 * (inertia[c, j] + mass[l]) * steady[l] * steady[l]
    for _ in range(_ROUNDS):
        growth[:], rise[:], lost[:] = 0.0, 0.0, 0.0
        for c in range(m):
            h = sense * width[c]
            gain, shift, more, gained = maps[0, c], maps[1, c], cells[0, c], cells[1, c]
            for j in range(s):
                for l in range(lanes):
                    push[j, l] = torque[c, j] + c0[l]
                    rate[j, l] = 2.0 * c2[l] / (inertia[c, j] + mass[l])
                    gain[j, l], shift[j, l] = 1.0, 0.0
                if viscous:
                    for l in range(lanes):
                        total = inertia[c, j] + mass[l]
                        w = sense * math.sqrt(2.0 * energy[c, j, l] / total)
                        push[j, l] += 0.5 * c1[l] * w
                        rate[j, l] += c1[l] / (total * w)
            for j in range(s):
                for i in range(s):
                    part, one = h * matrix[j, i], 1.0 if i == j else 0.0
                    for l in range(lanes):
                        shift[j, l] += part * push[i, l]
                        system[j, i, l] = one - part * rate[i, l]
            for k in range(s):  # nearly the unit matrix, which needs no pivots
                for j in range(k + 1, s):
                    for l in range(lanes):
                        factor[l] = system[j, k, l] / system[k, k, l]
                        gain[j, l] -= factor[l] * gain[k, l]
                        shift[j, l] -= factor[l] * shift[k, l]
                    for i in range(k + 1, s):
                        for l in range(lanes):
                            system[j, i, l] -= factor[l] * system[k, i, l]
            for k in range(s - 1, -1, -1):
                for i in range(k + 1, s):
                    for l in range(lanes):
                        gain[k, l] -= system[k, i, l] * gain[i, l]
                        shift[k, l] -= system[k, i, l] * shift[i, l]
                for l in range(lanes):
                    gain[k, l] /= system[k, k, l]
                    shift[k, l] /= system[k, k, l]
            more[:], gained[:] = 0.0, 0.0
            for j in range(s):
                part = h * weights[j]
                for l in range(lanes):
                    more[l] += part * rate[j, l] * gain[j, l]
                    gained[l] += part * (push[j, l] + rate[j, l] * shift[j, l])
            for l in range(lanes):  # rises nearly cancel: what they round counts over the damping
                growth[l] += more[l] + growth[l] * more[l]
                step = gained[l] + more[l] * rise[l] - lost[l]
                after = rise[l] + step
                lost[l], rise[l] = (after - rise[l]) - step, after
        for l in range(lanes):
            at[l] = -rise[l] / growth[l] if growth[l] < 0.0 else math.nan
            change[l] = most[l] = 0.0
            least[l] = math.inf
        for c in range(m):
            for j in range(s):
                for l in range(lanes):
                    new = maps[0, c, j, l] * at[l] + maps[1, c, j, l]
                    moved = abs(new - energy[c, j, l])
                    change[l] = moved if moved > change[l] else change[l]
                    most[l] = new if new > most[l] else most[l]
                    least[l] = new if new < least[l] else least[l]
                    energy[c, j, l] = new if left[l] > 0.0 else energy[c, j, l]
            for l in range(lanes):
                at[l] += cells[0, c, l] * at[l] + cells[1, c, l]
        for l in range(lanes):
            good = 0.0 < least[l] < math.inf  # there is one, and it turns on
            ends_here = c1[l] == 0.0 or not change[l] > _SETTLED * most[l] or not good
            now[l] = left[l] if ends_here else 0.0
            at[l] = -(rise[l] + nudge[l] * most[l]) / growth[l] if good else math.nan
            begin[l] = at[l] if now[l] > 0.0 else begin[l]
            damping[l] = growth[l] if now[l] > 0.0 else damping[l]
            left[l] -= now[l]
        for c in range(m):
            for j in range(s):
                for l in range(lanes):
                    new = maps[0, c, j, l] * at[l] + maps[1, c, j, l]
                    energy[c, j, l] = new if now[l] > 0.0 else energy[c, j, l]
            for l in range(lanes):
                at[l] += cells[0, c, l] * at[l] + cells[1, c, l]
                ends[c, l] = at[l] if now[l] > 0.0 else ends[c, l]
        if not left.any():
            break
    for l in range(lanes):
        if begin[l] != begin[l]:
            energy[:, :, l] = math.nan
