"""A free motion and its error: passed through twice, refined until what is asked is met."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.variables import variables_of
from crankmbs.motion.account import Account
from crankmbs.motion.assemble import Assembled, assemble
from crankmbs.motion.base import Samples, Segment, Solution
from crankmbs.motion.crank_angle.grid import FINEST_CELL, Grid, edges_apart, grid_of
from crankmbs.motion.cycles import MOST_CYCLES
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.handover import FINEST_STEP
from crankmbs.motion.free.integrate import Begin, Pass, Setup, begin_at_start, integrate
from crankmbs.motion.minimal.segment import StepSizes
from crankmbs.motion.motion import Motion, Passes
from crankmbs.motion.observer import Followed, account_of
from crankmbs.motion.plan import plan_of
from crankmbs.motion.remarks import remarks
from crankmbs.numerics.collocation import gauss
from crankmbs.numerics.once import once
from crankmbs.scene.scene import Scene

__all__ = ["Lead", "evaluations", "first_grid", "match", "run", "staggered", "stays"]

_PASSES = 12  # at most; each asks for less of an error, or begins elsewhere
_BETTERED = 0.5  # of the least error: what is not below has not been bettered by finer steps
_EVALUATIONS = 50_000  # over time, for which a second of the cost cap stands: as measured
_PLACES = np.array([0.225, 0.725])  # of new edges in a cell: an old edge is then at 0.55 of a new
# cell, where no Gauss rule of few nodes takes a jump to be
_BESIDE = np.array([1.5e-2, 1e-3, 7e-5])  # of a cell: edges near a knot, where all grids have one,
# each so near the next that what hides before the first node of their cell is twice as far off
# what a pass may say that has not seen yet, or by its errors never, that the crank is at rest
_RESTING = {Ending.REST, Ending.SWING, Ending.COMPLETE}
_SAME_REST = 1e-3  # rad: two passes rest at the same place; how far apart is in the stated error
_BROKEN = (Ending.COSTLY, Ending.FAILED)


class Lead(NamedTuple):
    """How a solution sets out: the first grid, what a step on it may err, and where either pass
    begins, by its grid and what it may err locally."""

    grid: Grid
    local: float
    begin: Begin


@once
def first_grid(train: CrankTrain, rtol: float) -> Grid:
    """The coarsest grid, of the order that a tolerance asks for."""
    return grid_of(train, gauss(min(3 + round(-math.log10(rtol) / 3.0), 7)))


def evaluations(cost_cap: float) -> int:
    """Evaluations over time that a cost cap [s] stands for."""
    return int(min(cost_cap * _EVALUATIONS, 1e18))


def run(
    train: CrankTrain,
    rtol: float,
    cost_cap: float,
    *,
    by_angle: bool,
    lead: Lead | None = None,
) -> Assembled:
    """Solve a free motion to a relative global error, twice: the second pass is of higher order.

    by_angle : the crank angle is the variable wherever it can be; else time throughout
    cost_cap [s] : for which time is evaluated in either pass before it gives up, on a slow machine
    lead : of a motion that does not begin at the start
    """
    grid, local, begin = lead or Lead(first_grid(train, rtol), rtol, begin_at_start)
    setup = Setup(begin, plan_of(train.scene), evaluations(cost_cap), refines=True)
    functions = train.has_functions
    best: Assembled | None = None
    least, rounded = math.inf, False
    finest = FINEST_CELL if by_angle else 100.0 * FINEST_STEP
    local = max(local, finest)
    for left in reversed(range(_PASSES)):
        answer = integrate(grid, setup, local, by_angle=by_angle)
        grid = answer.hand.grid
        if left and lead is not None and grid is not answer.grid:
            continue  # where a settled motion begins depends on the cells
        better = integrate(grid.finer, setup, 1e-2 * local, by_angle=by_angle, before=answer)
        passes = [answer, better]
        solution = _solution(train.scene, answer, better, setup)
        assembled = assemble(train, solution)
        if functions:
            other = staggered(grid)
            elsewhere = integrate(other, setup, 0.1 * local, by_angle=by_angle, before=answer)
            passes.append(elsewhere)
            again = assemble(train, _solution(train.scene, answer, elsewhere, setup))
            assembled = _stated_twice(assembled, again)
        near = local <= 10.0 * finest
        estimate = assembled.relative_error * (2.0 if near else 1.0)
        in_vain = not functions and estimate > _BETTERED * least
        if estimate <= least:
            best, least, rounded = assembled, estimate, near
            followed = tuple(passes)
        if estimate <= rtol or in_vain or local <= finest or answer.ending in _BROKEN:
            break
        local = max(local * max(1e-3, 0.1 * rtol / estimate), finest)
    assert best is not None
    share = 2.0 if functions else 1.0
    if rounded or least > rtol:
        # what is left is rounding, in both passes alike, and their difference too small an estimate
        best = _doubled(best)
        share *= 2.0
    first, *others = (Motion(one.grid.train, [*one.path.segments]) for one in followed)
    if not all(one.path.segments for one in followed):  # the crank never moves
        first, *others = [Motion.of_one(train, best.solution.samples)] * len(followed)
    keep = partial(_account, followed, setup, share)
    solution = replace(best.solution, keep=keep)
    if best.relative_error > rtol and solution.status >= 0:
        text = f"asked for {rtol:.0e}, reached {best.relative_error:.0e}"
        if functions:
            names = " and ".join(dict.fromkeys(train.undeclared))
            text += (
                f"; where {names} bends or jumps must be declared, by kink_angles, kink_times and "
                "what else it may depend on"
            )
        solution = replace(solution, message=f"{solution.message}; {text}")
    return replace(best, solution=solution, motion=partial(Passes, first, tuple(others), share))


def _account(passes: tuple[Pass, ...], setup: Setup, share: float) -> Account:
    """The events of a motion and its whole cycles."""
    followed = [
        Followed(one.grid.train, one.begin, _segments(one, setup), one.ending) for one in passes
    ]
    return account_of(followed, share)


def _segments(one: Pass, setup: Setup) -> Iterable[Segment]:
    """The segments of a pass; where they were not kept it is followed once more."""
    if one.path.state is None or not (math.isfinite(setup.plan.last) or one.path.dropped):
        return one.path.segments
    plan = replace(setup.plan, last=(MOST_CYCLES + 1) * one.grid.train.scene.period)
    again = replace(one.hand, grid=one.grid, taken=StepSizes())
    end, segments = one.path.state.time, again.segments(one.start, plan, setup.allowed)
    return takewhile(lambda segment: segment.begin.time < end, segments)


@once
def staggered(grid: Grid) -> Grid:
    """Cells halved, and with edges beside those that are no knots: a jump or a bend that nobody has
    declared, and that hides between the end of a cell and its first node, then lies amid the nodes.
    Near a knot, where all cells end, they are narrow, so that little can hide."""
    knots = grid_of(grid.train, grid.rule, math.inf).edges
    start, width = grid.edges[:-1, None], np.diff(grid.edges)[:, None]
    behind, before = np.isin(grid.edges[:-1], knots), np.isin(grid.edges[1:], knots)
    edges = edges_apart(
        knots,
        start + width * _PLACES,
        (start + width * _BESIDE)[behind],
        (start + width * (1.0 - _BESIDE))[before],
    )
    return Grid(grid.train, edges, grid.rule)


def _stated_twice(by_order: Assembled, by_place: Assembled) -> Assembled:
    """The answer with twice the larger error of two comparisons; broken if one of them is."""
    larger = {name: max(e, by_place.errors[name]) for name, e in by_order.errors.items()}
    answer = by_place if by_place.solution.status < by_order.solution.status else by_order
    return _doubled(replace(answer, errors=larger))


def _doubled(one: Assembled) -> Assembled:
    """With twice the errors."""
    return replace(one, errors={name: 2.0 * error for name, error in one.errors.items()})


def _solution(scene: Scene, answer: Pass, better: Pass, setup: Setup) -> Solution:
    plan, path, endings = setup.plan, answer.path, {answer.ending, better.ending}
    ends = _RESTING if plan.until_time else _RESTING - {Ending.COMPLETE}
    both, in_time, reversals = (answer.samples, better.samples), plan.in_time, path.reversals
    still = endings <= ends and stays(*both)
    at_rest = still and Ending.REST in endings
    matched = match(*both, in_time=in_time, reversals=reversals, at_rest=at_rest)
    if matched.parted and still and not at_rest:  # both swing on by their errors alone
        matched = match(*both, in_time=in_time, reversals=reversals, at_rest=True)
        at_rest = not matched.parted
    samples, check, parted = matched
    ending = Ending.REST if at_rest and answer.ending is not Ending.COMPLETE else answer.ending
    broken = [one for one in _BROKEN if one in endings]
    if broken:
        ending = broken[0]
    elif (len(endings) > 1 and not at_rest) or parted:
        ending = Ending.PARTED
    last = float(samples.theta[-1]), float(samples.omega[-1])
    status, text = ending.said(*last, reversals=path.reversals, allowed=setup.allowed)
    if status >= 0 and path.state is not None:
        text = "; ".join([text, *remarks(scene, path.state.mode, samples)])
    reasons: tuple[str, ...] = ()
    if path.slow and answer.hand.by_angle:
        times = ", ".join(f"{t:.4g}" for t in path.slow[:5])
        more = " and later" if len(path.slow) > 5 else ""
        slow = f"near standstill, from {times} s{more} on, it was integrated over time, by minimal"
        reasons = (slow,)
    evaluations = path.evaluations + better.path.evaluations
    steps = path.steps + better.path.steps
    unknown = {} if check else dict.fromkeys(variables_of(scene), math.inf)
    return Solution(samples, status, text, evaluations, steps, check, unknown, reasons)


class _Matched(NamedTuple):
    """Samples of either pass, of the second None without a common one; whether the passes part."""

    samples: Samples
    better: Samples | None
    parted: bool


def stays(a: Samples, b: Samples) -> bool:
    """Whether from the earlier end on the other pass stays where the first has ended."""
    short, long = sorted((a, b), key=lambda samples: float(samples.time[-1]))
    later = long.theta[long.time.searchsorted(short.time[-1]) :]
    return bool(np.max(np.abs(later - short.theta[-1])) <= _SAME_REST)


def match(a: Samples, b: Samples, *, in_time: bool, reversals: int, at_rest: bool) -> _Matched:
    """The samples that both passes have, and their ends.

    A grid angle within the error of a reversal, or of the end, may be missing in one of them.
    Where they part their ends are left out. A crank at rest stays there: when a pass deems it so
    depends on its tolerance, so what comes after is compared with that end, at equal times.

    at_rest : whether they come to rest at the same place, but for their errors
    """
    grid_a, grid_b = (s.time[:-1] if in_time else s.theta[:-1] for s in (a, b))
    n, m = len(grid_a), len(grid_b)
    if not at_rest and np.array_equal(grid_a, grid_b):
        return _Matched(a, b, parted=False)
    kept: list[tuple[int, int]] = []
    i = j = 0
    while i < n and j < m:
        late = a.time[i] - b.time[j]
        if grid_a[i] != grid_b[j]:
            i, j = (i + 1, j) if late < 0.0 else (i, j + 1)
        elif i + 1 < n and grid_a[i + 1] == grid_b[j] and abs(a.time[i + 1] - b.time[j]) < -late:
            i += 1  # turning there it is passed twice, or, within the error, not at all
        elif j + 1 < m and grid_b[j + 1] == grid_a[i] and abs(b.time[j + 1] - a.time[i]) < late:
            j += 1
        else:
            kept.append((i, j))
            i, j = i + 1, j + 1
    common = min(a.time[-1], b.time[-1]) if at_rest else math.inf
    passed = np.count_nonzero(a.time[:-1] < common) + np.count_nonzero(b.time[:-1] < common)
    parted = bool(passed - 2 * len(kept) > 2 * (reversals + 1))
    if parted and not kept:
        return _Matched(a, None, parted=True)
    if at_rest:
        kept += [(k, m) for k in range(i, n) if a.time[k] >= b.time[-1]]
    if not parted:
        kept.append((n, m))
    rows_a, rows_b = np.array(kept).T
    a, b = a.select(rows_a), b.select(rows_b)
    if at_rest:
        b = replace(b, time=np.where(rows_b == m, a.time, b.time))
    return _Matched(a, b, parted)
