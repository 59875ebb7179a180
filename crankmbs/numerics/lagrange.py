"""Polynomials through values at given places: their values anywhere, and their slopes."""

from __future__ import annotations

from functools import cache, cached_property

import numpy as np

from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.collocation import gauss, summed
from crankmbs.numerics.roots import invert_monotone

__all__ = ["Lagrange", "at_nodes", "ends_and_nodes"]


class Lagrange:
    """The polynomials through values at n places, summed from Chebyshev's.

    places : shape (n,), increasing
    weights : shape (n,), whose sum with the values is the integral over a unit interval; zero where
        the rule of `ends_and_nodes` has none
    """

    def __init__(self, places: Array, weights: Array) -> None:
        self.places, self.weights = places, weights
        apart = places[:, None] - places
        np.fill_diagonal(apart, 1.0)
        barycentric = 1.0 / apart.prod(axis=1)
        ratio = barycentric / barycentric[:, None] / apart
        np.fill_diagonal(ratio, 0.0)
        np.fill_diagonal(ratio, -ratio.sum(axis=1))
        self.slopes = ratio
        """Shape (n, n): from values to slopes at the places."""

    def basis(self, x: Array) -> Array:
        """What each value adds at x: shape (p,) -> (p, n).

        >>> ends_and_nodes(1).basis(np.array([0.25])).round(12)
        array([[ 0.375,  0.75 , -0.125]])
        """
        return summed(self._to_series[:, 0, :, None], x).T

    def series(self, values: Array, derivatives: int = 0) -> Array:
        """Chebyshev series on the unit interval of polynomials through values, shape (n, ...), and
        of so many derivatives, up to two: shape (n, 1 + derivatives, ...), as
        `crankmbs.numerics.collocation.summed` takes them."""
        return np.asarray(
            np.einsum("dkn,n...->dk...", self._to_series[:, : 1 + derivatives], values)
        )

    def part(self, values: Array, low: Array | float, high: Array | float) -> Array:
        """Values at the places of parts of the unit interval from low to high, shape (p,), as
        cells of their own: shape (n, ..., p) -> (n, ..., p)."""
        places = self.places.reshape(-1, *np.ones(values.ndim - 1, np.intp))
        return summed(self.series(values)[:, 0], low + (high - low) * places)

    @cached_property
    def _to_series(self) -> Array:
        """Of the polynomial and two derivatives, shape (n, 3, n)."""
        last = np.polynomial.chebyshev.chebvander(2.0 * self.places - 1.0, len(self.places) - 1)
        matrices = [np.linalg.inv(last)]
        for _ in range(2):
            matrices.append(matrices[-1] @ self.slopes)
        return np.stack(matrices, axis=1)

    def values(self, rows: Array, k: Index, x: Array) -> Array:
        """The polynomials through rows k, shape (..., m, n), at places x in them, shape (p,);
        shape (..., p)."""
        if len(k) < rows.shape[-2]:
            rows, k = rows.take(k, axis=-2), np.arange(len(k))
        first = rows[..., 0]
        series = np.moveaxis((rows - first[..., None]) @ self._to_series[:, 0].T, -1, 0)
        return np.asarray(first.take(k, axis=-1) + summed(series.take(k, axis=-1), x))

    def inverse(
        self,
        rows: Array,
        k: Index,
        values: Array,
        low: Array | float = 0.0,
        high: Array | float = 1.0,
    ) -> Array:
        """Where between two places the polynomials through rows k, monotone there, take values,
        shape (p,)."""
        first, ends = rows[k, 0], np.empty((2, len(k)))
        ends[0], ends[1] = low, high
        series = self.series(rows[k].T - first, 1)

        def at(x: Array) -> tuple[Array, Array]:
            value, slope = summed(series, x)
            return value, slope

        return invert_monotone(at, values - first, *ends)


@cache
def at_nodes(stages: int) -> Lagrange:
    """Through the nodes of a Gauss rule.

    >>> at_nodes(2).basis(np.array([0.5]))
    array([[0.5, 0.5]])
    """
    rule = gauss(stages)
    return Lagrange(rule.nodes, rule.weights)


@cache
def ends_and_nodes(stages: int) -> Lagrange:
    """Through the ends of the unit interval and the nodes of a Gauss rule between.

    >>> ends_and_nodes(1).places
    array([0. , 0.5, 1. ])
    """
    rule = gauss(stages)
    places = np.concatenate([[0.0], rule.nodes, [1.0]])
    return Lagrange(places, np.concatenate([[0.0], rule.weights, [0.0]]))
