"""Where curves of motions have their peaks: loops over curves and cases, compiled by numba
(`crankmbs.numerics.kernels`).

Every curve is A u + B alpha + C + D p, where u is omega^2 - p, or omega - p, with a level p; and A,
B, C and D are of the angle alone. Between the nodes of a cell all is the polynomial through them.

No curve is made as a whole. Within a cell, and within a block of cells, what it is made of is
straight but for a rest (`crankmbs.batch.straight`), so that the curve is, but for a rest which is
bounded. Only where that could exceed what is found it is made, and sought in. A second pass with
another rule looks where the first one found the peaks: what it has there tells how far they are
off.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.numerics.kernels import kernel

__all__ = ["find"]

Curves = tuple[Array, Array, Array, Array]  # A and B, C and D; both in straight lines
Indices = NDArray[np.intp]

_STEPS, _CLOSE, _BESIDE = 16, 1e-7, 1e-4  # towards a peak; of a cell
_CANDIDATES = 64  # cells of a curve that are sought in; more are ripples of rounding
_ROUNDING = 64 * 2.0**-52  # of a quantity
_TAILS = 2.0  # times the last coefficient: what the polynomial of a cell misses at its ends


@kernel
def find(
    sought: bool,
    asked: Indices,
    curves: Curves,
    grid: tuple[Array, Indices, Array],
    motions: tuple[Array, Array, Array],
    found: tuple[Array, Array],
) -> None:
    """Fill the largest sizes of curves over the period, the angles turned to there [rad] and what
    they may err: how much more any cell could have by the last coefficient of its polynomial. Where
    they are is sought and filled, or given; then no error is told.

    asked : shape (q, 8); of every curve its first row, how many rows make it up, number of C and D,
        whether u is of omega, number of its level, of the curve before whose size has a rounding
        that is nothing to it, of the one before that is the same, or -1, and whether it is the
        same in every case
    curves : as `crankmbs.batch.walk.walk` has them
    grid : `crankmbs.batch.curves.Grid`
    motions : omega^2, alpha and omega of the cases, shape (k, 3, n), and all three in straight
        lines, shape (k, 9, m + b); and levels p, no numbers where there is no motion, shape (k,
        any)
    found : cells and places in them, 0 to 1, shape (k, q, 2); filled, sizes, angles and errors,
        shape (k, q, 3); no numbers where there is no motion
    """
    (courses, tracks, levels), (places, peaks), s = motions, found, grid[2].shape[1]
    room, first = (np.empty((7, tracks.shape[2])), np.zeros((3, s))), 0
    while first < len(levels) and levels[first, 0] != levels[first, 0]:
        first += 1
    peaks[:] = math.nan
    if sought:
        places[:] = math.nan
    for q in range(len(asked)):
        row, rows, kind, linear, of_level, base, twin, steady = asked[q]
        which = row, rows, kind, linear > 0
        for k in range(first, len(levels)):
            if levels[k, 0] != levels[k, 0]:
                continue
            like, one = (k, twin) if twin >= 0 else (first if steady > 0 else k, q)
            if like != k or one != q:
                for i in range(3):
                    peaks[k, q, i] = peaks[like, one, i]
                for i in range(2):
                    places[k, q, i] = places[like, one, i]
                continue
            level, scale = levels[k, of_level], peaks[k, base, 0] if base >= 0 else 0.0
            motion, into = (courses[k], tracks[k], level, scale), (places[k, q], peaks[k, q])
            if sought:
                _seek(which, curves, grid, motion, (room, into))
            else:
                _look(which, curves, grid, motion, (room, into))


@kernel
def _look(
    which: tuple[int, int, int, bool],
    curves: Curves,
    grid: tuple[Array, Indices, Array],
    motion: tuple[Array, Array, float, float],
    found: tuple[tuple[Array, Array], tuple[Array, Array]],
) -> None:
    """Do so for one curve of one case where it is given."""
    (row, rows, kind, linear), (of, rest, _, _), (edges, _, gauss) = which, curves, grid
    (course, _, level, _), ((_, values), ((cell, x), peak)) = motion, found
    if cell != cell:
        return
    c, squares = int(cell), 0.0
    for r in range(rows):
        _make((c, linear, level), of[row + r], rest[row + r, kind], course, values[r])
        above = below = 0.0
        for j in range(gauss.shape[1]):
            apart = x - gauss[0, j]
            weight = gauss[1, j] / (apart if apart != 0.0 else 1e-200)
            above, below = above + weight * values[r, j], below + weight
        squares += (above / below) ** 2
    peak[0], peak[2] = math.sqrt(squares), 0.0
    peak[1] = edges[c] + x * (edges[c + 1] - edges[c])


@kernel
def _seek(
    which: tuple[int, int, int, bool],
    curves: Curves,
    grid: tuple[Array, Indices, Array],
    motion: tuple[Array, Array, float, float],
    found: tuple[tuple[Array, Array], tuple[Array, Array]],
) -> None:
    """Do so for one curve of one case; which : the first four of what is `asked`; motion : course
    and track, p, and the scale whose rounding is nothing; found : room for bounds and values, and
    what is filled."""
    (row, rows, kind, linear), (of, rest, lines_of, lines_rest) = which, curves
    (edges, starts, gauss), ((room, values), (there, peak)) = grid, found
    (course, track, level, scale), bounds = motion, room[6]
    m, s, blocks = len(edges) - 1, gauss.shape[1], len(starts) - 1
    most_of, paired = 0.0, rows == 2
    for j in range(s):
        most_of += abs(gauss[3, j])
    highest, limit, left, seen = -1.0, -1.0, -1.0, 0
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
                _make((c, linear, level), of[row + r], rest[row + r, kind], course, values[r])
            for j in range(s):
                if paired:
                    values[2, j] = math.sqrt(values[0, j] ** 2 + values[1, j] ** 2)
                else:
                    values[2, j] = abs(values[0, j])
            size, x = _top(paired, values, gauss, limit)
            one = other = 0.0
            for j in range(s):
                one += gauss[1, j] * values[0, j]
                other += gauss[1, j] * values[1, j]
            tail = math.sqrt(one * one + (other * other if paired else 0.0))
            left = max(left, size + _TAILS * tail)
            if size > highest:
                highest, limit = size, size + _ROUNDING * max(scale, size)
                there[0], there[1] = c, x
                peak[0], peak[1] = size, edges[c] + x * (edges[c + 1] - edges[c])
    peak[2] = left - highest


@kernel
def _make(
    which: tuple[int, bool, float], of: Array, rest: Array, course: Array, values: Array
) -> None:
    """Fill what one component of a curve is at the nodes of a cell; which : the cell, whether u is
    of omega, and the level p."""
    (c, linear, level), s = which, len(values)
    for j in range(s):
        i = c * s + j
        u = course[2, i] if linear else course[0, i]
        values[j] = (
            of[0, i] * (u - level) + of[1, i] * course[1, i] + (rest[0, i] + rest[1, i] * level)
        )


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
                weight = barycentric[i] / (apart if apart != 0.0 else 1e-200)
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
