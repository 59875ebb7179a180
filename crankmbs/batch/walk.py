"""What motions of one machine over a period amount to: peaks and means of all that is observed.

Of a case only the crank's inertia and the loads are its own. Every curve is A u + B alpha + C +
D p, as `crankmbs.batch.peaks` says.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.batch.curves import Curves, Grid
from crankmbs.numerics.arrays import Array

__all__ = ["walk"]

Indices = NDArray[np.intp]


def walk(
    about: tuple[float, int, int, bool],
    rule: tuple[Array, Array, Array, Array],
    of_angle: tuple[Array, Array, Array, Array],
    parts: tuple[Curves, Array, Curves, Grid, tuple[Indices, NDArray[np.bool_]]],
    motions: tuple[Array, Array],
    found: tuple[Array, Array],
) -> None:
    """Fill the columns of every case from its energies over one period.

    about : sense of rotation; number of the quantity whose A belongs to omega; of columns before
        those of joints; whether peaks are sought, or looked at where they are
    rule : matrix, weights, nodes, and what makes of the values there the last coefficient of
        Legendre polynomials: the nodes' barycentric weights, too
    of_angle : width [rad] of the m cells, and at their s nodes J without the crank's, dJ/dtheta and
        the torque, shape (m, s)
    parts : of forces, those of joints in pairs of x and y, then the side forces: A and B at the n =
        m s nodes, shape (rows, 2, n), C and D, shape (rows, 1, 2, n), and both in straight lines
        (`crankmbs.batch.straight`), shape (rows, 6, m + b) and (rows, 1, 6, m + b); A, B and C of
        the torque of all rods, shape (3, n); of the quantities of the lectures as of the forces,
        but in the place of 1 the quantity itself, with p = 0, and what it is more than each lecture
        says at a constant speed, with the square of the mean omega, or it, as p; where all these
        are, `crankmbs.batch.curves.Grid`; and the number of the first of a quantity's curves that
        is the same, shape (q, 1 + lectures), and whether all of them are of the angle alone, shape
        (q,)
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
    # numba is loaded only when it is used
    from crankmbs.batch.courses import follow
    from crankmbs.batch.means import integrate
    from crankmbs.batch.peaks import find
    from crankmbs.batch.straight import straighten

    (sense, linear, own, sought), (width, *_), (columns, places) = about, of_angle, found
    forces, rods, quantities, grid, (twin, steady) = parts
    share, (edges, starts, _) = (width[:, None] * rule[1]).ravel(), grid
    count, n, pieces = len(columns), len(share), len(width) + len(starts) - 1
    courses, slow = np.empty((count, 3, n)), np.empty((count, n))
    columns[:, 2:] = np.nan
    follow(sense, of_angle, (share, rods), motions, (courses, slow, columns))
    tracks = np.empty((count, 9, pieces))
    if sought:
        lines = tracks.reshape(-1, 3, pieces)
        straighten(courses.reshape(-1, n), rule[2], edges, starts, lines)

    joints = (columns.shape[1] - own - 2 * twin.size) // 4
    end, levels = own + 4 * joints, 0.0 * np.repeat(columns[:, 2:3], 3, axis=1)

    def peaks(asked: Indices, curves: Curves, begin: int) -> Array:
        """Of curves, shape (k, q, 3), whose places begin there."""
        of = slice(begin, begin + len(asked))
        sizes, where = np.empty((count, len(asked), 3)), places[:, of].copy()
        find(sought, asked, curves, grid, (courses, tracks, levels), (where, sizes))
        places[:, of] = where
        return sizes

    speed, line = np.zeros((1, 2, n)), np.zeros((1, 6, pieces))
    speed[0, 0], line[0, 0] = 1.0, 1.0
    of_speed = speed, 0.0 * speed[:, None], line, 0.0 * line[:, None]
    fast = peaks(np.array([[0, 1, 0, 1, 0, -1, -1, 0]]), of_speed, 0)[:, 0]
    levels[:, 1] = 2.0 * sense * fast[:, 0]  # by which the lowest one misses it most
    low = peaks(np.array([[0, 1, 0, 1, 1, -1, -1, 0]]), of_speed, 1)[:, 0]
    columns[:, 5], columns[:, 6] = fast[:, 0], 2.0 * fast[:, 0] - low[:, 0]
    columns[:, 9], columns[:, 10] = fast[:, 2], low[:, 2]

    pairs = len(forces[0]) - joints
    rows = [(2 * k, 2) if k < pairs else (pairs + k, 1) for k in range(joints)]
    asked = np.array([(*row, 0, 0, 0, -1, -1, 0) for row in rows])
    sizes, means = peaks(asked, forces, 2), np.empty((count, joints))
    integrate(asked, forces, (courses, slow, share, width), rule, means)
    columns[:, own:end:4], columns[:, own + 1 : end : 4] = sizes[..., 0], sizes[..., 1]
    columns[:, own + 2 : end : 4] = means / columns[:, 2:3]
    columns[:, own + 3 : end : 4] = sizes[..., 2]

    levels[:, 1] = sense * edges[-1] / columns[:, 2]
    levels[:, 2] = levels[:, 1] ** 2
    sizes = peaks(_asked(twin, steady, linear), quantities, 2 + joints)
    columns[:, end::2], columns[:, end + 1 :: 2] = sizes[..., 0], sizes[..., 2]


def _asked(twin: Indices, steady: NDArray[np.bool_], linear: int) -> Indices:
    """Of all quantities, each with what it is more than lectures say, as `crankmbs.batch.peaks`
    takes it."""
    q, kind = (each.ravel() for each in np.indices(twin.shape))
    level = np.where(kind > 0, np.where(q == linear, 1, 2), 0)
    base, before = q * twin.shape[1], twin.ravel()
    scaled, like = np.where(kind > 0, base, -1), np.where(before < kind, base + before, -1)
    one = np.ones_like(q)
    return np.stack([q, one, kind, q == linear, level, scaled, like, steady[q]], axis=1)
