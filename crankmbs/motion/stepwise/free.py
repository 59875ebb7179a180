"""A free motion in steps over time: passes side by side, carried as those of a run are."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.train import CrankTrain
from crankmbs.mechanics.windows import acting
from crankmbs.motion.assemble import ANGLE_ROUNDING, Assembled, assemble
from crankmbs.motion.base import Samples, Solution, State
from crankmbs.motion.crank_angle.grid import FINEST_CELL, Grid
from crankmbs.motion.ending import Ending
from crankmbs.motion.free.handover import Handover
from crankmbs.motion.free.passes import first_grid, staggered
from crankmbs.motion.minimal.reduced import Reduced
from crankmbs.motion.minimal.segment import StepSizes
from crankmbs.motion.mode import begun
from crankmbs.motion.plan import Plan, folds_of
from crankmbs.motion.states import first_sample
from crankmbs.motion.stepwise.standing import AT_REST, Moving, Standing, commanded, said

__all__ = ["Free"]

_LOCAL = 0.1  # of rtol: what a pass may err locally; of that: what the third may
_BETTER = 1e-2  # of that: what the better pass may
_NEAR = 1e-12  # rtol: from there on rounding, in both passes alike, is most of the error
_ALLOWED = 1_500_000  # evaluations in one step: half a minute
_ROUNDING = 64 * float(np.finfo(float).eps)  # as in `assemble`


class _Carried(NamedTuple):
    """A pass carried on: the state, how it ended, the steps that it took over time, and its
    cells."""

    state: State
    ending: Ending
    taken: StepSizes
    grid: Grid


class Free:
    """The steps of a free crank train; the better pass is of higher order, in finer steps. Where
    there are functions a third has its cells elsewhere, for what they do undeclared."""

    def __init__(self, train: CrankTrain) -> None:
        scene = train.scene
        assert scene.start is not None
        self._train, self._start = train, scene.start
        self._functions = train.has_functions
        # as in a run: twice where rounding is left, or what functions do undeclared
        self._share = 2.0 if self._functions or scene.run.rtol <= _NEAR else 1.0
        self._by_angle = scene.run.formulation != "minimal"  # which is time throughout
        self._local = max(_LOCAL * scene.run.rtol, FINEST_CELL)
        self._reduced = Reduced(train), Reduced(train.perturbed, checks=True)
        self._coarsest = first_grid(train, scene.run.rtol)
        self._refined: tuple[tuple[float, ...], Grid] = (), self._coarsest  # the last, by its edges
        folds = folds_of(scene, scene.start.angle)
        self._plan = Plan(scene.start.angle, 1.0, True, 0.0, True, folds=folds)

    def begin(self) -> Standing:
        """Where it starts; the other passes a rounding ahead, as in a run."""
        start = self._start
        state = State(0.0, start.angle, start.speed, 0.0, begun(self._train))
        ahead = math.copysign(ANGLE_ROUNDING * start.angle, start.speed)
        others = (state._replace(theta=start.angle + ahead),) * (1 + self._functions)
        return Standing((state, *others), abs(ahead))

    def advance(
        self, standing: Standing, until: float, torque: float, share: float | None
    ) -> Standing:
        """One step of all passes; see `crankmbs.motion.stepwise.standing.Steps`."""
        begins = [commanded(state, torque, share) for state in standing.states]
        grid, edges = self._grid_of(standing.edges), standing.edges
        hand = Handover(grid, self._reduced[0], self._local, self._by_angle, refines=True)
        answer = self._carried(hand, begins[0], until)
        if answer.grid is not grid:
            grid, edges = answer.grid, tuple(answer.grid.edges.tolist())
            self._refined = edges, grid
        ways = [(grid.finer, self._reduced[1], _BETTER * self._local)]
        if self._functions:
            ways.append((staggered(grid), self._reduced[0], _LOCAL * self._local))
        others = [
            self._carried(Handover(*way, self._by_angle, answer.taken), begin, until)
            for way, begin in zip(ways, begins[1:], strict=True)
        ]
        for each in (answer, *others):
            if each.ending.value[0] < 0:
                return standing._replace(ending=each.ending, angle=each.state.theta)
        one, ending = answer.state, answer.ending
        ahead, faster = standing.ahead, standing.faster
        for other in (each.state for each in others):
            late = other.time - one.time
            ahead = max(ahead, abs(other.theta - one.theta - one.omega * late))
            faster = max(faster, abs(other.omega - one.omega))
        for each in others:
            ending = _worse(ending, each.ending)
        states = one, *(each.state for each in others)
        return Standing(states, ahead, faster, ending, one.theta, edges)

    def _grid_of(self, edges: tuple[float, ...]) -> Grid:
        """The grid with these edges, the coarsest one without."""
        if edges and edges != self._refined[0]:
            self._refined = edges, Grid(self._train, np.array(edges), self._coarsest.rule)
        return self._refined[1] if edges else self._coarsest

    def _carried(self, hand: Handover, state: State, until: float) -> _Carried:
        """A pass carried on to a time [s]; a crank at rest for good stays there."""
        if state.time >= until:
            return _Carried(state, Ending.COMPLETE, hand.taken, hand.grid)
        if self._plan.folds_at(state.theta):
            return _Carried(state, Ending.FOLD, hand.taken, hand.grid)
        segments = hand.segments(state, replace(self._plan, until=until), _ALLOWED)
        ending: Ending | None = None
        while ending is None:
            try:
                segment = next(segments)
            except StopIteration as stop:
                ending = stop.value
                continue
            state = segment.end
        if ending is Ending.REST or (ending in AT_REST and state.omega == 0.0):
            state = state._replace(time=until, omega=0.0)
        elif ending is Ending.COMPLETE and state.time < until:
            ending = Ending.FOLD
        ending = Ending.LABOURS if ending is Ending.COSTLY else ending
        return _Carried(state, ending, hand.taken, hand.grid)

    def moving(self, standing: Standing) -> Moving:
        """The motion of the answer, with the most that the passes have differed by."""
        state = standing.states[0]
        errors = (
            self._share * (apart + _ROUNDING * abs(value))
            for apart, value in zip(standing[1:3], state[1:3], strict=True)
        )
        alpha = float(self._sample(self._train, state).alpha[0])
        return Moving(state.theta, state.omega, alpha, *errors)

    def said(self, standing: Standing) -> tuple[int, str]:
        """Status and sentence of the last step."""
        return said(standing, _ALLOWED)

    def assembled(self, standing: Standing) -> Assembled:
        """Every variable of the answer, beside a motion that is as far from it as the passes have
        been, at most: that they agree here may be chance."""
        one, other, *_ = standing.states
        turned = math.copysign(standing.ahead, other.theta - one.theta)
        moves = one.omega != 0.0 or other.omega != 0.0
        faster = math.copysign(standing.faster, other.omega - one.omega) if moves else 0.0
        beside = one._replace(theta=one.theta + turned, omega=one.omega + faster, mode=other.mode)
        answer = self._sample(self._train, one)
        better = self._sample(self._train.perturbed, beside)
        assembled = assemble(self._train, Solution(answer, *self.said(standing), 0, 0, better))
        errors = {name: self._share * error for name, error in assembled.errors.items()}
        return replace(assembled, errors=errors)

    def _sample(self, train: CrankTrain, state: State) -> Samples:
        sample = first_sample(train, self._known(state))
        return replace(sample, time=np.array([state.time]))

    def _known(self, state: State) -> State:
        """A state at the very end of a load's table over time an instant before it."""
        loads = acting(self._train.loads, state.mode.loads)
        tables = [load.given.table_over_time for _, load in loads]
        end = min((float(table.x[-1]) for table in tables if table), default=math.inf)
        if state.time < end:
            return state
        return state._replace(time=math.nextafter(end, 0.0))


def _worse(one: Ending, other: Ending) -> Ending:
    """Of the endings of both passes one that stands before the time that was asked for, if any."""
    stops = Ending.FOLD, Ending.HELD
    return other if other in stops and one is Ending.COMPLETE else one
