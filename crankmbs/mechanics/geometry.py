"""Loop closure of the slider-crank with offset: exact positions and their derivatives.

The crank angle here is the cycle angle phi of one cylinder, from its own axis to its own throw:

    l sin(beta) = r sin(phi) - e,    x = r cos(phi) + l cos(beta)

A suffix ``_1`` or ``_2`` is a first or second derivative in phi; a derivative in time follows as
q' = q_1 omega, q'' = q_2 omega^2 + q_1 alpha.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crankmbs.mechanics.knots import KNOT
from crankmbs.numerics.arrays import Array

__all__ = [
    "Loop",
    "bottom_position",
    "close_loop",
    "close_loops",
    "dead_centres",
    "slides",
    "throw_angles",
    "top_position",
]


class Loop(NamedTuple):
    """The closed loop at given cycle angles; every field has the shape of the angles.

    x [m] piston pin from the crank axis, and the derivatives of it and of the rod angle in phi.
    """

    sin_phi: Array
    cos_phi: Array
    sin_beta: Array
    cos_beta: Array
    beta_1: Array
    beta_2: Array
    x: Array
    x_1: Array
    x_2: Array

    @property
    def beta(self) -> Array:
        """Rod angle [rad]."""
        return np.asarray(np.arctan2(self.sin_beta, self.cos_beta))


def close_loop(cycle_angle: ArrayLike, radius: float, rod_length: float, offset: float) -> Loop:
    """Close the loop exactly.

    beta_1 = r cos(phi) / (l cos(beta)),  beta_2 = -r sin(phi) / (l cos(beta)) + tan(beta) beta_1^2
        = -lambda (sin(phi) (1 - lambda^2 - eps^2) + eps lambda (1 + sin(phi)^2)) / cos(beta)^3
    x_1 = -r sin(phi) - l sin(beta) beta_1

    Parameters
    ----------
    cycle_angle : shape (...) [rad]
    radius, rod_length, offset : [m]; rod_length >= radius + abs(offset)

    Returns
    -------
    Loop : exact; relative rounding error a few 1e-16, also near the fold of a rod no longer than
        radius + offset, where the textbook forms of cos(beta) and beta_2 cancel

    >>> float(close_loop(0.0, 0.1, 0.3, 0.0).x)
    0.4
    """
    phi = np.asarray(cycle_angle, dtype=np.float64)
    return _closed(np.sin(phi), np.cos(phi), (radius, rod_length, offset))


def close_loops(
    crank_angle: Array, phases: Array, radius: float, rod_length: float, offset: float
) -> Loop:
    """Close the loops of several cylinders: one sine and one cosine for each crank angle, turned
    by the phases.

    crank_angle, phases : shape (n,), (cylinders,) [rad]; every field has shape (cylinders, n)

    >>> close_loops(np.zeros(1), np.array([0.0, math.pi]), 0.1, 0.3, 0.0).x.round(12).tolist()
    [[0.4], [0.2]]
    """
    sin, cos = np.sin(crank_angle), np.cos(crank_angle)
    if len(phases) == 1 and phases[0] == 0.0:
        sin, cos = sin[np.newaxis], cos[np.newaxis]
    else:
        ahead, beside = np.cos(phases)[:, np.newaxis], np.sin(phases)[:, np.newaxis]
        sin, cos = sin * ahead + cos * beside, cos * ahead - sin * beside
    return _closed(sin, cos, (radius, rod_length, offset))


def _closed(sin_phi: Array, cos_phi: Array, lengths: tuple[float, float, float]) -> Loop:
    r, l, e = lengths
    ratio, skew = r / l, e / l
    throw, side = ratio * cos_phi, ratio * sin_phi
    sin_beta = side - skew if e else side
    # 1 - |sin(phi)| from its product with 1 + |sin(phi)|, as it would cancel near a fold
    wide = 1.0 + np.abs(sin_phi)
    narrow = cos_phi * cos_phi / wide
    # l (1 - sin(beta)) = (l - r + e) + r (1 - sin(phi)); likewise 1 + sin
    spare, far = max(l - r - abs(e), 0.0) / l, abs(skew)
    beyond = np.copysign(skew, e * sin_phi) if e else 0.0
    cos_beta = np.sqrt(
        (spare + (far + beyond) + ratio * narrow) * (spare + (far - beyond) + ratio * wide)
    )
    beta_1 = throw / cos_beta
    # -cos(beta)^3 beta_2 / lambda as a sum of terms that are themselves small near a fold
    bend = (spare * (1.0 + ratio + far)) * sin_phi
    if e:
        towards = np.where((sin_phi > 0.0) == (e > 0.0), wide, narrow)
        bend = bend + (skew * ratio) * towards**2
    beta_2 = -ratio * bend / (cos_beta * cos_beta * cos_beta)
    return Loop(
        sin_phi=sin_phi,
        cos_phi=cos_phi,
        sin_beta=sin_beta,
        cos_beta=cos_beta,
        beta_1=beta_1,
        beta_2=beta_2,
        x=l * (throw + cos_beta),
        x_1=-l * (side + sin_beta * beta_1),
        x_2=-l * (throw + cos_beta * beta_1**2 + sin_beta * beta_2),
    )


def dead_centres(radius: float, rod_length: float, offset: float) -> tuple[float, float]:
    """Cycle angles [rad] of the true top and bottom dead centre.

    sin(phi_top) = e / (l + r),  phi_bottom = pi + asin(e / (l - r)); exact. A rod as long as the
    crank has no bottom dead centre of its own: the fold at pi stands for it.

    >>> dead_centres(0.046, 0.153, 0.0)
    (0.0, 3.141592653589793)
    """
    spare = rod_length - radius
    bottom = math.asin(min(max(offset / spare, -1.0), 1.0)) if spare > 0.0 else 0.0
    return math.asin(offset / (rod_length + radius)), math.pi + bottom


def slides(
    cycle_angle: ArrayLike, sense: float, radius: float, rod_length: float, offset: float
) -> Array:
    """The sign of a piston's velocity towards the crank just beyond cycle angles, shape (...)
    [rad], in a sense of rotation (a sign).

    >>> slides([0.0, 4.0], 1.0, 0.1, 0.3, 0.0)
    array([ 1., -1.])
    """
    top, bottom = dead_centres(radius, rod_length, offset)
    behind = np.mod(np.asarray(cycle_angle) + sense * KNOT - top, 2.0 * math.pi)
    return np.where(behind < bottom - top, sense, -sense)


def top_position(radius: float, rod_length: float, offset: float) -> float:
    """Piston pin position x [m] at the true top dead centre: sqrt((l + r)^2 - e^2)."""
    return math.sqrt((rod_length + radius - offset) * (rod_length + radius + offset))


def bottom_position(radius: float, rod_length: float, offset: float) -> float:
    """Piston pin position x [m] at the true bottom dead centre."""
    shape = radius, rod_length, offset
    return float(close_loop(dead_centres(*shape)[1], *shape).x)


def throw_angles(
    above: Array, below: Array, radius: float, rod_length: float, offset: float
) -> tuple[Array, Array]:
    """The cycle angles [rad] at which a piston has come so far from its top dead centre, on the way
    to the bottom one and, less than a turn later, on the way back.

    With the pin at x, d = hypot(x, e) from the crank axis, the throw leads the direction
    atan2(e, x) of the pin by the angle opposite the rod,

        tan^2(lead / 2) = (r + l - d)(l + d - r) / ((r + d - l)(r + d + l)),

    on the way down, and lags it as much on the way up. Exact to rounding also at the dead centres,
    where the distances from them are given as such and not as differences.

    above, below : shape (...) [m], from the top and from the bottom dead centre

    >>> throw_angles(np.array([0.2]), np.array([0.0]), 0.1, 0.3, 0.0)[0].round(12)
    array([3.14159265])
    """
    r, l, e = radius, rod_length, offset
    top, bottom = top_position(r, l, e), bottom_position(r, l, e)
    x = top - above
    distance = np.hypot(x, e)
    over = above * (top + x) / (r + l + distance) * (l + distance - r)
    under = below * (bottom + x) / (distance + l - r) * (r + distance + l)
    lead = 2.0 * np.arctan2(np.sqrt(np.maximum(over, 0.0)), np.sqrt(np.maximum(under, 0.0)))
    along = np.arctan2(e, x)
    return np.asarray(along + lead), np.asarray(along - lead + 2.0 * math.pi)
