"""Orders of the inertia torque and of the force on the frame at constant speed, in closed form.

With lambda = r/l, eps = e/l and u = sin(beta) = lambda sin(phi) - eps the series

    cos(beta) = sum_m binomial(1/2, m) (-u^2)^m,    1 / cos(beta)^2 = sum_m u^(2 m)

are polynomials in exp(i phi), term by term; products of such are convolutions. Nothing here is
sampled, and nothing is shared with `crankmbs.mechanics.geometry`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crankmbs.numerics.arrays import Array
from crankmbs.scene.parts import RunningGear
from crankmbs.scene.scene import Scene

__all__ = ["ClosedOrders", "closed_orders"]

Waves = NDArray[np.complex128]

_K = 512  # harmonics of one revolution that are kept, on either side
_STEEPEST = 0.97  # of lambda + |eps|: beyond, what the kept harmonics miss is more than rounding
_LEFT = 1e-18  # of a series


@dataclass(frozen=True)
class ClosedOrders:
    """What a crank train does at constant speed, per omega^2: amplitude exp(i phase), so that a
    quantity is omega^2 Re(sum of wave exp(i order theta)).

    order : shape (n,), 1, 2, ... per revolution
    frame_force_x, frame_force_y : shape (n,) [kg m], sum of -m a over crank, rods and pistons
    torque : shape (n,) [kg m2], of all rods on the crank, by their inertia and the pistons'
    """

    order: Array
    frame_force_x: Waves
    frame_force_y: Waves
    torque: Waves


def closed_orders(scene: Scene, highest: int = 12) -> ClosedOrders | None:
    """The orders of inertia of a crank train, exact to rounding; None near a fold, where the rod
    is so short that r + |e| > 0.97 l and the series hardly fall.

    force along X, Y = -m G'' omega^2,  torque = -(1/2) dJ/dphi omega^2, summed with the phase and
    bank of every cylinder.

    >>> closed = closed_orders(load_scene("coasting"))
    >>> print(abs(closed.torque[1]) > abs(closed.torque[0]))
    True
    """
    order, crank = np.arange(1.0, highest + 1.0), scene.crank
    waves = {gear: _of_gear(gear, highest) for gear in set(scene.running_gear)}
    total = np.zeros((3, highest), dtype=np.complex128)
    for cylinder, gear in zip(scene.cylinders, scene.running_gear, strict=True):
        of_gear = waves[gear]
        if of_gear is None:
            return None
        along, across, torque = of_gear
        turn, cos_bank, sin_bank = (
            np.exp(1j * order * cylinder.phase),
            np.cos(cylinder.bank),
            np.sin(cylinder.bank),
        )
        total[0] += turn * (cos_bank * along - sin_bank * across)
        total[1] += turn * (sin_bank * along + cos_bank * across)
        total[2] += turn * torque
    of_crank = crank.mass * crank.center_of_mass
    total[:2, 0] += of_crank, -1j * of_crank
    return ClosedOrders(order, *total)


def _of_gear(gear: RunningGear, highest: int) -> tuple[Waves, Waves, Waves] | None:
    """Force along and across the cylinder, and torque, of one at phase 0, shape (highest,) each."""
    (r, l, e), rod, piston = gear.shape, gear.rod, gear.piston
    a, ratio, skew = rod.center_of_mass, r / l, e / l
    if ratio + abs(skew) > _STEEPEST:
        return None
    cosine, sine = _wave({1: 0.5, -1: 0.5}), _wave({1: -0.5j, -1: 0.5j})
    u = ratio * sine - skew * _wave({0: 1.0})
    cos_beta, wide = _series(u[_K - 1 : _K + 2], ratio + abs(skew))
    x = r * cosine + l * cos_beta
    rod_x, rod_y = r * cosine + a * cos_beta, r * sine - a * u
    x_1, rod_x_1, rod_y_1 = (_slope(q) for q in (x, rod_x, rod_y))
    inertia = (
        piston.mass * _product(x_1, x_1)
        + rod.mass * (_product(rod_x_1, rod_x_1) + _product(rod_y_1, rod_y_1))
        + rod.moment_of_inertia * ratio**2 * _product(_product(cosine, cosine), wide)
    )
    force_x = -piston.mass * _slope(x_1) - rod.mass * _slope(rod_x_1)
    force_y = -rod.mass * _slope(rod_y_1)
    along, across, torque = (
        2.0 * wave[_K + 1 : _K + 1 + highest] for wave in (force_x, force_y, -0.5 * _slope(inertia))
    )
    return along, across, torque


def _series(u: Waves, most: float) -> tuple[Waves, Waves]:
    """cos(beta) and 1 / cos(beta)^2 from the three harmonics of u, |u| <= most < 1."""
    square = np.convolve(u, u)
    power = cos_beta = wide = _wave({0: 1.0})
    factor, m, bound = 1.0, 0, 1.0
    while bound > _LEFT:
        factor *= (m - 0.5) / (m + 1.0)  # of binomial(1/2, m) (-1)^m
        power = np.convolve(power, square, mode="same")
        cos_beta, wide = cos_beta + factor * power, wide + power
        m, bound = m + 1, bound * most**2
    return cos_beta, wide


def _wave(parts: dict[int, complex]) -> Waves:
    """A sum of parts[k] exp(i k phi)."""
    wave = np.zeros(2 * _K + 1, dtype=np.complex128)
    for k, part in parts.items():
        wave[_K + k] = part
    return wave


def _slope(wave: Waves) -> Waves:
    return np.asarray(1j * np.arange(-_K, _K + 1) * wave)


def _product(left: Waves, right: Waves) -> Waves:
    return np.asarray(np.convolve(left, right, mode="same"))
