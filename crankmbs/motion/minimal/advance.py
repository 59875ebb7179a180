"""One free rotation with time as the variable: (theta, omega), also at rest and backwards.

    alpha = (T_gas + T_gravity + T_outside - J_1 omega^2 / 2) / J

SciPy's DOP853 takes one step after the other: between two knots on the polynomials that hold there,
continued a little beyond the knot, where the step is cut; likewise at a bound of the loads' branch
and at a reversal. Where a load damps the speed far faster than the crank turns, its Radau takes
the place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import Radau

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal.equation import Equation, enter
from crankmbs.motion.minimal.exits import first_exit, interpolant, value
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.segment import StepSizes, TimeSegment, Track
from crankmbs.motion.minimal.step_by_step import StepByStep
from crankmbs.motion.plan import Plan
from crankmbs.numerics.arrays import Array

__all__ = ["Effort", "advance"]

_MOST_STEPS = 4096  # of one segment
_FINEST, _RADAU = 2.3e-14, 1e-13  # tolerances of a step relative to a value, SciPy's; of Radau
_BEYOND = 1.02  # of the way to a knot: a step that goes there, so that it is passed
_FIRST = 1e-3  # of the step that could be: the first one behind a knot, where it hesitates
_LAST = 0.9  # of the way to a knot: a step there, where it hesitates
_GROWS = 10.0  # times at most, from one step of DOP853 to the next
_OFF = 1e-6  # rad: of a difference
_LOST = 1e-14  # of the time: no shorter step leads to where a function of Python has a value
_LEAVES = 1e-12  # of a step: a motion that leaves a limit before has not set out


class Effort(NamedTuple):
    """Relative tolerance of each step, the evaluations that are allowed, the steps of a first pass,
    which are halved here, and how many the first segment may have.

    hesitates : whether steps before and behind a knot are far shorter than they could be. A jump of
        a function of Python right beside a dead centre, where its force has no torque, lies else
        between the first or the last two places at which a step knows the torque, and is passed
        over unseen
    """

    tolerance: float
    allowed: int
    before: StepSizes | None = None
    room: int = 1
    hesitates: bool = False


def advance(
    reduced: Reduced,
    state: State,
    plan: Plan,
    effort: Effort,
    is_fast: Callable[[State, Branch], bool],
) -> Generator[TimeSegment, None, Ending | None]:
    """Carry the motion on, in segments of ever more steps: a short crossing is soon over.

    is_fast : whether the crank angle can take over again

    Returns
    -------
    how the motion ends; None where the crank angle takes over
    """
    tolerance, allowed, before, room, hesitates = effort
    scale = reduced.torque_scale + abs(state.mode.held)
    evaluations, most, h = 0, 0.0, math.inf
    while evaluations < allowed:
        equation = enter(reduced, state, scale)
        if isinstance(equation, Ending):
            return equation
        if equation.holds:
            yield (
                rest := TimeSegment.at_rest(equation, state, min(equation.until, plan.time_bound))
            )
            state = rest.end
            if state.time >= plan.time_bound:
                return Ending.COMPLETE
            continue
        inertia = equation.piece(state.theta - equation.piece.middle)[0]
        speed = max(abs(state.omega), math.sqrt(2.0 * scale / inertia), 1e-150)
        h = tolerance**0.125 / speed if math.isinf(h) else h
        room = min(room, (allowed - evaluations) // 12 + 1)
        low, high = plan.angle_bounds
        control = _Control(
            tolerance,
            speed,
            min(plan.time_bound, equation.branch.t_end),
            (max(low, state.mode.low), min(high, state.mode.high)),
            room,
            before,
            hesitates,
        )
        walk = _Walk(equation, control, state, h, most)
        with np.errstate(all="ignore"):
            track = walk.track()
        if len(track.widths) == 0:
            return Ending.FAILED
        segment = TimeSegment.of(equation, track, state)
        yield segment
        begin, state, h, most = state, segment.end, track.next_step, track.most
        evaluations, room = evaluations + track.evaluations, min(2 * room, _MOST_STEPS)
        if state.time >= plan.time_bound or state.theta in plan.angle_bounds:
            return Ending.COMPLETE
        equation = track.equation
        kinetic = equation.kinetic(state.theta, state.omega)
        if kinetic <= tolerance**2 * most and (
            equation.is_stuck(begin, state)
            or equation.is_balanced(state, scale)
            or equation.is_caught(state, tolerance)
        ):
            return Ending.REST
        if is_fast(state, equation.branch):
            return None
    return Ending.COSTLY


@dataclass(frozen=True)
class _Control:
    """Tolerance of a step, speed [rad/s] to which it is relative, end in time [s], crank angles
    [rad] at which a segment ends, most steps, the steps that are halved, and as in `Effort`."""

    tolerance: float
    speed: float
    bound: float
    angles: tuple[float, float]
    room: int
    before: StepSizes | None
    hesitates: bool


class _Step(NamedTuple):
    """A step: its polynomial, as in `crankmbs.motion.minimal.exits`, its length [s], what it adds
    to the state, the next length; where it first leaves a limit, and which, as in `first_exit`."""

    row: Array
    width: float
    gained: Array
    h: float
    x: float
    which: int
    limit: float


class _Walk:
    """Step from knot to knot on one branch of the loads, in one sense of rotation.

    Its state has the angle from the middle of the piece on: the last digit of a crank angle is too
    coarse where the inertia changes within 1e-5 rad.
    """

    def __init__(
        self, equation: Equation, control: _Control, begin: State, h: float, most: float
    ) -> None:
        self._equation, self._control = equation, control
        self._time, self._theta = begin.time, begin.theta
        self._y = np.array([begin.theta - equation.piece.middle, begin.omega, 0.0])
        self._h, self._most, self._evaluations = h, most, 0
        self._free = h  # the next step, were there no knot near
        self._at_knot = begin.theta in (equation.piece.low, equation.piece.high)
        self._steps: list[tuple[float, float, Array]] = []
        branch = equation.branch
        self._speeds = 0.0, branch.omega_low, branch.omega_high
        self._origin = begin.time, self._y  # of a step: its time and state
        self._steps_of_dop853: StepByStep | None = None

    def track(self) -> Track:
        """The steps, up to the end of the segment."""
        self._most = max(self._most, self._kinetic())
        while len(self._steps) < self._control.room and self._step():
            kinetic = self._kinetic()
            self._most = max(self._most, kinetic)
            dies = kinetic <= self._control.tolerance**2 * self._most
            if dies or self._time >= self._control.bound:
                break
        columns = ([step[k] for step in self._steps] for k in range(3))
        begins, widths, rows = (np.array(column) for column in columns)
        y = np.append(self._theta, self._y[1:])
        at_end = y, self._equation, self._h, self._most, self._evaluations
        return Track(begins, widths, rows, self._time, *at_end)

    def _kinetic(self) -> float:
        return self._equation.kinetic(self._theta, float(self._y[1]))

    def _step(self) -> bool:
        """The next step; whether the segment goes on."""
        for function in self._equation.branch.functions:
            function.failure = ""
        self._origin = self._time, self._y
        slopes = self._equation.slopes(*self._origin)
        width, left = self._width(float(slopes[1])), self._control.bound - self._time
        step = self._tried(width, slopes)
        if step is None:
            return False
        self._h, begin, self._at_knot = step.h, self._time, False
        self._free = max(self._free, step.h) if step.width == width else step.h
        if step.x > _LEAVES:
            row = step.row.copy()
            row[0, 0] = self._theta
            self._steps.append((begin, step.width, row))
            self._time = begin + step.x * step.width
        if step.which >= 0:
            return self._landed(step)
        self._y = self._y + step.gained
        self._theta = float(self._equation.piece.middle + self._y[0])
        if step.width == width == left:
            self._time = self._control.bound
        return True

    def _tried(self, width: float, slopes: Array) -> _Step | None:
        """A step no longer than this [s], with these slopes at its begin; None where none is short
        enough."""
        equation, control, time = self._equation, self._control, self._time
        begin = State(time, self._theta, float(self._y[1]), 0.0)
        stiff = equation.is_stiff(begin, control.tolerance * control.speed)
        solver = self._radau(width, begin) if stiff else self._dop853(width, slopes)
        failed = solver.step()
        self._evaluations += solver.nfev
        functions = equation.branch.functions
        lost = any(function.failure for function in functions) and solver.t < _LOST * time
        if failed or lost or (solver.t < width and time + solver.t == time):
            return None
        row, middle = interpolant(solver), equation.piece.middle
        row[0] = self._y
        knots = zip(equation.piece[:2], control.angles, (max, min), strict=True)
        low, high = (nearer(knot, angle) for knot, angle, nearer in knots)
        x, which, limit = first_exit(row, (low - middle, high - middle), self._speeds)
        if which == 0:
            limit = low if limit == low - middle else high
        return _Step(row, float(solver.t), solver.y, float(solver.h_abs), x, which, limit)

    def _dop853(self, width: float, slopes: Array) -> Any:
        """Made once, then set back: to make one takes a tenth of a step."""
        if self._steps_of_dop853 is None:
            control = self._control
            solver = self._solver_of(StepByStep, width, control.tolerance, control.speed)
            self._steps_of_dop853 = solver
        else:
            self._steps_of_dop853.again(width, slopes)
        return self._steps_of_dop853

    def _radau(self, width: float, begin: State) -> Any:
        """With the derivatives of the slopes; SciPy's differences would be lost in the rounding of
        what a step adds to. Relative to the largest torque the acceleration may err by the
        tolerance, and the speed by no more than leads to that through the load."""
        time, y = self._origin
        off = np.array([_OFF, 0.0, 0.0])
        ahead, behind = (self._equation.slopes(time, y + each)[1] for each in (off, -off))
        rate, tolerance = self._equation.rate(begin), max(self._control.tolerance, _RADAU)
        rates = [0.5 * (ahead - behind) / _OFF, rate, 0.0]
        derivatives = np.array([[0.0, 1.0, 0.0], rates, 3 * [0.0]])
        speed = self._control.speed * min(self._control.speed / abs(rate), 1.0)
        return self._solver_of(Radau, width, tolerance, speed, jac=derivatives)

    def _solver_of(
        self, method: Any, width: float, tolerance: float, speed: float, **more: Array
    ) -> Any:
        """Of what a step adds: relative to the values SciPy asks for 100 roundings."""
        return method(
            self._slopes_after,
            0.0,
            np.zeros(3),
            width,
            first_step=width,
            max_step=width,
            rtol=max(tolerance, _FINEST),
            atol=np.array([tolerance, tolerance * speed, math.inf]),
            **more,
        )

    def _slopes_after(self, t: float, gained: Array) -> Array:
        """So long [s] after the begin of the step, with so much gained."""
        time, y = self._origin
        return self._equation.slopes(time + t, y + gained)

    def _width(self, alpha: float) -> float:
        """Length of the next step [s]: what the errors allow, and not much beyond the next knot.

        alpha : at its begin [rad/s2]
        """
        control, piece = self._control, self._equation.piece
        ahead, omega, _ = self._y.tolist()
        sense = math.copysign(1.0, omega or alpha)
        distance = sense * ((piece.high if sense > 0.0 else piece.low) - piece.middle - ahead)
        square = omega * omega + 2.0 * sense * alpha * distance
        reach = math.inf
        if square > 0.0:
            reach = _BEYOND * 2.0 * distance / (abs(omega) + math.sqrt(square))
        h = self._h
        if control.hesitates and self._at_knot:
            h = _FIRST * self._free
        elif control.hesitates and _FIRST * self._free < reach < _GROWS * h:
            reach *= _LAST
        width = min(h, reach, control.bound - self._time)
        return control.before.halved(self._time, width) if control.before else width

    def _landed(self, step: _Step) -> bool:
        """Put the motion on the limit that it has come to; whether it goes on there."""
        begin, middle = float(self._y[0]), self._equation.piece.middle
        self._y = np.array(value(step.row, step.x))
        if step.which == 0:
            self._theta, self._y[0] = step.limit, step.limit - middle
            if not self._y[1] * (self._y[0] - begin) >= 0.0:
                self._y[1] = 0.0  # it turns there
        else:
            self._theta, self._y[1] = float(middle + self._y[0]), step.limit
        if step.which == 1 or self._y[1] == 0.0 or step.limit in self._control.angles:
            return False
        piece = self._equation.pieces.around(step.limit, math.copysign(1.0, self._y[1]))
        self._y[0] = step.limit - piece.middle
        self._equation, self._at_knot = replace(self._equation, piece=piece), True
        return True
