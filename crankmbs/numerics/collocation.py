"""Gauss collocation on the unit interval: the rule, and its polynomials between the nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.blas import dtbsv

from crankmbs.numerics.arrays import Array

__all__ = ["Maps", "Rule", "carried", "chain", "gauss", "summed"]

_SWEEPS = 0.1  # of |h rate|: where no cell has more, sweeps solve it sooner than elimination
_EPS = float(np.finfo(float).eps)


class Maps(NamedTuple):
    """Of the energy E at a cell's begin: E becomes gain E + shift at each node, shape (..., m, s),
    and E + (growth E + rise) at the cell's end, shape (..., m)."""

    gain: Array
    shift: Array
    growth: Array
    rise: Array

    def composed(self) -> Maps:
        """Of the energy at the begin of the first cell: at the nodes of all, and at their edges,
        shape (..., m + 1)."""
        grown, risen = (carried(self.growth, each, 0.0) for each in (self.growth, self.rise))
        gain = self.gain * (1.0 + grown[..., :-1, None])
        return Maps(gain, self.gain * risen[..., :-1, None] + self.shift, grown, risen)


@dataclass(frozen=True)
class Rule:
    """Gauss collocation with s stages, of order 2 s at the end of a step.

    nodes, weights : shape (s,)
    matrix : shape (s, s), integrals of the Lagrange polynomials from 0 to each node
    to_legendre : shape (s, s), node values to coefficients of shifted Legendre polynomials
    """

    nodes: Array
    weights: Array
    matrix: Array
    to_legendre: Array

    @cached_property
    def to_series(self) -> tuple[Array, Array]:
        """Node values to the Chebyshev series of their polynomial and of its integral from 0 on, as
        `summed` takes them: shape (s + 1, s) each."""
        s = len(self.nodes)
        share = 0.5 / (2.0 * np.arange(s) + 1.0)  # int P_j dx = (P_{j+1} - P_{j-1}) / (4 j + 2)
        integral = np.diag(share, -1)[:, :s]
        integral[: s - 1] -= np.diag(share[1:], 1)[: s - 1, :s]
        integral[0, 0] = 0.5
        chebyshev = np.zeros((s + 1, s + 1))
        for j, unit in enumerate(np.eye(s + 1)):
            of_legendre = np.polynomial.chebyshev.poly2cheb(np.polynomial.legendre.leg2poly(unit))
            chebyshev[: len(of_legendre), j] = of_legendre
        return chebyshev[:, :s] @ self.to_legendre, chebyshev @ integral @ self.to_legendre

    @cached_property
    def _reach(self) -> Array:
        """How large |u' rate| may be so that 0, 1, ... sweeps leave no more than rounding."""
        reach, power = [0.0], self.matrix
        while reach[-1] < _SWEEPS:
            norm = float(np.abs(power).sum(axis=1).max())
            reach.append((_EPS / norm) ** (1.0 / len(reach)))
            power = power @ self.matrix
        return np.array(reach[1:])

    def integrals(self, x: Array) -> Array:
        """Integrals of the s Lagrange polynomials from 0 to x: shape (n,) -> (n, s)."""
        return _legendre_integrals(x, len(self.nodes)) @ self.to_legendre

    def maps(self, turned: Array, push: Array, rate: Array) -> Maps:
        """The affine maps of dE/du = push + rate E over cells, exact to rounding.

        With a node's u' = du/dx, x from 0 to 1 in the cell, and A the matrix,

            y_i = E + sum over j of A_ij u'_j (push_j + rate_j y_j)

        is solved by sweeps where |u' rate| is small throughout a case, else by elimination.

        turned : u', shape (..., m, s), or (..., m, 1) where a cell is passed evenly [rad]
        push, rate : shape (..., m, s) [N m, 1/rad], at the nodes

        >>> rule = gauss(3)
        >>> maps = rule.maps(np.full((1, 1), 0.5), np.zeros((1, 3)), np.ones((1, 3)))
        >>> f"{1.0 + maps.growth[0]:.6f}"
        '1.648721'
        """
        push, rate = turned * push, turned * rate
        gain, first = np.ones_like(push), push @ self.matrix.T
        shift = first.copy()
        stiff = np.abs(rate).max(axis=(-2, -1), initial=0.0)
        steep = ~(stiff <= _SWEEPS)
        if steep.any():
            system = np.eye(len(self.weights)) - self.matrix * rate[steep][..., None, :]
            both = np.linalg.solve(system, np.stack([gain[steep], first[steep]], axis=-1))
            gain[steep], shift[steep] = both[..., 0], both[..., 1]
        sweeps = np.where(steep, 0, np.searchsorted(self._reach, stiff))
        for done in range(sweeps.max(initial=0)):
            left = sweeps > done  # of each case as many as it needs, whatever the others do
            some = ... if left.all() else left
            more = rate[some] * gain[some], rate[some] * shift[some]
            gain[some] = 1.0 + more[0] @ self.matrix.T
            shift[some] = first[some] + more[1] @ self.matrix.T
        growth = (rate * gain) @ self.weights
        return Maps(gain, shift, growth, (push + rate * shift) @ self.weights)

    def corrected(self, missed: Array, rate: Array) -> tuple[Array, Array]:
        """Of (I - A rate) y = 1 and = missed, shape (m, s), the answers in each cell, with A the
        matrix: exact where |rate| is not small, else to a thousandth or better, as a step of
        Newton's method is repeated.

        rate : shape (m, s), times u' of `maps`
        """
        gain = 1.0 + rate @ self.matrix.T
        gain = 1.0 + (rate * gain) @ self.matrix.T
        shift = missed + (rate * missed) @ self.matrix.T
        shift = missed + (rate * shift) @ self.matrix.T
        stiff = np.abs(rate).max(initial=0.0)
        if not stiff <= _SWEEPS:
            which = np.flatnonzero(~(np.abs(rate) <= _SWEEPS).all(axis=1))
            system = np.eye(len(self.weights)) - self.matrix * rate[which, None, :]
            right = np.stack([np.ones_like(missed[which]), missed[which]], axis=-1)
            gain[which], shift[which] = np.moveaxis(np.linalg.solve(system, right), -1, 0)
        return gain, shift


def chain(growth: Array, rise: Array, start: float | Array) -> Array:
    """Energy at the edges of consecutive cells, of which each adds growth E + rise.

    growth, rise : shape (..., m); start : shape (...)

    Returns
    -------
    shape (..., m + 1)

    >>> chain(np.array([1.0, 1.0]), np.array([0.0, 3.0]), 1.0)
    array([1., 2., 7.])
    """
    rise = np.asarray(rise, dtype=np.float64)
    edges = np.empty((*rise.shape[:-1], rise.shape[-1] + 1))
    edges[..., 0], edges[..., 1:] = start, rise
    factors = 1.0 + np.broadcast_to(growth, rise.shape)
    if rise.ndim > 1:
        whole = np.cumprod(factors, axis=-1)
        begin = np.asarray(start)[..., None]
        edges[..., 1:] = whole * (begin + np.cumsum(rise / whole, axis=-1))
        return edges
    band = np.zeros((2, len(edges)), order="F")  # a triangle of two diagonals, of which one is 1
    np.negative(factors, out=band[1, :-1])
    return np.asarray(dtbsv(1, band, edges, lower=1, diag=1))


def summed(series: Array, x: Array) -> Array:
    """Sums of Chebyshev polynomials of 2 x - 1 at x in [0, 1], by Clenshaw's recurrence: shape
    (n,), with coefficients of shape (degrees, ..., n), by ascending degree.

    >>> summed(np.array([[1.0], [2.0], [4.0]]), np.array([0.5]))
    array([-3.])
    """
    z = 2.0 * x - 1.0
    if len(series) == 2:
        return np.asarray(z * series[1] + series[0])
    twice = 2.0 * z
    last, before = twice * series[-1] + series[-2], series[-1]
    for coefficient in series[-3:0:-1]:
        last, before = twice * last + (coefficient - before), last
    return np.asarray(z * last + (series[0] - before))


def carried(
    growth: Array, rise: Array, start: float | Array, surplus: float | Array = 0.0
) -> Array:
    """The same edges, each to its own rounding: what the first chain missed is chained behind.

    surplus : shape (..., m), of the rises, so little that they cannot hold it

    >>> float(carried(np.zeros(1000), np.full(1000, 0.1), 0.0)[-1])
    100.0
    """
    edges = chain(growth, rise, start)
    missed = np.diff(edges, axis=-1) - (growth * edges[..., :-1] + rise) + surplus
    return np.asarray(edges - chain(growth, missed, 0.0))


@cache
def gauss(stages: int) -> Rule:
    """The Gauss rule with this number of stages.

    >>> gauss(1).nodes
    array([0.5])
    """
    z, w = np.polynomial.legendre.leggauss(stages)
    nodes, weights = 0.5 * (1.0 + z), 0.5 * w
    odd = 2.0 * np.arange(stages) + 1.0
    to_legendre = (odd * np.polynomial.legendre.legvander(z, stages - 1)).T * weights
    return Rule(nodes, weights, _legendre_integrals(nodes, stages) @ to_legendre, to_legendre)


def _legendre_integrals(x: Array, stages: int) -> Array:
    """Integrals from 0 to x of the shifted Legendre polynomials of degree below ``stages``."""
    p = np.polynomial.legendre.legvander(2.0 * x - 1.0, stages)
    rows = np.empty((*x.shape, stages))
    rows[..., 0] = x
    degree = np.arange(1, stages)
    rows[..., 1:] = (p[..., 2:] - p[..., :-2]) / (2.0 * (2.0 * degree + 1.0))
    return rows
