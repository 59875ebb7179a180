"""What each main journal carries, and each crank pin that two rods share.

With R_k the crank's force on rod k, u_j the unbalance of throw j as a complex number in the
engine's frame at crank angle 0, m g / T the weight of each of T throws, and the shares s and t of
`crankmbs.scene.bearings.Throws`, the bearing's force on journal i is

    F_i = sum_k s_ik R_k + sum_j t_ij S_j,   S_j = (i alpha - omega^2) u_j exp(i theta) - m g / T

As the shares of every load add up to 1, all journals together carry the main bearing's force. The
frame feels -S_j at each throw's place, the moment of which is in its rocking moments.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.axes import axes_of, gravity_vector
from crankmbs.numerics.arrays import Array
from crankmbs.scene.bearings import Throws
from crankmbs.scene.scene import Scene

__all__ = ["journal_rows", "of_journals", "of_rods", "rocking_of_throws"]

_JOURNAL = ("main_journal_force_x", "main_journal_force_y")
_PIN = ("pin_force_x", "pin_force_y")


def journal_rows(scene: Scene) -> dict[str, int]:
    """How many journals and shared pins a scene has a force of, by variable; none without bearings.

    >>> journal_rows(load_scene("propeller"))
    {}
    """
    throws = scene.throws
    if throws is None:
        return {}
    pins = dict.fromkeys(_PIN, len(throws.unbalances)) if throws.shared else {}
    return dict.fromkeys(_JOURNAL, len(throws.rods)) | pins


def of_journals(
    scene: Scene,
    theta: Array,
    motion: tuple[Array, Array, Array],
    rods: tuple[Array, Array],
) -> dict[str, Array]:
    """The forces of journals and shared pins in the engine's frame, shape (journals, u, n) [N].

    motion : omega^2, alpha and 1, shape (u, n) or (u, 1) each
    rods : the crank's force on each rod in its cylinder's axes, shape (cylinders, u, n)
    """
    joints, throws = of_rods(scene, *rods), scene.throws
    if throws is None:
        return joints
    held = np.tensordot(np.array(throws.throws), _of_throws(scene, throws, theta, motion), 1)
    for name, part in zip(_JOURNAL, (held.real, held.imag), strict=True):
        joints[name] = joints[name] + part
    return joints


def rocking_of_throws(
    scene: Scene, theta: Array, motion: tuple[Array, Array, Array]
) -> tuple[Array, Array] | None:
    """Moments about X and Y, middle of the crank, of what the throws' unbalances and weights do to
    the frame, shape (u, n) [N m]; None without bearings, where the crank's mass is in the middle.

    theta and motion as `of_journals` takes them
    """
    throws = scene.throws
    if throws is None:
        return None
    on_frame = -np.tensordot(np.array(throws.levers), _of_throws(scene, throws, theta, motion), 1)
    return -on_frame.imag, on_frame.real


def _of_throws(
    scene: Scene, throws: Throws, theta: Array, motion: tuple[Array, Array, Array]
) -> NDArray[np.complex128]:
    """What its journals do to each throw for its own mass, shape (throws, u, n) [N]."""
    square, alpha, one = motion
    weight = complex(*gravity_vector(scene)) * scene.crank.mass / len(throws.unbalances)
    turning = np.exp(1j * theta) * (1j * alpha - square)
    unbalance = np.array(throws.unbalances)[:, np.newaxis, np.newaxis]
    return np.asarray(unbalance * turning - weight * one)


def of_rods(scene: Scene, x: Array, y: Array) -> dict[str, Array]:
    """What the crank's forces on the rods add to those of journals and shared pins, shape
    (journals, ...) [N]: forces in their cylinders' axes, shape (cylinders, ...)."""
    throws = scene.throws
    if throws is None:
        return {}
    axes, shape = axes_of(scene), (-1, *(1,) * (x.ndim - 1))
    cos, sin = axes.cos.reshape(shape), axes.sin.reshape(shape)
    along = cos * x - sin * y, sin * x + cos * y
    held = {_JOURNAL: np.array(throws.rods)}
    if throws.shared:
        held[_PIN] = (np.arange(len(throws.unbalances))[:, None] == throws.numbers).astype(float)
    return {
        name: np.tensordot(shares, part, 1)
        for names, shares in held.items()
        for name, part in zip(names, along, strict=True)
    }
