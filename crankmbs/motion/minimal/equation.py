"""The equation of motion over time on one piece, between two knots and on one branch of the loads;
which piece a motion enters, and what holds a crank at rest."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from crankmbs.mechanics.torque import Branch, branch_at, branch_of
from crankmbs.mechanics.windows import phase_ends
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal.reduced import Piece, Pieces, Reduced
from crankmbs.numerics.arrays import Array
from crankmbs.scene.units import DEGREE

__all__ = ["Equation", "enter"]

_BALANCED = 1e-13  # of the largest torque: what the rounding of an angle leaves at a dead centre
_LOOKS = 2000  # at a load that is a function, until the end of a rest
_LONGEST = 60.0  # s: a rest of no known end is looked through so far
_HALVES = 50  # to 1e-15 of the bracket


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
        branch, state = self.branch, (t, theta, omega)
        speeds = branch.omega_low, branch.omega_high
        return sum(
            function.continued(state, branch.t_end, self.piece[:2], speeds)
            for function in branch.functions
        )

    def is_stiff(self, state: State, least: float) -> bool:
        """Whether the loads damp the speed 300 times while the crank turns 5 degrees, and what they
        had to damp is gone, or less than the ``least`` speed [rad/s] that matters: while it still
        dies away small steps are needed anyway."""
        damping = abs(self.rate(state))
        strong = damping * 5.0 * DEGREE > 300.0 * abs(state.omega)
        small = max(0.01 * abs(state.omega), least)
        inertia = self.piece(state.theta - self.piece.middle)[0]
        return strong and abs(self.pull(state)) < inertia * damping * small

    def rate(self, state: State) -> float:
        """By how much loads and friction change the acceleration per speed [1/s]."""
        inertia, _, _, drag = self.piece(state.theta - self.piece.middle)
        at, branch = np.array(state[:3]), self.branch
        slope = sum(float(function.slope(*at)) for function in branch.functions)
        return (branch.c1 + 2.0 * branch.c2 * state.omega - drag + slope) / inertia

    @property
    def changes(self) -> bool:
        """Whether the torque at one angle and speed may be another later."""
        later = self.branch.ct != 0.0 or math.isfinite(self.branch.t_end)
        return later or bool(self.branch.functions)

    def is_balanced(self, state: State, scale: float) -> bool:
        """Whether no torque acts on a crank at rest here, now or later."""
        return not self.changes and abs(self.pull(state._replace(omega=0.0))) <= _BALANCED * scale

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

    def pull(self, state: State, side: float = 0.0) -> float:
        """Torque of gas, gravity, friction and loads at a state [N m].

        side : the sign of a speed that is about to be: where a function jumps, that side of it
        """
        time, theta, omega = state[:3]
        _, _, torque, drag = self.piece(theta - self.piece.middle)
        torque += self.outside(time, omega) - drag * omega
        functions = self.branch.functions
        return torque + sum(function.beside(time, theta, omega, side) for function in functions)

    def kinetic(self, theta: float, omega: float) -> float:
        """Kinetic energy [J]."""
        return 0.5 * self.piece(theta - self.piece.middle)[0] * omega * omega


def enter(reduced: Reduced, state: State, scale: float) -> Equation | Ending:
    """The piece that the motion enters, or why it enters none; at rest, where loads or friction
    hold it, it waits for loads that are still to set in, to end or to grow.

    scale [N m] : largest torque, against which rounding is told
    """
    torques, phases = reduced.train.loads, state.mode.loads
    pieces = reduced.at(state.mode)
    if state.omega != 0.0:
        piece = pieces.around(state.theta, math.copysign(1.0, state.omega))
        _, slope, torque, drag = piece(state.theta - piece.middle)
        rest = torque - drag * state.omega - 0.5 * slope * state.omega**2
        branch = branch_at(torques, state[:3], rest + state.mode.held, phases)
        if branch is None:
            return Ending.HELD
        return Equation(pieces, piece, branch.plus(state.mode.held))
    sides: list[Equation] = []
    resisted = False
    for sense in (1.0, -1.0):
        branch = branch_of(torques, state.time, 0.0, rising=sense > 0.0, phases=phases)
        equation = Equation(pieces, pieces.around(state.theta, sense), branch.plus(state.mode.held))
        pull = equation.pull(state, sense)
        if pull * sense > _BALANCED * scale:
            return equation
        resisted = resisted or pull * sense < -_BALANCED * scale
        sides.append(equation)
    rubs = reduced.train.rubs
    if resisted:
        waits, until = bool(phase_ends(torques, phases)[0]), sides[0].branch.t_end
        ends = rubs or bool(sides[0].branch.functions)  # what holds it, by what grows over time
        until = _until(sides, state, scale) if ends else until
        if waits or (ends and until < math.inf):
            return replace(sides[0], holds=True, until=until)
        return Ending.STICKS if rubs else Ending.HELD
    if sides[0].is_balanced(state, scale):
        return Ending.STUCK
    if sides[0].branch.functions:
        return sides[0]
    return replace(sides[0], holds=True, until=_until(sides, state, scale))


def _until(sides: list[Equation], state: State, scale: float) -> float:
    """Until when [s] a crank at rest stays there, if the loads' branch does not end before: a
    line over time is met where it is, a function of Python where it is first seen to be."""
    until = sides[0].branch.t_end
    for equation, sense in zip(sides, (1.0, -1.0), strict=True):
        missing, rate = 2.0 * _BALANCED * scale - sense * equation.pull(state, sense), sense
        rate *= equation.branch.ct
        if rate > 0.0 and not equation.branch.functions:
            until = min(until, state.time + missing / rate)
        elif equation.branch.functions:
            until = min(until, _first_pull(equation, sense, state, _BALANCED * scale))
    return max(until, math.nextafter(state.time, math.inf))


def _first_pull(equation: Equation, sense: float, state: State, least: float) -> float:
    """When [s] a function of time first turns a crank at rest; infinite where it is not seen to."""

    def turns(t: float) -> bool:
        return sense * equation.pull(state._replace(time=t), sense) > least

    end = min(equation.branch.t_end, state.time + _LONGEST)
    low = state.time
    for high in np.linspace(state.time, end, _LOOKS + 1)[1:].tolist():
        if turns(high):
            for _ in range(_HALVES):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if turns(middle) else (middle, high)
            return float(high)
        low = high
    return math.inf
