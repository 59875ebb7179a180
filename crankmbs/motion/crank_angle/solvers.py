"""The energy over the crank angle and the time, on consecutive cells at once.

A load c0 + c2 omega^2 is affine in the energy: one pass over affine maps is the answer. Everything
else is solved by Newton's method on all of them: about the last motion the torque is
f + rate E, each cell an affine map, and all of them are chained. What a cell does depends on those
before it alone, so the cells solved are the first ones, up to one that has not converged.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crankmbs.mechanics.torque import Branch, Course
from crankmbs.motion.crank_angle.grid import Grid, Terms
from crankmbs.numerics.arrays import Array, Index, largest_of_row
from crankmbs.numerics.collocation import Maps, carried, chain

__all__ = ["Begin", "Cells", "added", "lasting", "solve", "surplus", "torque_at"]

_NEWTON = 20  # steps; where they do not suffice the motion goes on from the last cell that is good
_TRIED = 2  # of them, after which cells are given up from one on whose energy is still cut
_SETTLED, _GOOD = 1e-14, 1e-11  # relative change of the energy that another step would bring
_TINY = float(np.finfo(float).tiny)
_LEAST = 0.1  # of the energy of a node before, that a step leaves it at least


class Begin(NamedTuple):
    """Sense of rotation, kinetic energy [J], time [s] and crank angle [rad] where the cells begin;
    they end after the cell that passes ``t_end``."""

    sense: float
    energy: float
    time: float
    t_end: float
    angle: float


class Cells(NamedTuple):
    """Solved cells: energy and time at their edges, torque and slowness at their nodes."""

    edges: Array
    time: Array
    torque: Array
    slowness: Array

    def first(self, m: int) -> Cells:
        """The first m cells."""
        if m == len(self.torque):
            return self
        return Cells(self.edges[: m + 1], self.time[: m + 1], self.torque[:m], self.slowness[:m])


def solve(grid: Grid, terms: Terms, loads: Branch | Course, begin: Begin) -> Cells:
    """Solved cells, the last one across the end in time or a bound of the loads in the
    speed; fewer where the energy is gone or Newton's method does not converge."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if isinstance(loads, Branch) and loads.is_affine_in_energy and not terms.drags:
            cells = _affine(grid, terms, loads, begin)
        else:
            cells = _newton(grid, terms, loads, begin)
    count = len(cells.torque)
    if count == 0:
        return cells
    if not cells.time[-1] < begin.t_end:  # or it is NaN: then as far as the energy lasts
        count = min(count, int(np.argmax(~(cells.time[1:] < begin.t_end))) + 1)
    if math.isfinite(loads.omega_low) or math.isfinite(loads.omega_high):
        omega = begin.sense / cells.slowness
        beyond = ((omega < loads.omega_low) | (omega > loads.omega_high)).any(axis=1)
        count = min(count, int(np.argmax(np.append(beyond, True))) + 1)
    return cells.first(count)


def lasting(slow: float, grid: Grid, terms: Terms, cells: Cells) -> int:
    """How many solved cells come before one whose energy would be gone within an angle ``slow``
    [rad], or that has none."""
    energy, least = cells.edges, grid.least[terms.cell]
    outside = cells.torque[:, -1] - terms.torque[:, -1]
    enough = slow * (grid.scale[terms.cell] + np.abs(outside))
    slowest = largest_of_row(cells.slowness)  # NaN where one is
    lasts = (energy[:-1] > enough) & (energy[1:] > enough)
    lasts &= 0.5 * least > enough * slowest**2
    return int(np.argmin(np.append(lasts, False)))


def added(begin: float, steps: Array) -> Array:
    """What a value is at the edges that changes by steps; summed in more bits where there are:
    passes over the same cells would round alike, and not see it in their difference."""
    return np.asarray(begin + np.append(0.0, np.cumsum(steps, dtype=np.longdouble)), np.float64)


def _affine(grid: Grid, terms: Terms, branch: Branch, begin: Begin) -> Cells:
    """dE/du = sense (T + c0) + 2 sense c2 E / J: an affine map per cell, the same every period."""
    once, of = _alike(grid, terms)
    inertia, torque, turned = terms.inertia, terms.torque, begin.sense * terms.pace
    push, rate = torque[once] + branch.c0, 2.0 * branch.c2 / inertia[once]
    maps = grid.rule.maps(turned[once], push, rate)
    rises = maps.rise
    if of is not None:
        maps = Maps(*(part.take(of, axis=0) for part in maps))
        push = push.take(of, axis=0)
    whole = of is not None
    more = surplus(grid, branch, begin.sense, rises[1:-1]) if whole else -grid.rounding
    edges = carried(maps.growth, maps.rise, begin.energy, more * terms.width)
    energy = edges[:-1, None] + maps.shift
    if branch.c2:
        energy = maps.gain * edges[:-1, None] + maps.shift
        push = push + 2.0 * branch.c2 * energy / inertia
    slowness = np.sqrt(0.5 * inertia / energy)
    time = added(begin.time, (terms.pace * slowness) @ grid.rule.weights)
    return Cells(edges, time, push, slowness)


def surplus(grid: Grid, branch: Branch, sense: float, rises: Array) -> float:
    """By how much the rises of one period's cells are too large, per radian [N m].

    Weights do no work in a period. What rounding and the rule make of it would be the same in every
    period and every pass, and come to light in neither; where nothing else acts but a constant
    load, it is known. Else it is less what `Grid.rounding` adds.
    """
    if branch.c2 or not grid.weights_alone:
        return -grid.rounding
    period = float(grid.edges[-1])
    return math.fsum([*rises.tolist(), -sense * branch.c0 * period]) / period


def _alike(grid: Grid, terms: Terms) -> tuple[slice | Index, Index | None]:
    """Cells of which the others are copies, and of which each is one: after a period they come
    again, but for the first and the last, which may be parts, and shares of the fuel."""
    count, period = len(terms.cell), len(grid.edges) - 1
    if count <= period + 2 or grid.train.law is not None:
        return slice(None), None
    of = 1 + (np.arange(count) - 1) % period
    of[0], of[-1] = 0, period + 1
    return np.append(np.arange(period + 1), count - 1), of


def _newton(grid: Grid, terms: Terms, loads: Branch | Course, begin: Begin) -> Cells:
    """Newton's method on energies e at the edges and y at the nodes.

    With the torque f and its slope k about the last ones, u' the pace, A and b the rule's matrix
    and weights, they miss

        d = e + A u' f - y      at the nodes,      D = b u' f - (next e - e)      at the edge,

    and are corrected by dy = de + d + A u' k dy and next de = de + D + b u' k dy. Time follows by
    quadrature, so that a load over the time converges as the cells do.
    """
    sense, start, t0, _, angle = begin
    rule, theta = grid.rule, np.empty(0)
    if loads.functions:
        theta = terms.angles(angle, sense, rule)
    timed = not loads.is_steady or bool(loads.functions)
    energy, edges = np.full(terms.inertia.shape, start), np.full(len(terms.cell) + 1, start)
    slowness, t = np.sqrt(0.5 * terms.inertia / energy), np.full_like(energy, t0)
    before = np.full(len(energy), math.inf)
    for step in range(_NEWTON):
        torque, slope = _linear(terms, loads, t, theta, sense / slowness)
        turned = sense * terms.pace
        push, rate = turned * torque, turned * slope
        missed = edges[:-1, None] + push @ rule.matrix.T - energy
        gain, shift = rule.corrected(missed, rate)
        rise = (push + rate * shift) @ rule.weights - np.diff(edges)
        more = chain((rate * gain) @ rule.weights, rise, 0.0)
        edges, new = edges + more, energy + gain * more[:-1, None] + shift
        change, least = largest_of_row(np.abs(new / energy - 1.0)), _LEAST * energy
        # what another step would bring, by what the last one did
        left = change * np.minimum(change / np.maximum(before, _TINY), 1.0) if step else change
        if step >= _TRIED and (new < least).any():
            m = int(np.argmax((new < least).any(axis=1)))
            if m == 0:
                break
            terms, edges, new, least = terms.first(m), edges[: m + 1], new[:m], least[:m]
            change, left, t, theta = change[:m], left[:m], t[:m], theta[:m]
        energy, before = np.maximum(new, least), change
        slowness = np.sqrt(0.5 * terms.inertia / energy)
        if timed:
            time = added(t0, (terms.pace * slowness) @ rule.weights)
            t = time[:-1, None] + (terms.pace * slowness) @ rule.matrix.T
        if not (left > _SETTLED).any():
            break
    m = int(np.argmin(np.append(left < _GOOD, False)))
    terms, slowness, theta = terms.first(m), slowness[:m], theta[:m]
    torque = torque_at(terms, loads, t[:m], theta, sense / slowness)
    work = (sense * terms.pace * torque) @ rule.weights + grid.rounding * terms.width
    edges = added(start, work)
    return Cells(edges, added(t0, (terms.pace * slowness) @ rule.weights), torque, slowness)


def _linear(
    terms: Terms, loads: Branch | Course, t: Array, theta: Array, omega: Array
) -> tuple[Array, Array]:
    """Torque [N m] and its slope over the energy [1/rad] at the nodes."""
    slope = loads.slope(omega)
    if terms.drags:
        slope = slope - terms.drag
    for function in loads.functions:
        slope = slope + function.slope(t, theta, omega)
    return torque_at(terms, loads, t, theta, omega), slope / (terms.inertia * omega)


def torque_at(terms: Terms, loads: Branch | Course, t: Array, theta: Array, omega: Array) -> Array:
    """Torque of all at the nodes [N m]; angles are for functions."""
    torque = terms.torque + loads(t, omega)
    if terms.drags:
        torque = torque - terms.drag * omega
    for function in loads.functions:
        torque = torque + function(t, theta, omega)
    return torque
