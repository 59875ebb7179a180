"""The variables at the ends and nodes of a motion's cells, and what is read off them: integrals
over time, of magnitudes too, and largest values.

Cells end where pressures, loads over the angle or friction bend or jump, so that all is smooth in
them. Integrals are those of the Gauss rule the motion was solved with. A magnitude bends where it
comes near zero: there its parts are, as polynomials, integrated piece by piece
(`crankmbs.numerics.magnitudes`). A largest value is sought on the polynomial through the nodes and
evaluated there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.train import CrankTrain, edges_over_angle
from crankmbs.motion.base import Samples
from crankmbs.motion.cells import Cells
from crankmbs.motion.motion import Motion
from crankmbs.motion.states import inner_samples, samples_in, variables_at
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.lagrange import Lagrange, ends_and_nodes
from crankmbs.numerics.magnitudes import impulses, tops
from crankmbs.numerics.once import once
from crankmbs.scene.units import DEGREE

__all__ = ["Nodes", "Tops", "nodes_of"]

_WIDEST = 6.0 * DEGREE  # of a cell: in a wider one, of steps over time, forces are no polynomials
_ANGLE = 1.0 / 16.0  # of ROUNDING: four units of rounding of an angle
_HAIRS = np.arange(1.0, 5.0)  # places from the end of a cell at which a cubic is known there
_TO_END = Lagrange(_HAIRS, np.empty(0)).basis(np.linspace(0.0, 1.0, 65)).T

Rows = Callable[[dict[str, Array]], Array]


class Tops(NamedTuple):
    """The largest values of q quantities, and the crank angles [rad] and times [s] where they are,
    shape (q,) each.

    steep : at the end of a cell the slope over the angle times the angle, whose rounding is in the
        value
    """

    value: Array
    angle: Array
    time: Array
    steep: Array

    @property
    def sizes(self) -> Array:
        """What of the values is rounded."""
        return np.asarray(np.abs(self.value) + _ANGLE * self.steep)


class _Block(NamedTuple):
    """Cells of one kind, and which of all points are theirs."""

    cells: Cells
    points: slice

    def of(self, values: Array) -> Array:
        """Values at points, shape (..., p), by cell and node."""
        return values[..., self.points].reshape(*values.shape[:-1], *self.cells.time.shape)


class Nodes:
    """Every variable at the nodes and ends of the cells of a motion.

    variables : by name, shape (p,) or (p, cylinders)
    duration, turned : shape (p,) [s, rad], weights of the integrals over time and crank angle; zero
        at ends
    """

    def __init__(self, motion: Motion, widest: float) -> None:
        self.train = motion.train  # not the motion, which keeps its nodes
        marks, first = _marks(motion.train, widest), 0
        self._blocks: list[_Block] = []
        for stretch in motion.cells:
            turned = np.abs(stretch.angle[:, -1] - stretch.angle[:, 0])
            wide = int(np.max(turned, initial=0.0) > 1.01 * widest)
            cells = stretch.cut_at(marks[wide], motion.train.period)
            self._blocks.append(_Block(cells, slice(first, first + cells.time.size)))
            first += cells.time.size
        self.samples = Samples.joined([inner_samples(b.cells, self.train) for b in self._blocks])
        self.variables = variables_at(self.train, self.samples)
        weights = [(b.cells.spent * b.cells.weights).ravel() for b in self._blocks]
        self.duration = np.concatenate(weights)
        self.turned = self.duration * self.samples.omega

    def integral(self, values: Array) -> Array:
        """Over time, of values at the points, shape (p, ...)."""
        return np.asarray(np.tensordot(self.duration, values, (0, 0)))

    def magnitude(self, parts: Array) -> Array:
        """Integral over time of the magnitudes of q vectors, shape (q,).

        parts : shape (q, c, p), their c components at the points
        """
        total = np.zeros(len(parts))
        for block in self._blocks:
            at, spent = block.of(parts).copy(), block.cells.spent
            polynomials, hair = ends_and_nodes(spent.shape[1] - 2), block.cells.inner()[:, 0]
            for end, inwards in ((0, hair), (-1, -hair)):  # from a hair inside to the very ends
                at[..., end] -= inwards * (at @ polynomials.slopes[end])
            sizes = np.sqrt((at**2).sum(axis=1))
            total += impulses(polynomials, at[None], sizes[None], spent[None])[0]
        return total

    def tops(self, rows: Rows) -> Tops:
        """The largest values of q quantities over the motion.

        rows : from variables by name at any points to the quantities, shape (q, points)
        """
        values = rows(self.variables)
        at_node = np.argmax(values, axis=1)
        q = np.arange(len(values))
        best = values[q, at_node]
        angle, time = self.samples.theta[at_node], self.samples.time[at_node]
        block, cell, near, at_end = self._sought(values)
        hair = np.where(at_end, np.where(near < 0.5, near, near - 1.0), 0.0)
        places = near + (_HAIRS[:, None] - 1.0) * hair
        samples = self._at(block, cell, places)
        there = rows(variables_at(self.train, samples)).reshape(len(q), len(_TO_END), len(q))[
            q, :, q
        ]
        # at the end of a cell the cubic through values a hair and more inside is continued to it
        top = there[:, 0]
        higher = np.where(at_end, np.max(there @ _TO_END, axis=1), top)
        more = higher > best
        angle_there = samples.theta[q]
        turned = np.abs(angle_there - samples.theta[q + len(q)])
        fall, flat = np.abs(top - there[:, 1]), np.zeros(len(q))
        slope = np.divide(fall, turned, out=flat, where=turned > 0.0)
        return Tops(
            np.where(more, higher, best),
            np.where(more, angle_there, angle),
            np.where(more, samples.time[q], time),
            np.where(at_end, slope * np.abs(angle_there), 0.0),
        )

    def _sought(self, values: Array) -> tuple[Index, Index, Array, np.ndarray]:
        """Block, cell and place of the top of each quantity's polynomials; whether it is an end."""
        found = [_highest(part.cells, part.of(values)) for part in self._blocks]
        high, *others = (np.array(each) for each in zip(*found, strict=True))
        block = np.argmax(high, axis=0)
        cell, place, ends = (each[block, np.arange(len(values))] for each in others)
        return block, cell, place, ends

    def _at(self, block: Index, cell: Index, places: Array) -> Samples:
        """The motion at several places each of q cells, shape (places, q), place after place."""
        parts, order, count = [], [], len(places)
        for number in np.unique(block):
            which = np.flatnonzero(block == number)
            k = np.tile(cell[which], count)
            x = places[:, which].ravel()
            parts.append(samples_in(self._blocks[number].cells, self.train, k, x))
            order += [which + len(block) * n for n in range(count)]
        return Samples.joined(parts).select(np.argsort(np.concatenate(order)))


@once
def nodes_of(motion: Motion, widest: float = _WIDEST) -> Nodes:
    """The nodes of a motion in cells no wider than an angle [rad], made once."""
    return Nodes(motion, widest)


def _marks(train: CrankTrain, widest: float) -> tuple[Array, Array]:
    """Crank angles [rad] of one period at which cells end, and those of wide cells."""
    marks = edges_over_angle(train)
    even = np.arange(0.0, train.period, widest)
    return marks, np.concatenate([marks, even])


def _highest(cells: Cells, values: Array) -> tuple[Array, Index, Array, np.ndarray]:
    """The top of polynomials through values, shape (q, m, n): value, cell and place, and whether
    that is a hair from the end of the cell."""
    polynomials, inner = ends_and_nodes(len(cells.places) - 2), cells.inner()
    highest, lowest = _extremes(values)
    # a polynomial goes hardly farther beyond its values than they lie apart
    which, k = np.nonzero(~(2.0 * highest - lowest < highest.max(axis=1, keepdims=True)))
    floor = lowest.min(axis=1)  # a magnitude is as high above it as a value
    rows = (values[which, k] - floor[which, None]).T[:, None]
    best = tops(polynomials, rows.copy(), np.searchsorted(which, np.arange(len(values))))
    cell, x, hair = k[best.which], best.place, inner[k[best.which], 0]
    at_end = (x <= hair) | (x >= 1.0 - hair)
    return best.size + floor, cell, np.clip(x, hair, 1.0 - hair), at_end


def _extremes(values: Array) -> tuple[Array, Array]:
    """Largest and least along the last axis: ten times faster than along an axis of few."""
    first = np.moveaxis(values, -1, 0).copy()
    return first.max(axis=0), first.min(axis=0)
