"""What solved cells of the crank angle err, by a finer Gauss rule along the solution."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.motion.crank_angle.grid import largest_of_row
from crankmbs.motion.crank_angle.solvers import torque_at
from crankmbs.numerics.arrays import Array, Index

if TYPE_CHECKING:
    from crankmbs.motion.crank_angle.window import Window

__all__ = ["Errors", "errors_of"]


class Errors(NamedTuple):
    """Of solved cells, shape (m,): error of the energy gained in each [J]; the worst of energy and
    time, relative, at its end and inside."""

    energy: Array
    at_end: Array
    inside: Array

    def raised(self, worst: Array, cell: Index) -> None:
        """Raise the largest errors so far at ends and inside of each cell of a grid, shape (2, n),
        to these; NaN where one is."""
        with np.errstate(invalid="ignore"):
            for most, errors in zip(worst, (self.at_end, self.inside), strict=True):
                np.maximum.at(most, cell, errors)


def errors_of(window: Window) -> Errors:
    """The torque and the slowness that a solution has at the finer rule's nodes, integrated up to
    these and to the cells' ends, less what its own rule made of them."""
    grid, loads, sense = window.grid, window.branch, window.sense
    rule, finer = grid.rule, grid.finer.rule
    strip = grid.finer.same(window.strip, window.begin.theta, sense)
    if window.modes:
        strip = strip.fired(window.shares)
    pace = strip.pace
    own = np.column_stack([rule.integrals(finer.nodes).T, rule.weights])
    to_nodes = np.column_stack([finer.matrix.T, finer.weights])
    gained, spent = window.torque @ own, window.slowness @ own
    with np.errstate(invalid="ignore", divide="ignore"):
        energy = window.energy[:-1, None] + sense * pace * gained[:, :-1]
        slowness = np.sqrt(0.5 * strip.inertia / np.maximum(energy, 0.0))
        t = window.time[:-1, None] + pace * spent[:, :-1]
        theta = strip.angles(window.begin.theta, sense, finer) if loads.functions else np.empty(0)
        torque = torque_at(strip, loads, t, theta, sense / slowness)
        missed = sense * pace * (torque @ to_nodes - gained)
        late = np.abs(pace * (slowness @ to_nodes - spent))
        per_time = np.maximum(1.0 / largest_of_row(window.slowness), 1.0 / window.time[1:])
        both = np.abs(missed) / window.energy[1:, None] + late * per_time[:, None]
    return Errors(missed[:, -1], both[:, -1], largest_of_row(both))
