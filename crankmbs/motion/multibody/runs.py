"""A free run at steps h, h/2, h/4, ...: one motion, and one that is as far off as it may be.

How fine the steps become follows from the error and from a number of steps, never from a clock.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from crankmbs.errors import FormulationError
from crankmbs.mechanics.peaks import peak
from crankmbs.mechanics.train import CrankTrain
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.cost import STEPS_A_TURN
from crankmbs.motion.multibody.forces import Forces
from crankmbs.motion.multibody.integrate import Limits, Path, acceleration, integrate
from crankmbs.motion.multibody.model import Model
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.roots import invert_monotone

__all__ = ["Motion", "Runs"]

_RETRIES = 4  # with a quarter of the step each time, where exudyn fails
_UNTOUCHED = 0.98  # of the time to where it fails: before it goes wrong
_EPS = float(np.finfo(float).eps)
_STUCK = 1e-9  # rad/s2
_EXTRAPOLATED = (-1.0 / 3.0, 4.0 / 3.0)  # weights of two runs, h and h/2, whose error is of h^2
_BEFORE = (-1.0 / 48.0, 5.0 / 48.0, -20.0 / 48.0, 64.0 / 48.0)  # E'' + (E - E') / 16
_SHAKEN = 1e-12  # of the crank angle: how far off a run begins that shows what rounding grows to
_HELD = "a jump of the loads drives the speed back from both sides"
_NO_STEP = "exudyn's Newton iteration does not converge"


@dataclass(frozen=True)
class Motion:
    """A weighted sum of runs.

    paths : coarsest first; weights : of each
    """

    paths: tuple[Path, ...]
    weights: tuple[float, ...]

    def at(self, time: Array) -> tuple[Array, Array]:
        """Crank angle [rad] and speed [rad/s] at times."""
        parts = [np.array(path.at(time)) for path in self.paths]
        theta, omega = np.tensordot(self.weights, parts, 1)
        return theta, omega

    @cached_property
    def grid(self) -> Array:
        """Times of the steps of the finest run, each once."""
        return np.unique(self.paths[-1].rows[:, 0])

    @cached_property
    def stretches(self) -> list[tuple[float, float]]:
        """Begins and ends [s] of what turns one way."""
        grid, omega = self.grid, self.at(self.grid)[1]
        k = np.flatnonzero(omega[:-1] * omega[1:] < 0.0)
        low, high = grid[k], grid[k + 1]

        def value(time: Array) -> tuple[Array, Array]:
            speed = self.at(time)[1]
            return speed, np.full_like(speed, np.inf)

        turns = invert_monotone(value, np.zeros(len(k)), low, high) if len(k) else k
        rests = grid[1:-1][omega[1:-1] == 0.0]
        ends = np.unique([grid[0], *turns, *rests, grid[-1]]).tolist()
        return list(pairwise(ends))

    def until(self, time: float, bound: float | None) -> float:
        """Where it ends: at a crank angle [rad] that it reaches a hair before or after a time [s],
        or else at that time."""
        angle, speed = (float(each[0]) for each in self.at(np.array([time])))
        return time if bound is None or not speed else time + (bound - angle) / speed

    def times(self, theta: Array, begin: float, end: float) -> Array:
        """When it passes angles [rad] in a stretch [s]."""
        inside = self.grid[(self.grid > begin) & (self.grid < end)]
        edges = np.concatenate([[begin], inside, [end]])
        at = self.at(edges)[0]
        sign = 1.0 if at[-1] >= at[0] else -1.0
        k = np.clip(np.searchsorted(sign * at, sign * theta) - 1, 0, len(edges) - 2)
        return invert_monotone(self.at, theta, edges[k], edges[k + 1])


class Runs:
    """Runs of one problem at halved steps, coarsest first.

    moves : False where the crank stays at rest
    ending : of the runs, once the first is made
    shaken : the coarsest run again, from a start that is hardly off
    """

    shaken: Path

    def __init__(self, train: CrankTrain, model: Model, start: State, limits: Limits) -> None:
        self._train, self.model, self.start = train, model, start
        self._limits, self._stiff = limits, False
        self.forces, self.paths = Forces(train), list[Path]()
        self._step, self.moves = self._coarsest()
        self.ending = Ending.COMPLETE if self.moves else Ending.UNMOVED

    @property
    def states(self) -> tuple[State, ...]:
        """Where the stretches of the finest run begin, and where it ends."""
        return self.paths[-1].states if self.paths else (self.start,)

    @property
    def steps(self) -> int:
        """Steps of all runs."""
        return sum(path.steps for path in self.paths)

    def first(self) -> bool:
        """Three runs, shorter than asked for where the steps do not reach or exudyn fails there;
        False where the crank stays at rest.

        Raises
        ------
        FormulationError : exudyn cannot take a single step
        """
        if not self.moves:
            return False
        seventh = self._limits._replace(steps=self._limits.steps // 7)
        path = self._coarse(seventh)
        self.ending = path.ending
        if len(path.states) == 1 and (path.ending is not Ending.HELD or self.start.omega):
            why = _HELD if path.ending is Ending.HELD else _NO_STEP
            raise FormulationError(
                f"formulation 'multibody' cannot serve this scene: {why} at its start; choose auto"
            )
        self.moves = len(path.states) > 1
        time = path.states[-1].time
        if path.ending is Ending.DIVERGED:
            self._limits = self._limits._replace(time=_UNTOUCHED * time)
            path = self._run(seventh._replace(time=_UNTOUCHED * time))
        elif path.ending is Ending.CALLED_OFF:
            self._limits = self._limits._replace(time=time)
            path = self._run(self._limits)
        self.paths, there = [path], self.start.theta
        if not self.moves:
            return False
        off = math.copysign(_SHAKEN * (1.0 + abs(there)), path.states[-1].theta - there)
        self.shaken = self._run(self._limits, self.start._replace(theta=there + off))
        return self.halve() and self.halve()

    def _coarse(self, limits: Limits) -> Path:
        """A run at the coarsest step at which exudyn comes as far as at a quarter of it."""
        path = self._run(limits)
        for _ in range(_RETRIES):
            if path.ending is not Ending.DIVERGED:
                break
            before = path, self._stiff, self._step
            self._stiff, self._step = True, 0.25 * self._step
            path = self._run(limits)
            further = _UNTOUCHED * path.states[-1].time > before[0].states[-1].time
            if path.ending is Ending.DIVERGED and not further:
                path, self._stiff, self._step = before
                break
        return path

    def halve(self) -> bool:
        """One more run, at half the step; False where exudyn fails there."""
        self._step *= 0.5
        path = self._run(self._limits)
        if path.ending is not self.paths[-1].ending:
            return False
        self.paths.append(path)
        return True

    @property
    def affords_another(self) -> bool:
        """Whether the steps suffice for one more."""
        return self.steps + 2 * self.paths[-1].steps <= self._limits.steps

    @property
    def rounded(self) -> bool:
        """Whether rounding has grown beyond what the steps err by."""
        answer, checks = self.motions()
        grid = self.paths[0].rows[:, 0]
        *steps, rounding = (peak(each.at(grid)[0] - answer.at(grid)[0]) for each in checks)
        return rounding > max(steps)

    def motions(self) -> tuple[Motion, tuple[Motion, ...]]:
        """The answer, and motions as far off as it may be.

        With f, f', f'' the last three runs, coarse to fine, the answer is E'' = f'' + (f'' - f')/3
        where that differs from E' = f' + (f' - f)/3 by at most a third of f'' - f', and loads jump
        nowhere within a step; it is checked by E', and by a motion that is off by what E' was off
        by from the one before, E, over 16: where in its last step a run is cut differs from run to
        run, and E' may be right by chance. Else the answer is f'', and the checks are off
        by half of f - f'' and by f' - f'': at order 1 the first is no less by chance where f' is
        between, and the second where it is not. The last check is off by what the rounding of all
        steps grows to, as they do at random. Of one run there is none.
        """
        *coarser, fine = self.paths[-3:]
        if not coarser:
            return Motion((fine,), (1.0,)), ()
        answer = Motion((fine,), (1.0,))
        checks = [Motion((coarser[0], fine), (0.5, 0.5)), Motion((coarser[-1],), (1.0,))]
        if len(coarser) == 2 and fine.whole and self._is_clean():
            answer = Motion((coarser[1], fine), _EXTRAPOLATED)
            checks = [Motion(tuple(coarser), _EXTRAPOLATED)]
            if len(self.paths) > len(_BEFORE) - 1:
                checks.append(Motion(tuple(self.paths[-len(_BEFORE) :]), _BEFORE))
        rounded = math.sqrt(fine.steps) * _EPS / _SHAKEN
        also = (self.shaken, self.paths[0], *answer.paths), (rounded, -rounded, *answer.weights)
        return answer, (*checks, Motion(*also))

    def _is_clean(self) -> bool:
        coarse, middle, fine = self.paths[-3:]
        grid = np.unique(coarse.rows[:, 0])
        grid = grid[grid <= min(path.rows[-1, 0] for path in self.paths[-3:])]
        first, second, third = (np.array(path.at(grid)) for path in (coarse, middle, fine))
        change, before = third - second, second - first
        apart = np.abs(before - 4.0 * change).max(axis=1)
        return bool(np.all(apart <= np.abs(change).max(axis=1)))

    def _run(self, limits: Limits, start: State | None = None) -> Path:
        begin, stiff = start or self.start, self._stiff
        return integrate(self._train, self.model, begin, limits, self._step, stiff=stiff)

    def _coarsest(self) -> tuple[float, bool]:
        """A step [s] to begin with, and whether the crank will move at all.

        It resolves a turn at the speed at the start, or from rest at that after one turn at the
        first acceleration.
        """
        speed, end = abs(self.start.omega), self._limits.time
        moves = True
        if speed == 0.0:
            leaves = acceleration(self.model, self.forces, self.start)
            alpha = abs(leaves or 0.0)
            steady = all(load.is_steady for load in self._train.loads)
            moves = leaves is None or alpha > _STUCK or not steady
            speed = min(math.sqrt(4.0 * math.pi * alpha), alpha * end)
        turn = 2.0 * math.pi / speed if speed > 0.0 else math.inf
        longest = 1.0 if math.isinf(end) else end - self.start.time
        return min(turn, longest) / STEPS_A_TURN, moves
