"""Where cells of the crank angle are cut because rings feel a gas force that changes its sign.

Without fuel these angles are known, and edges of the grid. With fuel they move with the share of
the combustion that acts, which is known once the cells are solved: between two knots the pressure
is a cubic, given by its values at the nodes, and its roots become edges. As they are those of the
shares and not of the motion, solving again moves them no more than the shares err.
"""

from __future__ import annotations

import numpy as np

from crankmbs.motion.crank_angle.segment import AngleSegment
from crankmbs.numerics.arrays import Array

__all__ = ["sign_changes_in"]

_AT_EDGE = 1e-7  # rad: a root so near an edge is there
_BISECTIONS = 50  # to 1e-15 of a piece


def sign_changes_in(segment: AngleSegment) -> Array:
    """Angles turned [rad] at which gas forces change their sign inside cells and press rings;
    empty without fuel."""
    train, terms = segment.grid.train, segment.terms
    found = [np.empty(0)]
    if terms.rubbed.shape[-1] == 0 or train.pressure is None or train.combustion is None:
        return found[0]
    theta = terms.angles(segment.begin.theta, segment.sense, segment.grid.rule)
    nodes = segment.grid.rule.nodes
    to_cubic = np.linalg.pinv(np.vander(nodes, 4)).T
    x = np.concatenate([[0.0], nodes, [1.0]])
    for k, cylinder in enumerate(train.scene.cylinders):
        phi = theta + cylinder.phase
        force = train.pressure[k](phi) + segment.shares[:, k, None] * train.combustion[k](phi)
        cubics = force @ to_cubic
        values = cubics @ np.vander(x, 4).T
        cell, at = np.nonzero(values[:, 1:] * values[:, :-1] < 0.0)
        low, high = x[at], x[at + 1]
        falls = values[cell, at] > 0.0
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            positive = np.polynomial.polynomial.polyval(middle, cubics[cell, ::-1].T, False) > 0.0
            low, high = (
                np.where(positive == falls, middle, low),
                np.where(positive == falls, high, middle),
            )
        behind = low * terms.width[cell]
        inside = np.minimum(behind, terms.width[cell] - behind) > _AT_EDGE
        found.append((segment.edges[cell] + behind)[inside])
    return np.concatenate(found)
