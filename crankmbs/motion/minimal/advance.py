"""One free rotation with time as the variable: (theta, omega), also at rest and backwards.

    alpha = (T_gas + T_gravity + T_outside - J_1 omega^2 / 2) / J

The `stepper` integrates piece by piece: between two knots of the pressure each cylinder keeps its
polynomial, continued beyond the knot, and the piece is cut exactly at the knot; likewise at a bound
of the loads' branch and at a reversal. Where a load damps the speed far faster than the crank
turns, SciPy's Radau takes its place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import DOP853, Radau

from crankmbs.mechanics.torque import Branch
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.minimal import stepper
from crankmbs.motion.minimal.entering import enter
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.stretch import Equation, Stretch, Track
from crankmbs.motion.plan import Plan
from crankmbs.numerics.arrays import Array

__all__ = ["Effort", "advance"]

_MOST_STEPS = 4096  # of one stretch
_SLACK = 1.001  # of a part: none is left over where the parts of a step sum up to less by rounding
_RADAU = 1e-13  # finest tolerance of a step, half of it where steps are halved; SciPy's is 2.3e-14


class Effort(NamedTuple):
    """Relative tolerance of each step, into how many it is divided then, the evaluations that are
    allowed, and how many steps the first stretch may have."""

    tolerance: float
    parts: int
    allowed: int
    room: int = 1


def advance(
    reduced: Reduced,
    state: State,
    plan: Plan,
    effort: Effort,
    is_fast: Callable[[State, Branch], bool],
) -> Generator[Stretch, None, Ending | None]:
    """Carry the motion on, in stretches of ever more steps: a short crossing is soon over.

    is_fast : whether the crank angle can take over again

    Returns
    -------
    how the motion ends; None where the crank angle takes over
    """
    tolerance, parts, allowed, room = effort
    scale = reduced.torque_scale + abs(state.mode.held)
    evaluations, most, h = 0, 0.0, math.inf
    base = reduced
    while evaluations < allowed:
        reduced = base.at(state.mode.loads).fired(state.mode.shares)
        equation = enter(reduced, state, scale)
        if isinstance(equation, Ending):
            return equation
        if equation.holds:
            yield (rest := Stretch.at_rest(equation, state, min(equation.until, plan.time_bound)))
            state = rest.end
            if state.time >= plan.time_bound:
                return Ending.COMPLETE
            continue
        inertia = reduced(state.theta, equation.between.pieces)[0]
        speed = max(abs(state.omega), math.sqrt(2.0 * scale / inertia), 1e-150)
        h = tolerance**0.125 / speed if math.isinf(h) else h
        bound = min(plan.time_bound, equation.branch.t_end)
        room = min(room, (allowed - evaluations) // 12 + 1)
        control = _Control(tolerance, speed, bound, h, most, room, parts)
        speeds = (0.0, equation.branch.omega_low, equation.branch.omega_high)
        low, high = plan.angle_bounds
        angles = max(low, state.mode.low), min(high, state.mode.high)
        limits = np.array([*equation.between[:2], *angles, *speeds])
        track = _track(equation, state, control, limits, stiff=equation.is_stiff(state, inertia))
        if len(track.widths) == 0:
            return Ending.FAILED
        stretch = Stretch.of(equation, track, state)
        yield stretch
        begin, state, h, most = state, stretch.end, track.next_step, track.most
        evaluations, room = evaluations + track.evaluations, min(2 * room, _MOST_STEPS)
        if state.time >= plan.time_bound or state.theta in plan.angle_bounds:
            return Ending.COMPLETE
        kinetic = equation.kinetic(state.theta, state.omega)
        dead = equation.is_stuck(begin, state) or equation.is_balanced(state, scale)
        if kinetic <= tolerance**2 * most and dead:
            return Ending.REST
        if is_fast(state, equation.branch):
            return None
    return Ending.COSTLY


class _Control(NamedTuple):
    """Tolerance of a step, speed [rad/s] to which it is relative, end in time [s], next step [s],
    largest kinetic energy so far [J], most steps, and into how many each is divided."""

    tolerance: float
    speed: float
    bound: float
    h: float
    most: float
    room: int
    parts: int


def _track(
    equation: Equation, begin: State, control: _Control, limits: Array, *, stiff: bool
) -> Track:
    """The next steps, by the method that serves them."""
    if stiff:
        return _by_scipy(Radau, equation, begin, control, limits)
    if equation.branch.functions:  # of which the compiled stepper knows nothing
        return _by_scipy(DOP853, equation, begin, control, limits)
    return _dop853(equation, begin, control, limits)


def _dop853(equation: Equation, begin: State, control: _Control, limits: Array) -> Track:
    """Steps of order 8."""
    begins, widths = np.empty((2, control.room + 1))
    rows, y = np.empty((control.room + 1, 8, 3)), np.array([begin.theta, begin.omega, 0.0])
    asked = (*control[:3], control.parts)
    start = (begin.time, control.h, control.most)
    with np.errstate(all="ignore"):
        n, t, h, most, evaluations = stepper.travel(
            equation.system, asked, start, y, limits, (begins, widths, rows)
        )
    return Track(begins[:n], widths[:n], rows[:n], t, y, h, most, evaluations)


def _by_scipy(
    method: type[Radau | DOP853],
    equation: Equation,
    begin: State,
    control: _Control,
    limits: Array,
) -> Track:
    """Steps of a method of SciPy's, up to the end of the piece."""
    parts = control.parts
    tolerance = max(control.tolerance, _RADAU / parts)
    atol = np.array([tolerance, tolerance * control.speed, math.inf])
    options: dict[str, Any] = {"rtol": tolerance, "atol": atol}

    function: Any = equation

    def start(t: float, y: Array, bound: float, first: float, longest: float) -> Radau | DOP853:
        first = min(first, longest, bound - t)
        return method(function, t, y, bound, first_step=first, max_step=longest, **options)

    track: list[tuple[float, float, Array]] = []
    most, evaluations, y = control.most, 0, np.array([begin.theta, begin.omega, 0.0])
    longest = (control.bound - begin.time) / parts if parts > 1 else math.inf
    solver = start(begin.time, y, control.bound, control.h, longest)
    t, h, i = begin.time, control.h, -1
    while solver.status == "running" and len(track) < control.room and i < 0:
        if solver.step():  # a sentence why it failed
            break
        track.append(_interpolant(solver))
        x, i = stepper.first_exit(track[-1][2], solver.y, limits)
        if i < 0:
            t, y, h = float(solver.t), solver.y, solver.h_abs
        elif x > 0.0:  # again, up to there only: its end is more exact than its inside
            t, width, row = track.pop()
            y, part = row[0], x * width / parts
            again = start(t, y, t + x * width, part, _SLACK * part)
            while again.status == "running" and not again.step():
                track.append(_interpolant(again))
            t, y, evaluations = float(again.t), again.y, evaluations + again.nfev
        state = State(t, float(y[0]), float(y[1]), 0.0)
        kinetic = equation.kinetic(state.theta, state.omega)
        most = max(most, kinetic)
        inertia = equation.reduced(state.theta, equation.between.pieces)[0]
        stiff = equation.is_stiff(state, inertia)
        if kinetic <= control.tolerance**2 * most or stiff != (method is Radau):
            break
    y = np.array(y)
    if i >= 0:
        near = stepper.NEAR * track[-1][1]
        t = stepper.land(t, y, equation(t, y), 0 if i < 4 else 1, limits[i], near)
    begins, widths, rows = ([step[part] for step in track] for part in range(3))
    arrays = np.array(begins), np.array(widths), np.array(rows)
    return Track(*arrays, t, y, h, most, evaluations + solver.nfev)


def _interpolant(solver: Radau | DOP853) -> tuple[float, float, Array]:
    """Beginning and length of the last step, and its polynomial as the `stepper` takes it: SciPy's
    own of order 7, of Radau the cubic."""
    dense: Any = solver.dense_output()
    begin, width, row = float(dense.t_min), float(dense.t_max - dense.t_min), np.zeros((8, 3))
    old = np.asarray(solver.y_old)
    if isinstance(solver, DOP853):
        row[0], row[1:] = old, dense.F
        return begin, width, row
    rise = solver.y - old
    near, far = (4.5 * (dense(begin + x * width) - old - x * rise) for x in (1 / 3, 2 / 3))
    row[:4] = old, rise, 2.0 * near - far, 3.0 * (far - near)
    return begin, width, row
