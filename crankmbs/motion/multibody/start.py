"""Where a run starts: every body's coordinates on the closed loop, and how the generalized-alpha
method wants them so that its multipliers do not ring.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from crankmbs.motion.multibody.taylor import taylor
from crankmbs.numerics.arrays import Array
from crankmbs.scene.scene import Scene

__all__ = ["DIES_AWAY", "SPECTRAL_RADIUS", "Start", "angle_of", "coordinates", "quiet_start"]

SPECTRAL_RADIUS = 0.9  # cleanly of order 2, so that extrapolation pays; 0.6 is not

_ALPHA_M = (2.0 * SPECTRAL_RADIUS - 1.0) / (SPECTRAL_RADIUS + 1.0)
_ALPHA_F = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1.0)
_GAMMA = 0.5 + _ALPHA_F - _ALPHA_M
_BETA = 0.25 * (_GAMMA + 0.5) ** 2

DIES_AWAY = -_ALPHA_M / (1.0 - _ALPHA_M)  # by step, of a wrong algorithmic acceleration

_TERMS = 6  # of the series in the step


class Start(NamedTuple):
    """Coordinates and their derivatives in time, shape (3 + 5 n,) for n cylinders.

    Per body x, y of the centre of mass [m] and angle [rad] in the engine's frame: the crank, then
    for each cylinder the rod and the piston (which has no angle).
    """

    position: Array
    velocity: Array
    acceleration: Array


def coordinates(scene: Scene, theta: float, omega: float, alpha: float = 0.0) -> Start:
    """All bodies on the closed loop at a crank angle, speed and acceleration. Exact."""
    position, velocity, half = taylor(scene, (theta, omega, 0.5 * alpha))
    return Start(position, velocity, 2.0 * half)


def quiet_start(scene: Scene, angle: Sequence[float], step: float) -> Start:
    """Initial values from which the multipliers of the first steps do not ring.

    The method's solutions that do not ring are smooth functions of time with the position
    constraints met. With x = h d/dt its formulas give for them, from the positions q(t),

        accelerations  Q(x) q'',  Q = 1 - 0.1687 x^2 + ...
        velocities     V(x) q',   V = 1 - 0.0840 x^2 + ...
        algorithmic accelerations  A(x) q'',  A = 1 + (alpha_m - alpha_f) x + ...

    exudyn takes one acceleration for both; shifts of position and velocity make up for that in the
    first step. What is left is what the series leaves of q(t).

    angle : coefficients of the crank angle [rad] over the number of the step, as the method's own
        smooth solution has it
    step [s]
    """
    coefficients = [*angle, *[0.0] * (_TERMS + 2)][: _TERMS + 2]
    series = taylor(scene, coefficients)
    slopes = series * _FACTORIALS[:, None]  # derivatives in the number of the step
    velocity = _VELOCITY @ slopes[1:-1] / step
    acceleration = _ACCELERATION @ slopes[2:] / step**2
    algorithmic = _ALGORITHMIC @ slopes[2:] / step**2
    given = (_ALPHA_M * algorithmic - _ALPHA_F * acceleration) / (_ALPHA_M - _ALPHA_F)
    late = given - algorithmic
    return Start(
        slopes[0] + step**2 * (0.5 - _GAMMA + _BETA) * late,
        velocity - step * (1.0 - _GAMMA) * late,
        given,
    )


def angle_of(state: Iterable[float], alpha: Sequence[float], step: float) -> list[float]:
    """Coefficients of the crank angle [rad] over the number of the step, for `quiet_start`.

    state : crank angle [rad] and speed [rad/s] of the method, at the start
    alpha : coefficients of its crank acceleration [rad/s2] over the number of the step
    """
    slopes = np.zeros(_TERMS)
    slopes[: len(alpha)] = alpha[:_TERMS]
    slopes *= step**2 * _FACTORIALS[:_TERMS]
    second = [float(_POSITION[: _TERMS - k] @ slopes[k:]) for k in range(_TERMS)]
    theta, omega = (float(q) for q in state)
    first = omega * step - float(_VELOCITY[1:] @ second[: _TERMS - 1])
    return [theta, first, *(d / math.factorial(k + 2) for k, d in enumerate(second))]


def _quotient(above: Array, below: Array) -> Array:
    """Coefficients of a quotient of power series."""
    result = np.zeros(len(above))
    for k in range(len(above)):
        result[k] = (above[k] - result[:k] @ below[k:0:-1]) / below[0]
    return result


def _product(left: Array, right: Array) -> Array:
    return np.convolve(left, right)[: len(left)]


def _series() -> tuple[Array, Array, Array, Array]:
    """1 / Q, Q, V and A of `quiet_start`, by putting q = exp(s t), x = s h into the method."""
    one = np.eye(_TERMS)[0]
    ahead = 1.0 / _FACTORIALS[:_TERMS]  # exp(x)
    rise = 1.0 / _FACTORIALS[1 : _TERMS + 1]  # (exp(x) - 1) / x
    algorithmic = _quotient(
        (1.0 - _ALPHA_F) * ahead + _ALPHA_F * one, (1.0 - _ALPHA_M) * ahead + _ALPHA_M * one
    )
    velocity = _product(_quotient(_GAMMA * ahead + (1.0 - _GAMMA) * one, rise), algorithmic)
    bent = _product((0.5 - _BETA) * one + _BETA * ahead, algorithmic)
    position = _quotient(velocity + np.append(0.0, bent[:-1]), rise)
    acceleration = _quotient(one, position)
    return (
        position,
        acceleration,
        _product(velocity, acceleration),
        _product(algorithmic, acceleration),
    )


_FACTORIALS = np.array([float(math.factorial(k)) for k in range(_TERMS + 2)])
_POSITION, _ACCELERATION, _VELOCITY, _ALGORITHMIC = _series()
