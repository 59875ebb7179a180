"""Which piece a motion enters, and what holds a crank at rest."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crankmbs.mechanics.torque import branch_at, branch_of
from crankmbs.mechanics.windows import phase_ends
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal.equation import BALANCED, Equation
from crankmbs.motion.minimal.reduced import Reduced

__all__ = ["enter"]

_LOOKS = 2000  # at a load that is a function, until the end of a rest
_LONGEST = 60.0  # s: a rest of no known end is looked through so far
_HALVES = 50  # to 1e-15 of the bracket


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
        pull = equation.pull(state)
        if pull * sense > BALANCED * scale:
            return equation
        resisted = resisted or pull * sense < -BALANCED * scale
        sides.append(equation)
    rubs = reduced.train.rubs
    if resisted:
        waits = bool(phase_ends(torques, phases)[0])
        until = _until(sides, state, scale) if rubs else sides[0].branch.t_end
        if waits or (rubs and until < math.inf):
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
        missing, rate = 2.0 * BALANCED * scale - sense * equation.pull(state), sense
        rate *= equation.branch.ct
        if rate > 0.0 and not equation.branch.functions:
            until = min(until, state.time + missing / rate)
        elif equation.branch.functions:
            until = min(until, _first_pull(equation, sense, state, BALANCED * scale))
    return max(until, math.nextafter(state.time, math.inf))


def _first_pull(equation: Equation, sense: float, state: State, least: float) -> float:
    """When [s] a function of time first turns a crank at rest; infinite where it is not seen to."""

    def turns(t: float) -> bool:
        return sense * equation.pull(state._replace(time=t)) > least

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
