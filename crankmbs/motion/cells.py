"""Cells of a solved motion: the polynomials that it was solved with.

In a cell time and crank angle, and energy or speed, are polynomials of a place x from 0 to 1, given
by their values at both ends and at the nodes of a Gauss rule. What follows from them belongs in
`crankmbs.motion.states`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.knots import KNOT, repeat
from crankmbs.mechanics.windows import Phases
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.function import Function
from crankmbs.numerics.lagrange import Lagrange, ends_and_nodes

__all__ = ["Acting", "Cells", "Loads", "cell_of"]

_INSIDE = 2.0 * KNOT  # rad: so far from the end of a cell nothing counts as on a knot there
_MOST = 0.25  # of a cell
_SAME = 8 * float(np.finfo(float).eps)  # of the largest value: rounding
_POLYNOMIALS = ("time", "angle", "speed", "energy", "acceleration", "outside")
_ROWS = (*_POLYNOMIALS, "shares", "residual")


def cell_of(ends: Array, values: Array) -> Index:
    """In which of consecutive cells values lie, by the increasing ends of these; at an end, but for
    rounding, in the one before it.

    >>> cell_of(np.array([1.0, 2.0]), np.array([1.0, 1.5, 3.0]))
    array([0, 1, 1])
    """
    hair = _SAME * max(abs(float(ends[0])), abs(float(ends[-1])))
    return np.minimum(np.searchsorted(ends, values - hair), len(ends) - 1)


class Loads(Protocol):
    """The torque of loads."""

    @property
    def functions(self) -> tuple[Function, ...]:
        """Those of time, angle and speed together."""

    def __call__(self, t: ArrayLike, omega: ArrayLike) -> Array:
        """Of all others [N m] at times [s] and speeds [rad/s]."""


class Acting(NamedTuple):
    """What acts in cells, the same in all of them.

    sense : of rotation; holds : whether the crank is at rest and held
    phases : of the loads' windows; loads : their torque over time and speed, with functions; None
        where the torque from outside is what the given acceleration takes
    """

    sense: float
    holds: bool = False
    phases: Phases = ()
    loads: Loads | None = None


@dataclass(frozen=True, eq=False)
class Cells:
    """Consecutive cells in the order in which they are passed, in one sense of rotation.

    time, angle, speed : shape (m, n) [s, rad, rad/s], at the n - 2 nodes of a Gauss rule and at
        both ends
    energy : shape (m, n) [J]; where there is one it is the polynomial, and the speed follows
    shares : shape (m, cylinders), of the combustion; (m, 0) without fuel
    acceleration : shape (m, n) [rad/s2], where it is given and not what the torques make
    outside : shape (m, n) [N m], the torque of the loads, without that of forces on the pistons,
        where these are known at the nodes alone
    residual : shape (m,) [J], kinetic energy gained up to the end of each less work done, if known
    """

    time: Array
    angle: Array
    speed: Array
    acting: Acting
    shares: Array
    energy: Array | None = None
    acceleration: Array | None = None
    outside: Array | None = None
    residual: Array | None = None

    @property
    def places(self) -> Array:
        """Of ends and nodes, shape (n,)."""
        return self._polynomials.places

    @property
    def weights(self) -> Array:
        """Of the Gauss rule, shape (n,), zero at the ends."""
        return self._polynomials.weights

    @property
    def _polynomials(self) -> Lagrange:
        return ends_and_nodes(self.time.shape[1] - 2)

    @property
    def spent(self) -> Array:
        """dt/dx at ends and nodes [s], shape (m, n)."""
        return np.asarray((self.time - self.time[:, :1]) @ self._polynomials.slopes.T)

    @property
    def turned(self) -> Array:
        """d angle/dx at ends and nodes [rad], shape (m, n)."""
        return np.asarray((self.angle - self.angle[:, :1]) @ self._polynomials.slopes.T)

    def located(self, values: Array, *, in_time: bool) -> tuple[Index, Array]:
        """The cells in which times [s], or else angles [rad], are passed, shape (p,), and where; at
        the end of one rather than at the begin of the next."""
        row, sense = (self.time, 1.0) if in_time else (self.angle, self.acting.sense)
        k = cell_of(sense * row[:, -1], sense * values)
        return k, self.place(k, values, in_time=in_time)

    def place(self, k: Index, values: Array, *, in_time: bool) -> Array:
        """Where in the cells k times [s], or else angles [rad], are passed, shape (p,)."""
        row = self.time if in_time else self.angle
        if in_time != (self.energy is None):
            return self._polynomials.inverse(row, k, values)
        begin, width = row[k, 0], row[k, -1] - row[k, 0]  # the variable that it was solved over
        x = np.divide(values - begin, width, out=np.zeros_like(values), where=width != 0.0)
        return np.asarray(np.clip(x, 0.0, 1.0))

    def part(self, k: Index, low: Array, high: Array) -> Cells:
        """Parts of cells, each from a place in it to another, as cells; shape (p,) each."""
        x = low[:, None] + (high - low)[:, None] * self.places
        names = [name for name in _POLYNOMIALS if getattr(self, name) is not None]
        rows = np.array([getattr(self, name) for name in names])
        cut = self.values(rows, np.repeat(k, x.shape[1]), x.ravel()).reshape(-1, *x.shape)
        residual = None if self.residual is None else self.residual[k]
        rest: dict[str, Any] = dict(zip(names, cut, strict=True))
        return replace(self, shares=self.shares[k], residual=residual, **rest)

    def first(self, m: int) -> Cells:
        """The first m cells."""
        return self._with(lambda row: row[:m])

    def joined(self, after: Cells) -> Cells:
        """These cells and others after them in which the same acts."""
        rows: dict[str, Any] = {}
        for name in _ROWS:
            row = getattr(self, name)
            rows[name] = None if row is None else np.concatenate([row, getattr(after, name)])
        return replace(self, **rows)

    def since(self, k: int, x: float = 0.0) -> Cells:
        """The cells from a place in cell k on."""
        rest = self._with(lambda row: row[k:])
        if x == 0.0:
            return rest
        first = self.part(np.array([k]), np.array([x]), np.ones(1))
        return first.joined(rest.since(1))

    def _with(self, function: Callable[[Array], Array]) -> Cells:
        """With a function of all its rows in their place."""
        rows: dict[str, Any] = {}
        for name in _ROWS:
            row = getattr(self, name)
            rows[name] = None if row is None else function(row)
        return replace(self, **rows)

    def cut_at(self, knots: Array, period: float) -> Cells:
        """The cells with ends at all knots [rad], given over one period, that lie inside them."""
        begin, end = self.angle[:, 0], self.angle[:, -1]
        sense, bounds = self.acting.sense, (float(self.angle.min()), float(self.angle.max()))
        if sense == 0.0 or len(knots) == 0:
            return self
        inside = sense * repeat(knots, period, *bounds)
        cell = np.searchsorted(sense * begin, inside, side="right") - 1
        reach = np.minimum(inside - sense * begin[cell], sense * end[cell] - inside)
        cell, inside = cell[reach > KNOT], inside[reach > KNOT]
        if len(cell) == 0:
            return self
        x = self.place(cell, sense * inside, in_time=False)
        order = np.lexsort((x, cell))
        return self._cut(cell[order], x[order])

    def _cut(self, cell: Index, x: Array) -> Cells:
        """The cells with ends at places in some of them, in their order, shape (p,) each."""
        at = cell + np.arange(len(cell)) + 1  # of the later parts among all
        parts = np.insert(np.arange(len(self.time)), cell + 1, cell)
        low, high = np.zeros(len(parts)), np.ones(len(parts))
        low[at], high[at - 1] = x, x
        return self.part(parts, low, high)

    def inner(self) -> Array:
        """Places of nodes, and of the ends a hair inside, shape (m, n): there everything counts as
        it is in the cell."""
        turned = np.abs(self.angle[:, -1] - self.angle[:, 0])
        hair = np.zeros_like(turned)
        np.divide(_INSIDE, turned, out=hair, where=turned > 0.0)
        places = np.tile(self.places, (len(turned), 1))
        places[:, 0] = np.minimum(hair, _MOST)
        places[:, -1] = 1.0 - places[:, 0]
        return places

    def inner_reader(self) -> Callable[[Array], Array]:
        """What reads rows at the places of `inner`, cell after cell: at the nodes as they are."""
        every, places = np.arange(len(self.time)), self.inner()

        def read(row: Array) -> Array:
            values = row.copy()
            for at in (0, -1):
                values[..., at] = self.values(row, every, places[:, at])
            return values.reshape(*row.shape[:-2], -1)

        return read

    def values(self, row: Array, k: Index, x: Array) -> Array:
        """A row, or several, shape (..., m, n), at places x in the cells k, shape (p,) each."""
        return self._polynomials.values(row, k, x)
