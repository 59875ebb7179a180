"""The equation of motion over time on one piece, between two knots and on one branch of the
loads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.base import State
from crankmbs.motion.minimal.reduced import Piece, Pieces
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import DEGREE

__all__ = ["BALANCED", "Equation"]

BALANCED = 1e-13  # of the largest torque: what the rounding of an angle leaves at a dead centre


@dataclass(frozen=True)
class Equation:
    """alpha = (T - J_1 omega^2 / 2) / J, with the torque T of gas, gravity, friction and loads.

    holds : whether the crank is at rest and its loads or friction hold it there, until a time [s]
    """

    pieces: Pieces
    piece: Piece
    branch: Branch
    holds: bool = False
    until: float = math.inf

    def slopes(self, t: float, y: Array) -> Array:
        """Slopes of (angle, omega, work) in time; the angle is counted from the piece's middle."""
        ahead, omega, _ = y.tolist()
        inertia, slope, torque, drag = self.piece(ahead)
        torque += self.outside(t, omega) - drag * omega
        if self.branch.functions:
            torque += self._of_functions(t, self.piece.middle + ahead, omega)
        return np.array([omega, (torque - 0.5 * slope * omega * omega) / inertia, torque * omega])

    def outside(self, t: float, omega: float) -> float:
        """Torque from outside [N m]."""
        b = self.branch
        return b.c0 + b.ct * t + (b.c1 + b.c2 * omega) * omega

    def _of_functions(self, t: float, theta: float, omega: float) -> float:
        return sum(function.number(t, theta, omega) for function in self.branch.functions)

    def is_stiff(self, state: State, least: float) -> bool:
        """Whether the loads damp the speed a thousand times while the crank turns 5 degrees, and
        what they had to damp is gone, or less than the ``least`` speed [rad/s] that matters: while
        it still dies away small steps are needed anyway."""
        inertia, _, _, drag = self.piece(state.theta - self.piece.middle)
        damping = abs(self.branch.c1 + 2.0 * self.branch.c2 * state.omega - drag) / inertia
        strong = damping * 5.0 * DEGREE > 1e3 * abs(state.omega)
        small = max(0.01 * abs(state.omega), least)
        return strong and abs(self.pull(state)) < inertia * damping * small

    @property
    def changes(self) -> bool:
        """Whether the torque at one angle and speed may be another later."""
        later = self.branch.ct != 0.0 or math.isfinite(self.branch.t_end)
        return later or bool(self.branch.functions)

    def is_balanced(self, state: State, scale: float) -> bool:
        """Whether no torque acts on a crank at rest here, now or later."""
        return not self.changes and abs(self.pull(state._replace(omega=0.0))) <= BALANCED * scale

    def is_caught(self, state: State, within: float) -> bool:
        """Whether a slow crank is driven back from either side, ``within`` an angle [rad]: it comes
        to rest between."""
        back, ahead = (
            self.pull(state._replace(theta=state.theta + off, omega=0.0))
            for off in (-within, within)
        )
        return not self.changes and ahead < 0.0 < back

    def is_stuck(self, begin: State, end: State) -> bool:
        """Whether a torque is left, so small that a step leads from rest to rest at the same angle:
        so does every other."""
        at_rest = begin.omega == end.omega == 0.0 and begin.theta == end.theta
        return at_rest and not self.changes

    def pull(self, state: State) -> float:
        """Torque of gas, gravity, friction and loads at a state [N m]."""
        time, theta, omega = state[:3]
        _, _, torque, drag = self.piece(theta - self.piece.middle)
        torque += self.outside(time, omega) - drag * omega
        return torque + self._of_functions(time, theta, omega)

    def kinetic(self, theta: float, omega: float) -> float:
        """Kinetic energy [J]."""
        return 0.5 * self.piece(theta - self.piece.middle)[0] * omega * omega
