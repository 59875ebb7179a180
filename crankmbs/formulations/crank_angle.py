"""One free rotation with the crank angle as the variable.

The kinetic energy E = J(theta) omega^2 / 2 obeys dE/dtheta = Q(theta, omega, t), and time follows
from dt/dtheta = 1 / omega. J and the torque of gas and gravity depend on theta alone: they are
tabulated once, at the nodes of a Gauss collocation whose cells no knot of the pressure lies
inside. On every branch of the loads Q is quadratic in omega and linear in t; without linear terms
it is linear in E, each cell is an affine map, and whole blocks of periods are solved at once.
Otherwise Newton's method solves a window of cells at once.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import replace

import numpy as np

from crankmbs import kernels
from crankmbs.cells import Grid, largest_of_row
from crankmbs.formulations.base import State
from crankmbs.formulations.periods import period_of
from crankmbs.formulations.solvers import Begin, solve_affine, solve_newton
from crankmbs.formulations.window import Window
from crankmbs.inertia import reduce
from crankmbs.sampling import Plan
from crankmbs.schema import DEGREE
from crankmbs.torque import Branch, branch_at

__all__ = ["advance", "is_fast"]

_SLOW = 0.5 * DEGREE  # where the energy would be gone within this angle, time must be the variable
_BLOCK = 4096  # cells of one window
_SPEED_BLOCK = 512  # where the loads' branch may end at a speed, and the rest is for nothing
_REACH = 1.0  # rad: what arrays can hold of it in one Newton step after the other
_AFFINE_TIME, _NEWTON_TIME = 4e-6, 1e-4  # s a cell with arrays
_HAIR = 1e-6  # of a cell: as near its edge it is as exact as there
_BEYOND = (_HAIR, 1e-4, 1e-2)  # of a cell: how far ahead a landing near a turn may really be
_KEPT = 2  # whole periods at the end that are solved cell by cell when only the last is kept


def is_fast(grid: Grid, state: State, branch: Branch, times: float) -> bool:
    """Whether the energy lasts for so many times the angle at which this formulation gives up."""
    scale = grid.scale[grid.cell_at(state.theta, math.copysign(1.0, state.omega))]
    scale += abs(float(branch(state.time, state.omega)))
    inertia = float(reduce(grid.scene, None, state.theta)[0])
    return bool(0.5 * inertia * state.omega**2 > times * _SLOW * scale)


def advance(grid: Grid, state: State, plan: Plan) -> Generator[Window, None, str]:
    """Carry the motion on, window by window.

    Returns
    -------
    "end" of the plan; "slow", where the energy comes near zero; "held", where a jump of a speed
    table drives the speed back from both sides
    """
    sense = math.copysign(1.0, state.omega)
    bound = plan.angle_bounds[1 if sense > 0.0 else 0]
    skipped = 0
    while True:
        branch, energy = _enter(grid, state)
        if branch is None:
            return "held"
        t_end = min(branch.t_end, plan.time_bound)
        window = _solve(grid, branch, state, energy, sense, bound, t_end)
        if window is None:
            return "slow"
        whole, window = _landed(replace(window, skipped=skipped).cut(t_end, bound), t_end)
        if whole is not None:
            yield whole
        yield window
        if window.end.time >= plan.time_bound or window.end.theta == bound:
            return "end"
        if window.end.theta == state.theta:
            return "held"
        state, skipped = window.end, 0
        if math.isfinite(plan.last) and state.time < t_end and branch.is_affine_in_energy:
            state, skipped = _skip(grid, branch, state, sense, bound, t_end)


def _landed(window: Window, t_end: float) -> tuple[Window | None, Window]:
    """A window that ends inside a cell in two: the whole cells, and that one solved again up to the
    end. Inside a cell the answer is of lower order than at its edge."""
    k, x = window.stop
    width = float(window.strip.width[k])
    if not _HAIR < x < 1.0 - _HAIR:
        return None, window
    whole = window.first(k) if k > 0 else None
    begin = whole.end if whole else window.begin
    energy = float(window.energy[k])
    for beyond in _BEYOND:
        turned = float(window.edges[k]) + (x + beyond) * width
        bound = window.begin.theta + window.sense * turned
        last = _solve(window.grid, window.branch, begin, energy, window.sense, bound, math.inf)
        if last is None:
            break
        last = last.cut(t_end, math.inf)
        if np.array_equal(last.landed, window.landed, equal_nan=True):
            return whole, replace(last, skipped=0 if whole else window.skipped)
    return None, window


def _skip(
    grid: Grid, branch: Branch, state: State, sense: float, bound: float, t_end: float
) -> tuple[State, int]:
    """Pass whole periods at once, all but the last ones; return the state after them and the
    number of cells passed."""
    period = float(grid.edges[-1])

    def at(time: float, turned: float, energy: float) -> Window | None:
        """The period that begins with this energy, if the motion passes it whole."""
        theta = state.theta + sense * turned
        omega = sense * math.sqrt(2.0 * energy / float(reduce(grid.scene, None, theta)[0]))
        begin = State(time, theta, omega, state.residual)
        window = _solve(grid, branch, begin, energy, sense, theta + sense * period, math.inf)
        if window is None or window.edges[-1] < (1.0 - 1e-9) * period:
            return None
        return window if window.cut(math.inf, math.inf).stop == window.stop else None

    start = _enter(grid, state)[1]
    first = at(state.time, 0.0, start)
    most = min(abs(bound - state.theta) / period, 1e15) // 1.0 - _KEPT
    if first is None:
        return state, 0
    one = period_of(grid, first.strip, branch, sense)
    while most >= 1.0:
        run = one.run(start, state.time, most, t_end, _KEPT)
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


def _enter(grid: Grid, state: State) -> tuple[Branch | None, float]:
    """The branch of the loads that the motion enters, and its kinetic energy [J]."""
    inertia, slope, torque = reduce(grid.scene, grid.pressure, state.theta)
    rest = float(torque - 0.5 * slope * state.omega**2)
    branch = branch_at(grid.scene.torque, state.time, state.omega, rest)
    return branch, 0.5 * float(inertia) * state.omega**2


def _solve(
    grid: Grid,
    branch: Branch,
    state: State,
    energy: float,
    sense: float,
    bound: float,
    t_end: float,
) -> Window | None:
    """Solve as many cells as one window holds, from a state and its kinetic energy [J] on; None
    when the first is too slow already."""
    affine = branch.is_affine_in_energy
    n, period = len(grid.edges) - 1, float(grid.edges[-1])
    ahead = 1.2 * (t_end - state.time) * abs(state.omega)
    cells = min(ahead, abs(bound - state.theta)) / period * n + 2.0
    few = max(2.0, _REACH / period * n)
    arrays = min(cells, _BLOCK) * _AFFINE_TIME if affine else min(cells, few) * _NEWTON_TIME
    compiled = kernels.pay(arrays)
    if affine or compiled:
        ends = (branch.omega_low * sense, branch.omega_high * sense)
        few = _SPEED_BLOCK if any(0.0 < end < math.inf for end in ends) else _BLOCK
    count = int(min(cells, few))
    strip = grid.strip(state.theta, sense, count, bound)
    solve = solve_affine if affine else solve_newton
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        begin = Begin(sense, energy, state.time, t_end)
        edges, time, torque, slowness = solve(grid, strip, branch, begin, compiled=compiled)
        strip = strip.first(len(torque))
        outside = branch(time[1:], sense / slowness[:, -1])
        scale = grid.scale[strip.cell] + np.abs(outside)
        least = 0.5 * grid.least[strip.cell] / largest_of_row(slowness) ** 2
        good = np.minimum(least, np.minimum(edges[1:], edges[:-1])) > _SLOW * scale  # not of a NaN
    m = len(good) if good.all() else int(np.argmin(good))
    if m == 0:
        return None
    return Window(
        grid,
        strip.first(m),
        branch,
        sense,
        state,
        strip.turned[: m + 1],
        edges[: m + 1],
        time[: m + 1],
        torque[:m],
        slowness[:m],
        (m - 1, 1.0),
    )
