"""Where cells of the crank angle are cut because loads bend inside them, or rings feel a gas force
that changes its sign.

A Gauss rule of s nodes misses of a kink at the position c of a cell, where the torque's slope
changes by b per cell, at most b min(c^2 / 2, (1 - c)^2 / 2, 0.31 / s^2) of the mean torque. The
cells are solved with the loads as they are; where the kinks in one of them are worth more than may
be missed they become edges, and all is solved again; where they are worth little more, on a grid
that checks another, what the rule misses of them is computed and added. Rows of a fine table are so
stepped over, and their number costs nothing.

Without fuel the angles at which gas forces change their sign are known, and edges of the grid. With
fuel they move with the share of the combustion that acts, which is known once the cells are solved:
between two knots the pressure is a cubic, given by its values at the nodes, and its roots become
edges. As they are those of the shares and not of the motion, solving again moves them no more than
the shares err.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.torque import Course
from crankmbs.motion.crank_angle.segment import AngleSegment
from crankmbs.numerics.arrays import Array, Index, largest_of_row
from crankmbs.numerics.lagrange import Lagrange, at_nodes, ends_and_nodes

__all__ = ["Missing", "sign_changes_in", "what_misses"]

_WORST = 0.31  # over s^2: what s nodes miss of a kink of slope 1; (pi / 2)^2 / 8, for many nodes
_MENDED = 50.0  # times what may be missed: kinks whose errors, known to a hundredth, are added
_CALM = 0.01  # of a cell's energy, by the slopes of its loads: what a missed kink feeds back
_AT_EDGE = 1e-7  # rad: a root so near an edge is there
_LITTLE = 1e-3  # of what a cell may miss: a kink worth less stays in it beside others


class _Passed(NamedTuple):
    """Rows that a variable of the loads passes, shape (n,) each.

    cell, row : their numbers; low, high : positions in the cell, 0 to 1, of points around it;
    rises : sign of the slope; missed [J]
    """

    cell: Index
    row: Index
    low: Array
    high: Array
    rises: Array
    missed: Array

    def select(self, which: NDArray[np.bool_]) -> _Passed:
        """Some of them."""
        return _Passed._make(part[which] for part in self)


class _Points(NamedTuple):
    """A variable at begin, nodes and end of some cells: the polynomials through them, values, rows,
    and bends of the torque's slope there; the cells' numbers and widths, and what each may miss
    [J]."""

    through: Lagrange
    values: Array
    rows: Array
    bends: Array
    cell: Index
    width: Array
    least: Array


class Missing(NamedTuple):
    """What cells miss at kinks.

    marks : angles turned [rad] at which cells that miss too much are to be cut
    gained [J] : in each of the others, to be added
    """

    marks: Array
    gained: Array


def what_misses(segment: AngleSegment, allowed: float) -> Missing:
    """What the cells of a segment miss at kinks of its loads.

    On a grid that checks another, little kinks cut no cell: their errors are known well enough to
    be added. Elsewhere the finer rule by which the cells' errors are read would count them again.

    allowed [1/rad] : of the energy that a cell may miss at kinks, per radian
    """
    width, k, x = segment.terms.width, np.empty(0, dtype=np.intp), np.empty(0)
    least = allowed * width * segment.energy[1:]
    missed, gained = np.zeros_like(least), np.zeros_like(least)
    if not isinstance(segment.branch, Course):
        return Missing(x, gained)
    blocks = [
        (points, _passed(points), _turns(points))
        for points in _near_rows(segment, segment.branch, least)
    ]
    for points, rows, _ in blocks:
        missed += np.bincount(points.cell[rows.cell], rows.missed, len(least))
    bad = missed > least
    mended = bad & (missed < _MENDED * least) & segment.grid.checks & segment.branch.is_steady
    mended[mended] = np.abs(segment.rate(mended)).sum(axis=1) * width[mended] < _CALM
    for points, _, (turning, _) in blocks:
        mended[points.cell[turning]] = False
    for points, rows, (turning, tops) in blocks:
        worth = bad[points.cell][rows.cell] & (rows.missed > _LITTLE * points.least[rows.cell])
        passed = rows.select(worth)
        cell = points.cell[passed.cell]
        of, between = (points.values, passed.cell), (passed.low, passed.high)
        at = points.through.inverse(*of, points.rows[passed.row], *between)
        added = mended[cell]
        more = _gained(points, passed.select(added), at[added], segment)
        gained += np.bincount(cell[added], more, len(gained))
        k = np.concatenate([k, cell[~added], points.cell[turning]])
        x = np.concatenate([x, at[~added], tops])
    return Missing(segment.edges[k] + x * width[k], gained)


def _gained(points: _Points, passed: _Passed, x: Array, segment: AngleSegment) -> Array:
    """Energy [J] that the Gauss rule misses of the rows' kinks at positions x: the integral of the
    variable's polynomial beyond the row, less its sum over the nodes there."""
    through, above = points.through, points.values[passed.cell] - points.rows[passed.row][:, None]
    beyond = through.part(above.T, x, 1.0)
    total = np.where(through.places > x[:, None], above, 0.0)
    error = ((1.0 - x) * beyond - total.T).T @ through.weights
    width = segment.sense * points.width[passed.cell]
    return np.asarray(width * points.bends[passed.row] * passed.rises * error)


def _near_rows(segment: AngleSegment, course: Course, least: Array) -> list[_Points]:
    """Time and speed in the cells that a row lies in, or is no farther from than the nodes from one
    another."""
    through = ends_and_nodes(len(segment.grid.rule.nodes))
    width, near = segment.terms.width, []
    passed = np.diff(np.searchsorted(course.times, segment.time))
    k = np.flatnonzero(passed)
    if len(k):
        spent = width[k, None] * (segment.slowness[k] @ segment.grid.rule.matrix.T)
        begin = segment.time[k, None]
        time = np.hstack([begin, begin + spent, segment.time[k + 1, None]])
        bends = np.diff(course.in_time[:, 1])
        near.append(_Points(through, time, course.times, bends, k, width[k], least[k]))
    slow, fast = 1.0 / largest_of_row(segment.slowness), -1.0 / largest_of_row(-segment.slowness)
    rows = np.sort(segment.sense * course.speeds)
    before, after = np.searchsorted(rows, [2.0 * slow - fast, 2.0 * fast - slow])
    k = np.flatnonzero(after > before)
    bends = np.diff(course.in_speed[:, 1])
    most = np.append(0.0, np.cumsum(np.abs(bends)[:: int(segment.sense)]))
    k = k[_may_miss(segment, k, (most[after] - most[before])[k] * width[k] / least[k])]
    if len(k):
        inside = segment.sense / segment.slowness[k]
        omega = np.column_stack([segment.speeds[k], inside, segment.speeds[k + 1]])
        near.append(_Points(through, omega, course.speeds, bends, k, width[k], least[k]))
    return near


def _may_miss(segment: AngleSegment, k: Index, worth: Array) -> NDArray[np.bool_]:
    """Whether rows that are worth so much in each of the cells k, by the slope of the speed, can
    make it miss more than it may: between nodes where it rises or falls, or where it turns."""
    nodes = segment.grid.rule.nodes
    slope = np.diff(1.0 / segment.slowness[k]).T / np.diff(nodes)[:, None]
    before, after = 1.5 * slope[0] - 0.5 * slope[1], 1.5 * slope[-1] - 0.5 * slope[-2]
    slopes = np.vstack([before, slope, after])
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    steepest = np.maximum(high, -low)
    turns = low * high <= 0.0
    missed = worth * steepest * np.where(turns, 1.0, 2.0 * _WORST / len(nodes) ** 2)
    return np.asarray(missed > 1.0)


def _passed(points: _Points) -> _Passed:
    """The rows between each two neighbouring points."""
    x, values, rows, bends = points.through.places, *points[1:4]
    below = np.searchsorted(rows, values)
    k, j = np.nonzero(np.diff(below, axis=1))
    times = np.abs(below[k, j + 1] - below[k, j])
    row = np.minimum(below[k, j], below[k, j + 1]).repeat(times)
    row += np.arange(len(row)) - (np.cumsum(times) - times).repeat(times)
    k, j = k.repeat(times), j.repeat(times)
    rise, low, high = values[k, j + 1] - values[k, j], x[j], x[j + 1]
    position = np.clip(low + (rows[row] - values[k, j]) / rise * (high - low), low, high)
    at_edge = 0.5 * np.minimum(position, 1.0 - position) ** 2
    share = np.minimum(at_edge, _WORST / (len(x) - 2) ** 2)
    missed = points.width[k] * np.abs(bends[row] * rise / (high - low)) * share
    return _Passed(k, row, low, high, np.sign(rise), missed)


def _turns(points: _Points) -> tuple[Index, Array]:
    """Cells and positions where the variable turns beyond a row that no point beside it passed."""
    x, values, rows, bends = points.through.places, *points[1:4]
    rise, none = np.diff(values, axis=1), np.zeros((len(values), 1))
    before, after = np.hstack([none, rise]), np.hstack([rise, none])
    reach, side = np.abs(before) + np.abs(after), np.sign(before - after)
    worth = np.max(np.abs(bends)) * points.width / points.least
    k, i = np.nonzero((before * after <= 0.0) & (worth[:, None] * reach > 1.0))
    at, side = values[k, i], side[k, i]
    below = np.searchsorted(rows, at)
    may = np.searchsorted(rows, at + side * reach[k, i]) != below
    k, i, at, side, below = (np.tile(part[may], 2) for part in (k, i, at, side, below))
    j = np.where(np.arange(len(i)) < len(i) // 2, i - 1, i)  # it turns before the point or after it
    inside = (j >= 0) & (j < rise.shape[1])
    k, j, at, side, below = (part[inside] for part in (k, j, at, side, below))
    slopes = values @ points.through.slopes.T
    tops = points.through.inverse(slopes, k, np.zeros(len(k)), x[j], x[j + 1])
    top = points.through.values(values, k, tops)
    passes = (np.searchsorted(rows, top) != below) & (worth[k] * np.abs(top - at) > 1.0)
    return k[passes], tops[passes]


def sign_changes_in(segment: AngleSegment) -> Array:
    """Angles turned [rad] at which gas forces change their sign inside cells and press rings;
    empty without fuel."""
    train, terms = segment.grid.train, segment.terms
    bends = [np.empty(0)]
    if terms.rubbed.shape[-1] == 0 or train.pressure is None or train.combustion is None:
        return bends[0]
    theta = terms.angles(segment.begin.theta, segment.sense, segment.grid.rule)
    through = at_nodes(len(segment.grid.rule.nodes))
    x = np.concatenate([[0.0], through.places, [1.0]])
    for k, cylinder in enumerate(train.scene.cylinders):
        phi = theta + cylinder.phase
        force = train.pressure[k](phi) + segment.shares[:, k, None] * train.combustion[k](phi)
        values = force @ through.basis(x).T
        cell, at = np.nonzero(values[:, 1:] * values[:, :-1] < 0.0)
        behind = through.inverse(force, cell, np.zeros(len(cell)), x[at], x[at + 1])
        behind *= terms.width[cell]
        inside = np.minimum(behind, terms.width[cell] - behind) > _AT_EDGE
        bends.append((segment.edges[cell] + behind)[inside])
    return np.concatenate(bends)
