"""What solved cells of the crank angle err, by a finer Gauss rule along the solution."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.motion.crank_angle.grid import largest_of_row
from crankmbs.motion.crank_angle.solvers import torque_at
from crankmbs.numerics.arrays import Array

if TYPE_CHECKING:
    from crankmbs.motion.crank_angle.segment import AngleSegment

__all__ = ["Errors", "errors_of"]


class Errors(NamedTuple):
    """Of solved cells, shape (m,): error of the energy gained in each [J]; the worst of energy and
    time, relative, at its end and inside."""

    energy: Array
    at_end: Array
    inside: Array


def errors_of(segment: AngleSegment) -> Errors:
    """The torque and the slowness that a solution has at the finer rule's nodes, integrated up to
    these and to the cells' ends, less what its own rule made of them."""
    grid, loads, sense = segment.grid, segment.branch, segment.sense
    rule, finer = grid.rule, grid.of_finer_rule.rule
    terms = grid.of_finer_rule.same(segment.terms, segment.begin.theta, sense)
    if segment.modes:
        terms = terms.fired(segment.shares)
    pace = terms.pace
    own = np.column_stack([rule.integrals(finer.nodes).T, rule.weights])
    to_nodes = np.column_stack([finer.matrix.T, finer.weights])
    gained, spent = segment.torque @ own, segment.slowness @ own
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
