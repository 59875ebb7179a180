"""A free run at steps h, h/2, h/4, ...: one motion, and one that is as far off as it may be.

How fine the steps become follows from the error and from a number of steps, never from a clock.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crankmbs.errors import FormulationError
from crankmbs.mechanics.peaks import peak
from crankmbs.motion.base import State
from crankmbs.motion.ending import Ending
from crankmbs.motion.multibody.cost import STEPS_A_TURN
from crankmbs.motion.multibody.forces import Forces, Limits
from crankmbs.motion.multibody.integrate import Path, acceleration, integrate
from crankmbs.motion.multibody.model import Model
from crankmbs.numerics.arrays import Array, Index
from crankmbs.numerics.cycle import NEAR
from crankmbs.numerics.roots import invert_monotone

__all__ = ["Motion", "Runs"]

_RETRIES = 4  # with a quarter of the step each time, where exudyn fails
_UNTOUCHED = 0.98  # of the time to where it fails: before it goes wrong
_EPS = float(np.finfo(float).eps)
_STUCK = 1e-9  # rad/s2
_SHAKEN = 1e-12  # of the crank angle: how far off a run begins that shows what rounding grows to
_HELD = "a jump of the loads drives the speed back from both sides"
_NO_STEP = "exudyn's Newton iteration does not converge"


@dataclass(frozen=True)
class Motion:
    """A weighted sum of runs.

    paths, weights : of each; states : where its stretches begin, and the last one ends
    """

    paths: tuple[Path, ...]
    weights: tuple[float, ...]
    states: tuple[State, ...]

    def at(self, time: Array) -> Array:
        """Crank angle [rad] and speed [rad/s] at times, shape (2, p)."""
        pairs = zip(self.paths, self.weights, strict=True)
        return np.asarray(sum(weight * path.at(time) for path, weight in pairs if weight))

    @cached_property
    def grid(self) -> Array:
        """Times of the steps of the finest run, each once."""
        return np.unique(self.paths[-1].rows[:, 0])

    def until(self, bound: float | None) -> float:
        """Where it ends [s]: at a crank angle [rad] that it reaches a hair before or after its last
        state, or else there."""
        time = self.states[-1].time
        angle, speed = self.at(np.array([time]))[:, 0].tolist()
        return time if bound is None or not speed else time + (bound - angle) / speed

    def times(self, theta: Array, begin: float, end: float) -> Array:
        """When it passes angles [rad] in a stretch [s]."""
        inside = self.grid[(self.grid > begin) & (self.grid < end)]
        edges = np.concatenate([[begin], inside, [end]])
        at = self.at(edges)[0]
        sign = 1.0 if at[-1] >= at[0] else -1.0
        k = np.clip(np.searchsorted(sign * at, sign * theta) - 1, 0, len(edges) - 2)
        return invert_monotone(lambda t: tuple(self.at(t)), theta, edges[k], edges[k + 1])

    def after(self, time: Array) -> Index:
        """Which of its states begins the stretch at times; where two meet the later one."""
        return np.searchsorted(self._edges, time * (1.0 + 1e-11), side="right")

    def before(self, time: Array, theta: Array) -> Index:
        """The same of the earlier one, at the times of crank angles."""
        k = np.searchsorted(self._edges, time, side="right")
        angles = np.array([state.theta for state in self.states])
        for _ in range(2):  # where something else is cut at the same angle, too
            k = np.where((k > 0) & (np.abs(theta - angles[k]) < NEAR), k - 1, k)
        return k

    @property
    def _edges(self) -> Array:
        return np.array([state.time for state in self.states[1:-1]])


class Runs:
    """Runs of one problem at halved steps, coarsest first.

    moves : False where the crank stays at rest
    ending : of the runs, once the first is made
    shaken : the coarsest run again, from a start that is hardly off
    """

    shaken: Path

    def __init__(self, forces: Forces, model: Model, start: State, limits: Limits) -> None:
        self.forces, self.model, self.start = forces, model, start
        self._limits, self._stiff = limits, False
        self.paths = list[Path]()
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
        False where the crank stays at rest, or a finer run ends otherwise.

        Raises
        ------
        FormulationError : exudyn cannot take a single step
        """
        if not self.moves:
            return False
        path = self._coarse()
        self.ending, reached = path.ending, path.states[-1]
        self.moves = len(path.states) > 1
        if not self.moves and (path.ending is not Ending.HELD or self.start.omega):
            why = _HELD if path.ending is Ending.HELD else _NO_STEP
            raise FormulationError(
                f"formulation 'multibody' cannot serve this scene: {why} at its start; choose auto"
            )
        share = {Ending.DIVERGED: _UNTOUCHED, Ending.CALLED_OFF: 1.0}.get(path.ending)
        if share is not None:
            self._limits = self._limits._replace(time=share * reached.time)
            path = self._run()
        self.paths, there = [path], self.start.theta
        if not self.moves:
            return False
        off = math.copysign(_SHAKEN * (1.0 + abs(there)), reached.theta - there)
        self.shaken = self._run(start=self.start._replace(theta=there + off))
        return self.halve() and self.halve()

    def _coarse(self) -> Path:
        """A run at the coarsest step at which exudyn comes as far as at a quarter of it."""
        most = self._limits.steps // 7
        path = self._run(most)
        for _ in range(_RETRIES):
            if path.ending is not Ending.DIVERGED:
                break
            before = path, self._stiff, self._step
            self._stiff, self._step = True, 0.25 * self._step
            path = self._run(most)
            further = _UNTOUCHED * path.states[-1].time > before[0].states[-1].time
            if path.ending is Ending.DIVERGED and not further:
                path, self._stiff, self._step = before
                break
        return path

    def halve(self) -> bool:
        """One more run, at half the step; False where exudyn fails there."""
        self._step *= 0.5
        path = self._run()
        if path.ending is not self.paths[-1].ending:
            return False
        self.paths.append(path)
        return True

    def _run(self, most: int | None = None, start: State | None = None) -> Path:
        limits = self._limits if most is None else self._limits._replace(steps=most)
        begin, stiff = start or self.start, self._stiff
        return integrate(self.forces, self.model, begin, limits, self._step, stiff=stiff)

    @property
    def affords_another(self) -> bool:
        """Whether the steps suffice for one more."""
        return self.steps + 2 * self.paths[-1].steps <= self._limits.steps

    @property
    def rounded(self) -> bool:
        """Whether rounding has grown beyond what the steps err by."""
        answer, *checks = self.motions()
        grid = self.paths[0].rows[:, 0]
        *steps, rounding = (peak(each.at(grid)[0] - answer.at(grid)[0]) for each in checks)
        return rounding > max(steps)

    def motions(self) -> list[Motion]:
        """The answer, and motions as far off as it may be; of one run none.

        With f, f', ... the runs, coarse to fine, the answers E are (4 f' - f)/3 where the last
        three runs differ as errors of h^2 do and loads jump nowhere within a step, and else f'
        alone. The last answer is checked by the one before, and by a motion that is off by what the
        one before that was off by, over 16 or, at order 1, over 2: where in its last step a run is
        cut differs from run to run, and two answers may agree by chance. The last check is off by
        what the rounding of all steps grows to, as they do at random.
        """
        paths, unit = (self.shaken, *self.paths), np.eye(len(self.paths) + 1)
        answers, share = unit[1:], 2.0
        if len(self.paths) > 2 and paths[-1].whole and self._is_clean():
            answers, share = (4.0 * unit[2:] - unit[1:-1]) / 3.0, 16.0
        checks = [*answers[-2:-1]]
        if len(answers) > 2:
            checks.append(answers[-1] + (answers[-3] - answers[-1]) / share)
        if checks:
            rounded = math.sqrt(paths[-1].steps) * _EPS / _SHAKEN
            checks.append(answers[-1] + rounded * (unit[0] - unit[1]))
        before = self.paths[-2:][0].states  # with decisions of its own
        weighted = [(answers[-1], self.states), *((each, before) for each in checks)]
        return [Motion(paths, tuple(weights.tolist()), states) for weights, states in weighted]

    def _is_clean(self) -> bool:
        coarse, middle, fine = self.paths[-3:]
        first, second, third = (path.at(coarse.rows[:, 0]) for path in (coarse, middle, fine))
        change, before = third - second, second - first
        apart = np.abs(before - 4.0 * change).max(axis=1)
        return bool(np.all(apart <= np.abs(change).max(axis=1)))

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
            steady = all(load.is_steady for load in self.forces.train.loads)
            moves = leaves is None or alpha > _STUCK or not steady
            speed = min(math.sqrt(4.0 * math.pi * alpha), alpha * end)
        turn = 2.0 * math.pi / speed if speed > 0.0 else math.inf
        longest = 1.0 if math.isinf(end) else end - self.start.time
        return min(turn, longest) / STEPS_A_TURN, moves
