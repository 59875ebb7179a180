"""The solution over time on a segment of steps; the steps of a pass, which a later one halves."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.inertia import inertia_alone
from crankmbs.motion.base import Samples, State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.minimal.equation import Equation
from crankmbs.motion.mode import decided
from crankmbs.motion.states import samples_in
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes

__all__ = ["StepSizes", "TimeSegment", "Track"]

_DIED_OUT = 1e-12  # of the time: steps as short led to where a load has no value, and need no half
_STAGES = 8  # of the rule at whose nodes, and at both ends, a step of degree 7 is told


class Track(NamedTuple):
    """Steps one after the other.

    begins, widths : shape (n,) [s]
    rows : shape (n, 8, 3), their polynomials, as in `crankmbs.motion.minimal.exits`
    time [s], y : the end, and (theta, omega, work) there; equation : that holds there
    next_step [s] : what the error control proposes; most [J] : largest kinetic energy so far
    """

    begins: Array
    widths: Array
    rows: Array
    time: float
    y: Array
    equation: Equation
    next_step: float
    most: float
    evaluations: int

    def at(self, t: Array, k: NDArray[np.intp]) -> Array:
        """(theta, omega, work), shape (3, n), at times in the steps k."""
        x = ((t - self.begins[k]) / self.widths[k])[:, None]
        row = self.rows[k]
        y = row[:, -1]
        for coefficients in np.moveaxis(row, 1, 0)[-2::-1]:
            y = y * x + coefficients
        return np.asarray(y.T)


@dataclass(frozen=True)
class TimeSegment:
    """Steps on one branch of the loads in one sense of rotation, across any number of knots."""

    equation: Equation
    track: Track
    begin: State
    end: State

    @classmethod
    def of(cls, equation: Equation, track: Track, begin: State) -> TimeSegment:
        """The steps of a track, and the state after them."""
        theta, omega, work = track.y.tolist()
        gained = track.equation.kinetic(theta, omega)
        gained -= equation.kinetic(begin.theta, begin.omega)
        mode = decided(equation.pieces.train, begin.mode, track.time, theta, omega)
        end = State(track.time, theta, omega, begin.residual + gained - work, mode)
        return cls(equation, track, begin, end)

    @property
    def decisions(self) -> tuple[State, ...]:
        """None inside: a decision ends a segment."""
        return ()

    @property
    def steps(self) -> int:
        """Accepted steps."""
        return len(self.track.widths)

    @property
    def size(self) -> int:
        """About how many numbers it holds."""
        return 3 * self.track.rows.size

    @property
    def evaluations(self) -> int:
        """Evaluations of the equation of motion."""
        return self.track.evaluations

    @cached_property
    def cells(self) -> Cells:
        """Its steps as cells of a motion."""
        track, places, begin, end = self.track, ends_and_nodes(_STAGES).places, self.begin, self.end
        edges = np.append(track.begins, end.time)
        time = track.begins[:, None] + np.diff(edges)[:, None] * places
        time[:, -1] = edges[1:]
        steps = np.repeat(np.arange(self.steps), len(places))
        angle, speed, work = track.at(time.ravel(), steps).reshape(3, *time.shape)
        angle[-1, -1], speed[-1, -1] = end.theta, end.omega
        inertia = inertia_alone(self.equation.pieces.train.scene, angle[:, -1])
        gained = 0.5 * inertia * speed[:, -1] ** 2 - self.equation.kinetic(begin.theta, begin.omega)
        acting = Acting(self._sense, self.equation.holds, begin.mode.loads, self.equation.branch)
        shares = np.tile(begin.mode.shares, (self.steps, 1))
        residual = begin.residual + gained - work[:, -1]
        return Cells(time, angle, speed, acting, shares, residual=residual)

    @property
    def last(self) -> Samples:
        """The motion at its end, by its polynomials."""
        at = np.array([self.steps - 1]), np.ones(1)
        return samples_in(self.cells, self.equation.pieces.train, *at)

    @property
    def _sense(self) -> float:
        """Of rotation; of a crank that hardly moves that of its speed."""
        turned = self.end.theta - self.begin.theta
        return float(np.sign(turned or self.begin.omega or self.end.omega))

    @staticmethod
    def at_rest(equation: Equation, begin: State, until: float) -> TimeSegment:
        """A crank that its loads hold at rest, up to a time [s]."""
        y = np.array([begin.theta, 0.0, 0.0])
        rows = np.zeros((1, 8, 3))
        rows[0, 0] = y
        times = np.array([begin.time]), np.array([until - begin.time])
        return TimeSegment.of(
            equation, Track(*times, rows, until, y, equation, math.inf, 0.0, 0), begin
        )


class StepSizes:
    """When the steps of a pass begin and how long they are [s]: without bound where the crank angle
    carries it.

    >>> steps = StepSizes()
    >>> steps.add([0.0, 1.0, 1.5], [1.0, 0.5, math.inf])
    >>> steps.halved(0.0, 1.0), steps.halved(1.0, 0.8), steps.halved(1.5, 1.0)
    (0.5, 0.25, 1.0)
    """

    def __init__(self) -> None:
        self._begins, self._sizes = array("d"), array("d")

    def add(self, begins: Iterable[float], sizes: Iterable[float]) -> None:
        """Add steps that follow those so far."""
        self._begins.extend(begins)
        self._sizes.extend(sizes)

    def at(self, time: float) -> float:
        """How long the step is [s] that is under way at a time [s]; without bound before any."""
        k = bisect_right(self._begins, time)
        return self._sizes[k - 1] if k else math.inf

    def halved(self, time: float, size: float) -> float:
        """A step [s] from a time [s] on, no longer than half the one under way at its middle."""
        least = _DIED_OUT * abs(time)
        while size > (half := 0.5 * self.at(time + 0.5 * size)) > least:
            size = half
        return size
