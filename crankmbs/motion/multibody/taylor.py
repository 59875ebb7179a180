"""Taylor series in time of every body's coordinates on the closed loop."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from operator import mul
from typing import TypeVar

import numpy as np

from crankmbs.mechanics.geometry import close_loop
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["taylor"]

T = TypeVar("T", float, complex)


def taylor(scene: Scene, angle: Sequence[float]) -> Array:
    """Coefficients of all coordinates, those of the crank angle [rad] given.

    A coordinate is sum c_k t^k in any unit of time t; shape (len(angle), 3 + 5 n) for n cylinders,
    in the order of a `Start`. With p = exp(i theta), s = sin(beta), c = cos(beta) the series follow
    from p' = i theta' p, c c = 1 - s s and beta' c = s'. Exact.
    """
    length, e = scene.rod.length, scene.piston.offset
    turned = _exp_i(angle)
    columns = _plane(turned, scene.crank.center_of_mass)
    columns.append(list(angle))
    for cylinder in scene.cylinders:
        phase, bank = cmath.rect(1.0, cylinder.phase), cmath.rect(1.0, cylinder.bank)
        throw = [scene.crank.radius * phase * z for z in turned]
        loop = close_loop(angle[0] + cylinder.phase, scene.crank.radius, length, e)
        sine = [z.imag / length for z in throw]
        sine[0] = float(loop.sin_beta)
        cosine, beta = [float(loop.cos_beta)], [float(loop.beta)]
        risen: list[float] = []  # k beta_k
        for n in range(1, len(angle)):
            squares = _mixed(sine, sine, n) + _mixed(cosine[1:], cosine[1:], n - 2)
            cosine.append(-0.5 * squares / cosine[0])
            risen.append((n * sine[n] - _mixed(risen, cosine[1:], n - 2)) / cosine[0])
        beta += [slope / n for n, slope in enumerate(risen, 1)]
        rod = [complex(c, -s) for c, s in zip(cosine, sine, strict=True)]
        a = scene.rod.center_of_mass
        columns += _plane([z + a * b for z, b in zip(throw, rod, strict=True)], bank)
        columns.append([cylinder.bank - beta[0], *(-b for b in beta[1:])])
        pin = [complex((z + length * b).real) for z, b in zip(throw, rod, strict=True)]
        pin[0] += 1j * e
        columns += _plane(pin, bank)
    return np.array(columns).T


def _exp_i(angle: Sequence[float]) -> list[complex]:
    """Series of exp(i theta)."""
    series = [cmath.rect(1.0, angle[0])]
    risen = [k * angle[k] for k in range(1, len(angle))]
    for n in range(1, len(angle)):
        series.append(1j / n * _mixed(risen, series, n - 1))
    return series


def _mixed(left: Sequence[T], right: Sequence[T], n: int) -> T:
    """The coefficient of t^n in a product of two series; zero below n = 0."""
    return sum(map(mul, left[: n + 1], right[n::-1])) if n >= 0 else 0.0


def _plane(series: Sequence[complex], factor: complex) -> list[list[float]]:
    turned = [factor * z for z in series]
    return [[z.real for z in turned], [z.imag for z in turned]]
