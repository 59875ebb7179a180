"""One free rotation with the crank angle as the variable.

The kinetic energy E = J(theta) omega^2 / 2 obeys dE/dtheta = Q(theta, omega, t), and time follows
from dt/dtheta = 1 / omega. J and the torque of gas and gravity depend on theta alone: they are
tabulated once, at the nodes of a Gauss collocation whose cells no knot of the pressure lies
inside. On every branch of the loads Q is quadratic in omega and linear in t; without linear terms
it is linear in E, each cell is an affine map, and whole blocks of periods are solved at once.
Otherwise Newton's method solves a segment of cells at once, across kinks of the loads, which become
edges of cells where they matter; at a jump a segment ends.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.inertia import reduce
from crankmbs.mechanics.torque import Branch, Course, course_of
from crankmbs.motion.base import State
from crankmbs.motion.crank_angle.firings import solve_fired
from crankmbs.motion.crank_angle.grid import Grid, Terms
from crankmbs.motion.crank_angle.kinks import sign_changes_in, what_misses
from crankmbs.motion.crank_angle.periods import period_of
from crankmbs.motion.crank_angle.segment import AngleSegment
from crankmbs.motion.crank_angle.solvers import Begin, lasting, solve
from crankmbs.motion.ending import Ending
from crankmbs.motion.mode import Mode
from crankmbs.motion.plan import Plan
from crankmbs.motion.states import entered
from crankmbs.scene.units import DEGREE

__all__ = ["advance", "is_fast"]

_SLOW = 0.5 * DEGREE  # where the energy would be gone within this angle, time must be the variable
_BLOCK = 4096  # cells of one segment; with more BLAS would wake a second thread
_SPEED_BLOCK = 512  # where the loads' branch may end at a speed, and the rest is for nothing
_REACH = 1.0  # rad: what Newton's method can hold of functions of Python, on all cells at once
_HAIR = 1e-6  # of a cell: as near its edge it is as exact as there
_BEYOND = (_HAIR, 1e-4, 1e-2)  # of a cell: how far ahead a landing near a turn may really be
_ROUNDS = 6  # of cutting cells at kinks
_KEPT = 2  # whole periods at the end that are solved cell by cell, at least, when not all are kept


def is_fast(grid: Grid, state: State, branch: Branch, times: float) -> bool:
    """Whether the energy lasts for so many times the angle at which this formulation gives up."""
    grid = grid.at(state.mode.loads)
    scale = grid.scale[grid.cell_at(state.theta, math.copysign(1.0, state.omega))]
    outside = float(branch(state.time, state.omega))
    outside += sum(f.number(state.time, state.theta, state.omega) for f in branch.functions)
    scale += abs(outside)
    inertia = float(reduce(grid.train, state.theta).inertia)
    return bool(0.5 * inertia * state.omega**2 > times * _SLOW * scale)


def advance(
    grid: Grid, state: State, plan: Plan, allowed: float
) -> Generator[AngleSegment, None, Ending | None]:
    """Carry the motion on, segment by segment.

    allowed [1/rad] : of the energy that a cell may miss at kinks of the loads, per radian

    Returns
    -------
    how the motion ends; None where it goes on over time, as the energy comes near zero
    """
    sense = math.copysign(1.0, state.omega)
    end = plan.angle_bounds[1 if sense > 0.0 else 0]
    skipped = 0
    while True:
        mode = state.mode
        grid = grid.at(mode.loads)
        bound = min(end, mode.high) if sense > 0.0 else max(end, mode.low)
        bound = bound if grid.train.law is None else end  # decisions are edges within a segment
        branch, reduction, _ = entered(grid.train, state)
        energy = 0.5 * float(reduction.inertia) * state.omega**2
        if branch is None:
            return Ending.HELD
        problem = _Problem(grid, state, energy, sense, bound, plan.time_bound, allowed)
        segment = _stretch(problem, branch)
        if segment is None:
            return None
        t_end = min(segment.branch.t_end, plan.time_bound)
        segment = (replace(segment, skipped=skipped) if skipped else segment).cut(t_end, bound)
        segment = _ended_exactly(problem, segment, t_end)
        yield segment
        if segment.end.time >= plan.time_bound or segment.end.theta == end:
            return Ending.COMPLETE
        if segment.end.theta == state.theta and segment.end.mode == mode:
            return Ending.HELD
        state, skipped = segment.end, 0
        t_end = min(branch.t_end, plan.time_bound)
        goes_on = state.mode == mode and state.time < t_end and grid.train.law is None
        if math.isfinite(plan.last) and goes_on and branch.is_affine_in_energy and not grid.drags:
            energy = 0.5 * float(reduce(grid.train, state.theta).inertia) * state.omega**2
            ahead = problem._replace(state=state, energy=energy, t_end=t_end)
            state, skipped = _skip(ahead, branch, plan.last)


class _Problem(NamedTuple):
    """From a state and its kinetic energy [J] on: sense of rotation, bounds in angle [rad] and time
    [s], and what a cell may miss at kinks, as `advance` takes it."""

    grid: Grid
    state: State
    energy: float
    sense: float
    bound: float
    t_end: float
    allowed: float


def _stretch(problem: _Problem, branch: Branch) -> AngleSegment | None:
    """The next cells on the course that continues a branch; on the branch alone where its cells are
    affine, or where kinks are too strong to be found by solving again."""
    course = course_of(
        problem.grid.train.loads, branch, problem.state.time, problem.state.mode.loads
    )
    if isinstance(course, Branch):
        return _solve(problem, course)
    course = course.plus(problem.state.mode.held)
    affine = branch.is_affine_in_energy and not problem.grid.drags
    segment = _before_kink(problem, branch, course) if affine else None
    return segment or _solve(problem, course) or _solve(problem, branch)


def _before_kink(problem: _Problem, branch: Branch, course: Course) -> AngleSegment | None:
    """The whole cells on an affine branch, as far as none of its kinks lies in them."""
    segment = _solve(problem, branch)
    if segment is None:
        return None
    cut = segment.cut(min(branch.t_end, problem.t_end), problem.bound)
    bent = cut.exact.time < min(course.t_end, problem.t_end)
    bent |= course.omega_low < cut.exact.omega < course.omega_high
    if not bent:
        return segment
    return segment.first(cut.stop[0]) if cut.stop[0] > 0 else None


def _ended_exactly(problem: _Problem, segment: AngleSegment, t_end: float) -> AngleSegment:
    """A segment that ends inside a cell, with that one solved again up to the end: inside a cell
    the answer is of lower order than at its edge."""
    k, x = segment.stop
    if not _HAIR < x < 1.0 - _HAIR:
        return segment
    begin, energy = segment.at_edge(k), float(segment.energy[k])
    for beyond in _BEYOND:
        turned = float(segment.edges[k]) + (x + beyond) * float(segment.terms.width[k])
        bound = segment.begin.theta + segment.sense * turned
        again = problem._replace(state=begin, energy=energy, bound=bound, t_end=math.inf)
        last = _solve(again, segment.branch)
        if last is None:
            break
        last = last.cut(t_end, math.inf)
        if last.exact[:3] == segment.exact[:3]:  # also what neither knows: it is one NaN
            return segment.ended_by(last)
    return segment


def _skip(problem: _Problem, branch: Branch, last: float) -> tuple[State, int]:
    """Pass whole periods at once, all but the last ones; return the state after them and the
    number of cells passed."""
    grid, state, start, sense, bound, t_end, _ = problem
    period = float(grid.edges[-1])

    def at(time: float, turned: float, energy: float) -> AngleSegment | None:
        """The period that begins with this energy, if the motion passes it whole."""
        theta = state.theta + sense * turned
        omega = sense * math.sqrt(2.0 * energy / float(reduce(grid.train, theta).inertia))
        begin = state._replace(time=time, theta=theta, omega=omega)
        end = theta + sense * period
        from_there = problem._replace(state=begin, energy=energy, bound=end, t_end=math.inf)
        segment = _solve(from_there, branch)
        if segment is None or segment.edges[-1] < (1.0 - 1e-9) * period:
            return None
        return segment if segment.cut(math.inf, math.inf).stop == segment.stop else None

    first = at(state.time, 0.0, start)
    kept = max(_KEPT, math.ceil(last / period))
    most = min(abs(bound - state.theta) / period, 1e15) // 1.0 - kept
    if first is None:
        return state, 0
    one = period_of(grid, first.terms, branch, sense)
    while most >= 1.0:
        run = one.run(start, state.time, most, t_end, kept)
        if run.periods == 0:
            break
        far = at(run.time, run.periods * period, run.energy)
        middle = at(state.time, 0.0, run.mean)
        if far is not None and middle is not None:
            missed = run.periods * float(middle.missed[-1])  # linear in the energy
            passed = run.periods * len(first.torque)
            return far.begin._replace(residual=state.residual - missed), passed
        most = run.periods // 2
    return state, 0


def _solve(problem: _Problem, loads: Branch | Course) -> AngleSegment | None:
    """Solve as many cells as one segment holds; None when the first is too slow already, or misses
    too much at kinks."""
    grid, state, _, sense, bound, t_end, allowed = problem
    t_end = min(t_end, loads.t_end)
    n, period = len(grid.edges) - 1, float(grid.edges[-1])
    ahead = 1.2 * (t_end - state.time) * abs(state.omega)
    cells = min(ahead, abs(bound - state.theta)) / period * n + 2.0
    if not all(function.declared for function in loads.functions):
        most = max(2, int(_REACH / period * n))
    else:
        ends = (loads.omega_low * sense, loads.omega_high * sense)
        most = _SPEED_BLOCK if any(0.0 < end < math.inf for end in ends) else _BLOCK
    terms = grid.terms(state.theta, sense, int(min(cells, most)), bound)
    segment = _solved(problem, loads, terms, t_end)
    if isinstance(loads, Branch) and grid.train.law is None:
        return segment
    for _ in range(_ROUNDS):
        if segment is None:
            return None
        missing, gained = what_misses(segment, allowed)
        marks = np.append(missing, sign_changes_in(segment))
        if len(marks) == 0:
            return segment.with_more(gained) if gained.any() else segment
        terms = grid.cut(terms, state.theta, sense, marks)
        segment = _solved(problem, loads, terms, t_end)
    return None


def _solved(
    problem: _Problem, loads: Branch | Course, terms: Terms, t_end: float
) -> AngleSegment | None:
    """The solved cells, up to where they are too slow."""
    grid, state, energy, sense, *_ = problem
    begin = Begin(sense, energy, state.time, t_end, state.theta)
    modes: tuple[tuple[int, Mode], ...] = ()
    if grid.train.law is None:
        cells = solve(grid, terms, loads, begin)
    else:
        cells, terms, modes = solve_fired(grid, terms, loads, begin, state)
    terms = terms.first(len(cells.torque))
    m = lasting(_SLOW, grid, terms, cells)
    if m == 0:
        return None
    return AngleSegment(
        grid,
        terms.first(m),
        loads,
        sense,
        state,
        *cells.first(m),
        (m - 1, 1.0),
        modes=tuple(one for one in modes if one[0] < m),
    )
