"""What motions of one machine over a period amount to: loops over cases, compiled by numba
(`crankmbs.numerics.kernels`).

Of a case only the crank's inertia and the loads are its own. Every force is A omega^2 + B alpha +
C, with A, B and C of the angle alone. Between the nodes of a cell all is the polynomial through
them.

Kernels of one file call none of another, so that they stand together here, over 300 lines.
"""

from __future__ import annotations

import math

import numpy as np

from crankmbs.batch.lanes import LANES
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["walk"]

Rule = tuple[
    Array, Array, Array, Array
]  # matrix, weights, nodes, and what makes of the values there
# the last coefficient of Legendre polynomials: the nodes' barycentric weights, too
Outline = tuple[Array, Array, Array]  # of the cells: width, and what `_reaching` fills
Curve = tuple[Array, Array, Array]  # two components at the nodes and their size; of one alone, it,
# an empty one, and it again

_STEPS, _CLOSE, _BESIDE = 12, 1e-7, 0.1  # towards a peak; of a cell; of the way from its end
_BENT = 0.6  # of what a force changes by across a piece: where it is less it has a bend, or nearly
_DEEPEST = 8  # halvings of a cell
_CANDIDATES = 64  # of a curve's peak; more are ripples of rounding
_ROUNDING = 64 * 2.0**-52  # of a quantity


@kernel
def walk(
    about: tuple[float, bool, int, int],
    rule: Rule,
    of_angle: tuple[Array, Array, Array, Array],
    parts: tuple[Array, Array, Array, Array],
    motions: tuple[Array, Array],
    columns: Array,
) -> None:
    """Fill the columns of every case from its energies over one period.

    about : sense of rotation; whether the motions repeat themselves, so that the first cell follows
        the last one; number of the quantity of which the first part belongs to omega instead of
        omega^2; of columns before those of joints
    of_angle : width [rad] of the m cells, and at their s nodes J without the crank's, dJ/dtheta and
        the torque, shape (m, s)
    parts : what belongs to omega^2, alpha and 1, at the n = m s nodes: of forces, shape (rows, 3,
        n), those of joints in pairs of x and y, then the side forces; of the torque of all rods,
        shape (1, 3, n); of the quantities of the lectures, shape (q, 3, n); and what the lectures
        say of them at a constant speed, shape (q, lectures, 2, n), what belongs to omega^2 and to 1
    motions : of the cases, beside one another as `crankmbs.batch.lanes` lays them; inertia of the
        crank [kg m2], c0, c1 and c2 of the loads, shape (groups, 4 or more, LANES); the energy [J]
        at the nodes, shape (groups, m, s, LANES), no number where there is no motion
    columns : filled, shape (k, columns), but for the first two; no numbers where there is no
        motion: duration [s], greatest and least energy [J], highest and lowest speed, mean torque
        of all rods and from outside, what both speeds may err; of every joint its peak, the angle
        turned to it, its mean over time and what the peak may err; of every quantity its peak and
        what that may err, and for each lecture its largest deviation and that one's
    """
    (sense, closed, linear, own_columns), (width, inertia, slope, torque) = about, of_angle
    forces, rods, quantities, lectures = parts
    (cases, energy), weights = motions, rule[1]
    m, s = inertia.shape
    n, count = m * s, len(columns)
    square, alpha, slow = np.empty((count, n)), np.empty((count, n)), np.empty((count, n))
    first, second, size, share = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    none, turned = np.empty(0), 0.0
    for c in range(m):
        turned += width[c]
        for j in range(s):
            share[c * s + j] = width[c] * weights[j]
    outline = (width, np.empty((2, n)), np.empty(m))
    _reaching(closed, outline, rule)
    for k in range(count):
        out, g, l = columns[k], k // LANES, k % LANES
        out[2:] = math.nan
        if energy[g, 0, 0, l] != energy[g, 0, 0, l]:
            continue
        time, work, outside, fastest = 0.0, 0.0, 0.0, 0.0
        most, least = 0.0, math.inf
        for c in range(m):
            for j in range(s):
                i, total = c * s + j, inertia[c, j] + cases[g, 0, l]
                w2 = 2.0 * energy[g, c, j, l] / total
                w = sense * math.sqrt(w2)
                load = cases[g, 1, l] + cases[g, 2, l] * w + cases[g, 3, l] * w2
                rate = (torque[c, j] + load - 0.5 * slope[c, j] * w2) / total
                square[k, i], alpha[k, i], slow[k, i], first[i] = w2, rate, 1.0 / abs(w), abs(w)
                most, least = max(most, energy[g, c, j, l]), min(least, energy[g, c, j, l])
                time += share[i] * slow[k, i]
                outside += share[i] * load
                work += share[i] * (rods[0, 0, i] * w2 + rods[0, 1, i] * rate + rods[0, 2, i])
                fastest = max(fastest, first[i])
        out[2], out[3], out[4] = time, most, least
        out[5], _, out[9] = _highest(closed, (first, none, first), outline, rule, 0.0)
        for i in range(n):
            second[i] = 2.0 * fastest - first[i]
        slowest, _, out[10] = _highest(closed, (second, none, second), outline, rule, 0.0)
        out[6] = 2.0 * fastest - slowest
        out[7], out[8] = work / turned, outside / turned
    rows = len(forces)
    joints = (columns.shape[1] - own_columns - 2 * len(quantities) * (1 + lectures.shape[1])) // 4
    at, row, pairs = (
        own_columns,
        0,
        rows - joints,
    )  # tables outside, cases inside: they stay in the cache
    for joint in range(joints):
        for k in range(count):
            if columns[k, 2] != columns[k, 2]:
                continue
            _put_together(forces[row], square[k], alpha[k], first)
            if joint < pairs:
                _put_together(forces[row + 1], square[k], alpha[k], second)
                for i in range(n):
                    size[i] = math.sqrt(first[i] * first[i] + second[i] * second[i])
            curve = (first, second, size) if joint < pairs else (first, none, first)
            columns[k, at], columns[k, at + 1], columns[k, at + 3] = _highest(
                closed, curve, outline, rule, 0.0
            )
            columns[k, at + 2] = _integral(curve, (slow[k], share), width, rule) / columns[k, 2]
        at, row = at + 4, row + (2 if joint < pairs else 1)
    for q in range(len(quantities)):
        of = quantities[q]
        for k in range(count):
            time = columns[k, 2]
            if time != time:
                continue
            mean = sense * turned / time
            _put_together(of, square[k], alpha[k], first)
            if q == linear:
                for i in range(n):
                    first[i] = of[0, i] * sense / slow[k, i]
            peak, _, rough = _highest(closed, (first, none, first), outline, rule, 0.0)
            columns[k, at], columns[k, at + 1] = peak, rough
            for lecture in range(lectures.shape[1]):
                said = lectures[q, lecture]
                power = mean if q == linear else mean * mean
                for i in range(n):
                    second[i] = said[0, i] * power + said[1, i] - first[i]
                most, _, rough = _highest(closed, (second, none, second), outline, rule, peak)
                columns[k, at + 2 + 2 * lecture] = most
                columns[k, at + 3 + 2 * lecture] = rough
        at += 2 * (1 + lectures.shape[1])


@kernel
def _put_together(parts: Array, square: Array, alpha: Array, curve: Array) -> None:
    """Fill A omega^2 + B alpha + C."""
    for i in range(len(curve)):
        curve[i] = parts[0, i] * square[i] + parts[1, i] * alpha[i] + parts[2, i]


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
def _reaching(closed: bool, outline: Outline, rule: Rule) -> None:
    """Fill by how much a parabola may rise above a node that its neighbours do not exceed: parts of
    what either lies below it, shape (2, nodes), and the largest sum of both in every cell.

    With the gaps g and h to its neighbours, which lie b and c below it, that is at most
    b (1 + h / 4 g) + c (1 + g / 4 h). At the ends of what is not closed a gap goes to the end,
    which is taken to lie no lower.
    """
    (width, lean, reach), nodes = outline, rule[2]
    s, m = len(nodes), len(width)
    for c in range(m):
        reach[c] = 0.0
        for j in range(s):
            behind = (nodes[j] - nodes[j - 1]) * width[c] if j > 0 else nodes[0] * width[c]
            ahead = (nodes[j + 1] if j + 1 < s else 1.0) * width[c] - nodes[j] * width[c]
            if j == 0 and (c > 0 or closed):
                behind += (1.0 - nodes[s - 1]) * width[c - 1 if c > 0 else m - 1]
            if j + 1 == s and (c + 1 < m or closed):
                ahead += nodes[0] * width[c + 1 if c + 1 < m else 0]
            lean[0, c * s + j] = 1.0 + 0.25 * ahead / behind
            lean[1, c * s + j] = 1.0 + 0.25 * behind / ahead
            reach[c] = max(reach[c], lean[0, c * s + j] + lean[1, c * s + j])


@kernel
def _highest(
    closed: bool, curve: Curve, outline: Outline, rule: Rule, scale: float
) -> tuple[float, float, float]:
    """The largest size of a curve over the period, the angle turned to it [rad], and the size of
    the last coefficient in its cell, about what the polynomial there errs.

    Around every node that no neighbour exceeds, and from which the curve, bending as it does there,
    could rise above what is found, it is sought in the cell; at the cell's ends in the next one
    too. What cannot rise by more than the rounding of ``scale`` is left as the nodes have it.
    """
    (first, second, size), (_, _, nodes, barycentric) = curve, rule
    (width, lean, reach), s = outline, len(nodes)
    m = len(width)
    n, highest, cell, place, seen = s * m, -1.0, 0, 0.0, 0
    rises, top = np.empty(m), 0
    before = abs(size[n - 1 if closed else 0])
    for c in range(m):
        most, low = 0.0, before
        for i in range(c * s, c * s + s):
            here = abs(size[i])
            most = here if here > most else most
            low = here if here < low else low
        before = abs(size[c * s + s - 1])
        after = abs(size[c * s + s if c + 1 < m else (0 if closed else n - 1)])
        low = after if after < low else low
        rises[c] = most + reach[c] * (most - low)
        if most > highest:
            highest, top = most, c
    cell, rounding = top, _ROUNDING * max(scale, highest)
    for j in range(s):
        if abs(size[top * s + j]) == highest:
            place = nodes[j]
    for k in range(-1, m):
        c = top if k < 0 else k
        if rises[c] <= highest + rounding or (c == top and k >= 0):
            continue
        for j in range(s):
            i = c * s + j
            here = abs(size[i])
            before = abs(size[i - 1 if i > 0 else (n - 1 if closed else 0)])
            after = abs(size[i + 1 if i + 1 < n else (0 if closed else n - 1)])
            beyond = here + lean[0, i] * (here - before) + lean[1, i] * (here - after)
            if beyond <= highest + rounding or here < before or here < after:
                continue
            if seen == _CANDIDATES:
                break
            seen += 1
            for side in range(-1, 2):
                if (side < 0 and j > 0) or (side > 0 and j + 1 < s):
                    continue
                node = j if side == 0 else (s - 1 if side < 0 else 0)
                at = (c + side) % m
                if not closed and at != c + side:
                    continue
                found, x = _climb(node, curve, at * s, nodes, barycentric)
                if found >= highest:
                    highest, cell, place = found, at, x
    turned = 0.0
    for c in range(cell):
        turned += width[c]
    one = other = 0.0
    for j in range(s):
        one += barycentric[j] * first[cell * s + j]
        if len(second) > 0:
            other += barycentric[j] * second[cell * s + j]
    return highest, turned + place * width[cell], math.sqrt(one * one + other * other)


@kernel
def _climb(
    node: int, curve: Curve, begin: int, nodes: Array, barycentric: Array
) -> tuple[float, float]:
    """The largest size of a curve between the neighbours of a node in the cell whose nodes begin at
    a number, and where it is, by parabolas; beyond its outermost nodes a cell's ends are their
    neighbours, and where one is larger it is looked for beside it."""
    first, second, size = curve
    s, paired = len(nodes), len(second) > 0
    x, of_x = nodes[node], abs(size[begin + node])
    a, of_a, b, of_b = 0.0, -1.0, 1.0, -1.0
    if node > 0:
        a, of_a = nodes[node - 1], abs(size[begin + node - 1])
    if node + 1 < s:
        b, of_b = nodes[node + 1], abs(size[begin + node + 1])
    looks = 0  # beside an end that is larger
    for _ in range(_STEPS):
        at_end = of_a > of_x or of_b > of_x
        left, right = (x - a) * (of_x - of_b), (x - b) * (of_x - of_a)
        both = left - right
        move = 0.5 * ((x - b) * right - (x - a) * left) / both if both != 0.0 else 0.0
        if of_a < 0.0:
            u = a
        elif of_b < 0.0:
            u = b
        elif at_end:
            end, of_end = (a, of_a) if of_a > of_b else (b, of_b)
            if 0.0 < end < 1.0:
                return of_x, x
            u = end + _BESIDE * (x - end) if looks == 0 else x + move
            if looks == 2 or not min(x, end) < u < max(x, end):
                return of_end, end
        else:
            if abs(move) <= _CLOSE:
                break
            u = x + move
            if not a < u < b:
                u = 0.5 * (x + (a if x - a > b - x else b))
        total = one = other = 0.0
        for j in range(s):
            apart = u - nodes[j]
            weight = barycentric[j] / (apart if apart != 0.0 else 1e-300)
            total += weight
            one += weight * first[begin + j]
            if paired:
                other += weight * second[begin + j]
        of_u = abs(one / total) if not paired else math.sqrt(one * one + other * other) / abs(total)
        if of_a < 0.0:
            of_a = of_u
        elif of_b < 0.0:
            of_b = of_u
        elif at_end:
            looks += 1
            if end == a:
                b, of_b, x, of_x = x, of_x, u, of_u
            else:
                a, of_a, x, of_x = x, of_x, u, of_u
        elif of_u > of_x:
            a, of_a, b, of_b = (a, of_a, x, of_x) if u < x else (x, of_x, b, of_b)
            x, of_x = u, of_u
        elif u < x:
            a, of_a = u, of_u
        else:
            b, of_b = u, of_u
    return of_x, x


@kernel
def _integral(curve: Curve, over: tuple[Array, Array], width: Array, rule: Rule) -> float:
    """Integral of a size over time; over : 1 / |omega|, and its weights over the angle.

    Where a force is small beside what it changes by its size bends: there cells are halved until
    it is not, or they are small enough.
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
