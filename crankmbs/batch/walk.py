"""What motions of one machine over a period amount to: loops over cases, compiled by numba
(`crankmbs.numerics.kernels`).

Of a case only the crank's inertia and the loads are its own. Every curve is A u + B alpha + C +
D p, where u is omega^2 - p, or omega - p, with a level p; and A, B, C and D are of the angle alone.
Between the nodes of a cell all is the polynomial through them.

No curve is made as a whole for its peak. Within a cell, and within a block of cells, what it is
made of is straight but for a rest, so that the curve is, but for a rest which is bounded. Only
where that could exceed what is found it is made, and sought in. A second pass with another rule
looks where the first one found the peaks: what it has there tells how far they are off.

Kernels of one file call none of another, so that they stand together here, over 300 lines.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["walk"]

Rule = tuple[
    Array, Array, Array, Array
]  # matrix, weights, nodes, and what makes of the values there
# the last coefficient of Legendre polynomials: the nodes' barycentric weights, too
Curves = tuple[Array, Array, Array, Array]  # A and B, C and D; both in straight lines
Indices = NDArray[np.intp]
Grid = tuple[
    Array, Indices
]  # where cells end; the first cell of every block, and how many there are

_STEPS, _CLOSE, _BESIDE = 16, 1e-7, 1e-4  # towards a peak; of a cell
_BENT = 0.6  # of what a force changes by across a piece: where it is less it has a bend, or nearly
_DEEPEST = 8  # halvings of a cell
_CANDIDATES = 64  # cells of a curve that are sought in; more are ripples of rounding
_ROUNDING = 64 * 2.0**-52  # of a quantity


@kernel
def walk(
    about: tuple[float, int, int, bool],
    rule: Rule,
    of_angle: tuple[Array, Array, Array, Array],
    parts: tuple[Curves, Array, Curves, Indices, tuple[Indices, NDArray[np.bool_]]],
    motions: tuple[Array, Array],
    found: tuple[Array, Array],
) -> None:
    """Fill the columns of every case from its energies over one period.

    about : sense of rotation; number of the quantity whose A belongs to omega; of columns before
        those of joints; whether peaks are sought, or looked at where they are
    of_angle : width [rad] of the m cells, and at their s nodes J without the crank's, dJ/dtheta and
        the torque, shape (m, s)
    parts : of forces, those of joints in pairs of x and y, then the side forces: A and B at the n =
        m s nodes, shape (rows, 2, n), C and D, shape (rows, 1, 2, n), and both in straight lines
        (`lines`), shape (rows, 6, m + b) and (rows, 1, 6, m + b); A, B and C of the torque of all
        rods, shape (3, n); of the quantities of the lectures as of the forces, but in the place of
        1 the quantity itself, with p = 0, and what it is more than each lecture says at a constant
        speed, with the square of the mean omega, or it, as p; the first cell of each of the b
        blocks, and m; and the number of the first of a quantity's curves that is the same, shape
        (q, 1 + lectures), and whether all of them are of the angle alone, shape (q,)
    motions : of the cases, beside one another as `crankmbs.batch.lanes` lays them; inertia of the
        crank [kg m2], c0, c1 and c2 of the loads, shape (groups, 4 or more, lanes); the energy [J]
        at the nodes, shape (groups, m, s, lanes), no number where there is no motion
    found : columns, filled, shape (k, columns), but for the first two; no numbers where there is no
        motion: duration [s], greatest and least energy [J], highest and lowest speed, mean torque
        of all rods and from outside, what both speeds may err; of every joint its peak, the angle
        turned to it, its mean over time and what the peak may err; of every quantity its peak and
        what that may err, and for each lecture its largest deviation and that one's. And where the
        peaks are, shape (k, 2 + joints + curves of quantities, 2): the cell, and the place in it, 0
        to 1; filled, or given
    """
    (sense, linear, own_columns, sought), (width, inertia, _, _) = about, of_angle
    (forces, rods, quantities, starts, (twin, steady)), (cases, energy) = parts, motions
    columns, places = found
    m, s = inertia.shape
    n, count, lanes = m * s, len(columns), energy.shape[3]
    share, edges, gauss = np.empty(n), np.zeros(m + 1), np.empty((8, s))
    for c in range(m):
        edges[c + 1] = edges[c] + width[c]
        for j in range(s):
            share[c * s + j] = width[c] * rule[1][j]
    _prepare(rule, gauss)
    grid, turned = (edges, starts), edges[m]
    courses, tracks = np.empty((count, 4, n)), np.empty((count, 9, m + len(starts) - 1))
    for k in range(count):
        g, l = k // lanes, k % lanes
        columns[k, 2:] = math.nan
        if energy[g, 0, 0, l] == energy[g, 0, 0, l]:
            case = (cases[g, 0, l], cases[g, 1, l], cases[g, 2, l], cases[g, 3, l])
            _course(sense, case, of_angle, energy[g, :, :, l], courses[k])
            _sums(of_angle, case, (courses[k], share, rods), columns[k])
            for row in range(3 if sought else 0):
                _straighten(courses[k, row], gauss, grid, tracks[k, 3 * row : 3 * row + 3])
    ones = np.zeros((1, 2, n)), np.zeros((1, 1, 2, n))
    lines = np.zeros((1, 6, tracks.shape[2])), np.zeros((1, 1, 6, tracks.shape[2]))
    ones[0][0, 0], lines[0][0, 0] = 1.0, 1.0
    speed = (ones[0], ones[1], lines[0], lines[1])
    levels, peaks = np.zeros((count, 2)), np.empty((count, 3))
    levels[:, 1] = 0.0 * columns[:, 2]
    seen, by = (courses, tracks, levels), (grid, gauss, sought)
    _peaks((0, 1, 0, True), speed, by, seen, (places[:, 0], peaks))
    columns[:, 5], columns[:, 9] = peaks[:, 0], peaks[:, 2]
    levels[:, 0] = 2.0 * sense * peaks[:, 0]
    _peaks((0, 1, 0, True), speed, by, seen, (places[:, 1], peaks))
    columns[:, 6], columns[:, 10] = sense * levels[:, 0] - peaks[:, 0], peaks[:, 2]
    levels[:, 0] = 0.0
    rows, kinds = len(forces[0]), quantities[1].shape[1]
    joints = (columns.shape[1] - own_columns - 2 * len(quantities[0]) * kinds) // 4
    at, row, pairs, of = own_columns, 0, rows - joints, 2
    for joint in range(joints):
        more = 2 if joint < pairs else 1
        _peaks((row, more, 0, False), forces, by, seen, (places[:, of], peaks))
        columns[:, at], columns[:, at + 1] = peaks[:, 0], peaks[:, 1]
        columns[:, at + 3] = peaks[:, 2]
        _means(row, more, forces, (courses, share, width), rule, columns[:, at + 2])
        columns[:, at + 2] /= columns[:, 2]
        at, row, of = at + 4, row + more, of + 1
    mean, some = sense * turned / columns[:, 2], 0
    while some + 1 < count and mean[some] != mean[some]:
        some += 1
    for q in range(len(quantities[0])):
        one, end = (some, some + 1) if steady[q] else (0, count)
        seen = courses[one:end], tracks[one:end], levels[one:end]
        for kind in range(kinds):
            for k in range(count):
                of_mean = mean[k] if q == linear else mean[k] * mean[k]
                levels[k, 0] = of_mean if kind > 0 else 0.0
                levels[k, 1] = columns[k, at - 2 * kind] if kind > 0 else 0.0 * mean[k]
            if twin[q, kind] < kind:
                back = kind - twin[q, kind]
                columns[:, at : at + 2] = columns[:, at - 2 * back : at - 2 * back + 2]
                places[:, of] = places[:, of - back]
            else:
                which = (q, 1, kind, q == linear)
                _peaks(which, quantities, by, seen, (places[one:end, of], peaks[one:end]))
                for k in range(count):
                    like = some if steady[q] and mean[k] == mean[k] else k
                    columns[k, at], columns[k, at + 1] = peaks[like, 0], peaks[like, 2]
                    places[k, of] = places[like, of]
            at, of = at + 2, of + 1


@kernel
def _prepare(rule: Rule, gauss: Array) -> None:
    """Fill nodes, barycentric weights, what makes of the values there those at both ends of a cell
    and the slopes there, how far a parabola may rise above a node: parts of what both neighbours
    lie below it."""
    _, _, nodes, barycentric = rule
    s = len(nodes)
    gauss[0], gauss[1] = nodes, barycentric
    for side in range(2):
        _basis(float(side), rule, gauss[2 + side])
        values, slopes = gauss[2 + side], gauss[4 + side]
        inverse = 0.0
        for j in range(s):
            inverse += 1.0 / (side - nodes[j])
        for j in range(s):
            slopes[j] = values[j] * (inverse - 1.0 / (side - nodes[j]))
    for j in range(s):
        behind = nodes[j] - (nodes[j - 1] if j > 0 else 0.0)
        ahead = (nodes[j + 1] if j + 1 < s else 1.0) - nodes[j]
        gauss[6, j], gauss[7, j] = 1.0 + 0.25 * ahead / behind, 1.0 + 0.25 * behind / ahead


@kernel
def _course(
    sense: float,
    case: tuple[float, float, float, float],
    of_angle: tuple[Array, Array, Array, Array],
    energy: Array,
    course: Array,
) -> None:
    """Fill omega^2, alpha, omega and 1 / |omega| at the nodes."""
    (_, inertia, slope, torque), (mass, c0, c1, c2) = of_angle, case
    m, s = inertia.shape
    square, alpha, omega, slow = course[0], course[1], course[2], course[3]
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
    about: tuple[Array, Array, Array],
    out: Array,
) -> None:
    """Fill duration, greatest and least energy, mean torques of all rods and from outside."""
    (width, inertia, _, _), (mass, c0, c1, c2), (course, share, rods) = of_angle, case, about
    m, s = inertia.shape
    time = work = outside = turned = most = 0.0
    least = math.inf
    for c in range(m):
        of_time = of_work = of_load = 0.0
        for j in range(s):
            i = c * s + j
            w2, rate, w = course[0, i], course[1, i], course[2, i]
            of_time += share[i] * course[3, i]
            of_load += share[i] * (c0 + c1 * w + c2 * w2)
            of_work += share[i] * (rods[0, i] * w2 + rods[1, i] * rate + rods[2, i])
            energy = 0.5 * w2 * (inertia[c, j] + mass)
            most, least = max(most, energy), min(least, energy)
        time, work, outside = time + of_time, work + of_work, outside + of_load
        turned += width[c]
    out[2], out[3], out[4] = time, most, least
    out[7], out[8] = work / turned, outside / turned


@kernel
def _straighten(values: Array, gauss: Array, grid: Grid, lines: Array) -> None:
    """Fill middle, rise and rest of the straight lines for the m cells, then for the blocks, as
    `crankmbs.batch.machine.lines` does."""
    (edges, starts), nodes = grid, gauss[0]
    m, s = len(edges) - 1, len(nodes)
    middle, rise, rest = lines[0], lines[1], lines[2]
    for c in range(m):
        low, high = values[c * s], values[c * s + s - 1]
        middle[c], rise[c] = 0.5 * (low + high), (high - low) / (nodes[s - 1] - nodes[0])
        worst = 0.0
        for j in range(1, s - 1):
            off = abs(values[c * s + j] - middle[c] - rise[c] * (nodes[j] - 0.5))
            worst = off if off > worst else worst
        rest[c] = worst
    for b in range(len(starts) - 1):
        begin, end = starts[b], starts[b + 1]
        low, high = middle[begin] - 0.5 * rise[begin], middle[end - 1] + 0.5 * rise[end - 1]
        middle[m + b], rise[m + b] = 0.5 * (low + high), high - low
        worst = 0.0
        for c in range(begin, end):
            for side in range(2):
                at = (edges[c + side] - edges[begin]) / (edges[end] - edges[begin]) - 0.5
                off = abs(middle[c] + (side - 0.5) * rise[c] - middle[m + b] - rise[m + b] * at)
                worst = max(worst, off + rest[c])
        rest[m + b] = worst


@kernel
def _basis(x: float, rule: Rule, basis: Array) -> None:
    """Fill the Lagrange polynomials of the nodes at a place in a cell, from 0 to 1."""
    _, _, nodes, barycentric = rule
    total = 0.0
    for j in range(len(nodes)):
        apart = x - nodes[j]
        if apart == 0.0:
            basis[:] = 0.0
            basis[j] = 1.0
            return
        basis[j] = barycentric[j] / apart
        total += basis[j]
    for j in range(len(nodes)):
        basis[j] /= total


@kernel
def _peaks(
    which: tuple[int, int, int, bool],
    curves: Curves,
    by: tuple[Grid, Array, bool],
    motions: tuple[Array, Array, Array],
    found: tuple[Array, Array],
) -> None:
    """Fill the places, shape (k, 2), of the largest size of a curve over the period, for every
    case, and that size, the angle turned to it [rad] and what it may err, shape (k, 3), as `_seek`
    does; or, where none is sought, the size at the places."""
    (grid, gauss, sought), (places, peaks) = by, found
    if sought:
        _seek(which, curves, grid, gauss, motions, (places, peaks))
        return
    (row, rows, kind, linear), (of, rest, _, _) = which, curves
    (courses, _, levels), edges, s = motions, grid[0], gauss.shape[1]
    for k in range(len(peaks)):
        cell, x = places[k]
        peaks[k] = math.nan
        if cell == cell and levels[k, 1] == levels[k, 1]:
            c, course, level = int(cell), courses[k], levels[k, 0]
            of_rows = 0.0
            for r in range(row, row + rows):
                above = below = 0.0
                for j in range(s):
                    i = c * s + j
                    u = course[2, i] if linear else course[0, i]
                    value = of[r, 0, i] * (u - level) + of[r, 1, i] * course[1, i]
                    value += rest[r, kind, 0, i] + rest[r, kind, 1, i] * level
                    apart = x - gauss[0, j]
                    weight = gauss[1, j] / (apart if apart != 0.0 else 1e-300)
                    above, below = above + weight * value, below + weight
                of_rows += (above / below) ** 2
            peaks[k, 0], peaks[k, 2] = math.sqrt(of_rows), 0.0
            peaks[k, 1] = edges[c] + x * (edges[c + 1] - edges[c])


@kernel
def _seek(
    which: tuple[int, int, int, bool],
    curves: Curves,
    grid: Grid,
    gauss: Array,
    motions: tuple[Array, Array, Array],
    found: tuple[Array, Array],
) -> None:
    """Fill for every case where the largest size of a curve over the period is, shape (k, 2), that
    size, the angle turned to it [rad], and what it may err, shape (k, 3): the size of the last
    coefficient of the polynomial in its cell.

    which : row, how many rows make it up, number of C and D, and whether u is of omega; motions :
        courses and tracks, and for each case p, and the scale whose rounding is nothing, no number
        where there is no motion; shape (k, 2)
    """
    (row, rows, kind, linear), (of, rest, lines_of, lines_rest) = which, curves
    (edges, starts), (courses, tracks, levels), (places, peaks) = grid, motions, found
    m, s, blocks = len(edges) - 1, gauss.shape[1], len(starts) - 1
    room, values = np.empty((7, m + blocks)), np.zeros((3, s))
    bounds, most_of, paired = room[6], 0.0, rows == 2
    for j in range(s):
        most_of += abs(gauss[3, j])
    for k in range(len(peaks)):
        level, scale = levels[k]
        course, track = courses[k], tracks[k]
        peaks[k], places[k] = math.nan, math.nan
        if scale != scale:
            continue
        highest, limit, place, tail, left, seen = -1.0, -1.0, 0.0, 0.0, -1.0, 0
        for r in range(rows):
            lines = (lines_of[row + r], lines_rest[row + r, kind])
            _bound((r, linear, level), lines, track, (m, m + blocks), room)
        _join(paired, most_of, (m, m + blocks), room)
        best = m
        for b in range(m + 1, m + blocks):
            best = b if bounds[b] > bounds[best] else best
        for step in range(m - 1, m + blocks):
            block = best if step < m else step
            if not bounds[block] > limit or step == best:
                continue
            begin, end = starts[block - m], starts[block - m + 1]
            bounds[begin] = bounds[block]
            if end - begin > 1:
                for r in range(rows):
                    lines = (lines_of[row + r], lines_rest[row + r, kind])
                    _bound((r, linear, level), lines, track, (begin, end), room)
                _join(paired, most_of, (begin, end), room)
            top = begin
            for c in range(begin + 1, end):
                top = c if bounds[c] > bounds[top] else top
            for turn in range(begin - 1, end):
                c = top if turn < begin else turn
                if not bounds[c] > limit or turn == top:
                    continue
                if seen == _CANDIDATES:
                    left = max(left, bounds[c])
                    continue
                seen += 1
                for r in range(rows):
                    for j in range(s):
                        i = c * s + j
                        u = course[2, i] if linear else course[0, i]
                        values[r, j] = (
                            of[row + r, 0, i] * (u - level)
                            + of[row + r, 1, i] * course[1, i]
                            + (rest[row + r, kind, 0, i] + rest[row + r, kind, 1, i] * level)
                        )
                for j in range(s):
                    if paired:
                        values[2, j] = math.sqrt(values[0, j] ** 2 + values[1, j] ** 2)
                    else:
                        values[2, j] = abs(values[0, j])
                size, x = _top(paired, values, gauss, limit)
                if size > highest:
                    one = other = 0.0
                    for j in range(s):
                        one += gauss[1, j] * values[0, j]
                        other += gauss[1, j] * values[1, j]
                    highest, tail = size, math.sqrt(one * one + other * other)
                    place = edges[c] + x * (edges[c + 1] - edges[c])
                    places[k, 0], places[k, 1] = c, x
                    limit = highest + _ROUNDING * max(scale, highest)
        if highest >= 0.0:
            peaks[k, 0], peaks[k, 1], peaks[k, 2] = highest, place, tail + max(left - highest, 0.0)


@kernel
def _bound(
    which: tuple[int, bool, float],
    lines: tuple[Array, Array],
    track: Array,
    span: tuple[int, int],
    room: Array,
) -> None:
    """Fill middle, rise and rest of a curve in cells, or blocks, from some number to another.

    (a + a' x + da) (u + u' x + du) is straight but for a' u' x^2, which is a' u' / 4 at most, da u
    and (a + a' x) du. which : component, whether u is of omega, and the level p
    """
    (r, linear, level), (of, rest) = which, lines
    a0, a1, ar, b0, b1, br = of[0], of[1], of[2], of[3], of[4], of[5]
    c0, c1, cr, d0, d1, dr = rest[0], rest[1], rest[2], rest[3], rest[4], rest[5]
    first = 6 if linear else 0
    u0, u1, ur, v0, v1, vr = (
        track[first],
        track[first + 1],
        track[first + 2],
        track[3],
        track[4],
        track[5],
    )
    middle, rise, rests, size = room[3 * r], room[3 * r + 1], room[3 * r + 2], abs(level)
    for c in range(span[0], span[1]):
        w = u0[c] - level
        middle[c] = a0[c] * w + b0[c] * v0[c] + (c0[c] + d0[c] * level)
        rise[c] = (
            a0[c] * u1[c] + a1[c] * w + b0[c] * v1[c] + b1[c] * v0[c] + (c1[c] + d1[c] * level)
        )
        rests[c] = (
            0.25 * (abs(a1[c] * u1[c]) + abs(b1[c] * v1[c]))
            + ar[c] * (abs(w) + 0.5 * abs(u1[c]) + ur[c])
            + (abs(a0[c]) + 0.5 * abs(a1[c])) * ur[c]
            + br[c] * (abs(v0[c]) + 0.5 * abs(v1[c]) + vr[c])
            + (abs(b0[c]) + 0.5 * abs(b1[c])) * vr[c]
            + cr[c]
            + dr[c] * size
        )


@kernel
def _join(paired: bool, most_of: float, span: tuple[int, int], room: Array) -> None:
    """Fill what the size of a curve does not exceed."""
    bounds = room[6]
    if paired:
        for c in range(span[0], span[1]):
            x, y, over_x, over_y = room[0, c], room[3, c], 0.5 * room[1, c], 0.5 * room[4, c]
            before = (x - over_x) ** 2 + (y - over_y) ** 2
            after = (x + over_x) ** 2 + (y + over_y) ** 2
            larger = after if after > before else before
            bounds[c] = math.sqrt(larger) + most_of * (room[2, c] + room[5, c])
    else:
        for c in range(span[0], span[1]):
            bounds[c] = abs(room[0, c]) + 0.5 * abs(room[1, c]) + most_of * room[2, c]


@kernel
def _top(paired: bool, values: Array, gauss: Array, least: float) -> tuple[float, float]:
    """The largest size of a curve in a cell and where it is, from 0 to 1; by parabolas around every
    node, or end, from which it could rise above what is found and a number.

    values : at the nodes, two components, of which the second one may be 0, and their size
    """
    first, second, size = values[0], values[1], values[2]
    nodes, barycentric = gauss[0], gauss[1]
    s = len(nodes)
    highest, place = -1.0, 0.0
    begins, ends, falls, slopes = 0.0, 0.0, 0.0, 0.0
    for side in range(2):
        one = other = d_one = d_other = 0.0
        for j in range(s):
            one += gauss[2 + side, j] * first[j]
            d_one += gauss[4 + side, j] * first[j]
            if paired:
                other += gauss[2 + side, j] * second[j]
                d_other += gauss[4 + side, j] * second[j]
        of_end = math.sqrt(one * one + other * other) if paired else abs(one)
        slope = (one * d_one + other * d_other) / of_end if of_end > 0.0 else 0.0
        if side == 0:
            begins, slopes = of_end, slope
        else:
            ends, falls = of_end, -slope
        if of_end > highest:
            highest, place = of_end, float(side)
    for j in range(s):
        if size[j] > highest:
            highest, place = size[j], nodes[j]
    for j in range(-1, s + 1):
        if j < 0 or j == s:
            end, of_end, fall = (0.0, begins, slopes) if j < 0 else (1.0, ends, falls)
            node = 0 if j < 0 else s - 1
            gap = abs(end - nodes[node])
            if of_end <= size[node] or fall <= 0.0:
                continue
            far = 0.5 * fall * gap * gap / (of_end + fall * gap - size[node])
            if of_end + fall * far <= max(least, highest):
                continue
            a, of_a, x, b, of_b = (
                nodes[node],
                size[node],
                end + (nodes[node] - end) * far / gap,
                end,
                of_end,
            )
            of_x = -1.0
        else:
            a, of_a = (nodes[j - 1], size[j - 1]) if j > 0 else (0.0, begins)
            b, of_b = (nodes[j + 1], size[j + 1]) if j + 1 < s else (1.0, ends)
            x, of_x = nodes[j], size[j]
            if of_a > of_x or of_b > of_x:
                continue
            beyond = of_x + gauss[6, j] * (of_x - of_a) + gauss[7, j] * (of_x - of_b)
            if beyond <= max(least, highest):
                continue
        if a > b:
            a, of_a, b, of_b = b, of_b, a, of_a
        for _ in range(_STEPS):
            u = x
            if of_x >= 0.0:
                left, right = (x - a) * (of_x - of_b), (x - b) * (of_x - of_a)
                both = left - right
                move = 0.5 * ((x - b) * right - (x - a) * left) / both if both != 0.0 else 0.0
                u = x + move
                if abs(move) <= _CLOSE:  # by luck, perhaps, where a neighbour is far
                    if b - x > 2.0 * _BESIDE:
                        u = x + _BESIDE
                    elif x - a > 2.0 * _BESIDE:
                        u = x - _BESIDE
                    else:
                        break
                elif not a < u < b:
                    u = 0.5 * (x + (a if x - a > b - x else b))
            total = one = other = 0.0
            for i in range(s):
                apart = u - nodes[i]
                weight = barycentric[i] / (apart if apart != 0.0 else 1e-300)
                total += weight
                one += weight * first[i]
                if paired:
                    other += weight * second[i]
            of_u = math.sqrt(one * one + other * other) / abs(total) if paired else abs(one / total)
            if of_x < 0.0:
                of_x = of_u
            elif of_u > of_x:
                a, of_a, b, of_b = (a, of_a, x, of_x) if u < x else (x, of_x, b, of_b)
                x, of_x = u, of_u
            elif u < x:
                a, of_a = u, of_u
            else:
                b, of_b = u, of_u
        if of_x > highest:
            highest, place = of_x, x
    return highest, place


@kernel
def _means(
    row: int,
    rows: int,
    curves: Curves,
    motions: tuple[Array, Array, Array],
    rule: Rule,
    found: Array,
) -> None:
    """Fill the integral over time of the size of a force for every case.

    motions : courses; width times weight of the nodes; width of the cells
    """
    (of, rest, _, _), (courses, share, width) = curves, motions
    n = len(share)
    first, second, size, none = np.empty(n), np.empty(n), np.empty(n), np.empty(0)
    for k in range(len(found)):
        course = courses[k]
        _put_together(of[row], rest[row, 0, 0], course, first)
        if rows == 2:
            _put_together(of[row + 1], rest[row + 1, 0, 0], course, second)
            for i in range(n):
                size[i] = math.sqrt(first[i] * first[i] + second[i] * second[i])
            found[k] = _integral((first, second, size), (course[3], share), width, rule)
        else:
            found[k] = _integral((first, none, first), (course[3], share), width, rule)


@kernel
def _put_together(of: Array, constant: Array, course: Array, curve: Array) -> None:
    """Fill A omega^2 + B alpha + C."""
    a, b, square, alpha = of[0], of[1], course[0], course[1]
    for i in range(len(curve)):
        curve[i] = a[i] * square[i] + b[i] * alpha[i] + constant[i]


@kernel
def _integral(
    curve: tuple[Array, Array, Array], over: tuple[Array, Array], width: Array, rule: Rule
) -> float:
    """Integral of a size over time; over : 1 / |omega|, and its weights over the angle.

    Where a force is small beside what it changes by its size bends. There the cell is split where
    a single component passes zero; else it is halved until it does not bend, or is small enough.
    """
    (first, second, size), (slow, share), (_, weights, nodes, _) = curve, over, rule
    s, total = len(nodes), 0.0
    paired = len(second) > 0
    halves, made = np.empty((2, s, s)), False
    stack, depths = np.empty((_DEEPEST + 2, 3, s)), np.empty(_DEEPEST + 2, np.intp)
    stack[:] = 0.0
    piece = np.empty((3, s))
    for c in range(len(width)):
        low, high = c * s, c * s + s - 1
        least, sum_of_cell = math.inf, 0.0
        for i in range(low, high + 1):
            least = min(least, abs(size[i]))
            sum_of_cell += share[i] * slow[i] * abs(size[i])
        across = first[high] - first[low]
        other = second[high] - second[low] if paired else 0.0
        if least * least >= _BENT * _BENT * (across * across + other * other):
            total += sum_of_cell
            continue
        if not made:
            made = True
            for side in range(2):
                for j in range(s):
                    _basis(0.5 * (nodes[j] + side), rule, halves[side, j])
        for j in range(s):
            stack[0, 0, j], stack[0, 2, j] = first[low + j], slow[low + j]
            if paired:
                stack[0, 1, j] = second[low + j]
        split = -1.0 if paired else _split(stack[0, 0], stack[0, 2], rule)
        if split >= 0.0:
            total += width[c] * split
            continue
        depths[0], left = 0, 1
        while left > 0:
            left -= 1
            depth = depths[left] + 1
            piece[:] = stack[left]
            for side in range(2):
                half, to = halves[side], stack[left]
                for part in range(3):
                    for j in range(s):
                        to[part, j] = 0.0
                        for i in range(s):
                            to[part, j] += half[j, i] * piece[part, i]
                least, sum_of_piece = math.inf, 0.0
                for j in range(s):
                    here = math.sqrt(to[0, j] * to[0, j] + to[1, j] * to[1, j])
                    least = min(least, here)
                    sum_of_piece += weights[j] * to[2, j] * here
                across, other = to[0, s - 1] - to[0, 0], to[1, s - 1] - to[1, 0]
                bent = least * least < _BENT * _BENT * (across * across + other * other)
                if bent and depth < _DEEPEST:
                    depths[left] = depth
                    left += 1
                else:
                    total += 0.5**depth * width[c] * sum_of_piece
    return total


@kernel
def _value(x: float, values: Array, rule: Rule) -> float:
    """The polynomial through values at the nodes, somewhere in a cell, from 0 to 1."""
    _, _, nodes, barycentric = rule
    above = below = 0.0
    for j in range(len(nodes)):
        apart = x - nodes[j]
        weight = barycentric[j] / (apart if apart != 0.0 else 1e-300)
        above, below = above + weight * values[j], below + weight
    return above / below


@kernel
def _split(force: Array, slow: Array, rule: Rule) -> float:
    """The integral over a cell, from 0 to 1, of the size of a force times another, on both sides of
    where it passes zero; negative where it does so more than once."""
    _, weights, nodes, _ = rule
    s, passes, end, x = len(nodes), 0, 1.0, 0.0
    a, b, of_a, of_b = 0.0, 0.0, 0.0, 0.0
    before, of_before = 0.0, _value(0.0, force, rule)
    for j in range(s + 1):
        here, of_here = (nodes[j], force[j]) if j < s else (end, _value(end, force, rule))
        if (of_here > 0.0) != (of_before > 0.0):
            passes, a, b, of_a, of_b = passes + 1, before, here, of_before, of_here
        before, of_before = here, of_here
    if passes > 1:
        return -1.0
    kept = 0
    for _ in range(_STEPS if passes == 1 else 0):  # regula falsi; an end kept twice counts half
        x = a - of_a * (b - a) / (of_b - of_a)
        of_x = _value(x, force, rule)
        if (of_x > 0.0) == (of_b > 0.0):
            of_a, kept = of_a * (0.5 if kept < 0 else 1.0), -1
            b, of_b = x, of_x
        else:
            of_b, kept = of_b * (0.5 if kept > 0 else 1.0), 1
            a, of_a = x, of_x
        if of_x == 0.0 or b - a < _CLOSE:
            break
    total = 0.0
    for side in range(2):
        begin, wide = (0.0, x) if side == 0 else (x, 1.0 - x)
        for j in range(s if wide > 0.0 else 0):
            at = begin + wide * nodes[j]
            total += wide * weights[j] * abs(_value(at, force, rule)) * _value(at, slow, rule)
    return total
