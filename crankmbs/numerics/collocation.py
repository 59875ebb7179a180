"""Gauss collocation on the unit interval: the rule, and its polynomials between the nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from crankmbs.numerics.arrays import Array

__all__ = ["Maps", "Rule", "gauss"]


class Maps(NamedTuple):
    """Of the energy E at a cell's begin: E becomes gain E + shift at each node, shape (m, s), and
    E + (growth E + rise) at the cell's end, shape (m,)."""

    gain: Array
    shift: Array
    growth: Array
    rise: Array


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

    def integrals(self, x: Array) -> Array:
        """Integrals of the s Lagrange polynomials from 0 to x: shape (n,) -> (n, s)."""
        return _legendre_integrals(x, len(self.nodes)) @ self.to_legendre

    def maps(self, h: Array, push: Array, rate: Array) -> Maps:
        """The affine maps of dE/du = push + rate E over cells of signed width h.

        h : shape (m,) [rad]; push, rate : shape (m, s) [N m, 1/rad], at the nodes
        """
        shift: Array = h[:, None] * (push @ self.matrix.T)
        gain: Array = np.ones_like(push)
        if rate.any():
            system = np.eye(len(self.weights)) - h[:, None, None] * self.matrix * rate[:, None, :]
            both = np.linalg.solve(system, np.stack([gain, shift], axis=-1))
            gain, shift = (np.asarray(part, np.float64) for part in np.moveaxis(both, -1, 0))
        growth = h * ((rate * gain) @ self.weights)
        return Maps(gain, shift, growth, h * ((push + rate * shift) @ self.weights))


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
