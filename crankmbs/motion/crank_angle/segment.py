"""Solved cells of the crank angle: the motion between their edges, and what they err."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.base import NOWHERE, Samples, State
from crankmbs.motion.cells import Acting, Cells
from crankmbs.motion.crank_angle.grid import Grid, Terms
from crankmbs.motion.crank_angle.solvers import torque_at
from crankmbs.motion.mode import Mode, decided
from crankmbs.motion.states import samples_in
from crankmbs.numerics.arrays import Array, largest_of_row
from crankmbs.numerics.collocation import chain
from crankmbs.numerics.roots import first_above

__all__ = ["AngleSegment"]

_SAME = 1e-6  # rad: more than rounding of an angle, less than a cell


class Errors(NamedTuple):
    """Of solved cells, shape (m,): error of the energy gained in each [J]; the worst of energy and
    time, relative, at its end and inside."""

    energy: Array
    at_end: Array
    inside: Array


@dataclass(frozen=True)
class AngleSegment:
    """Consecutive solved cells on one branch or course of the loads.

    energy, time : shape (m + 1,), at the edges
    torque, slowness : shape (m, s), Q [N m] and dt/du [s/rad] at the nodes
    stop : cell and position in it, 0 to 1, where the segment ends; exact : what is exact there;
    skipped : cells of whole periods passed before it and not kept;
    modes : with fuel, from which cell on which mode holds.
    """

    grid: Grid
    terms: Terms
    branch: Branch | Course
    sense: float
    begin: State
    energy: Array
    time: Array
    torque: Array
    slowness: Array
    stop: tuple[int, float]
    exact: State = NOWHERE
    skipped: int = 0
    modes: tuple[tuple[int, Mode], ...] = ()

    @property
    def edges(self) -> Array:
        """Angle turned since the beginning up to each edge, u >= 0, shape (m + 1,) [rad]."""
        return self.terms.turned

    @cached_property
    def whole(self) -> Cells:
        """Its cells, the last one beyond where it ends."""
        return self._cells(0, len(self.torque))

    @cached_property
    def cells(self) -> Cells:
        """Its cells, the last one up to where it ends."""
        return self._ended(self.whole)

    def ending(self, turned: float) -> Cells:
        """Its cells from one on that begins so far before its end [rad], or farther."""
        k, x = self.stop
        begin = float(self.edges[k]) + x * float(self.terms.width[k]) - turned
        first = max(int(np.searchsorted(self.edges, begin - _SAME)) - 1, 0)
        return self._ended(self._cells(first, k + 1))

    def _ended(self, cells: Cells) -> Cells:
        """The last cells up to where the segment ends, with their energy residuals."""
        x, last = self.stop[1], len(cells.time) - 1
        residual = self.begin.residual - self.missed[-len(cells.time) :]
        cells = replace(cells, residual=residual)
        if x < 1.0:
            part = cells.part(np.array([last]), np.zeros(1), np.array([x]))
            cells = cells.first(last).joined(part)
        cells.time[-1, -1], cells.angle[-1, -1] = self.end.time, self.end.theta
        return cells

    def _cells(self, low: int, high: int) -> Cells:
        """The cells from one number to another."""
        rule, sense = self.grid.rule, self.sense
        some, edges, width = slice(low, high), slice(low, high + 1), self.terms.width[low:high]
        slowness = self.slowness[some].T
        turned = self.begin.theta + sense * self.edges[edges]
        ends = turned, self.energy[edges], self.time[edges], self.speeds[edges]
        inside = (
            sense * (width * rule.nodes[:, None]) + turned[:-1],
            sense * width * (rule.matrix @ self.torque[some].T) + self.energy[some],
            width * (rule.matrix @ slowness) + self.time[some],
            sense / slowness,
        )
        rows = np.empty((4, len(rule.nodes) + 2, high - low))  # along the cells they are long
        for row, nodes, at in zip(rows, inside, ends, strict=True):
            row[0], row[1:-1], row[-1] = at[:-1], nodes, at[1:]
        angle, energy, time, speed = rows.transpose(0, 2, 1)
        acting = Acting(sense, phases=self.begin.mode.loads, loads=self.branch)
        return Cells(time, angle, speed, acting, self.shares[some], energy)

    @cached_property
    def speeds(self) -> Array:
        """Speed [rad/s] at the edges, shape (m + 1,)."""
        inertia = np.append(self.terms.ends[:, 0], self.terms.ends[-1, 1])
        return np.asarray(self.sense * np.sqrt(2.0 * self.energy / inertia))

    @property
    def steps(self) -> int:
        """Cells in the segment and before it."""
        return self.skipped + len(self.torque)

    @property
    def size(self) -> int:
        """About how many numbers it holds."""
        return 16 * self.torque.size + self.terms.combustion.size

    @property
    def evaluations(self) -> int:
        """Nodes in the segment and before it."""
        return self.steps * len(self.grid.rule.nodes)

    @cached_property
    def last(self) -> Samples:
        """The motion where the segment ends, by the polynomials of its last cell."""
        k, x = self.stop
        at = np.zeros(1, np.intp), np.array([x])
        return samples_in(self._cells(k, k + 1), self.grid.train, *at)

    @cached_property
    def end(self) -> State:
        """The state where the segment ends; what is known exactly as it is."""
        k, x = self.stop
        theta = self.begin.theta + self.sense * float(self.edges[k] + x * self.terms.width[k])
        time, omega = float(self.time[k + 1]), float(self.speeds[k + 1])
        if x < 1.0:
            time, omega = float(self.last.time[0]), float(self.last.omega[0])
        pairs = zip(self.exact[:3], (time, theta, omega), strict=True)
        time, theta, omega = (here if math.isnan(known) else known for known, here in pairs)
        last = self.modes[-1][1] if self.modes else self.begin.mode
        mode = decided(self.grid.train, last, time, theta, omega)
        return State(time, theta, omega, self.begin.residual - float(self.missed[k + 1]), mode)

    @property
    def decisions(self) -> tuple[State, ...]:
        """The states inside at which the fuel is decided, each with the mode after."""
        if len(self.modes) < 2:
            return ()
        k = np.array([cell for cell, _ in self.modes[1:]])
        speeds, times = self.speeds[k].tolist(), self.time[k].tolist()
        before = (mode.high if self.sense > 0.0 else mode.low for _, mode in self.modes)
        after = (mode for _, mode in self.modes[1:])
        rows = zip(times, before, speeds, after, strict=False)
        return tuple(State(t, angle, speed, math.nan, mode) for t, angle, speed, mode in rows)

    @cached_property
    def errors(self) -> Errors:
        """What a finer Gauss rule along the solution gives, at its nodes and at the cell's end."""
        return _errors_of(self)

    @cached_property
    def missed(self) -> Array:
        """Error of the energy [J] that the cells have made up to each edge, shape (m + 1,); not
        known, and 0, on a grid that itself checks another."""
        if self.grid.checks:
            return np.zeros_like(self.edges)
        return np.concatenate([[0.0], np.cumsum(self.errors.energy)])

    def cut(self, t_end: float, bound: float) -> AngleSegment:
        """End where time, speed or angle leaves its bounds, whichever comes first."""
        nowhere = self.exact
        whole = self.begin.theta + self.sense * self.edges[-1]
        at_bound = math.isfinite(bound) and abs(whole - bound) <= 1e-12 * max(1.0, abs(bound))
        stops = [(self.stop, nowhere._replace(theta=bound) if at_bound else nowhere)]
        if self.time[-1] >= t_end:
            k = int(np.searchsorted(self.time[1:], t_end))
            x = self._cells(k, k + 1).place(np.zeros(1, np.intp), np.array([t_end]), in_time=True)
            stops.append(((k, float(x[0])), nowhere._replace(time=t_end)))
        for limit, above in ((self.branch.omega_low, False), (self.branch.omega_high, True)):
            if math.isfinite(limit) and limit * self.sense > 0.0:
                stop = _crossing(self, limit, above=above)
                if stop is not None:
                    stops.append((stop, nowhere._replace(omega=limit)))
        stop, exact = min(stops, key=lambda item: item[0])
        if (stop, exact) == (self.stop, self.exact):
            return self
        return self._up_to(stop, exact)

    def at_edge(self, k: int) -> State:
        """The state where a cell begins; without the energy residual, but for the first."""
        if k == 0:
            return self.begin
        mode = next((mode for cell, mode in self.modes[::-1] if cell <= k), self.begin.mode)
        theta = self.begin.theta + self.sense * float(self.edges[k])
        return State(float(self.time[k]), theta, float(self.speeds[k]), math.nan, mode)

    def ended_by(self, last: AngleSegment) -> AngleSegment:
        """With cells that were solved from where its last one begins, in place of that."""
        k = self.stop[0]
        terms = self.terms.part(0, k).joined(last.terms)
        later = tuple((k + cell, mode) for cell, mode in last.modes[1:])
        return replace(
            self,
            terms=terms,
            energy=np.concatenate([self.energy[:k], last.energy]),
            time=np.concatenate([self.time[:k], last.time]),
            torque=np.concatenate([self.torque[:k], last.torque]),
            slowness=np.concatenate([self.slowness[:k], last.slowness]),
            stop=(k + last.stop[0], last.stop[1]),
            exact=last.exact,
            modes=self.modes + later,
        )

    def first(self, m: int) -> AngleSegment:
        """The first m cells."""
        return self._up_to((m - 1, 1.0), NOWHERE)

    def _up_to(self, stop: tuple[int, float], exact: State) -> AngleSegment:
        m = stop[0] + 1
        if m == len(self.torque):
            return replace(self, stop=stop, exact=exact)
        return replace(
            self,
            terms=self.terms.first(m),
            energy=self.energy[: m + 1],
            time=self.time[: m + 1],
            torque=self.torque[:m],
            slowness=self.slowness[:m],
            stop=stop,
            exact=exact,
            modes=tuple(one for one in self.modes if one[0] < m),
        )

    @cached_property
    def shares(self) -> Array:
        """Shares of the combustion in each cell, shape (m, cylinders); without fuel (m, 0)."""
        if not self.modes:
            return np.empty((len(self.torque), 0))
        begins = [k for k, _ in self.modes]
        cells = np.diff([*begins, len(self.torque)])
        return np.repeat(np.array([mode.shares for _, mode in self.modes]), cells, axis=0)

    def rate(self, which: NDArray[np.bool_]) -> Array:
        """dQ/dE [1/rad] at the nodes of some cells."""
        omega = self.sense / self.slowness[which]
        slope = self.branch.slope(omega)
        if self.terms.drags:
            slope = slope - self.terms.drag[which]
        return slope / (self.terms.inertia[which] * omega)

    def with_more(self, gained: Array) -> AngleSegment:
        """With so much more energy [J] gained in each cell, little enough for what follows from it
        to be linear; in the cell itself the torque is higher by as much throughout."""
        width, weights = self.sense * self.terms.width, self.grid.rule.weights
        rate = self.rate(np.ones(len(width), dtype=np.bool_))
        more = chain(width * (rate @ weights), gained, 0.0)
        before = more[:-1, None]
        torque = self.torque + rate * before + (gained / width)[:, None]
        faster = self.slowness * (self.slowness**2 / self.terms.inertia * before)
        late = np.append(0.0, np.cumsum(self.terms.width * (faster @ weights)))
        return replace(
            self,
            energy=self.energy + more,
            time=self.time - late,
            torque=torque,
            slowness=self.slowness - faster,
        )


def _errors_of(segment: AngleSegment) -> Errors:
    """The torque and the slowness that a solution has at the finer rule's nodes, integrated up to
    these and to the cells' ends, less what its own rule made of them."""
    grid, loads, sense = segment.grid, segment.branch, segment.sense
    rule, finer = grid.rule, grid.of_finer_rule.rule
    terms = grid.of_finer_rule.same(segment.terms, segment.begin.theta, sense)
    if segment.modes:
        terms = terms.fired(segment.shares)
    pace = terms.pace
    weights = np.column_stack([rule.integrals(finer.nodes).T, rule.weights])
    to_nodes = np.column_stack([finer.matrix.T, finer.weights])
    gained, spent = segment.torque @ weights, segment.slowness @ weights
    with np.errstate(invalid="ignore", divide="ignore"):
        energy = segment.energy[:-1, None] + sense * pace * gained[:, :-1]
        slowness = np.sqrt(0.5 * terms.inertia / np.maximum(energy, 0.0))
        t = segment.time[:-1, None] + pace * spent[:, :-1]
        theta = terms.angles(segment.begin.theta, sense, finer) if loads.functions else np.empty(0)
        torque = torque_at(terms, loads, t, theta, sense / slowness)
        missed = sense * pace * (torque @ to_nodes - gained)
        late = np.abs(pace * (slowness @ to_nodes - spent))
        per_time = np.maximum(1.0 / largest_of_row(segment.slowness), 1.0 / segment.time[1:])
        both = np.abs(missed) / segment.energy[1:, None] + late * per_time[:, None]
    return Errors(missed[:, -1], both[:, -1], largest_of_row(both))


def _crossing(segment: AngleSegment, limit: float, *, above: bool) -> tuple[int, float] | None:
    """Cell and place in it, 0 to 1, where the speed first passes a limit [rad/s]; None where it
    does not."""
    omega = np.column_stack([segment.sense / segment.slowness, segment.speeds[1:]])
    positions = np.concatenate([[0.0], segment.grid.rule.nodes, [1.0]])
    side = 1.0 if above else -1.0
    beyond = side * (np.append(segment.begin.omega, omega) - limit)
    inside = int(np.argmax(np.append(beyond[1:] > 0.0, True)))  # stretches before it is seen
    stretches = np.append(np.flatnonzero(_may_leave(beyond)[:inside]), inside)
    for k, j in zip(*divmod(stretches, omega.shape[1]), strict=True):
        if k == len(omega):
            break

        def speed(x: Array, k: int = k) -> tuple[Array, Array]:
            there = samples_in(segment.whole, segment.grid.train, np.full(1, k), x)
            slope = segment.terms.width[k] * there.alpha / np.abs(there.omega)
            return side * (there.omega - limit), side * slope

        x = first_above(speed, positions[j], positions[j + 1])
        if x is not None:
            return int(k), x
    return None


def _may_leave(beyond: Array) -> NDArray[np.bool_]:
    """Between which of neighbouring points a value, below zero at both, may be above: where it
    turns, and falls off to the neighbours by more than is missing."""
    rise = np.diff(beyond, prepend=beyond[0], append=beyond[-1])
    before, after = rise[:-1], -rise[1:]
    near = (beyond < 0.0) & (beyond + before + after > 0.0)
    top = near & (before >= 0.0) & (after >= 0.0)
    return np.asarray(top[:-1] | top[1:])
