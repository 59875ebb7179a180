"""Where a run starts: every body's coordinates on the closed loop, and how the generalized-alpha
method wants them so that its multipliers do not ring.

A body's coordinate z is a function of the crank angle, so its derivatives in time are

    z' = z_1 omega,  z'' = z_2 omega^2 + z_1 alpha,
    z''' = z_3 omega^3 + 3 z_2 omega alpha + z_1 alpha'
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.formulations.base import Array
from crankmbs.geometry import close_loop
from crankmbs.scene import Scene

__all__ = ["SPECTRAL_RADIUS", "Start", "coordinates", "quiet_start"]

SPECTRAL_RADIUS = 0.9  # cleanly of order 2, so that extrapolation pays; 0.6 is not

_ALPHA_M = (2.0 * SPECTRAL_RADIUS - 1.0) / (SPECTRAL_RADIUS + 1.0)
_ALPHA_F = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1.0)
_GAMMA = 0.5 + _ALPHA_F - _ALPHA_M
_BETA = 0.25 * (_GAMMA + 0.5) ** 2


class Start(NamedTuple):
    """Coordinates and their derivatives in time, shape (3 + 5 n,) for n cylinders.

    Per body x, y of the centre of mass [m] and angle [rad] in the engine's frame: the crank, then
    for each cylinder the rod and the piston (which has no angle).
    """

    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array


def coordinates(
    scene: Scene, theta: float, omega: float, alpha: float = 0.0, jerk: float = 0.0
) -> Start:
    """All bodies on the closed loop at a crank angle, speed, acceleration and its rate. Exact."""
    r, l, a = scene.crank.radius, scene.rod.length, scene.rod.center_of_mass
    turn = 1j ** np.arange(4)  # derivatives of exp(i theta) in theta
    columns = _plane(scene.crank.center_of_mass * np.exp(1j * theta) * turn)
    columns.append(np.array([theta, 1.0, 0.0, 0.0]))
    offset = np.array([1j * scene.piston.offset, 0.0, 0.0, 0.0])
    for cylinder in scene.cylinders:
        phi = theta + cylinder.phase
        loop = close_loop(phi, r, l, scene.piston.offset)
        sin_b, cos_b, b_1, b_2 = loop.sin_beta, loop.cos_beta, loop.beta_1, loop.beta_2
        b_3 = (3.0 * sin_b * b_1 * b_2 + cos_b * b_1**3 - r * loop.cos_phi / l) / cos_b
        throw = r * np.exp(1j * phi) * turn
        along = np.exp(-1j * loop.beta) * np.array(
            [1.0, -1j * b_1, -1j * b_2 - b_1**2, 1j * (b_1**3 - b_3) - 3.0 * b_1 * b_2]
        )
        bank = np.exp(1j * cylinder.bank)
        columns += _plane((throw + a * along) * bank)
        columns.append(np.array([cylinder.bank - loop.beta, -b_1, -b_2, -b_3]))
        columns += _plane(((throw + l * along).real + offset) * bank)
    z, z_1, z_2, z_3 = np.array(columns).T
    return Start(
        z,
        z_1 * omega,
        z_2 * omega**2 + z_1 * alpha,
        z_3 * omega**3 + 3.0 * z_2 * omega * alpha + z_1 * jerk,
    )


def quiet_start(start: Start, step: float) -> Start:
    """Shift exact initial values so that the multipliers of the first steps carry no ringing.

    The position constraints hold at every step although the method's local error, of order h^3,
    would violate them; its velocities therefore carry a part of order h^2 off the constraints, and
    a start without it rings at order h in the multipliers. Its algorithmic acceleration belongs to
    the time t + (alpha_m - alpha_f) h. exudyn takes one acceleration for both the true and the
    algorithmic one; the further shifts of position and velocity make up for that in the first
    step. What is left is of order h^2 and dies away with the spectral radius.

    Source: Arnold, Bruels, Cardona, Numerische Mathematik 129 (2015) 149-179.
    """
    h, jerk = step, start.jerk
    off = (1.0 - 6.0 * _BETA - 3.0 * (_ALPHA_M - _ALPHA_F)) / 6.0
    late = _ALPHA_F * h * jerk  # the acceleration given below is by this much too late
    return Start(
        start.position + h**2 * (0.5 - _GAMMA + _BETA) * late,
        start.velocity + off * h**2 * jerk - h * (1.0 - _GAMMA) * late,
        start.acceleration + _ALPHA_M * h * jerk,
        jerk,
    )


def _plane(z: NDArray[np.complex128]) -> list[Array]:
    return [z.real, z.imag]
