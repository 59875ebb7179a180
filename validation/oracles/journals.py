"""What holds each throw of a crank: a beam on two supports, by balances of force and of moment."""

from typing import NamedTuple

import numpy as np

from validation.oracles.arithmetic import Array

__all__ = ["Pin", "Throw", "journal_forces"]


class Pin(NamedTuple):
    """A rod's place along the crank [m], and the crank's force on it in the engine's frame, complex
    of shape (samples,) [N]."""

    place: float
    force: Array


class Throw(NamedTuple):
    """A throw between two journals [m], with its rods.

    middle : where its own mass stands along the crank [m]
    mass : [kg]; unbalance : mass times the place of its centre, complex [kg m], in the engine's
        frame at crank angle 0
    """

    journals: tuple[float, float]
    middle: float
    mass: float
    unbalance: complex
    pins: tuple[Pin, ...]


def journal_forces(
    throws: tuple[Throw, ...], motion: tuple[Array, Array, Array], gravity: complex
) -> Array:
    """The bearing's force on each journal, complex of shape (samples, journals) [N], at crank
    angles, speeds and accelerations of shape (samples,) [rad, rad/s, rad/s2].

    Of a throw with its rods on the pins F_k at z_k, its own mass accelerated in its middle z_0 and
    the supports' forces A and B at a and b:

        A + B - sum F_k = S,    (a - z_0) A + (b - z_0) B - sum (z_k - z_0) F_k = 0
        S = rate of its momentum less its weight
    """
    theta, omega, alpha = motion
    forces = np.zeros((len(theta), len(throws) + 1), dtype=np.clongdouble)
    for number, throw in enumerate(throws):
        centre = throw.unbalance * (np.cos(theta) + 1j * np.sin(theta))
        rate = 1j * alpha * centre + 1j * omega * (1j * omega * centre)
        total = rate - throw.mass * gravity
        moment = np.zeros_like(total)
        for pin in throw.pins:
            total = total + pin.force
            moment = moment + (pin.place - throw.middle) * pin.force
        a, b = (place - throw.middle for place in throw.journals)
        held = np.linalg.solve(
            np.array([[1.0, 1.0], [a, b]]),
            np.array([total, moment]).astype(np.complex128),
        )
        forces[:, number] += held[0]
        forces[:, number + 1] += held[1]
    return forces
