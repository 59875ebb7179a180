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

from crankmbs.numerics.arrays import Array

__all__ = [
    "Lengths",
    "Loop",
    "Shape",
    "bottom_position",
    "close_loop",
    "close_loops",
    "dead_centres",
    "lengths_of",
    "loop_at",
    "throw_angles",
    "top_position",
]


Shape = tuple[float, float, float]
"""Radius of the throw, length of the rod and offset [m]."""


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


def close_loop(
    cycle_angle: ArrayLike,
    radius: Array | float,
    rod_length: Array | float,
    offset: Array | float,
) -> Loop:
    """Close the loop exactly.

    beta_1 = r cos(phi) / (l cos(beta)),  beta_2 = -r sin(phi) / (l cos(beta)) + tan(beta) beta_1^2
        = -lambda (sin(phi) (1 - lambda^2 - eps^2) + eps lambda (1 + sin(phi)^2)) / cos(beta)^3
    x_1 = -r sin(phi) - l sin(beta) beta_1

    Parameters
    ----------
    cycle_angle : shape (...) [rad]
    radius, rod_length, offset : [m], of all angles or of shapes that broadcast with them;
        rod_length >= radius + abs(offset)

    Returns
    -------
    Loop : exact; relative rounding error a few 1e-16, also near the fold of a rod no longer than
        radius + offset, where the textbook forms of cos(beta) and beta_2 cancel

    >>> float(close_loop(0.0, 0.1, 0.3, 0.0).x)
    0.4
    """
    phi = np.asarray(cycle_angle, dtype=np.float64)
    return _closed(np.sin(phi), np.cos(phi), lengths_of(radius, rod_length, offset))


class Lengths(NamedTuple):
    """What of a loop does not change with the angle: its lengths [m] and what is made of them, of
    all cylinders or shape (cylinders, 1).

    ratio, skew, far : r / l, e / l, |e| / l; spare : of l, by which the rod is longer than it must
        be
    centred : whether there is no offset
    """

    radius: Array | float
    rod_length: Array | float
    offset: Array | float
    ratio: Array | float
    skew: Array | float
    spare: Array | float
    far: Array | float
    centred: bool


def lengths_of(radius: Array | float, rod_length: Array | float, offset: Array | float) -> Lengths:
    """The lengths of a loop, with what is made of them.

    >>> lengths_of(0.1, 0.4, 0.0).ratio
    0.25
    """
    r, l, e = radius, rod_length, offset
    far: Array | float = np.abs(e) / l
    spare: Array | float = np.maximum(l - r - np.abs(e), 0.0) / l
    spare, far = (float(x) if np.ndim(x) == 0 else x for x in (spare, far))
    return Lengths(r, l, e, r / l, e / l, spare, far, not np.any(e))


def loop_at(cycle_angle: float, lengths: Lengths) -> tuple[float, float]:
    """Position [m] of one piston's pin and its slope over the angle [m/rad] at a cycle angle [rad]:
    as `close_loop`, without arrays, for what steps over time.

    >>> loop_at(0.0, lengths_of(0.1, 0.3, 0.0))[0]
    0.4
    """
    sin, cos = np.array(math.sin(cycle_angle)), np.array(math.cos(cycle_angle))
    loop = _closed(sin, cos, lengths)
    return float(loop.x), float(loop.x_1)


def close_loops(crank_angle: Array, phases: Array, lengths: Lengths) -> Loop:
    """Close the loops of several cylinders: one sine and one cosine for each crank angle, turned
    by the phases.

    crank_angle, phases : shape (n,), (cylinders,) [rad]; every field has shape (cylinders, n)

    >>> phases, lengths = np.array([0.0, math.pi]), lengths_of(0.1, 0.3, 0.0)
    >>> close_loops(np.zeros(1), phases, lengths).x.round(12).tolist()
    [[0.4], [0.2]]
    """
    sin, cos = np.sin(crank_angle), np.cos(crank_angle)
    if len(phases) == 1 and phases[0] == 0.0:
        sin, cos = sin[np.newaxis], cos[np.newaxis]
    else:
        ahead, beside = np.cos(phases)[:, np.newaxis], np.sin(phases)[:, np.newaxis]
        sin, cos = sin * ahead + cos * beside, cos * ahead - sin * beside
    return _closed(sin, cos, lengths)


def _closed(sin_phi: Array, cos_phi: Array, lengths: Lengths) -> Loop:
    _, l, e, ratio, skew, spare, far, centred = lengths
    throw, side = ratio * cos_phi, ratio * sin_phi
    sin_beta = side if centred else side - skew
    # 1 - |sin(phi)| from its product with 1 + |sin(phi)|, as it would cancel near a fold
    wide = 1.0 + np.abs(sin_phi)
    narrow = cos_phi * cos_phi / wide
    # l (1 - sin(beta)) = (l - r + e) + r (1 - sin(phi)); likewise 1 + sin
    beyond: Array | float = 0.0 if centred else np.copysign(skew, e * sin_phi)
    cos_beta = np.sqrt(
        (spare + (far + beyond) + ratio * narrow) * (spare + (far - beyond) + ratio * wide)
    )
    beta_1 = throw / cos_beta
    # -cos(beta)^3 beta_2 / lambda as a sum of terms that are themselves small near a fold
    bend = (spare * (1.0 + ratio + far)) * sin_phi
    if not centred:
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


def top_position(radius: float, rod_length: float, offset: float) -> float:
    """Piston pin position x [m] at the true top dead centre: sqrt((l + r)^2 - e^2)."""
    return math.sqrt((rod_length + radius - offset) * (rod_length + radius + offset))


def bottom_position(radius: float, rod_length: float, offset: float) -> float:
    """Piston pin position x [m] at the true bottom dead centre."""
    return math.sqrt(max((rod_length - radius - offset) * (rod_length - radius + offset), 0.0))


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
