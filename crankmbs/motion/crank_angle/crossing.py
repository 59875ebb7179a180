"""Where the speed leaves the branch of the loads, within solved cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crankmbs.motion.states import samples_in
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.roots import first_above

if TYPE_CHECKING:
    from crankmbs.motion.crank_angle.segment import AngleSegment

__all__ = ["crossing"]


def crossing(segment: AngleSegment, limit: float, *, above: bool) -> tuple[int, float] | None:
    """Cell and place in it, 0 to 1, where the speed first passes a limit [rad/s]; None where it
    does not."""
    omega = np.column_stack([segment.sense / segment.slowness, segment.speeds[1:]])
    positions = np.concatenate([[0.0], segment.grid.rule.nodes, [1.0]])
    side = 1.0 if above else -1.0
    beyond = side * (np.append(segment.begin.omega, omega) - limit)
    inside = int(np.argmax(np.append(beyond[1:] > 0.0, True)))  # stretches before it is seen
    stretches = np.append(np.flatnonzero(_may_leave(beyond)[:inside]), inside)
    for k, j in zip(*divmod(stretches, omega.shape[1]), strict=True):
        if k == len(omega):
            break

        def speed(x: Array, k: int = k) -> tuple[Array, Array]:
            there = samples_in(segment.whole, segment.grid.train, np.full(1, k), x)
            slope = segment.terms.width[k] * there.alpha / np.abs(there.omega)
            return side * (there.omega - limit), side * slope

        x = first_above(speed, positions[j], positions[j + 1])
        if x is not None:
            return int(k), x
    return None


def _may_leave(beyond: Array) -> NDArray[np.bool_]:
    """Between which of neighbouring points a value, below zero at both, may be above: where it
    turns, and falls off to the neighbours by more than is missing."""
    rise = np.diff(beyond, prepend=beyond[0], append=beyond[-1])
    before, after = rise[:-1], -rise[1:]
    near = (beyond < 0.0) & (beyond + before + after > 0.0)
    top = near & (before >= 0.0) & (after >= 0.0)
    return np.asarray(top[:-1] | top[1:])
