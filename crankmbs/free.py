"""A free motion from start to end, and its error: solved twice, refined until what is asked is met.

The crank angle carries the motion wherever the crank turns fast enough; time carries it across
rest and reversal. This is where the one hands over to the other.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.assemble import ANGLE_ROUNDING, Assembled, assemble
from crankmbs.cells import Grid, grid_of
from crankmbs.collocation import gauss
from crankmbs.drives import TimeTable
from crankmbs.formulations import crank_angle, minimal
from crankmbs.formulations.base import Array, Piece, Samples, Solution, State
from crankmbs.inertia import reduce
from crankmbs.path import Path
from crankmbs.pressure import PeriodicPressure
from crankmbs.reduced import Reduced
from crankmbs.result import VARIABLES
from crankmbs.sampling import FOLDED, plan_of
from crankmbs.scene import Scene
from crankmbs.torque import Branch, branch_at, branch_of

__all__ = ["run"]

_PASSES = 12
_VAIN = 8  # after as many vain hand-overs the crank must turn through a period before the next
_FAST = (2.0, 8.0)  # as many times as fast as need be either pass takes over: the better one later
_MOST_CELLS = 20_000
_FINEST = 3e-14  # what rounding leaves of a cell
_FINEST_STEP = 1e-15  # the same over time
_ENDS = {
    "end": (0, "reached the end of the run"),
    "stuck": (1, "at rest at {angle:.6g} degrees: no torque moves the crank from here"),
    "held": (
        1,
        "held at {speed:.6g} rpm at {angle:.6g} degrees: a jump of the loads drives the "
        "speed back from both sides",
    ),
    "rest": (1, "came to rest at {angle:.6g} degrees"),
    "swing": (
        1,
        "swings without reaching the end: {reversals} reversals, the last at {angle:.6g} degrees",
    ),
    "fold": (1, FOLDED),
    "costly": (
        -1,
        "stopped at {angle:.6g} degrees: to follow the motion over time beyond it takes more than "
        "{evaluations} evaluations",
    ),
    "failed": (-1, "stopped at {angle:.6g} degrees: no step over time is short enough there"),
}


class _Pass(NamedTuple):
    """One pass over the whole motion; ``local``, shape (2, cells): errors at ends and inside."""

    samples: Samples
    ending: str
    path: Path
    local: Array
    carried: tuple[float, ...]


def run(
    scene: Scene, pressure: PeriodicPressure | None, formulation: str, rtol: float
) -> Assembled:
    """Solve a free motion to a relative global error, twice: the second pass is of higher order.

    formulation : "crank_angle" (time carries it across rest) or "minimal" (time throughout)
    """
    by_angle = formulation == "crank_angle"
    stages = min(3 + round(-math.log10(rtol) / 3.0), 7)
    grid = grid_of(scene, pressure, gauss(stages))
    best: Assembled | None = None
    local, least, rounded = rtol, math.inf, False
    finest = _FINEST if by_angle else 100.0 * _FINEST_STEP
    for left in reversed(range(_PASSES)):
        answer = _travel(grid, local, by_angle=by_angle)
        parts = _parts(grid, answer.local, local)
        if left and parts.max() > 1 and len(grid.edges) < _MOST_CELLS:
            grid = grid.split(parts)
            continue
        better = _travel(grid.finer, 1e-2 * local, by_angle=by_angle, better=True)
        solution = _solution(answer, better, in_time=plan_of(scene).in_time)
        assembled = assemble(scene, pressure, solution)
        near = local <= 10.0 * finest
        estimate = assembled.relative_error * (2.0 if near else 1.0)
        if estimate <= least:
            best, least, rounded = assembled, estimate, near
        if estimate <= rtol or local <= finest or answer.ending in ("costly", "failed"):
            break
        local = max(local * max(1e-3, 0.1 * rtol / estimate), finest)
    assert best is not None
    if rounded or least > rtol:
        # what is left is rounding, in both passes alike, and their difference not a bound
        best = best._replace(errors={name: 2.0 * error for name, error in best.errors.items()})
    if best.relative_error > rtol and best.solution.status >= 0:
        text = f"asked for {rtol:.0e}, reached {best.relative_error:.0e}"
        solution = replace(best.solution, message=f"{best.solution.message}; {text}")
        best = best._replace(solution=solution)
    return best


def _travel(grid: Grid, local: float, *, by_angle: bool, better: bool = False) -> _Pass:
    """One pass from start to end, handing over between the formulations near rest."""
    scene = grid.scene
    assert scene.start is not None
    plan = plan_of(scene)
    state = State(0.0, scene.start.angle, scene.start.speed, 0.0)
    steady = not any(isinstance(load, TimeTable) for load in scene.torque)
    first = _first(grid, state)
    path = Path(plan, first, can_swing=steady)
    if better:  # it begins a rounding ahead: so the difference knows what the motion makes of one
        ahead = math.copysign(ANGLE_ROUNDING * state.theta, state.omega or float(first.alpha[0]))
        state = state._replace(theta=state.theta + ahead)
    reduced = Reduced(scene, grid.pressure)
    worst = np.zeros((2, len(grid.edges) - 1))
    carried: list[float] = []

    vain = 0  # hand-overs to the crank angle that did not carry the motion through a period

    def is_fast(at: State, branch: Branch) -> bool:
        swings = abs(at.theta - path.turned_back) < min(vain / _VAIN, 1.0) * scene.period
        fast = by_angle and at.omega != 0.0 and not swings
        return fast and crank_angle.is_fast(grid, at, branch, _FAST[better])

    def windows(at: State) -> Generator[Piece, None, str]:
        pieces = crank_angle.advance(grid, at, plan)
        while True:
            try:
                window = next(pieces)
            except StopIteration as stop:
                return str(stop.value)
            if not better:
                for row, error in zip(worst, window.relative_errors, strict=True):
                    np.maximum.at(row, window.strip.cell, error)
            yield window

    ending = "slow"
    if by_angle and state.omega != 0.0:
        ending = path.follow(windows(state))
    while ending in ("slow", "fast"):
        if ending == "slow":
            tolerance = max(0.01 * local, _FINEST_STEP)
            parts = 2 if better else 1
            steps = minimal.advance(reduced, path.state or state, plan, tolerance, parts, is_fast)
            carried.append((path.state or state).time)
            ending = path.follow(steps)
        else:
            begin = (path.state or state).theta
            ending = path.follow(windows(path.state or state))
            vain += abs((path.state or state).theta - begin) < scene.period
    if ending == "end" and plan.folds_at((path.state or state).theta):
        ending = "fold"
    return _Pass(path.samples(), ending, path, worst, tuple(carried) if by_angle else ())


def _first(grid: Grid, state: State) -> Samples:
    """The sample at the start."""
    inertia, slope, torque = reduce(grid.scene, grid.pressure, state.theta)
    rest = float(torque - 0.5 * slope * state.omega**2)
    torques = grid.scene.torque
    branch = branch_at(torques, state.time, state.omega, rest)
    branch = branch or branch_of(torques, state.time, state.omega, rising=True)
    outside = float(branch(state.time, state.omega))
    return Samples(
        time=np.array([state.time]),
        theta=np.array([state.theta]),
        omega=np.array([state.omega]),
        alpha=np.array([(rest + outside) / float(inertia)]),
        energy_residual=np.zeros(1),
        own={"external_torque": np.array([outside])},
    )


def _parts(grid: Grid, worst: Array, local: float) -> NDArray[np.intp]:
    """Into how many parts to cut every cell, to err by ``local`` per radian at its end, and by
    ``local`` inside, where the order is lower."""
    stages = len(grid.rule.nodes)
    at_end = worst[0] / np.maximum(local * np.diff(grid.edges), _FINEST)
    inside = worst[1] / max(local, _FINEST)
    parts = np.ceil(np.maximum(at_end ** (0.5 / stages), inside ** (1.0 / (stages + 1))))
    return np.asarray(np.clip(np.nan_to_num(parts, nan=2.0), 1, 4), dtype=np.intp)


def _solution(answer: _Pass, better: _Pass, *, in_time: bool) -> Solution:
    path = answer.path
    status, message = _ENDS[answer.ending]
    samples, check, parted = _matched(answer, better, in_time=in_time)
    if answer.ending != better.ending or (parted and status >= 0):
        status = -1
        message = "two passes of different order end differently, at {angle:.6g} degrees and later"
    text = message.format(
        angle=math.degrees(float(samples.theta[-1])),
        speed=float(samples.omega[-1]) * 30.0 / math.pi,
        reversals=path.reversals,
        evaluations=path.evaluations,
    )
    reasons: tuple[str, ...] = ()
    if answer.carried:
        times = ", ".join(f"{t:.4g}" for t in answer.carried[:5])
        more = " and later" if len(answer.carried) > 5 else ""
        reasons = (f"minimal carried it across slow stretches that begin at {times} s{more}",)
    evaluations = path.evaluations + better.path.evaluations
    steps = path.steps + better.path.steps
    unknown = {} if check else dict.fromkeys(VARIABLES, math.inf)
    return Solution(samples, status, text, evaluations, steps, check, unknown, reasons)


def _matched(
    answer: _Pass, better: _Pass, *, in_time: bool
) -> tuple[Samples, Samples | None, bool]:
    """The samples that both passes have, and their ends; and whether the passes part.

    A grid angle within the error of a reversal, or of the end, may be missing in one of them.
    Where they part their ends are left out; without a common sample there is no second answer.
    """
    a, b = answer.samples, better.samples
    grid_a, grid_b = (s.time[:-1] if in_time else s.theta[:-1] for s in (a, b))
    if np.array_equal(grid_a, grid_b):
        return a, b, False
    kept: list[tuple[int, int]] = []
    i = j = 0
    while i < len(grid_a) and j < len(grid_b):
        if grid_a[i] == grid_b[j]:
            kept.append((i, j))
            i, j = i + 1, j + 1
        elif a.time[i] < b.time[j]:
            i += 1
        else:
            j += 1
    missing = len(grid_a) + len(grid_b) - 2 * len(kept)
    parted = missing > 2 * (answer.path.reversals + 1)
    if parted and not kept:
        return a, None, True
    if not parted:
        kept.append((len(grid_a), len(grid_b)))
    rows_a, rows_b = np.array(kept).T
    return a.select(rows_a), b.select(rows_b), parted
