"""What solved cells of the crank angle err, by a finer Gauss rule along the solution."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crankmbs.motion.crank_angle import loops
from crankmbs.numerics.arrays import Array
from crankmbs.numerics.collocation import gauss

if TYPE_CHECKING:
    from crankmbs.motion.crank_angle.window import Window

__all__ = ["Errors", "errors_of"]


class Errors(NamedTuple):
    """Of solved cells, shape (m,): error of the energy gained in each [J]; the worst of energy and
    time, relative, at its end and inside."""

    energy: Array
    at_end: Array
    inside: Array


def errors_of(window: Window) -> Errors:
    """The torque and the slowness that a solution has at the finer rule's nodes, integrated up to
    these and to the cells' ends, less what its own rule made of them."""
    grid, branch, sense = window.grid, window.branch, window.sense
    rule, finer, width = grid.rule, grid.finer.rule, window.strip.width
    strip = grid.finer.same(window.strip, window.begin.theta, sense)
    if window.modes:
        begins = np.array([k for k, _ in window.modes])
        shares = np.array([mode.shares for _, mode in window.modes])
        loops.fire_each(strip.torque, strip.of_gas, (begins, shares))
    inside, rules = _between(len(rule.nodes), len(finer.nodes))
    solved = window.energy, window.time, window.torque, window.slowness
    t, slowness = np.empty((2, *strip.torque.shape))
    loops.along(sense, inside, (width, strip.inertia), solved, (t, slowness))
    if branch.functions:
        theta = strip.angles(window.begin.theta, sense, finer)
        for function in branch.functions:
            strip.torque[:] += function(t, theta, sense / slowness)
    energy, at_end, within = np.empty((3, len(width)))
    of_finer, found = (strip.torque, strip.drag, t, slowness), (energy, at_end, within)
    loops.missed(branch.tables, sense, rules, (width, *solved), of_finer, found)
    return Errors(*found)


@cache
def _between(stages: int, more: int) -> tuple[Array, tuple[Array, Array]]:
    """Integrals of a rule's polynomials up to the nodes of another; and the rules as
    `loops.missed` takes them."""
    rule, finer = gauss(stages), gauss(more)
    inside = rule.integrals(finer.nodes).T.copy()
    to_nodes = np.vstack([finer.matrix, finer.weights]).T.copy()
    return inside, (np.column_stack([inside, rule.weights]), to_nodes)
