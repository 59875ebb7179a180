"""The solution over time on a stretch of steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.friction import friction_forces, friction_torque, held_share
from crankmbs.mechanics.inertia import reduce
from crankmbs.motion.base import Nodes, Points, Samples, State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.minimal.equation import Equation
from crankmbs.motion.mode import decided
from crankmbs.motion.plan import Wanted
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.lagrange import ends_and_nodes
from crankmbs.numerics.roots import invert_monotone

__all__ = ["Stretch", "Track"]

_STAGES = 8  # of the rule at whose nodes, and at both ends, a step of degree 7 is told
_GAUSS = np.polynomial.legendre.leggauss(8)  # what a step's polynomials give is of degree 15
_PLACES, _WEIGHTS = 0.5 * (1.0 + _GAUSS[0]), 0.5 * _GAUSS[1]


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
class Stretch:
    """Steps on one branch of the loads in one sense of rotation, across any number of knots."""

    equation: Equation
    track: Track
    begin: State
    end: State

    @classmethod
    def of(cls, equation: Equation, track: Track, begin: State) -> Stretch:
        """The steps of a track, and the state after them."""
        theta, omega, work = track.y.tolist()
        gained = track.equation.kinetic(theta, omega)
        gained -= equation.kinetic(begin.theta, begin.omega)
        mode = decided(equation.pieces.train, begin.mode, track.time, theta, omega)
        end = State(track.time, theta, omega, begin.residual + gained - work, mode)
        return cls(equation, track, begin, end)

    @property
    def decisions(self) -> tuple[State, ...]:
        """None inside: a decision ends a stretch."""
        return ()

    @property
    def steps(self) -> int:
        """Accepted steps."""
        return len(self.track.widths)

    @property
    def size(self) -> int:
        """About how many numbers it holds."""
        return self.track.rows.size

    @property
    def evaluations(self) -> int:
        """Evaluations of the equation of motion."""
        return self.track.evaluations

    def cells(self) -> Cells:
        """Its steps as cells of a motion."""
        track, places = self.track, ends_and_nodes(_STAGES).places
        edges = np.append(track.begins, self.end.time)
        time = track.begins[:, None] + np.diff(edges)[:, None] * places
        steps = np.repeat(np.arange(self.steps), len(places))
        angle, speed, _ = track.at(time.ravel(), steps).reshape(3, *time.shape)
        time[:, -1], angle[-1, -1], speed[-1, -1] = edges[1:], self.end.theta, self.end.omega
        sense = float(np.sign(self.end.theta - self.begin.theta))
        mode, loads = self.begin.mode, self.equation.branch
        acting = Acting(sense, sense == 0.0, mode.loads, loads)
        return Cells(time, angle, speed, acting, np.tile(mode.shares, (self.steps, 1)))

    def nodes(self) -> Nodes:
        """The steps, and Gauss points in them."""
        track = self.track
        edges = np.append(track.begins, self.end.time)
        width = np.diff(edges)[:, None]  # that of a step which was cut at a knot differs
        time = track.begins[:, None] + width * _PLACES
        steps = np.repeat(np.arange(self.steps), len(_PLACES))
        theta, omega, _ = track.at(time.ravel(), steps).reshape(3, *time.shape)
        speeds = np.append(track.rows[:, 0, 1], self.end.omega)
        return Nodes(edges, speeds, Points(time, theta, omega, width * _WEIGHTS * omega))

    def sample(self, plan: Wanted) -> Samples:
        """The samples of the plan after the beginning, up to the end and with it."""
        track = self.track
        if plan.in_time:
            t = plan.between(self.begin.time, self.end.time)
            k = np.maximum(np.searchsorted(track.begins, t, side="left") - 1, 0)
            return self._samples(t, k)
        theta = plan.between(self.begin.theta, self.end.theta)
        sense = math.copysign(1.0, self.end.theta - self.begin.theta)
        passed = np.searchsorted(sense * track.rows[:, 0, 0], sense * theta, side="left")
        k = np.maximum(passed - 1, 0)
        ends = np.append(track.begins[1:], self.end.time)

        def angle(t: Array) -> tuple[Array, Array]:
            y = track.at(t, k)
            return y[0], y[1]

        t = invert_monotone(angle, theta, track.begins[k], ends[k])
        return self._samples(t, k, theta)

    def last(self) -> Samples:
        """The one sample at the end."""
        t, theta = np.array([self.end.time]), np.array([self.end.theta])
        at = self._samples(t, np.array([self.steps - 1]), theta)
        return replace(at, omega=np.array([self.end.omega]))

    @staticmethod
    def at_rest(equation: Equation, begin: State, until: float) -> Stretch:
        """A crank that its loads hold at rest, up to a time [s]."""
        y = np.array([begin.theta, 0.0, 0.0])
        rows = np.zeros((1, 8, 3))
        rows[0, 0] = y
        times = np.array([begin.time]), np.array([until - begin.time])
        return _Rest.of(equation, Track(*times, rows, until, y, equation, math.inf, 0.0, 0), begin)

    def _samples(self, t: Array, k: NDArray[np.intp], theta: Array | None = None) -> Samples:
        reached, omega, work = self.track.at(t, k)
        theta = reached if theta is None else theta
        # on a step of the pressure the value after it counts, here as in the joint forces
        train, over_angle = self.equation.pieces.train, self.equation.pieces.over_angle
        shares = self.begin.mode.shares
        inertia, slope, torque = reduce(train, theta, shares)
        outside = self.equation.branch(t, omega)
        if over_angle is not None:
            outside = outside + over_angle(theta)
        for function in self.equation.branch.functions:
            outside = outside + function(t, theta, omega)
        own = {"fuel": np.tile(shares, (len(t), 1))} if shares else {}
        if train.scene.friction is not None:
            sense = self.end.theta - self.begin.theta or self.begin.omega or self.end.omega
            slides = np.full_like(t, np.sign(sense))
            torque = torque + friction_torque(train, theta, omega, slides, shares or None)
            forces = friction_forces(train, theta, omega, own.get("fuel"), slides)
            own["friction_force"] = forces
        alpha = (torque + outside - 0.5 * slope * omega**2) / inertia
        start = self.equation.kinetic(self.begin.theta, self.begin.omega)
        residual = self.begin.residual + 0.5 * inertia * omega**2 - start - work
        return Samples(t, theta, omega, alpha, residual, {"external_torque": outside, **own})


class _Rest(Stretch):
    """A stretch at rest: friction gives what it takes, and loads the rest."""

    def _samples(self, t: Array, k: NDArray[np.intp], theta: Array | None = None) -> Samples:
        at, train = super()._samples(t, k, theta), self.equation.pieces.train
        shares = self.begin.mode.shares
        given = reduce(train, at.theta, shares).torque
        own = dict(at.own)
        if train.scene.friction is not None:
            loads = at.own["external_torque"]
            share = np.clip(held_share(train, self.begin.theta, given + loads, shares), -1.0, 1.0)
            given = given + friction_torque(train, at.theta, 0.0, share, shares or None)
            motion = at.theta, at.omega, own.get("fuel")
            own["friction_force"] = friction_forces(train, *motion, share)
        return replace(at, alpha=np.zeros_like(t), own={**own, "external_torque": -given})
